//! Corners of the parametric terrains, and of ground that differs between the tracks: step fields and oblique barriers.

use crate::scenario::{FieldPattern, Stepfield, Surface, Terrain};
use crate::units::Metres;

/// [m] Length of level ground before and behind a parametric obstacle.
pub(super) const RUN_OUT: Metres = Metres(100.0);

/// A described terrain, as corners.
pub(super) struct Obstacle {
    /// [m] Corners from left to right.
    pub points: Vec<[f64; 2]>,
    /// [m] The x that the whole robot must pass: the last edge.
    pub goal: f64,
    pub surface: Surface,
}

/// The corners of a terrain with one profile.
pub(super) fn of(terrain: &Terrain) -> Obstacle {
    match terrain {
        Terrain::Flat { length, friction } => Obstacle {
            points: vec![[-RUN_OUT.value(), 0.0], [length + RUN_OUT.value(), 0.0]],
            goal: *length,
            surface: Surface {
                edge_radius: 0.0,
                friction: *friction,
            },
        },
        Terrain::Step { height, surface } => {
            between_levels(&[[0.0, 0.0], [0.0, *height]], *surface)
        }
        Terrain::Ramp {
            angle,
            length,
            surface,
        } => {
            let top = length * libm::tan(*angle);
            between_levels(&[[0.0, 0.0], [*length, top]], *surface)
        }
        Terrain::Barrier {
            height,
            thickness,
            surface,
        } => block(*height, *thickness, *surface),
        Terrain::Ridge {
            height,
            edge_angle,
            surface,
        } => {
            let half = height * libm::tan(0.5 * edge_angle);
            let corners = [[0.0, 0.0], [half, *height], [2.0 * half, 0.0]];
            between_levels(&corners, *surface)
        }
        Terrain::Gap {
            width,
            depth,
            surface,
        } => block(-depth, *width, *surface),
        Terrain::Stairs {
            count,
            rise,
            run,
            surface,
        } => {
            let corner = |i: u32, height: f64| [f64::from(i) * run, height * rise];
            let step = |i: u32| [corner(i, f64::from(i)), corner(i, f64::from(i + 1))];
            let corners: Vec<[f64; 2]> = (0..*count).flat_map(step).collect();
            between_levels(&corners, *surface)
        }
        // Two quarter circles that meet on top.
        Terrain::HalfRound { radius, friction } => {
            let surface = Surface {
                edge_radius: *radius,
                friction: *friction,
            };
            block(*radius, 2.0 * radius, surface)
        }
        Terrain::Points {
            points,
            goal,
            surface,
            ..
        } => Obstacle {
            points: points.clone(),
            goal: *goal,
            surface: *surface,
        },
        Terrain::DiagonalBarrier { .. } | Terrain::RandomStepfield(_) | Terrain::Lanes { .. } => {
            unreachable!("a lane is a terrain of one profile")
        }
    }
}

/// A block on the ground, or a trench in it if `height` is negative.
fn block(height: f64, length: f64, surface: Surface) -> Obstacle {
    let corners = [[0.0, 0.0], [0.0, height], [length, height], [length, 0.0]];
    between_levels(&corners, surface)
}

/// The corners, with level ground before the first and behind the last.
fn between_levels(corners: &[[f64; 2]], surface: Surface) -> Obstacle {
    let ([x0, y0], [x1, y1]) = (corners[0], corners[corners.len() - 1]);
    let mut points = vec![[x0 - RUN_OUT.value(), y0]];
    points.extend(corners);
    points.push([x1 + RUN_OUT.value(), y1]);
    Obstacle {
        points,
        goal: x1,
        surface,
    }
}

/// Heights above level ground at 0: each [x, height] applies from its x [m] on; the last is level ground again.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Skyline {
    rises: Vec<[f64; 2]>,
}

impl Skyline {
    /// Blocks side by side from `start` [m], each `width` [m] wide.
    fn of_blocks(start: f64, width: f64, heights: &[f64]) -> Self {
        let mut rises: Vec<[f64; 2]> = heights
            .iter()
            .enumerate()
            .map(|(i, height)| [start + i as f64 * width, *height])
            .collect();
        rises.push([start + heights.len() as f64 * width, 0.0]);
        Self { rises }
    }

