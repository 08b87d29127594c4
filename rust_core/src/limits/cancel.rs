//! How a caller asks a running computation to end early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Error;

/// Shared by caller and computation; once asked, the computation ends with [`Error::Interrupted`].
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Asks to end.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Returns an error if it was asked to end.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.is_asked() {
            return Err(Error::Interrupted);
        }
        Ok(())
    }
}
