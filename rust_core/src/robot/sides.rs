//! A robot on lanes, which lie under the left track, the right track and the belly.

use super::{BodyKind, ChainOfShoes, Model, Mount, Part, Sprocket, Tensioner};
use crate::scenario::{Robot, ScenarioError};
use crate::terrain::Ground;

impl Model {
    /// The model of a robot on a ground: both tracks lumped if they meet the same profile, else side by side, each with
    /// half of the mass and force.
    ///
    /// # Errors
    /// Wheels that do not fit the robot.
    pub fn on(robot: &Robot, ground: &Ground) -> Result<Self, ScenarioError> {
        Ok(Self::new(robot)?.placed_on(ground))
    }

    /// The same, from a robot with lumped tracks.
    pub(crate) fn placed_on(self, ground: &Ground) -> Self {
        let mut model = if ground.tracks > 1 {
            self.side_by_side()
        } else {
            self
        };
        for part in &mut model.parts {
            if part.kind == BodyKind::Belly {
                part.lane = ground.middle();
            }
        }
        model
    }

    /// Parts of the left track, then of the right; drives in the same order, those with a motor first. A force along
    /// the chassis has no side and is not divided.
    fn side_by_side(self) -> Self {
        let shared = self.push_drive().into_iter().count();
        let (motors, free) = (self.motors - shared, self.drives - self.motors);
        let of_side = |drive: usize, side: usize| {
            if !self.chains.is_empty() {
                // Its first drives are those of the chains.
                2 * drive + side
            } else if drive < shared {
                drive
            } else if self.has_motor(drive) {
                drive + side * motors
            } else {
                drive + motors + side * free
            }
        };
        let shoes = self.shoes();
        let mut parts = Vec::new();
        for lane in 0..2 {
            parts.extend(self.track_parts().map(|part| Part {
                drive: part.drive.map(|k| of_side(k, lane)),
                mount: match part.mount {
                    Mount::Chassis | Mount::Flipper(_) => part.mount,
                    Mount::Shoe(i) => Mount::Shoe(i + lane * shoes),
                },
                lane,
                ..part.clone()
            }));
        }
        let drives = shared + 2 * (motors + free);
        let mut drive_masses = self.drive_masses.clone();
        drive_masses.resize(drives, 0.0);
        for (k, mass) in self.drive_masses.iter().enumerate().skip(shared) {
            drive_masses[of_side(k, 0)] = 0.5 * mass;
            drive_masses[of_side(k, 1)] = 0.5 * mass;
        }
        let chains = (0..2).flat_map(|lane| {
            let of_side = move |chain: &ChainOfShoes| ChainOfShoes {
                number: lane,
                shoes: chain.shoes.start + lane * shoes..chain.shoes.end + lane * shoes,
                tensioner: Tensioner {
                    pre_tension: 0.5 * chain.tensioner.pre_tension,
                    stiffness: 0.5 * chain.tensioner.stiffness,
                    damping: 0.5 * chain.tensioner.damping,
                    ..chain.tensioner
                },
                bushing: chain.bushing.times(0.5),
                sprocket: chain.sprocket.clone().map(|whole| Sprocket {
                    inertia: 0.5 * whole.inertia,
                    ..whole
                }),
                shoe_mass: 0.5 * chain.shoe_mass,
                shoe_inertia: 0.5 * chain.shoe_inertia,
                ..chain.clone()
            };
            self.chains.iter().map(of_side)
        });
        let chains = chains.collect();
        let motors = shared + 2 * motors;
        Self {
            parts: Self::in_order(parts, self.belly().cloned()),
            drives,
            drive_masses,
            chains,
            motor: self.motor.shared(self.motors, motors),
            motors,
            ..self
        }
    }
}