    /// The higher of two skylines at every x.
    fn higher(&self, other: &Self) -> Self {
        let mut places: Vec<f64> = self
            .rises
            .iter()
            .chain(&other.rises)
            .map(|r| r[0])
            .collect();
        places.sort_unstable_by(f64::total_cmp);
        places.dedup();
        let higher = |x: f64| [x, self.height(x).max(other.height(x))];
        Self {
            rises: places.into_iter().map(higher).collect(),
        }
    }

    /// [m] Height just behind an x.
    fn height(&self, x: f64) -> f64 {
        let next = self.rises.partition_point(|rise| rise[0] <= x);
        if next > 0 {
            self.rises[next - 1][1]
        } else {
            0.0
        }
    }

    /// [m] The x at which it begins.
    pub(super) fn begin(&self) -> f64 {
        self.rises[0][0]
    }

    /// [m] The x at which it ends.
    pub(super) fn end(&self) -> f64 {
        self.rises[self.rises.len() - 1][0]
    }

    /// [m] Its corners, from the first x of the ground to the last.
    pub(super) fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let mut points = vec![[from, 0.0]];
        let mut below = 0.0;
        for [x, height] in &self.rises {
            points.extend([[*x, below], [*x, *height]]);
            below = *height;
        }
        points.push([to, 0.0]);
        points
    }
}

/// [m] Blocks under the left track, the right track and the belly.
type Lanes = [Skyline; 3];

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
        let size = (field.barrier_height, field.barrier_thickness);
        barrier(size, field.barrier_yaw, start, gauge)
    };
    let length = |lanes: &Lanes| lanes[2].end();
    let barriers = across(0.5 * (length(&rows) - length(&across(0.0))));
    std::array::from_fn(|i| rows[i].higher(&barriers[i]))
}

