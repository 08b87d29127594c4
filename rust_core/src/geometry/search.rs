//! Searches along a line.

/// The zero of an increasing function with a change of sign between two arguments, up to rounding.
///
/// The Illinois method (Dowell and Jarratt 1971): false position, with the value at one end halved when the
/// other end moves twice. It takes a dozen calls where bisection takes fifty.
pub(crate) fn zero(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = ((low, f(low)), (high, f(high)));
    let rounding = f64::EPSILON * (low.0.abs() + high.0.abs());
    let mut last = 0.0;
    for _ in 0..100 {
        let falls_short = low.1 * high.1 >= 0.0;
        if falls_short || high.0 - low.0 <= rounding {
            break;
        }
        let middle = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let at_middle = f(middle);
        if at_middle < 0.0 {
            low = (middle, at_middle);
            if last < 0.0 {
                high.1 *= 0.5;
            }
        } else {
            high = (middle, at_middle);
            if last > 0.0 {
                low.1 *= 0.5;
            }
        }
        last = at_middle;
    }
    if low.1.abs() < high.1.abs() {
        low.0
    } else {
        high.0
    }
}

/// The argument at which a concave function is largest, by golden section.
pub(crate) fn maximise(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut at_a, mut at_b) = (f(a), f(b));
    // The bracket shrinks to 1e-11 of its start.
    for _ in 0..52 {
        if at_a < at_b {
            (low, a, at_a) = (a, b, at_b);
            b = low + SHARE * (high - low);
            at_b = f(b);
        } else {
            (high, b, at_b) = (b, a, at_a);
            a = high - SHARE * (high - low);
            at_a = f(a);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_and_peak_are_found() {
        assert!((zero(0.0, 2.0, |x| x * x - 2.0) - std::f64::consts::SQRT_2).abs() < 1e-15);
        let peak = maximise(-3.0, 5.0, |x| (x - 1.0).min(2.0 * (2.0 - x)));
        assert!((peak - 5.0 / 3.0).abs() < 1e-9);
    }

    /// False position alone keeps one end for good, and takes dozens of calls.
    #[test]
    fn a_curve_takes_a_dozen_calls_whichever_way_it_bends() {
        let curves: [fn(f64) -> f64; 2] = [|x| x.powi(5) - 0.1, |x| 0.1 - (1.0 - x).powi(5)];
        for (curve, expected) in curves
            .into_iter()
            .zip([0.1_f64.powf(0.2), 1.0 - 0.1_f64.powf(0.2)])
        {
            let calls = std::cell::Cell::new(0);
            let found = zero(0.0, 1.0, |x| {
                calls.set(calls.get() + 1);
                curve(x)
            });
            assert!((found - expected).abs() < 1e-15);
            assert!(calls.get() < 20, "{}", calls.get());
        }
    }

    /// Without a change of sign, the result is the end that is closer to one.
    #[test]
    fn a_zero_beyond_the_ends_is_sought_no_farther_than_the_nearer_end() {
        assert_eq!(zero(1.0, 2.0, |x| x).to_bits(), 1.0_f64.to_bits());
        assert_eq!(zero(-2.0, -1.0, |x| x).to_bits(), (-1.0_f64).to_bits());
    }

    #[test]
    fn a_zero_is_known_to_rounding_whatever_its_unit() {
        for unit in [1e-9, 1e-3, 1e6] {
            let calls = std::cell::Cell::new(0);
            let found = zero(0.0, 2.0 * unit, |x| {
                calls.set(calls.get() + 1);
                (x / unit) * (x / unit) - 2.0
            });
            let off = found / unit - std::f64::consts::SQRT_2;
            assert!(off.abs() < 1e-15 && calls.get() < 20, "{unit}: {off}");
        }
    }
}
