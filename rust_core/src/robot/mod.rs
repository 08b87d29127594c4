//! The robot as it is simulated: from the scenario to a body, the parts that meet the ground, and drives.

mod bodies;
mod chain;
mod closed;
mod flipper;
mod kind;
mod masses;
mod model;
mod motor;
mod mount;
mod outline;
mod part;
mod running;
mod sides;
mod start;
mod track;

pub use bodies::{ChassisBody, WheelBody};
pub use chain::{ChainOfShoes, Sprocket, Tensioner};
pub use flipper::Flipper;
pub(crate) use flipper::Mounted;
pub use kind::BodyKind;
pub use model::Model;
pub(crate) use motor::Line;
pub use motor::MotorRule;
pub(crate) use motor::held_speed;
pub use mount::Mount;
pub use outline::{Body, Circuit};
pub use part::{Part, Shape};
pub(crate) use running::Running;
pub(crate) use start::start_position;
