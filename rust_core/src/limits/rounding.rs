//! Whether the processor rounds as every figure here takes for granted.

use std::hint::black_box;

use crate::error::Error;

/// Other libraries can set how the processor rounds (`fesetround`), for their thread and all that it starts.
/// Every run would come out otherwise, without a word.
///
/// # Errors
/// [`Error::Internal`] if sums are not rounded to the nearest number.
pub fn check_rounding() -> Result<(), Error> {
    let one = black_box(1.0);
    let (most, little) = (
        black_box(0.75 * f64::EPSILON),
        black_box(0.25 * f64::EPSILON),
    );
    // Rounded downwards or towards zero the first stays one, upwards the second does not.
    if one + most > one && one + little <= one {
        return Ok(());
    }
    let message = "this thread does not round to the nearest number, so results would differ: another library \
                   has called fesetround, which fesetround(FE_TONEAREST) takes back";
    Err(Error::Internal(message.to_owned()))
}
