//! When, within a step, a motor reaches its speed or the end of a piece of its curve, or a contact stops sliding: a force
//! or its slope jumps then, and the step should end there.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::local_error::SHORTEST;
use super::{Dynamics, SetPoint};
use crate::solver::{Grip, MotorState};

/// A step is cut only at a time before this share of its length.
const LONGEST_SHARE: f64 = 0.97;

/// A speed that a motor or friction brings to 0, as found in the middle of a step.
#[derive(Clone, Copy)]
enum Middle {
    /// It is held at 0, by this share of the largest impulse.
    Held(f64),
    /// [m/s] It is not 0 yet, but this.
    Left(f64),
}

/// [s] When a speed of `lag` [m/s] at the beginning of a step reaches 0 under a constant force, from what it is in the
/// middle, after `half` [s]; none if the step as a whole is wrong by no more than `accuracy` [m].
fn arrival(lag: f64, middle: Middle, half: f64, accuracy: f64) -> Option<f64> {
    let step = 2.0 * half;
    let (time, off) = match middle {
        // A lock bears more than its motor can give, and holds from the middle on at the latest.
        Middle::Held(share) => {
            let time = if share > 1.0 { half } else { half * share };
            (time, 0.5 * lag.abs() * time)
        }
        Middle::Left(left) => {
            let time = half * lag / (lag - left);
            (time, 0.5 * lag.abs() * (step - time) * (step - time) / time)
        }
    };
    let is_within = time > SHORTEST.value() && time < LONGEST_SHARE * step;
    (is_within && off > accuracy).then_some(time)
}

/// [s] When a speed [m/s] under a constant force leaves a range, from what it is at the beginning and in the middle of a
/// step; none as above. At least the shortest step, so that the next step begins outside.
fn departure(speed: [f64; 2], [low, high]: [f64; 2], half: f64, accuracy: f64) -> Option<f64> {
    let step = 2.0 * half;
    let [begin, middle] = speed;
    let gain = middle - begin;
    let last = begin + 2.0 * gain;
    let (end, past) = if last > high {
        (high, last - high)
    } else {
        (low, low - last)
    };
    let time = (half * (end - begin) / gain).max(SHORTEST.value());
    let off = 0.5 * past * (step - time);
    (time < LONGEST_SHARE * step && off > accuracy).then_some(time)
}

impl Dynamics {
    /// Notes the speeds that motors and friction may bring to 0 within a step: those of the drives relative to their
    /// set-points, and those at which contacts slide.
    pub(super) fn note_lags(&mut self, set_point: SetPoint) {
        let problem = &self.problem;
        let target = self.model.motor.target(set_point.start());
        let drives = &problem.motors[self.model.drive_motors()];
        let of_drives = drives
            .iter()
            .map(|motor| problem.motor_speed(motor) - target);
        let of_contacts = problem.contacts.iter().map(|contact| {
            if contact.grip == Grip::Sticks {
                0.0
            } else {
                contact.tangent.along(&problem.unknowns) + contact.tangent.offset
            }
        });
        self.lags.clear();
        self.lags.extend(of_drives.chain(of_contacts));
    }

