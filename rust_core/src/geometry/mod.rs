//! Plane geometry: vectors, discs, belts and chains round them, gear wheels, and the part of a solid inside a belt.

mod bounds;
pub(crate) mod cut;
mod disc;
mod envelope;
mod gear;
mod grouser;
mod hull;
mod plane;
pub(crate) mod search;
mod shoes;
mod stretch;
mod teeth;
mod travel;

pub(crate) use bounds::{plausible, plausible_vectors};
pub use disc::Disc;
pub(crate) use disc::{end_discs, lower_tangent, outline_discs};
pub(crate) use envelope::Envelope;
pub use gear::Gear;
pub use grouser::Grouser;
pub use plane::Vector;
pub(crate) use plane::{Pose, Rotation, cross, direction, left_of, right_of};
pub use shoes::ShoeLoop;
pub use teeth::Teeth;
pub(crate) use travel::Motion;
