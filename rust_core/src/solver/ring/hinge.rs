//! A hinge between two links: it keeps an end of each together.
//!
//! The equations: docs/physics.md, "Chains".

use crate::geometry::Vector;

/// How a hinge holds its two links.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hinge {
    /// [m] From the centre of each link to the end that it holds, ...
    pub ends: [Vector; 2],
    /// [m] ... and to where its impulse acts.
    pub pushed_at: [Vector; 2],
    /// [m/s] Velocity of the second end relative to the first, with which it closes.
    pub velocity: Vector,
}
