//! All zeros of a smooth function on ranges of an angle.
//!
//! The functions of this module are polynomials of degree at most 10 in cosine and sine of the angle. On pieces some
//! degrees wide they are polynomials of degree 11, up to rounding. A series of Chebyshev polynomials bounds value,
//! slope and curvature of such a piece, so that no zero is missed: a piece is left out only if these exclude one.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Terms of a series.
const TERMS: usize = 12;
/// [rad] Widest piece: the terms left out are 1e-16 of a polynomial of degree 10.
const WIDEST: f64 = 0.09;
/// [rad] Narrowest piece, for functions that are not polynomials.
const NARROWEST: f64 = 1e-6;
/// Largest fraction of a series in its last two terms; smaller values are rounding errors.
const RESOLVED: f64 = 1e-9;
const ROUNDING: f64 = 1e-12;
/// Fraction of a piece below which zeros are merged, and to which they are known.
const NEAREST: f64 = 1e-6;
const ACCURACY: f64 = 1e-14;

/// Points at which a piece is sampled, from -1 to 1, and the weight of each sample in each term.
struct Table {
    nodes: [f64; TERMS],
    shares: [[f64; TERMS]; TERMS],
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let angle = |i: usize| PI * (i as f64 + 0.5) / TERMS as f64;
    let share = |k: usize, i: usize| {
        let whole = if k == 0 { 1.0 } else { 2.0 };
        whole / TERMS as f64 * libm::cos(k as f64 * angle(i))
    };
    Table {
        nodes: std::array::from_fn(|i| libm::cos(angle(i))),
        shares: std::array::from_fn(|k| std::array::from_fn(|i| share(k, i))),
    }
});

/// A value that is a difference, and the size of its terms.
pub(super) type Difference = [f64; 2];

/// All zeros of a function in ranges of angles; two that coincide are returned once or twice. Where the function
/// consists only of rounding errors, it has no zeros.
pub(super) fn zeros(
    ranges: impl Iterator<Item = [f64; 2]>,
    f: impl Fn(f64) -> Difference,
) -> Vec<f64> {
    let mut found = Vec::new();
    for [low, high] in ranges {
        let count = ((high - low) / WIDEST).ceil().max(1.0);
        let end = |i: f64| low + (high - low) * i / count;
        for i in 0..count as usize {
            let piece = [end(i as f64), end(i as f64 + 1.0)];
            zeros_of_piece(piece, &f, &mut found);
        }
    }
    found
}

