//! Limits of a computation: how it is asked to end, how much memory it may take, which rounding it needs.

pub(crate) mod memory;

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::error::Error;

/// Shared by caller and computation; once asked, the computation ends with [`Error::Interrupted`].
#[derive(Clone, Debug, Default)]
pub struct Cancel {
    asked: Arc<AtomicBool>,
    /// When it asks by itself.
    deadline: Option<Instant>,
}

impl Cancel {
    /// One that asks by itself at an instant.
    pub fn at(deadline: Instant) -> Self {
        Self {
            deadline: Some(deadline),
            ..Self::default()
        }
    }

    /// Asks to end.
    pub fn ask(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to end.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.deadline.is_some_and(|at| Instant::now() >= at)
    }

    /// Returns an error if it was asked to end.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.is_asked() {
            return Err(Error::Interrupted);
        }
        Ok(())
    }
}

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
