//! Motors, and the push of a track that is modelled by a force alone.

use rapier2d_f64::math::{Rotation, Vector};

use super::Dynamics;
use super::state::State;
use crate::plane::cross;
use crate::robot::Model;

impl Dynamics {
    /// The motor holds the surface at the set-point within its force limit.
    pub(super) fn solve_motor(
        &mut self,
        state: &mut State,
        k: usize,
        set_point: f64,
        h: f64,
    ) -> f64 {
        let m = &self.model;
        let square = m.drive_radius * m.drive_radius;
        let admittance = square * (self.inverse.drive + self.inverse.inertia);
        let limit = m.drive_force * h;
        let error = set_point - state.track_speed(m, k);
        let old = self.motor_impulses[k];
        let new = (old + error / admittance).clamp(-limit, limit);
        self.motor_impulses[k] = new;
        self.push_motor(state, k, new - old);
        (new - old).abs() * admittance
    }

    /// The push drives the chassis as if its axis ran on a rail: no slip, the motor limits it.
    pub(super) fn solve_push(&mut self, state: &mut State, set_point: f64, h: f64) -> f64 {
        let m = &self.model;
        let (axis, lever) = push_axis(&self.model, state.angle);
        let slip = axis.dot(state.velocity)
            + lever * state.angular_velocity
            + m.drive_radius * state.drives[0].spin;
        let held = self.holds(0, h);
        let admittance = if held {
            // The lever at the line of action itself: the locked drive turns with the chassis.
            let lever = lever + m.drive_radius;
            1.0 / m.mass + lever * lever / m.locked_inertia()
        } else {
            1.0 / m.mass + lever * lever / m.moment_of_inertia + 1.0 / m.drive_mass
        };
        let impulse = -slip / admittance;
        self.push_impulse += impulse;
        self.push_chassis(state, impulse);
        if held {
            self.solve_motor(state, 0, set_point, h);
        }
        slip.abs()
    }

    /// The motor is within its limit, so that it gives the speed of its surface.
    ///
    /// Friction on such a surface moves the robot with the drive locked to it. Solving both
    /// together makes the sweeps agree about ten times sooner than a free, light drive would.
    pub(super) fn holds(&self, drive: usize, h: f64) -> bool {
        self.motor_impulses
            .get(drive)
            .is_some_and(|impulse| impulse.abs() < self.model.drive_force * h * (1.0 - 1e-12))
    }

    pub(super) fn push_motor(&self, state: &mut State, k: usize, impulse: f64) {
        self.spin_up(state, k, -impulse);
        state.angular_velocity += self.model.drive_radius * impulse * self.inverse.inertia;
    }

    pub(super) fn push_chassis(&self, state: &mut State, impulse: f64) {
        let (axis, lever) = push_axis(&self.model, state.angle);
        state.velocity += axis * (impulse * self.inverse.mass);
        state.angular_velocity += lever * impulse * self.inverse.inertia;
        self.spin_up(state, 0, impulse);
    }

    /// An impulse at the drive's radius; its inertia is `drive_mass x drive_radius^2`.
    pub(super) fn spin_up(&self, state: &mut State, k: usize, impulse: f64) {
        state.drives[k].spin += impulse * self.model.drive_radius * self.inverse.drive;
    }
}

/// Direction and lever of a force along the chassis at axle height, at a chassis angle [rad].
pub(crate) fn push_axis(model: &Model, angle: f64) -> (Vector, f64) {
    let rotation = Rotation::new(angle);
    let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
    // As for a contact, one drive radius above the line of action: the motor's reaction does the rest.
    let arm = model.drive_radius * up - rotation * model.center_of_mass;
    (axis, cross(arm, axis))
}