/// Level of a post, 0 to `levels`: random, or on a slope up to a ridge and down again, with a random deviation of at
/// most one level. The ridge is transverse or oblique.
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

    /// The first values of splitmix64 with seed 0: Vigna's splitmix64.c.
    #[test]
    fn posts_have_the_bits_of_splitmix64() {
        let found = [0, 1, 2].map(|post| bits(0, 0, post));
        let expected = [
            0xE220_A839_7B1D_CDAF,
            0x6E78_9E6A_A1B9_65F4,
            0x06C4_5D18_8009_454F,
        ];
        assert_eq!(found, expected);
        assert_eq!(bits(0, 1, 7), bits(0, 0, 65_543));
        assert_ne!(bits(1, 0, 7), bits(0, 1, 7));
    }

    #[test]
    fn the_higher_of_two_is_as_high_as_either_everywhere() {
        let stairs = Skyline::of_blocks(0.0, 1.0, &[1.0, 3.0]);
        let block = Skyline::of_blocks(0.5, 1.0, &[2.0]);
        let both = stairs.higher(&block);
        for i in -10..40 {
            let x = 0.1 * f64::from(i);
            let higher = stairs.height(x).max(block.height(x));
            assert!((both.height(x) - higher).abs() < 1e-12, "at {x}");
        }
        assert!((both.end() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn its_corners_go_up_and_down_its_faces() {
        let block = Skyline::of_blocks(0.0, 0.5, &[0.1]);
        let corners = [[0.0, 0.0], [0.0, 0.1], [0.5, 0.1], [0.5, 0.0]];
        let points = block.points(-1.0, 2.0);
        assert_eq!(points[1..5], corners);
        assert_eq!([points[0], points[5]], [[-1.0, 0.0], [2.0, 0.0]]);
    }

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

    #[test]
    fn each_stair_rises_and_runs_as_much() {
        let stairs = of(&Terrain::Stairs {
            count: 3,
            rise: 0.125,
            run: 0.25,
            surface: Surface::sharp(0.9),
        });
        let corners = [
            [0.0, 0.0],
            [0.0, 0.125],
            [0.25, 0.125],
            [0.25, 0.25],
            [0.5, 0.25],
            [0.5, 0.375],
        ];
        assert_eq!(stairs.points[1..7], corners);
        assert_eq!((stairs.points[7][1], stairs.goal), (0.375, 0.5));
    }

    /// With so many levels, a random deviation of one level is small.
    #[test]
    fn a_hill_rises_to_its_ridge_and_falls_behind_it() {
        for (pattern, lane, ridge) in [
            (FieldPattern::Hill, 0, 0.5),
            (FieldPattern::Hill, 1, 0.5),
            (FieldPattern::Diagonal, 0, 0.3),
            (FieldPattern::Diagonal, 1, 0.7),
        ] {
            let field = Stepfield {
                levels: 100,
                ..field(7, pattern)
            };
            for post in 0..field.posts {
                let place = (f64::from(post) + 0.5) / f64::from(field.posts);
                let share = (place / ridge).min((1.0 - place) / (1.0 - ridge));
                let off = f64::from(level(&field, lane, post)) - 100.0 * share;
                assert!(off.abs() <= 1.5, "{pattern:?} {lane}: {post} is {off} off");
            }
        }
    }

    /// Each obstacle lies between 100 m of level ground before and behind.
    #[test]
    fn each_parametric_terrain_has_its_corners_and_its_goal() {
        let surface = Surface::sharp(0.9);
        let (friction, slope) = (surface.friction, 0.5_f64.atan());
        for (terrain, corners, goal) in [
            (
                Terrain::Flat {
                    length: 3.0,
                    friction,
                },
                vec![],
                3.0,
            ),
            (
                Terrain::Step {
                    height: 0.25,
                    surface,
                },
                vec![[0.0, 0.0], [0.0, 0.25]],
                0.0,
            ),
            (
                Terrain::Ramp {
                    angle: slope,
                    length: 0.8,
                    surface,
                },
                vec![[0.0, 0.0], [0.8, 0.4]],
                0.8,
            ),
            (
                Terrain::Barrier {
                    height: 0.25,
                    thickness: 0.5,
                    surface,
                },
                vec![[0.0, 0.0], [0.0, 0.25], [0.5, 0.25], [0.5, 0.0]],
                0.5,
            ),
            (
                Terrain::Ridge {
                    height: 0.2,
                    edge_angle: 2.0 * slope,
                    surface,
                },
                vec![[0.0, 0.0], [0.1, 0.2], [0.2, 0.0]],
                0.2,
            ),
            (
                Terrain::Gap {
                    width: 0.5,
                    depth: 0.25,
                    surface,
                },
                vec![[0.0, 0.0], [0.0, -0.25], [0.5, -0.25], [0.5, 0.0]],
                0.5,
            ),
            (
                Terrain::HalfRound {
                    radius: 0.25,
                    friction,
                },
                vec![[0.0, 0.0], [0.0, 0.25], [0.5, 0.25], [0.5, 0.0]],
                0.5,
            ),
        ] {
            let found = of(&terrain);
            let count = found.points.len();
            let (first, last) = (found.points[0], found.points[count - 1]);
            let ends = corners.first().zip(corners.last());
            let (from, to) = ends.map_or(([0.0; 2], [goal, 0.0]), |(a, b)| (*a, *b));
            let run_outs = [
                first[0] - from[0] + 100.0,
                first[1] - from[1],
                last[0] - to[0] - 100.0,
                last[1] - to[1],
            ];
            assert!(run_outs.iter().all(|off| off.abs() < 1e-12), "{terrain:?}");
            assert!((found.goal - goal).abs() < 1e-12, "{terrain:?}");
            assert_eq!(count, corners.len() + 2);
            for (point, corner) in found.points[1..count - 1].iter().zip(&corners) {
                let off = (point[0] - corner[0])
                    .abs()
                    .max((point[1] - corner[1]).abs());
                assert!(off < 1e-12, "{terrain:?}: {point:?}");
            }
        }
        let half_round = of(&Terrain::HalfRound {
            radius: 0.25,
            friction,
        });
        assert!((half_round.surface.edge_radius - 0.25).abs() < 1e-15);
    }
}
