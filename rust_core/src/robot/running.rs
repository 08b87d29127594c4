//! The positions of everything that moves relative to the chassis, and so the pose of every part.

use super::{Mount, Mounted};
use crate::geometry::Pose;

/// The positions of everything that moves relative to the chassis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Running {
    /// [m] Travel of the surface of each drive.
    pub drives: Vec<f64>,
    /// Frames of the shoes in that of the chassis.
    pub shoes: Vec<Pose>,
    /// Poses of the flippers.
    pub flippers: Vec<Mounted>,
}

impl Running {
    /// Frame of a mount on a robot whose chassis frame is `pose`.
    pub(crate) fn mounted(&self, mount: Mount, pose: Pose) -> Pose {
        match mount {
            Mount::Chassis => pose,
            Mount::Shoe(shoe) => pose * self.shoes[shoe],
            Mount::Flipper(k) => pose * self.flippers[k].pose,
        }
    }

    /// [m] Travel of a drive's surface relative to a mount.
    pub(crate) fn run(&self, mount: Mount, drive: usize) -> f64 {
        let over_chassis = self.drives[drive];
        match mount {
            Mount::Flipper(k) => over_chassis + self.flippers[k].run,
            Mount::Chassis | Mount::Shoe(_) => over_chassis,
        }
    }
}
