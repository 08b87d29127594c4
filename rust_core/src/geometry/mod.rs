//! Plane geometry: vectors, discs, belts and chains round them, gear wheels, and the part of a solid inside a belt.

mod belt;
pub(crate) mod cut;
mod envelope;
mod gear;
mod hull;
mod plane;
pub(crate) mod search;
mod shoes;
mod teeth;
mod twist;

pub use belt::Grouser;
pub(crate) use belt::Motion;
pub(crate) use envelope::Envelope;
pub use gear::Gear;
pub use plane::{Disc, Vector};
pub(crate) use plane::{
    Pose, Rotation, cross, direction, end_discs, is_between, left_of, lower_tangent, outline_discs,
    plausible, plausible_vectors, right_of, turned_by,
};
pub use shoes::ShoeLoop;
pub use teeth::Teeth;
pub(crate) use twist::Twist;
