//! How far two rates may be told apart.

/// 95 % quantile of the normal distribution, both sides.
const Z: f64 = 1.959_964;

/// Interval of 95 % of a rate, after Wilson.
pub(crate) fn wilson(hits: u32, runs: u32) -> [f64; 2] {
    let (n, p) = (f64::from(runs), f64::from(hits) / f64::from(runs));
    let center = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    [center - half, center + half]
}

/// Interval of 95 % of the difference of two rates, after Newcombe (from Wilson's intervals).
pub(crate) fn difference(first: u32, second: u32, runs: u32) -> [f64; 2] {
    let rate = |hits: u32| f64::from(hits) / f64::from(runs);
    let (p, q) = (rate(first), rate(second));
    let ([pl, pu], [ql, qu]) = (wilson(first, runs), wilson(second, runs));
    [
        p - q - ((p - pl).powi(2) + (qu - q).powi(2)).sqrt(),
        p - q + ((pu - p).powi(2) + (q - ql).powi(2)).sqrt(),
    ]
}

/// Probability that equal rates differ by as much or more, after Fisher, both sides.
pub(crate) fn fisher(first: u32, second: u32, runs: u32) -> f64 {
    let hits = first + second;
    let log_choose = |n: u32, k: u32| {
        (1..=k)
            .map(|i| f64::from(n - k + i).ln() - f64::from(i).ln())
            .sum::<f64>()
    };
    let chance = |k: u32| {
        (log_choose(runs, k) + log_choose(runs, hits - k) - log_choose(2 * runs, hits)).exp()
    };
    let seen = chance(first) * (1.0 + 1e-9);
    (hits.saturating_sub(runs)..=hits.min(runs))
        .map(chance)
        .filter(|p| *p <= seen)
        .sum()
}

/// The middle of some values; of an even number, the mean of the middle two.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}