    /// [s] When the first of these reaches 0, or a motor leaves the piece of its curve that limits it, from what they are in the
    /// middle of a step, after `half` [s]; none if the step as a whole is wrong by no more than `accuracy` [m].
    pub(super) fn first_arrival(&self, half: f64, accuracy: f64) -> Option<f64> {
        let problem = &self.problem;
        let drives = &problem.motors[self.model.drive_motors()];
        let of_drives = drives.iter().map(|motor| match motor.state {
            _ if motor.correction.is_some() => None,
            MotorState::Holds => Some(Middle::Held(problem.motor_load(motor))),
            MotorState::LimitForwards | MotorState::LimitBackwards => {
                Some(Middle::Left(problem.motor_speed(motor) - motor.target))
            }
            MotorState::Locked | MotorState::Absent => None,
        });
        let of_contacts = problem.contacts.iter().map(|contact| match contact.grip {
            _ if !contact.friction.resists() => None,
            Grip::Sticks => Some(Middle::Held(contact.friction_load())),
            Grip::Forwards | Grip::Backwards => {
                let slip = contact.tangent.along(&problem.unknowns);
                Some(Middle::Left(slip + contact.tangent.offset))
            }
            Grip::Open => None,
        });
        let middles = of_drives.chain(of_contacts);
        let arrivals = (self.lags.iter().zip(middles))
            .filter_map(|(lag, middle)| arrival(*lag, middle?, half, accuracy));
        let departures = drives
            .iter()
            .zip(&self.forces)
            .filter_map(|(motor, forces)| {
                if matches!(motor.state, MotorState::Locked | MotorState::Absent) {
                    return None;
                }
                let pushes_back = problem.motor_impulse(motor) < 0.0;
                let speeds = [forces.speed, problem.motor_speed(motor)];
                departure(
                    speeds,
                    forces.ends[usize::from(pushes_back)],
                    half,
                    accuracy,
                )
            });
        arrivals.chain(departures).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn a_speed_that_is_lost_evenly_is_lost_at_its_share_of_the_time() {
        // 0.3 m/s at 400 m/s^2: after 0.75 ms, in the first half of a long step and in the second of a short one.
        let (lag, loss) = (-0.3, 400.0);
        let time = 0.3 / loss;
        let held = arrival(lag, Middle::Held(time / 2e-3), 2e-3, 1e-7);
        assert_relative_eq!(held.expect("it is within"), time, max_relative = 1e-12);
        let left = arrival(lag, Middle::Left(lag + loss * 5e-4), 5e-4, 1e-7);
        assert_relative_eq!(left.expect("it is within"), time, max_relative = 1e-12);
    }

    #[test]
    fn a_speed_leaves_a_range_at_its_share_of_the_time_or_after_the_shortest_step() {
        let within =
            |begin: f64, gain: f64| departure([begin, begin + gain], [0.1, 0.3], 5e-3, 1e-7);
        // 20 m/s^2 over 10 ms.
        assert_relative_eq!(
            within(0.2, 0.1).expect("upwards"),
            5e-3,
            max_relative = 1e-12
        );
        assert_relative_eq!(
            within(0.2, -0.1).expect("downwards"),
            5e-3,
            max_relative = 1e-12
        );
        assert_eq!(within(0.3, 0.1), Some(SHORTEST.value()));
        assert_eq!(
            [within(0.2, 0.04), within(0.2, 0.0), within(0.1, 0.0)],
            [None; 3]
        );
        // 0.04 m/s beyond either end after the 20 / 7 ms that are left: 57 um, if evenly gained.
        for middle in [0.27, 0.13] {
            let speeds = [0.2, middle];
            let [coarse, fine] = [6e-5, 5e-5].map(|off| departure(speeds, [0.1, 0.3], 5e-3, off));
            assert!(coarse.is_none() && fine.is_some());
        }
    }

    #[test]
    fn what_a_step_is_not_off_by_does_not_cut_it() {
        let half = 1e-3;
        for lag in [0.1, 1e-2] {
            // The middle has no speed all the time, and there was half of the lag up to then.
            let off = 0.5 * lag * 0.25 * half;
            let cut = |accuracy| arrival(lag, Middle::Held(0.25), half, accuracy);
            assert_eq!(cut(0.9 * off), Some(0.25 * half));
            assert_eq!(cut(1.1 * off), None);
        }
        // 0.3 m/s at 400 m/s^2 have gone after 0.75 of 1 ms, and then grow the other way.
        let left = |accuracy| arrival(-0.3, Middle::Left(-0.1), 5e-4, accuracy);
        let off = 0.5 * 400.0 * 2.5e-4 * 2.5e-4;
        assert!(left(0.9 * off).is_some() && left(1.1 * off).is_none());
    }

    #[test]
    fn a_speed_that_grows_or_stays_never_arrives() {
        for left in [0.2, 0.3] {
            assert_eq!(arrival(0.2, Middle::Left(left), 1e-3, 1e-9), None);
        }
        assert_eq!(arrival(0.0, Middle::Held(0.0), 1e-3, 1e-9), None);
    }
}
