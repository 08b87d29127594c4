//! Poses of all bodies of a robot at every sample of a run, computed from the trace for pictures.

#[cfg(test)]
mod tests;

use super::record::Columns;
use super::{Trace, ValidScenario};
use crate::error::Error;
use crate::geometry::{Pose, Vector};
use crate::limits::Cancel;
use crate::limits::memory::ask;
use crate::robot::{Body, Model, Mount, Running};
use crate::scenario::ScenarioError;

/// Poses at every sample of a run; in angles full turns count.
#[derive(Clone, Debug, Default)]
pub struct Poses {
    /// Number of samples.
    pub samples: usize,
    /// Number of bodies, as in [`Model::outlines`].
    pub count: usize,
    /// Number of ends with flippers.
    pub flippers: usize,
    /// [m, m, rad] Pose of each body.
    pub bodies: Vec<f64>,
    /// [m, m, rad] Pose of the flippers at each end: the point midway between their axles.
    pub arms: Vec<f64>,
    /// [m] Travel of each body's surface relative to its carrier.
    pub travels: Vec<f64>,
    /// [m, m] Centre of mass of the whole robot.
    pub centers_of_mass: Vec<f64>,
}

/// One sample of a trace.
struct Sample<'a> {
    chassis: Pose,
    angle: f64,
    drives: &'a [f64],
    shoes: &'a [[f64; 3]],
    flippers: &'a [f64],
}

impl Sample<'_> {
    /// Sets the positions of everything that moves relative to the chassis.
    fn set(&self, model: &Model, running: &mut Running) {
        let back = self.chassis.inverse();
        let shoe = |[x, y, angle]: &[f64; 3]| back * Pose::new(Vector::new(*x, *y), *angle);
        let turns = (0..self.flippers.len()).map(|k| self.turn(model, k));
        let (drives, shoes) = (self.drives.iter().copied(), self.shoes.iter().map(shoe));
        model.set_running(running, drives, shoes, turns);
    }

    /// [rad] Angle of a flipper relative to the chassis, counter-clockwise.
    fn turn(&self, model: &Model, flipper: usize) -> f64 {
        model.flippers[flipper].sign() * self.flippers[flipper]
    }

    /// [rad] Angle of a mount relative to the ground.
    fn angle_of(&self, model: &Model, mount: Mount) -> f64 {
        match mount {
            Mount::Chassis => self.angle,
            Mount::Shoe(shoe) => self.shoes[shoe][2],
            Mount::Flipper(k) => self.angle + self.turn(model, k),
        }
    }
}

/// Poses of the bodies of a scenario's robot, from the columns of its trace: positions, chassis angles, drive
/// positions, shoe poses, flipper angles.
///
/// # Errors
/// Columns that do not belong to the scenario; more samples than fit into memory; cancellation by the caller.
pub fn poses(checked: &ValidScenario, trace: &Trace, cancel: &Cancel) -> Result<Poses, Error> {
    let model = checked.model();
    let bodies = model.outlines();
    let samples = trace.chassis_angle.len();
    Columns::of(model).check(trace)?;
    let bytes = bytes_of([samples, bodies.len(), model.flippers.len()]);
    ask("the poses of a run", bytes)?;
    let mut found = Poses {
        samples,
        count: bodies.len(),
        flippers: model.flippers.len(),
        bodies: Vec::with_capacity(3 * samples * bodies.len()),
        travels: Vec::with_capacity(samples * bodies.len()),
        ..Poses::default()
    };
    let (shoes, _) = trace.shoe_poses.as_chunks();
    let (positions, _) = trace.position.as_chunks::<2>();
    let (drives, shoe_count) = (model.drives, model.shoes());
    let mut running = Running::default();
    for (i, (position, angle)) in positions.iter().zip(&trace.chassis_angle).enumerate() {
        cancel.check()?;
        let sample = Sample {
            chassis: Pose::new(Vector::from(*position), *angle),
            angle: *angle,
            drives: &trace.drive_positions[i * drives..][..drives],
            shoes: &shoes[i * shoe_count..][..shoe_count],
            flippers: &trace.flipper_angles[i * found.flippers..][..found.flippers],
        };
        sample.set(model, &mut running);
        found.add(model, &bodies, &sample, &running);
    }
    Ok(found)
}

/// Bytes of the poses for a number of samples, of a robot with numbers of bodies and of ends with flippers.
fn bytes_of([samples, bodies, flippers]: [usize; 3]) -> u64 {
    let numbers = samples * (4 * bodies + 3 * flippers + 2);
    8 * numbers as u64
}

impl Poses {
    fn add(&mut self, model: &Model, bodies: &[Body], sample: &Sample<'_>, running: &Running) {
        for body in bodies {
            let mount = running.mounted(body.mount, sample.chassis);
            let (origin, angle) = body.place(model, running);
            let origin = mount.transform_point(origin);
            let angle = sample.angle_of(model, body.mount) + angle;
            self.bodies.extend([origin.x, origin.y, angle]);
            self.travels.push(body.run(model, running));
        }
        for k in 0..model.flippers.len() {
            let mount = Mount::Flipper(k);
            let origin = running.mounted(mount, sample.chassis).translation;
            let angle = sample.angle_of(model, mount);
            self.arms.extend([origin.x, origin.y, angle]);
        }
        let (_, center) = model.mass_center(running);
        let center = sample.chassis.transform_point(center);
        self.centers_of_mass.extend([center.x, center.y]);
    }
}

impl Columns {
    /// Checks that the columns needed for poses have the entries of this robot.
    fn check(self, trace: &Trace) -> Result<(), ScenarioError> {
        let samples = trace.chassis_angle.len();
        for (name, column, entries) in [
            ("position", &trace.position, 2),
            ("drive_positions", &trace.drive_positions, self.drives),
            ("shoe_poses", &trace.shoe_poses, 3 * self.shoes),
            ("flipper_angles", &trace.flipper_angles, self.flippers),
        ] {
            if column.len() != samples * entries {
                let rule = format!("must have {entries} numbers for each of {samples} samples");
                return Err(ScenarioError::new(name, column.len() as f64, rule));
            }
        }
        Ok(())
    }
}
