//! How an arm's motor reaches the angle that it is to hold: at its full rate, and then slowing down evenly. To stop within
//! one step it would need a torque that grows as steps get shorter.
//!
//! The equations: docs/physics.md, "Arms".

/// The motion of an arm in one step, relative to the angle that it is to hold.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Approach {
    /// [rad/s] Mean rate in the step.
    pub mean: f64,
    /// [rad/s] Rate at its end.
    pub end: f64,
    /// Whether it turns at its full rate throughout.
    pub goes_on: bool,
}

impl Approach {
    /// Motion at a constant rate [rad/s].
    pub(super) fn going_on(rate: f64) -> Self {
        Self {
            mean: rate,
            end: rate,
            goes_on: true,
        }
    }

    /// The motion in a step of `h` [s] that is to cover `way` [rad], at a rate of at most `limit` [rad/s] and a deceleration
    /// [rad/s^2] above 0. The limit is negative if the angle moves away faster than the arm can turn.
    pub(super) fn new(way: f64, [limit, deceleration]: [f64; 2], h: f64) -> Self {
        if limit <= 0.0 {
            return Self::going_on(limit * 1.0_f64.copysign(way));
        }
        let far = way.abs();
        let stops_within = 0.5 * limit * limit / deceleration;
        let at_limit = ((far - stops_within) / limit).clamp(0.0, h);
        let top = limit.min((2.0 * deceleration * far).sqrt());
        let slows = (h - at_limit).min(top / deceleration);
        let end = top - deceleration * slows;
        let turned = limit * at_limit + 0.5 * (top + end) * slows;
        Self {
            mean: (turned / h).copysign(way),
            end: end.copysign(way),
            goes_on: at_limit >= h,
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const LIMITS: [f64; 2] = [1.3, 200.0];

    /// [rad] What is left of a way after steps of `h` [s].
    fn left(way: f64, h: f64, steps: usize) -> f64 {
        (0..steps).fold(way, |way, _| way - Approach::new(way, LIMITS, h).mean * h)
    }

    #[test]
    fn the_length_of_steps_does_not_matter() {
        for way in [0.003, -0.0055, 0.02] {
            let whole = left(way, 8e-3, 1);
            assert_relative_eq!(left(way, 1e-5, 800), whole, epsilon = 1e-12);
        }
    }

    #[test]
    fn rates_continue_from_step_to_step() {
        let (way, h) = (0.006, 2e-3);
        let [first, second] = [way, left(way, h, 1)].map(|way| Approach::new(way, LIMITS, h));
        let middle = 0.5 * (first.end + second.end);
        assert_relative_eq!(second.mean, middle, max_relative = 1e-12);
    }

    #[test]
    fn it_arrives_and_stays() {
        let arrives = Approach::new(-1e-6, LIMITS, 1e-3);
        assert_relative_eq!(arrives.mean, -1e-3, max_relative = 1e-12);
        assert_relative_eq!(arrives.end, 0.0);
        assert!(!arrives.goes_on);
        assert_relative_eq!(Approach::new(0.0, LIMITS, 1e-3).mean, 0.0);
    }

    #[test]
    fn what_runs_away_is_not_caught() {
        let behind = Approach::new(-0.1, [-0.4, 200.0], 1e-2);
        assert_relative_eq!(behind.mean, 0.4);
        assert_relative_eq!(behind.end, 0.4);
        assert!(behind.goes_on);
    }

    #[test]
    fn a_long_way_goes_at_the_limit() {
        let far = Approach::new(1.0, LIMITS, 1e-2);
        assert_relative_eq!(far.mean, LIMITS[0], max_relative = 1e-12);
        assert_relative_eq!(far.end, LIMITS[0]);
        assert!(far.goes_on);
    }
}
