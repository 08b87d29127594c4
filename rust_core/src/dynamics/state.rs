//! What moves: the body and its drives.

use rapier2d_f64::math::{Pose, Rotation, Vector};
use serde::{Deserialize, Serialize};

use crate::plane::left_of;
use crate::robot::Model;

/// The moving state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct State {
    /// [m] Centre of mass.
    pub center: Vector,
    /// [rad] Chassis angle; it counts full turns.
    pub angle: f64,
    /// [m/s] Velocity of the centre of mass.
    pub velocity: Vector,
    /// [rad/s] Angular velocity of the chassis.
    pub angular_velocity: f64,
    /// One for each drive.
    pub drives: Vec<DriveState>,
}

/// State of one drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DriveState {
    /// [rad/s] Spin over ground; a drive of a robot at rest has none.
    pub spin: f64,
    /// [m] How far the surface has run along its path.
    pub position: f64,
    /// [N] Mean force of the motor at the surface over the last step.
    pub force: f64,
    /// [N] Mean force of the ground on the robot along the surface over the last step.
    pub traction: f64,
}

impl State {
    /// A robot at rest with its chassis frame at `position`.
    pub(crate) fn at_rest(model: &Model, position: Vector, angle: f64, track_phase: f64) -> Self {
        let rotation = Rotation::new(angle);
        let drive = DriveState {
            position: track_phase,
            ..DriveState::default()
        };
        Self {
            center: position + rotation * model.center_of_mass,
            angle,
            velocity: Vector::ZERO,
            angular_velocity: 0.0,
            drives: vec![drive; model.drives],
        }
    }

    /// Pose of the chassis frame.
    pub(crate) fn pose(&self, model: &Model) -> Pose {
        pose_at(self.center, self.angle, model)
    }

    /// The same after a time [s] if nothing changes the velocity.
    pub(crate) fn pose_after(&self, time: f64, model: &Model) -> Pose {
        let (center, angle) = self.moved(time);
        pose_at(center, angle, model)
    }

    /// [m] How far the surface of each drive has run by then.
    pub(crate) fn drive_positions_after(
        &self,
        time: f64,
        model: &Model,
    ) -> impl Iterator<Item = f64> {
        let speeds = (0..self.drives.len()).map(|k| self.track_speed(model, k));
        self.drives
            .iter()
            .zip(speeds)
            .map(move |(d, speed)| d.position + speed * time)
    }

    /// Centre of mass [m] and angle [rad] after a time [s] if nothing changes the velocity.
    pub(super) fn moved(&self, time: f64) -> (Vector, f64) {
        (
            self.center + self.velocity * time,
            self.angle + self.angular_velocity * time,
        )
    }

    /// [m/s] Velocity of a point that rides with the chassis.
    pub(crate) fn velocity_at(&self, point: Vector) -> Vector {
        self.velocity + self.angular_velocity * left_of(point - self.center)
    }

    /// [m/s] Surface speed of a drive; positive drives towards +x.
    pub(crate) fn track_speed(&self, model: &Model, drive: usize) -> f64 {
        (self.angular_velocity - self.drives[drive].spin) * model.drive_radius
    }

    pub(super) fn is_finite(&self) -> bool {
        let body = self.center.is_finite() && self.velocity.is_finite();
        let turn = self.angle.is_finite() && self.angular_velocity.is_finite();
        body && turn
            && self
                .drives
                .iter()
                .all(|d| d.spin.is_finite() && d.position.is_finite())
    }
}

fn pose_at(center: Vector, angle: f64, model: &Model) -> Pose {
    let rotation = Rotation::new(angle);
    Pose::from_parts(center - rotation * model.center_of_mass, rotation)
}
