//! Turns the commanded speed into a set-point that the drivetrain can follow.

use crate::scenario::Drivetrain;

/// [m/s] The set-point after `dt` [s]; its magnitude rises and falls at the drivetrain's rates.
pub(crate) fn set_point(now: f64, command: f64, limits: &Drivetrain, dt: f64) -> f64 {
    let (target, rate) = ramp(now, command, limits);
    now + (target - now).clamp(-rate * dt, rate * dt)
}

/// [s] How long the set-point changes at the same rate; infinite if it has its command.
pub(crate) fn ramp_time(now: f64, command: f64, limits: &Drivetrain) -> f64 {
    let (target, rate) = ramp(now, command, limits);
    let way = (target - now).abs();
    if way > 0.0 { way / rate } else { f64::INFINITY }
}

/// [m/s] Where the set-point goes, and [m/s^2] its rate.
fn ramp(now: f64, command: f64, limits: &Drivetrain) -> (f64, f64) {
    let slowing = now * command < 0.0 || command.abs() < now.abs();
    let target = if now * command < 0.0 { 0.0 } else { command };
    let rate = if slowing {
        limits.max_deceleration
    } else {
        limits.max_acceleration
    };
    (target, rate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::TorqueSharing;

    const LIMITS: Drivetrain = Drivetrain {
        max_speed: 1.0,
        max_acceleration: 0.2,
        max_deceleration: 4.0,
        max_torque: 6.0,
        torque_sharing: TorqueSharing::Track,
        rotor_inertia: 0.0,
        no_load_speed: None,
        torque_curve: None,
        controller: None,
        self_locking: false,
    };

    #[test]
    fn speeds_up_slowly_and_brakes_fast() {
        assert!((set_point(0.1, 0.4, &LIMITS, 0.1) - 0.12).abs() < 1e-15);
        assert!((set_point(0.4, 0.0, &LIMITS, 0.05) - 0.2).abs() < 1e-15);
        assert!((set_point(-0.1, -0.4, &LIMITS, 0.1) + 0.12).abs() < 1e-15);
    }

    #[test]
    fn a_ramp_lasts_until_the_command_or_a_stand() {
        assert!((ramp_time(0.1, 0.4, &LIMITS) - 1.5).abs() < 1e-12);
        assert!((ramp_time(0.1, -0.4, &LIMITS) - 0.025).abs() < 1e-12);
        assert!(ramp_time(0.4, 0.4, &LIMITS).is_infinite());
    }

    #[test]
    fn reversing_brakes_to_a_stand_first() {
        assert!((set_point(0.1, -0.4, &LIMITS, 0.1) - 0.0).abs() < 1e-15);
        assert!((set_point(0.0, -0.4, &LIMITS, 0.1) + 0.02).abs() < 1e-15);
    }

    #[test]
    fn reaches_the_command_and_stays() {
        assert!((set_point(0.399, 0.4, &LIMITS, 0.1) - 0.4).abs() < 1e-15);
    }
}
