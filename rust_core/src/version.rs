//! What this core is made of.

/// The physics library of the reference contacts and the second backend, with its exact version.
pub const ENGINE: &str = "rapier2d-f64 0.36.1";

/// Names the sources that this core was built from.
pub const BUILD_ID: &str = env!("CRAWLER2D_BUILD_ID");
