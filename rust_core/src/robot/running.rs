//! How far what moves over the chassis has moved, and so where every part is.

use super::{ChainOfShoes, Flipper, Model, Mount, Mounted};
use crate::geometry::Pose;

/// How far what moves over the chassis has moved.
#[derive(Clone, Debug, Default)]
pub(crate) struct Running {
    /// [m] How far the surface of each drive has run.
    pub drives: Vec<f64>,
    /// Frames of the shoes in that of the chassis.
    pub shoes: Vec<Pose>,
    /// Places of the flippers.
    pub flippers: Vec<Mounted>,
}

impl Running {
    /// All of a robot at time 0, when its tracks have run by `track_phase` [m].
    pub(crate) fn at_start(model: &Model, track_phase: f64) -> Self {
        let places = |chain: &ChainOfShoes| chain.path.places(track_phase);
        let mounted = |arm: &Flipper| arm.mounted(arm.sign() * arm.start_angle, model.drive_radius);
        Self {
            drives: vec![track_phase; model.drives],
            shoes: model.chains.iter().flat_map(places).collect(),
            flippers: model.flippers.iter().map(mounted).collect(),
        }
    }

    /// All of a robot again: how far its drives have run [m], frames of its shoes in that of the chassis, how far
    /// its flippers are turned over the chassis [rad], counter-clockwise. Steps and samples of a run come here.
    pub(crate) fn set(
        &mut self,
        model: &Model,
        drives: impl Iterator<Item = f64>,
        shoes: impl Iterator<Item = Pose>,
        turns: impl Iterator<Item = f64>,
    ) {
        self.drives.clear();
        self.drives.extend(drives);
        self.shoes.clear();
        self.shoes.extend(shoes);
        let flippers = model.flippers.iter().zip(turns);
        let mounted = flippers.map(|(arm, turn)| arm.mounted(turn, model.drive_radius));
        self.flippers.clear();
        self.flippers.extend(mounted);
    }

    /// Frame of a mount on a robot whose chassis frame is `pose`.
    pub(crate) fn mounted(&self, mount: Mount, pose: Pose) -> Pose {
        match mount {
            Mount::Chassis => pose,
            Mount::Shoe(shoe) => pose * self.shoes[shoe],
            Mount::Flipper(k) => pose * self.flippers[k].pose,
        }
    }

    /// [m] How far the surface of a drive has run over a mount.
    pub(crate) fn run(&self, mount: Mount, drive: usize) -> f64 {
        let over_chassis = self.drives[drive];
        match mount {
            Mount::Flipper(k) => over_chassis + self.flippers[k].run,
            Mount::Chassis | Mount::Shoe(_) => over_chassis,
        }
    }
}