/// Divides a range into pieces that grow with the distance from an angle, for a function that bends sharply within
/// `least` of it.
pub(super) fn graded([low, high]: [f64; 2], at: f64, least: f64) -> Vec<[f64; 2]> {
    let far = [low, high].map(|end| (end - at).abs());
    let steps = libm::log2(far[0].max(far[1]) / least).ceil().max(0.0) as i32;
    let away = (0..=steps).map(|k| least * 2.0_f64.powi(k));
    let mut ends: Vec<f64> = away.flat_map(|step| [at - step, at + step]).collect();
    ends.extend([low, at, high]);
    ends.retain(|end| (low..=high).contains(end));
    ends.sort_by(f64::total_cmp);
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn zeros_of_piece(piece: [f64; 2], f: &impl Fn(f64) -> Difference, found: &mut Vec<f64>) {
    let [low, high] = piece;
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (series, size) = Series::of(|t| f(middle + half * t));
    let others: f64 = series.terms[1..].iter().map(|term| term.abs()).sum();
    let sum = series.terms[0].abs() + others;
    let slack = ROUNDING * sum;
    let is_nothing = !sum.is_finite() || sum <= ROUNDING * size;
    if is_nothing || series.terms[0].abs() > others + slack + size * f64::EPSILON {
        return;
    }
    let last: f64 = series.terms[TERMS - 2..].iter().map(|t| t.abs()).sum();
    if half > NARROWEST && last > RESOLVED * sum + 10.0 * size * f64::EPSILON {
        zeros_of_piece([low, middle], f, found);
        zeros_of_piece([middle, high], f, found);
        return;
    }
    let angle = |t: f64| middle + half * t;
    found.extend(series.zeros(slack).into_iter().map(angle));
}

/// A sum of Chebyshev polynomials on [-1, 1].
struct Series {
    terms: [f64; TERMS],
}

impl Series {
    /// The series with these values, and the largest of their sizes.
    fn of(f: impl Fn(f64) -> Difference) -> (Self, f64) {
        let table = &*TABLE;
        let values = table.nodes.map(f);
        let term = |shares: &[f64; TERMS]| {
            let parts = shares
                .iter()
                .zip(values)
                .map(|(share, [value, _])| share * value);
            parts.sum()
        };
        let terms = std::array::from_fn(|k| term(&table.shares[k]));
        let size = values
            .iter()
            .fold(0.0, |most: f64, [_, size]| most.max(*size));
        (Self { terms }, size)
    }

    /// Value and slope.
    fn at(&self, t: f64) -> (f64, f64) {
        // T0 and T1, and their slopes.
        let (mut before, mut now) = ((1.0, 0.0), (t, 1.0));
        let mut sum = (self.terms[0] + self.terms[1] * t, self.terms[1]);
        for term in &self.terms[2..] {
            let next = (
                2.0 * t * now.0 - before.0,
                2.0 * now.0 + 2.0 * t * now.1 - before.1,
            );
            (before, now) = (now, next);
            sum.0 += term * now.0;
            sum.1 += term * now.1;
        }
        sum
    }

    /// A bound for the curvature: that of the k-th polynomial is largest at the ends, k^2 (k^2 - 1) / 3.
    fn curvature(&self) -> f64 {
        let of = |(k, term): (usize, &f64)| {
            let square = (k * k) as f64;
            term.abs() * square * (square - 1.0) / 3.0
        };
        self.terms.iter().enumerate().skip(2).map(of).sum()
    }

    fn zeros(&self, slack: f64) -> Vec<f64> {
        let curvature = self.curvature();
        let mut found = Vec::new();
        let mut pieces = vec![[-1.0, 1.0]];
        while let Some([low, high]) = pieces.pop() {
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            let (value, slope) = self.at(middle);
            let bend = curvature * half;
            if value.abs() > slope.abs() * half + 0.5 * bend * half + slack {
                continue;
            }
            if slope.abs() > bend {
                found.extend(self.only_zero(low, high, slack));
            } else if half < NEAREST {
                found.push(middle);
            } else {
                pieces.extend([[low, middle], [middle, high]]);
            }
        }
        found
    }

    /// The zero of a piece in which it is monotone; an end within rounding of zero counts.
    fn only_zero(&self, mut low: f64, mut high: f64, slack: f64) -> Option<f64> {
        let (at_low, at_high) = (self.at(low).0, self.at(high).0);
        if at_low * at_high > 0.0 {
            let (least, end) = if at_low.abs() < at_high.abs() {
                (at_low, low)
            } else {
                (at_high, high)
            };
            return (least.abs() <= slack).then_some(end);
        }
        let rises = at_low < at_high;
        let mut t = 0.5 * (low + high);
        // Newton's steps, or bisection where they leave the piece.
        for _ in 0..60 {
            let (value, slope) = self.at(t);
            if (value > 0.0) == rises {
                high = t;
            } else {
                low = t;
            }
            let next = t - value / slope;
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - t).abs() <= ACCURACY {
                return Some(next);
            }
            t = next;
        }
        Some(t)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn sorted(f: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut found = zeros(std::iter::once([-0.5 * TAU, 0.5 * TAU]), |x| {
            [f(x), f(x).abs()]
        });
        found.sort_by(f64::total_cmp);
        found
    }

    /// A polynomial in cosine and sine with these zeros, of half their number as its degree.
    fn product(roots: &[f64]) -> impl Fn(f64) -> f64 + '_ {
        |x| roots.iter().map(|r| libm::sin(0.5 * (x - r))).product()
    }

    #[test]
    fn all_zeros_of_a_product_come_back() {
        let mut state = 1_u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut tried = 0;
        for case in 0..4_000 {
            let degree = 1 + case % 10;
            let roots: Vec<f64> = (0..2 * degree).map(|_| TAU * (draw() - 0.5)).collect();
            let found = sorted(product(&roots));
            let alone = |r: &f64| roots.iter().filter(|o| (*o - r).abs() < 1e-3).count() == 1;
            for root in roots.iter().filter(|root| alone(root)) {
                let nearest = found.iter().map(|f| (f - root).abs()).fold(1.0, f64::min);
                assert!(
                    nearest < 1e-9,
                    "case {case}: {root} of {roots:?} in {found:?}"
                );
                tried += 1;
            }
        }
        assert!(tried > 40_000, "{tried}");
    }

    #[test]
    fn a_double_zero_is_not_missed() {
        let found = sorted(product(&[0.3, 0.3, -1.0, 2.0]));
        assert!(found.iter().any(|f| (f - 0.3).abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn no_zero_is_made_up() {
        assert!(sorted(|x| 1.1 + libm::cos(x)).is_empty());
        let found = sorted(|x| 0.5 + libm::cos(x));
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|f| (f.abs() - TAU / 3.0).abs() < 1e-14));
    }

    #[test]
    fn rounding_errors_have_no_zeros() {
        let found = zeros(std::iter::once([-1.0, 1.0]), |x| {
            [libm::sin(1e9 * x) * 1e-16, 1.0]
        });
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn zeros_are_those_of_the_function_times_any_number() {
        let roots = [-2.5, -0.4, 0.3, 0.300_1, 1.7, 2.9];
        let f = product(&roots);
        for scale in [1e-30, 1e-9, 1e-3, 1e3, 1e30] {
            let found = sorted(|x| scale * f(x));
            assert_eq!(found.len(), roots.len(), "{scale:e}: {found:?}");
            for (found, root) in found.iter().zip(roots) {
                assert!((found - root).abs() < 1e-9, "{scale:e}: {found} {root}");
            }
        }
    }

    #[test]
    fn pieces_that_grow_away_from_a_sharp_turn_resolve_it() {
        for width in [1e-2, 1e-4, 1e-6] {
            let f = |x: f64| [x / x.hypot(width) - 0.5, 1.0];
            let found = zeros(graded([-1.0, 1.3], 0.0, width).into_iter(), f);
            let zero = width / 3.0_f64.sqrt();
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((found[0] - zero).abs() < 1e-5 * width, "{found:?}");
        }
    }

    /// On the widest pieces, no series of 12 terms is close to it, in any unit.
    #[test]
    fn what_turns_sharply_is_divided_until_its_series_is_near() {
        let width = 1e-3;
        for scale in [1.0, 1e-20] {
            let f = |x: f64| [scale * (x / x.hypot(width) - 0.5), scale];
            let found = zeros(std::iter::once([-1.0, 1.3]), f);
            let zero = width / 3.0_f64.sqrt();
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((found[0] - zero).abs() < 1e-5 * width, "{found:?}");
        }
    }

    #[test]
    fn a_range_is_cut_into_few_pieces_none_wider_than_it_is_far_from_an_angle() {
        for (range, at, least) in [
            ([-1.0, 1.3], 0.2, 1e-3),
            ([0.5, 1.0], 0.2, 1e-3),
            ([-1.0, -0.5], 0.2, 0.01),
            ([-1.0, 0.0], 0.8, 0.1),
            ([-1.0, 1.0], 0.0, 4.0),
        ] {
            let pieces = graded(range, at, least);
            let ends = [pieces[0][0], pieces[pieces.len() - 1][1]];
            assert_eq!(ends.map(f64::to_bits), range.map(f64::to_bits));
            let joined = pieces.windows(2).map(|pair| pair[1][0] - pair[0][1]);
            assert!(joined.map(f64::abs).fold(0.0, f64::max) <= 0.0);
            for [low, high] in &pieces {
                let far = (low - at).max(at - high).max(least);
                assert!(
                    (0.0..=far + 1e-12).contains(&(high - low)),
                    "{low} to {high}"
                );
            }
            let most = range
                .map(|end| (end - at).abs())
                .into_iter()
                .fold(0.0, f64::max);
            let steps = (most / least).log2().max(0.0);
            assert!((pieces.len() as f64) < 2.0 * steps + 4.0, "{pieces:?}");
        }
    }

    /// Chebyshev's polynomial of degree k is the cosine of k times an angle whose cosine is t.
    #[test]
    fn a_series_has_the_values_and_slopes_of_cosines_and_its_curvature_at_an_end() {
        for case in 0..40 {
            let share = |k: usize| libm::sin((7 * case + 3 * k) as f64);
            let series = Series {
                terms: std::array::from_fn(share),
            };
            for i in 1..20 {
                let angle = PI * f64::from(i) / 20.0;
                let (sine, cosine) = libm::sincos(angle);
                let of = |k: usize| (k as f64 * angle, k as f64 * share(k));
                let value: f64 = (0..TERMS).map(|k| share(k) * of(k).0.cos()).sum();
                let slope: f64 = (0..TERMS).map(|k| of(k).1 * of(k).0.sin() / sine).sum();
                let found = series.at(cosine);
                // Slopes are a hundred times as large near the ends.
                assert!((found.0 - value).abs() < 1e-12 && (found.1 - slope).abs() < 1e-10);
            }
            let alike = Series {
                terms: std::array::from_fn(|k| share(k).abs()),
            };
            let step = 1e-6;
            let bend = (alike.at(1.0 + step).1 - alike.at(1.0 - step).1) / (2.0 * step);
            for series in [&alike, &series] {
                assert!((series.curvature() / bend - 1.0).abs() < 1e-6, "{bend}");
            }
        }
    }

    #[test]
    fn an_end_of_a_piece_within_rounding_of_zero_is_one() {
        // t + 1, t - 1 and their opposites, a little off their zeros.
        for (sign, end) in [(1.0, -1.0), (-1.0, 1.0)] {
            for side in [1.0, -1.0] {
                let mut terms = [0.0; TERMS];
                (terms[0], terms[1]) = (side * sign * (1.0 + 1e-13), side);
                let series = Series { terms };
                let found = series.only_zero(-1.0, 1.0, 1e-12);
                assert_eq!(found.map(f64::to_bits), Some(f64::to_bits(end)));
                assert!(series.only_zero(-1.0, 1.0, 1e-14).is_none());
            }
        }
    }
}
