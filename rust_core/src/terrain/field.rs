//! Ground that differs between the tracks: step fields and oblique barriers.

use super::skyline::Skyline;
use crate::scenario::{FieldPattern, Stepfield};

/// [m] Blocks under the left track, the right track and the belly.
pub(super) type Lanes = [Skyline; 3];

/// A barrier of some height and thickness [m], its front face turned by `yaw` [rad] about the vertical, its nearest
/// point at `start` [m]; the tracks are `gauge` [m] apart, and the belly is assumed to be as wide.
pub(super) fn barrier((height, thickness): (f64, f64), yaw: f64, start: f64, gauge: f64) -> Lanes {
    let along = thickness / libm::cos(yaw);
    let apart = gauge * libm::tan(yaw);
    let at = |x: f64, length: f64| Skyline::of_blocks(start + x, length, &[height]);
    // Turned counter-clockwise seen from above, its left end comes first.
    [
        at((-apart).max(0.0), along),
        at(apart.max(0.0), along),
        at(0.0, apart.abs() + along),
    ]
}

/// A field of square posts from x = 0, one row under each track, with a barrier across its middle.
pub(super) fn stepfield(field: &Stepfield, gauge: f64) -> Lanes {
    let row = |lane| {
        let heights = (0..field.posts).map(|post| field.rise * f64::from(level(field, lane, post)));
        Skyline::of_blocks(0.0, field.post, &heights.collect::<Vec<_>>())
    };
    let [left, right] = [row(0), row(1)];
    let middle = left.higher(&right);
    let rows = [left, right, middle];
    if field.barrier_height == 0.0 {
        return rows;
    }
    let across = |start: f64| {
        let form = (field.barrier_height, field.barrier_thickness);
        barrier(form, field.barrier_yaw, start, gauge)
    };
    let length = |lanes: &Lanes| lanes[2].end();
    let barriers = across(0.5 * (length(&rows) - length(&across(0.0))));
    std::array::from_fn(|i| rows[i].higher(&barriers[i]))
}

/// Level of a post, 0 to `levels`: random, or on a slope up to a ridge and down again, plus or minus one level at
/// random. The ridge lies across the field, or askew.
fn level(field: &Stepfield, lane: u32, post: u32) -> u32 {
    let draw = bits(field.seed, lane, post);
    let ridge = match field.pattern {
        FieldPattern::Flat => return (draw % u64::from(field.levels + 1)) as u32,
        FieldPattern::Hill => 0.5,
        FieldPattern::Diagonal => [0.3, 0.7][lane as usize],
    };
    let place = (f64::from(post) + 0.5) / f64::from(field.posts);
    let slope = if place < ridge {
        place / ridge
    } else {
        (1.0 - place) / (1.0 - ridge)
    };
    let mean = (slope * f64::from(field.levels)).round() as i64;
    let off = (draw % 3) as i64 - 1;
    (mean + off).clamp(0, i64::from(field.levels)) as u32
}

/// Random bits for one post: splitmix64 of its place and the seed.
fn bits(seed: u32, lane: u32, post: u32) -> u64 {
    let place = (u64::from(seed) << 32) | (u64::from(lane) << 16) | u64::from(post);
    let mut z = place
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Surface;

    const GAUGE: f64 = 0.2;

    fn field(seed: u32, pattern: FieldPattern) -> Stepfield {
        Stepfield {
            seed,
            pattern,
            posts: 10,
            post: 0.1,
            rise: 0.02,
            levels: 4,
            barrier_height: 0.0,
            barrier_thickness: 0.1,
            barrier_yaw: 0.0,
            surface: Surface::sharp(0.9),
        }
    }

    #[test]
    fn a_turned_barrier_is_met_gauge_times_tangent_apart() {
        let yaw = 0.5_f64;
        let [left, right, middle] = barrier((0.05, 0.03), yaw, 0.0, GAUGE);
        let along = 0.03 / yaw.cos();
        let apart = GAUGE * yaw.tan();
        assert!((left.end() - along).abs() < 1e-12);
        assert!((right.end() - apart - along).abs() < 1e-12);
        assert!((middle.end() - right.end()).abs() < 1e-12);
        let [left, right, _] = barrier((0.05, 0.03), -yaw, 0.0, GAUGE);
        assert!((left.end() - right.end() - apart).abs() < 1e-12);
    }

    #[test]
    fn a_straight_barrier_is_one_for_both_tracks() {
        let [left, right, middle] = barrier((0.05, 0.03), 0.0, 1.0, GAUGE);
        assert!(left == right && right == middle);
    }

    /// Five levels are equally likely: of 10,000 posts each has 2000, to four standard deviations.
    #[test]
    fn posts_of_a_flat_field_are_of_all_levels_alike() {
        let mut counts = [0; 5];
        for seed in 0..500 {
            let field = field(seed, FieldPattern::Flat);
            for lane in 0..2 {
                (0..10).for_each(|post| counts[level(&field, lane, post) as usize] += 1);
            }
        }
        assert!(
            counts.iter().all(|n| (1840..2160).contains(n)),
            "{counts:?}"
        );
    }

    #[test]
    fn a_hill_is_highest_in_the_middle_and_a_diagonal_one_sooner_on_the_left() {
        let mean = |pattern, lane, post| {
            let level = |seed| f64::from(level(&field(seed, pattern), lane, post));
            (0..300).map(level).sum::<f64>() / 300.0
        };
        let highest = |pattern, lane| {
            let by_height =
                |a: &u32, b: &u32| mean(pattern, lane, *a).total_cmp(&mean(pattern, lane, *b));
            (0..10).max_by(by_height).unwrap()
        };
        assert!((4..6).contains(&highest(FieldPattern::Hill, 0)));
        assert!((4..6).contains(&highest(FieldPattern::Hill, 1)));
        assert!(highest(FieldPattern::Diagonal, 0) < 4);
        assert!(highest(FieldPattern::Diagonal, 1) > 5);
        assert!(mean(FieldPattern::Hill, 0, 0) < 1.0);
    }

    #[test]
    fn a_barrier_across_a_field_lies_in_its_middle() {
        let mut low = field(3, FieldPattern::Flat);
        (low.rise, low.barrier_height) = (1e-6, 0.1);
        let [left, _, middle] = stepfield(&low, GAUGE);
        let points = left.points(-1.0, 2.0);
        let high: Vec<f64> = points
            .iter()
            .filter(|p| p[1] > 0.05)
            .map(|p| p[0])
            .collect();
        let (first, last) = (high[0], high[high.len() - 1]);
        assert!((first - 0.45).abs() < 1e-12 && (last - 0.55).abs() < 1e-12);
        assert!((middle.end() - 1.0).abs() < 1e-12);
    }
}
