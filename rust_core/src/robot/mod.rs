//! The robot as it is simulated: from the scenario to a body, the parts that meet the ground, and drives.

mod closed;
mod masses;
mod model;
mod motor;
mod moving_parts;
mod outline;
mod parts;
mod sides;
mod start;
#[cfg(test)]
mod tests;
mod track;

pub use masses::{ChassisBody, WheelBody};
pub use model::Model;
pub use motor::MotorRule;
pub(crate) use motor::{Line, held_speed};
pub(crate) use moving_parts::Bushing;
pub(crate) use moving_parts::Mounted;
pub use moving_parts::{ChainOfShoes, Flipper, Sprocket, Tensioner};
pub use outline::{Body, Circuit};
pub(crate) use parts::Running;
pub use parts::{BodyKind, Mount, Part, Shape};
pub(crate) use start::start_position;
