//! The local error of a step: by how much its motion differs from the mean of the velocities at its ends.
//!
//! The motion uses the velocities of the first solve, which is the midpoint rule; the mean of the velocities before and
//! after is the trapezoidal rule. Both are of second order, and they differ most where velocities jump.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::Dynamics;
use super::state::State;
use crate::geometry::Twist;
use crate::units::Seconds;

/// [s] Shortest step that is tried for the sake of accuracy.
pub(crate) const SHORTEST: Seconds = Seconds(2e-5);
/// Share of a shoe's error that counts: shoes are light, and swing where the chain is slack.
const OF_SHOES: f64 = 0.1;

impl Dynamics {
    /// [m] The local error of a step of `h` [s] from `before` to `after`: the largest error of any point of the robot, whose
    /// farthest point is `reach` [m] from its centre of mass, of any driven surface, and a tenth of that of any pin; or the
    /// depth to which a tip dips into the ground, if that is larger.
    pub(crate) fn local_error(&self, [before, after]: [&State; 2], h: f64, reach: f64) -> f64 {
        let moved = &self.motion;
        let off = |ends: [f64; 2], middle: f64| 0.5 * (ends[0] + ends[1]) - middle;
        let off_twist = |ends: [Twist; 2], middle: Twist| Twist {
            velocity: (ends[0].velocity + ends[1].velocity) * 0.5 - middle.velocity,
            turn: off(ends.map(|twist| twist.turn), middle.turn),
        };
        let chassis = off_twist([before.twist(), after.twist()], moved.twist());
        let of_chassis = chassis.velocity.length();
        let mut most = of_chassis + reach * chassis.turn.abs();
        // The drive of a chain on a guide moves as its shoes do, which count below.
        let on_guide = |k: usize| self.chains.get(k).is_some_and(|c| !c.has_sprocket());
        let drives = moved.drives.iter().enumerate();
        for (k, drive) in drives.filter(|(k, _)| !on_guide(*k)) {
            let spin = off([before.drives[k].spin, after.drives[k].spin], drive.spin);
            most = most.max(self.model.drive_radius * (spin - chassis.turn).abs());
        }
        for (k, flipper) in moved.flippers.iter().enumerate() {
            let rate = off(
                [before.flippers[k].rate, after.flippers[k].rate],
                flipper.rate,
            );
            most = most.max(of_chassis + reach * rate.abs());
        }
        let half_pitch = self
            .chains
            .first()
            .map_or(0.0, |chain| 0.5 * chain.rule.path.pitch);
        for (k, shoe) in moved.shoes.iter().enumerate() {
            let off = off_twist([before.shoes[k].twist, after.shoes[k].twist], shoe.twist);
            most = most.max(OF_SHOES * (off.velocity.length() + half_pitch * off.turn.abs()));
        }
        let contacts = self.touches.iter().zip(&self.problem.contacts);
        let dips = contacts.map(|(touch, solved)| touch.dip(solved));
        dips.fold(h * most, f64::max)
    }
}
