//! The flippers in the equations of motion.
//!
//! An arm is a body that hangs on the chassis by its pivot, so it adds one unknown, its rate, and none while
//! its motor holds the commanded rate: it then adds to the inertia of the chassis. Its mass enters as a damper
//! about the velocity that its centre of mass would have without the pivot; the impulse of that damper is the
//! impulse of the pivot.
//!
//! The equations: docs/physics.md, "Arms".

#[cfg(test)]
mod tests;

use super::Dynamics;
use super::action::Action;
use super::approach::Approach;
use super::arm::Arm;
use super::motor::{AT_LIMIT, Motor, PAST};
use super::phase::Phase;
use super::state::{State, Twist};
use super::system::Acts;
use super::trend::Trend;
use crate::geometry::{Vector, left_of};
use crate::scenario::End;

impl Dynamics {
    /// Commands angles of the flippers [rad], upwards > 0, front and rear, for a step of `h` [s]; and whether they turn
    /// against the chassis, to keep their angle to the ground. The chassis is expected to go on turning as in the last
    /// step.
    pub(crate) fn command_flippers(
        &mut self,
        state: &State,
        angles: [f64; 2],
        keep_level: [bool; 2],
        h: f64,
        trend: Option<Trend>,
    ) {
        let gained = trend.map_or(0.0, |trend| trend.turn_gained(state, 0.5 * h));
        let of_chassis = state.angular_velocity + gained;
        for (k, arm) in self.flippers.iter_mut().enumerate() {
            let end = usize::from(arm.rule.end == End::Rear);
            let way = arm.rule.sign() * angles[end] - state.over_chassis(k);
            arm.keeps_level = keep_level[end];
            if arm.rule.torque_limit > 0.0 {
                let closing = arm.rule.rate_limit - arm.follows(of_chassis) * 1.0_f64.copysign(way);
                arm.approach = Approach::new(way, [closing, arm.deceleration()], h);
            }
            arm.aim(arm.approach.mean, of_chassis);
        }
    }

    /// Has the motors aim at what they are to do at the end of a step. `began` is the angular velocity of the chassis
    /// at its beginning [rad/s]; half of its change is made.
    pub(super) fn aim_at_end(&mut self, state: &State, began: f64) {
        let of_chassis = 2.0 * state.angular_velocity - began;
        for arm in self.flippers.iter_mut().filter(|arm| !arm.approach.goes_on) {
            arm.aim(arm.approach.end, of_chassis);
        }
    }

