//! Checks the rounding mode of the processor, on which all results depend.

use std::hint::black_box;

use crate::error::Error;

/// Other libraries can change the rounding mode (`fesetround`) for their thread and all threads that it starts.
/// Every result would then differ, without notice.
///
/// # Errors
/// [`Error::Internal`] if sums are not rounded to the nearest number.
pub fn check_rounding() -> Result<(), Error> {
    let one = black_box(1.0);
    let (most, little) = (
        black_box(0.75 * f64::EPSILON),
        black_box(0.25 * f64::EPSILON),
    );
    // Rounded downwards or towards zero, the first sum stays one; rounded upwards, the second does not.
    if one + most > one && one + little <= one {
        return Ok(());
    }
    let message = "this thread does not round to the nearest number, so results would differ: another library \
                   has called fesetround; fesetround(FE_TONEAREST) undoes it";
    Err(Error::Internal(message.to_owned()))
}
