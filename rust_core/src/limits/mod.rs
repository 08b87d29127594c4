//! Limits of a computation: how it is asked to end, how much memory it may take, which rounding it needs.

mod cancel;
pub(crate) mod memory;
mod rounding;

pub use cancel::Cancel;
pub use rounding::check_rounding;