    /// Places the arms as they are in the middle of a step, `half` [s] from now.
    pub(super) fn place_flippers(&mut self, state: &State, half: f64) {
        let center = self.model.center_of_mass;
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            let angles = [state.moved(half).1, turn.angle + turn.rate * half];
            [arm.pivot, arm.center] = arm.rule.spokes(center, angles);
        }
    }

    /// Starts a step: velocities of the arms after a time [s] under weight alone.
    pub(super) fn start_flippers(&mut self, state: &State, time: f64) {
        let chassis = state.twist();
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            arm.free = Twist {
                velocity: arm.velocity(chassis, turn.rate),
                turn: turn.rate,
            };
        }
        self.pull_flippers(state, state.angular_velocity, time);
    }

    /// Continues for a time [s] under weight and centripetal acceleration: the pivot goes round with the chassis
    /// and the arm round the pivot, which changes no rate. `began` is the angular velocity of the chassis at the
    /// beginning of the step [rad/s]. Half of the step is over, so rates have made half of their change; they
    /// are extrapolated to its end.
    pub(super) fn pull_flippers(&mut self, state: &State, began: f64, time: f64) {
        let (center, gravity) = (self.model.center_of_mass, self.gravity);
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            let [pivot, out] = arm.rule.spokes(center, [state.angle, turn.angle]);
            let of_chassis = 2.0 * state.angular_velocity - began;
            let of_arm = 2.0 * turn.rate - arm.free.turn;
            let inwards = pivot * of_chassis * of_chassis + out * of_arm * of_arm;
            arm.free.velocity += (inwards - Vector::new(0.0, gravity)) * time;
        }
    }

    pub(super) fn assemble_flippers(&mut self, phase: &Phase) {
        for (k, arm) in self.flippers.iter().enumerate() {
            if arm.held_rate().is_some() {
                self.system.hold(k);
            }
            let acts = Acts {
                drive: None,
                flipper: Some(k),
            };
            for (action, damper) in arm.dampers(phase) {
                self.system.add(&action, &action, acts, damper);
            }
        }
    }

    /// Sets the flippers' rates to those of the last solve.
    pub(super) fn take_flippers(&self, state: &mut State) {
        for (turn, solved) in state.flippers.iter_mut().zip(self.system.turns) {
            turn.rate = solved;
        }
        self.turn_flippers_with_chassis(state);
    }

    /// [1/kg] The flipper's part of the admittance of its contacts.
    pub(super) fn admittance_of_flipper(&self, k: usize, action: &Action) -> f64 {
        // Beside shoes it is as soft as they are; otherwise its grip would keep changing with theirs.
        if let Some(chain) = self.chains.first() {
            return action.unit.length_squared() / chain.rule.shoe_mass;
        }
        let lever = action.flipper_lever;
        lever * lever / self.flippers[k].inertia_about_pivot()
    }

    /// Sets the rates of flippers held by their motors, which turn with the chassis.
    pub(super) fn turn_flippers_with_chassis(&self, state: &mut State) {
        for (turn, arm) in state.flippers.iter_mut().zip(&self.flippers) {
            if let Some(rate) = arm.held_rate() {
                turn.rate = state.angular_velocity + rate;
            }
        }
    }

    /// Converts the solved rates into changes, given that of the chassis.
    pub(super) fn change_flippers(&mut self, state: &State, chassis: &Twist) {
        for (k, arm) in self.flippers.iter().enumerate() {
            self.system.changes[k] = match arm.held_rate() {
                Some(_) => chassis.turn,
                None => self.system.turns[k] - state.flippers[k].rate,
            };
        }
    }

    /// Changes the flippers' rates by a share of the changes.
    pub(super) fn move_flippers(&self, state: &mut State, share: f64) {
        for (turn, change) in state.flippers.iter_mut().zip(self.system.changes) {
            turn.rate += change * share;
        }
    }

    /// [N m s] Angular impulse of a flipper's motor so far, upwards at the front.
    pub(super) fn flipper_impulse(&self, state: &State, phase: &Phase, k: usize) -> f64 {
        let (arm, rate) = (&self.flippers[k], state.flippers[k].rate);
        if let Some(share) = arm.motor.share() {
            return arm.given(share, phase);
        }
        // The motor has made the change of angular momentum about the pivot that the contacts have not.
        let gained = arm.velocity(state.twist(), rate) - arm.free.velocity;
        let of_arm = arm.rule.mass * left_of(arm.center).dot(gained)
            + arm.rule.moment_of_inertia * (rate - arm.free.turn);
        let on_it = self.rows.iter().filter(|row| row.flipper() == Some(k));
        let of_contacts = on_it.map(|row| {
            row.normal.flipper_lever * row.normal_impulse
                + row.tangent.flipper_lever * row.friction_impulse
        });
        of_arm - of_contacts.sum::<f64>()
    }

    /// [rad/s] How far the rate of a flipper exceeds the one at which its motor aims.
    pub(super) fn flipper_ahead(&self, state: &State, k: usize) -> f64 {
        state.flippers[k].rate - state.angular_velocity - self.flippers[k].rate
    }

    /// Releases motors of flippers beyond their limit, and lets those past their rate hold again; returns whether
    /// any changed.
    pub(super) fn switch_flippers(&mut self, state: &State, phase: &Phase) -> bool {
        let mut switched = false;
        for k in 0..self.flippers.len() {
            let arm = &self.flippers[k];
            let next = match arm.motor {
                Motor::Free => Motor::Free,
                Motor::Holds => {
                    let limit = arm.given(1.0, phase) * (1.0 + AT_LIMIT);
                    Motor::within(self.flipper_impulse(state, phase, k), limit)
                }
                at_limit => {
                    let past = self.flipper_ahead(state, k) * at_limit.share().unwrap_or_default();
                    if past > PAST { Motor::Holds } else { at_limit }
                }
            };
            switched |= next != arm.motor;
            self.flippers[k].motor = next;
        }
        switched
    }

    /// Stores the mean torques of the motors over a step.
    pub(super) fn collect_flippers(&self, state: &mut State, phase: &Phase) {
        for k in 0..self.flippers.len() {
            state.flippers[k].torque = self.flipper_impulse(state, phase, k) / phase.elapsed;
        }
    }

    /// [N s] Momentum of the flippers.
    pub(super) fn momentum_of_flippers(&self, state: &State) -> Vector {
        let of = |(arm, turn): (&Arm, &super::state::Turn)| {
            arm.velocity(state.twist(), turn.rate) * arm.rule.mass
        };
        self.flippers.iter().zip(&state.flippers).map(of).sum()
    }
}
