//! The tables and stretches of the index, compared with their pieces.

use super::*;
use crate::contact::lane::tests::lane;
use crate::contact::lane::{Lane, corners_of};
use crate::draw::Draw;
use crate::scenario::Surface;

/// [m] x at which each piece begins.
fn begins(profile: &Profile) -> Vec<f64> {
    let corners = corners_of(profile);
    let begins = corners.iter().map(|corner| profile.points[corner.facet].x);
    begins.take(corners.len() - 1).collect()
}

/// Rough ground, of few pieces and of many.
fn grounds(draw: &mut Draw) -> Vec<(Profile, Lane)> {
    let counts = [5, 40, 1000];
    counts.map(|count| lane(count, 1e-3, 0.0, draw)).into()
}

/// Ranges of x, on ground and beyond it, half of which begin or end where a piece does.
fn ranges(begins: &[f64], draw: &mut Draw) -> Vec<[f64; 2]> {
    let mut place = || {
        if draw.chance(0.5) {
            begins[draw.below(begins.len())]
        } else {
            draw.between(-0.1, 0.6)
        }
    };
    (0..500)
        .map(|_| {
            let (a, b) = (place(), place());
            [a.min(b), a.max(b)]
        })
        .collect()
}

#[test]
fn a_region_has_the_pieces_that_overlap_a_range() {
    let mut draw = Draw(20_270_201);
    for (profile, lane) in grounds(&mut draw) {
        let begins = begins(&profile);
        for [low, high] in ranges(&begins, &mut draw) {
            let first = begins.partition_point(|x| *x < low).saturating_sub(1);
            let end = begins.partition_point(|x| *x <= high).max(first + 1);
            let region = lane.index.region(low, high);
            assert_eq!(region.pieces(), first..end, "{low} to {high}");
            assert_eq!(region.corners(), first..=end);
            assert_eq!(region.is_long(), end - first > FEW);
        }
    }
}

#[test]
fn a_narrowed_region_has_those_of_its_pieces_that_overlap_a_range_or_the_nearest() {
    let mut draw = Draw(20_270_202);
    for (profile, lane) in grounds(&mut draw) {
        let begins = begins(&profile);
        for [low, high] in ranges(&begins, &mut draw) {
            let start = draw.below(begins.len());
            let end = (start + 1 + draw.below(FEW)).min(begins.len());
            let own = &begins[start..end];
            let first = own.partition_point(|x| *x < low).saturating_sub(1);
            let behind = own.partition_point(|x| *x <= high).max(first + 1);
            let found = lane.index.narrow(&Region(start..end), low, high);
            assert_eq!(found.pieces(), start + first..start + behind);
        }
        let all = Region(0..begins.len());
        let found = lane.index.narrow(&all, 0.2, 0.3).pieces();
        assert_eq!(found, lane.index.region(0.2, 0.3).pieces());
    }
}

#[test]
fn a_region_is_split_where_a_range_begins_and_ends() {
    let mut draw = Draw(20_270_203);
    for (profile, lane) in grounds(&mut draw) {
        let begins = begins(&profile);
        for [low, high] in ranges(&begins, &mut draw) {
            let [start, end] = ranges(&begins, &mut draw)[0].map(|x| lane.index.count_before(x));
            let before = |x: f64| begins.iter().filter(|begin| **begin < x).count();
            let [a, b] = [low, high].map(|x| before(x).clamp(start, end));
            let found = lane.index.split(&Region(start..end), low, high);
            assert_eq!(found.map(|part| part.pieces()), [start..a, a..b, b..end]);
            // Ends that rounding has swapped leave nothing between them.
            let [left, between, right] = lane.index.split(&Region(start..end), high, low);
            assert!(between.is_empty());
            assert_eq!((left.pieces(), right.pieces()), (start..b, b..end));
        }
    }
}

#[test]
fn the_top_of_a_region_is_that_of_its_highest_piece_or_a_little_beside_it() {
    let mut draw = Draw(20_270_204);
    for (profile, lane) in grounds(&mut draw) {
        let begins = begins(&profile);
        let highest = |pieces: Range<usize>| {
            let [first, last] = [pieces.start, pieces.end].map(|i| lane.corners[i].facet);
            let points = &profile.points[first..=last];
            points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max)
        };
        assert_eq!(
            lane.index.highest_of_all().to_bits(),
            highest(0..begins.len()).to_bits()
        );
        for [low, high] in ranges(&begins, &mut draw) {
            let region = lane.index.region(low, high);
            let Range { start, end } = region.pieces();
            let top = lane.index.top(&region);
            if region.is_long() {
                // A stretch reaches beyond a region by less than the region is long.
                let beside = end - start;
                let wide = start.saturating_sub(beside)..(end + beside).min(begins.len());
                assert!((highest(start..end)..=highest(wide)).contains(&top));
            } else {
                assert_eq!(top.to_bits(), highest(start..end).to_bits());
            }
        }
    }
}

#[test]
fn two_or_three_stretches_cover_a_region_however_long_it_is() {
    let mut draw = Draw(20_270_205);
    let (_, lane) = lane(1000, 1e-3, 0.0, &mut draw);
    let count = lane.faces.len();
    for _ in 0..500 {
        let start = draw.below(count);
        let region = Region(start..start + 1 + draw.below(count - start));
        let (level, stretches) = lane.index.cover(&region);
        let size = BLOCK << level;
        let (first, last) = (*stretches.start(), *stretches.end());
        assert!(last - first <= 2, "{region:?}");
        assert!((first * size..(first + 1) * size).contains(&region.0.start));
        assert!((last * size + 1..=(last + 1) * size).contains(&region.0.end));
        let is_longest = size * 2 > region.0.len() || level + 1 == lane.index.levels.len();
        assert!(is_longest, "{region:?} at {level}");
        let mut covered = 0;
        assert!(!lane.index.any(&region, |_| {
            covered += 1;
            false
        }));
        assert_eq!(covered, last - first + 1);
        assert!(lane.index.any(&region, |_| true));
    }
}

#[test]
fn each_piece_of_a_region_is_visited_once_and_its_last_corner_without_a_face() {
    let mut draw = Draw(20_270_206);
    let (_, lane) = lane(1000, 1e-3, 0.0, &mut draw);
    let count = lane.faces.len();
    for _ in 0..200 {
        let start = draw.below(count);
        let end = start + 1 + draw.below(count - start);
        let region = Region(start..end);
        let mut visited = Vec::new();
        lane.index
            .visit(&region, |_| true, |i, is_face| visited.push((i, is_face)));
        let expected = (start..=end).map(|i| (i, i != end));
        assert_eq!(visited, expected.collect::<Vec<_>>());
        if end - start >= 4 * FEW {
            // A stretch that does not matter is left out, the last one with the last corner.
            let mut visited = Vec::new();
            let limit = 0.5 * (lane.corners[start].center.x + lane.corners[end].center.x);
            let matters = |stretch: &Stretch| stretch.bounds.mins.x <= limit;
            lane.index.visit(&region, matters, |i, _| visited.push(i));
            assert_eq!(visited[0], start);
            let last = visited[visited.len() - 1];
            assert!(last < end && lane.corners[last + 1].center.x >= limit - 1e-12);
            assert!(lane.corners[last].center.x <= limit + BLOCK as f64 * 1e-3);
            assert!(visited.windows(2).all(|pair| pair[1] == pair[0] + 1));
        }
    }
}

#[test]
fn a_region_is_fine_if_its_many_pieces_are_shorter_than_a_millimetre_on_average() {
    for (pitch, fine) in [(0.995e-3, true), (1.1e-3, false)] {
        let points: Vec<[f64; 2]> = (0..200)
            .map(|i| [5.0 + pitch * f64::from(i), 1e-4 * f64::from(i % 2)])
            .collect();
        let profile = Profile::new("terrain", &points, Surface::sharp(0.9), false);
        let lane = Lane::new(&profile.expect("it is ground"));
        for (start, count) in [(0, FEW + 1), (3, FEW), (40, 100), (170, 20)] {
            let found = lane.index.is_fine(&Region(start..start + count));
            assert_eq!(found, fine && count > FEW, "{count} from {start}");
        }
    }
}

#[test]
fn the_corner_that_rises_highest_is_found_if_it_rises_by_more_than_the_least() {
    let mut draw = Draw(20_270_207);
    let (_, lane) = lane(1000, 1e-3, 0.0, &mut draw);
    let count = lane.faces.len();
    let rise = |i: usize| lane.corners[i].center.y;
    let bound = |stretch: &Stretch| stretch.roof[0].y.max(stretch.roof[1].y);
    for _ in 0..200 {
        let start = draw.below(count);
        let end = start + 1 + draw.below(count - start);
        let convex = (start..end).filter(|i| lane.corners[*i].is_convex);
        let Some(highest) = convex.max_by(|a, b| rise(*a).total_cmp(&rise(*b))) else {
            continue;
        };
        let found = |least: f64| lane.index.highest(&Region(start..end), least, bound, rise);
        let least = rise(highest) - 1e-9;
        // Others in a stretch with it need not be convex.
        let by_rise = found(least).map(rise);
        assert!(
            by_rise.is_some_and(|found| found >= rise(highest)),
            "{start} to {end}"
        );
        let all = (start..end).map(rise).fold(f64::NEG_INFINITY, f64::max);
        assert!(found(all).is_none());
    }
}

/// Of every level, from a few pieces to all.
#[test]
fn a_stretch_bounds_the_places_and_the_normals_of_its_pieces() {
    let mut draw = Draw(20_270_208);
    for edge_radius in [0.0, 1e-5] {
        let (profile, lane) = lane(300, 1e-3, edge_radius, &mut draw);
        let count = lane.faces.len();
        let levels = &lane.index.levels;
        assert_eq!(levels[0].len(), count.div_ceil(BLOCK));
        assert_eq!(levels[levels.len() - 1].len(), 1);
        for (level, stretches) in levels.iter().enumerate() {
            let size = BLOCK << level;
            assert_eq!(stretches.len(), count.div_ceil(size));
            for (k, stretch) in stretches.iter().enumerate() {
                let (first, end) = (k * size, ((k + 1) * size).min(count));
                let (faces, corners) = (&lane.faces[first..end], &lane.corners[first..=end]);
                let normals = corners.iter().flat_map(|corner| corner.normals);
                let x: Vec<f64> = faces
                    .iter()
                    .map(|f| f.normal)
                    .chain(normals)
                    .map(|n| n.x)
                    .collect();
                let most = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let least = x.iter().copied().fold(f64::INFINITY, f64::min);
                let [right, left] = stretch.normals;
                assert_eq!(
                    [right.x, left.x].map(f64::to_bits),
                    [most, least].map(f64::to_bits)
                );
                for normal in [right, left] {
                    assert!(stretch.may_have_normal(normal));
                }
                assert_eq!(
                    stretch.is_convex,
                    corners.iter().any(|corner| corner.is_convex)
                );
                let facets = corners[0].facet..=corners[corners.len() - 1].facet;
                let points = &profile.points[facets];
                let (low, high) = (points[0].x, points[points.len() - 1].x);
                let bounds = stretch.bounds;
                assert!((bounds.mins.x - low).abs() < 1e-15 && bounds.maxs.x >= high);
                assert!(bounds.maxs.x < high + 1e-4);
                let [lowest, highest] = [f64::min, f64::max].map(|pick| {
                    points
                        .iter()
                        .map(|p| p.y)
                        .reduce(pick)
                        .expect("it has points")
                });
                assert!((bounds.mins.y - lowest).abs() < 1e-15);
                // An arc rises above its points by 40 millionths of its radius.
                assert!((0.0..1e-4 * edge_radius + 1e-15).contains(&(bounds.maxs.y - highest)));
                assert_eq!(stretch.roof, roof(corners));
                assert!(stretch.reaches([high + 0.1, 1.0], 0.11));
                assert!(!stretch.reaches([high + 0.1, 1.0], 0.09));
                assert!(stretch.reaches([-1.0, low - 0.1], 0.11));
                assert!(!stretch.reaches([-1.0, low - 0.1], 0.09));
                assert!(stretch.reaches([0.5 * (low + high), 0.5 * (low + high)], 0.0));
            }
        }
    }
}

/// Ground that rises by 0.5 ahead of a step, and falls as steeply behind it.
#[test]
fn a_stretch_may_have_the_normals_between_its_outermost_ones() {
    let points = [[-2.0, -1.0], [0.0, 0.0], [2.0, -1.0]];
    let profile = Profile::new("terrain", &points, Surface::sharp(0.9), true);
    let lane = Lane::new(&profile.expect("it is ground"));
    let stretch = lane.index.levels[0][0];
    let slope = 0.5_f64.atan();
    // By 0.02 rad beyond them, a corner at an edge still bears: 0.043 of their angle.
    for (off, may) in [
        (0.0, true),
        (1.0, true),
        (1.04, true),
        (1.046, false),
        (3.0, false),
    ] {
        for side in [-1.0, 1.0] {
            let turned = off * side * slope;
            let normal = Vector::new(libm::sin(turned), libm::cos(turned));
            assert_eq!(stretch.may_have_normal(normal), may, "{off} {side}");
        }
    }
    assert!(!stretch.may_have_normal(Vector::NEG_Y));
}

#[test]
fn a_disc_faces_a_stretch_that_is_within_reach_and_whose_normals_lead_to_it() {
    // From -1 m to 2 m along x and from 0 m to 0.5 m along y, with upright faces.
    let block = [
        [-1.0, 0.0],
        [0.0, 0.0],
        [0.0, 0.5],
        [1.0, 0.5],
        [1.0, 0.0],
        [2.0, 0.0],
    ];
    // From -2 m to 2 m and from -1 m to 0 m.
    let ridge = [[-2.0, -1.0], [0.0, 0.0], [2.0, -1.0]];
    for (points, places) in [
        (
            &block[..],
            &[
                (3.0, 0.25, 1.01, true),
                (3.0, 0.25, 0.99, false),
                (-2.0, 0.25, 1.01, true),
                (-2.0, 0.25, 0.99, false),
                // Beyond its corner, 3 m along x and 4 m along y.
                (5.0, 4.5, 5.01, true),
                (5.0, 4.5, 4.99, false),
                (0.5, -0.5, 0.51, true),
                (0.5, -0.5, 0.49, false),
            ][..],
        ),
        (
            &ridge[..],
            &[
                (0.0, 0.5, 0.51, true),
                (0.0, 0.5, 0.49, false),
                (0.0, -0.5, 0.1, true),
                (0.0, -1.5, 0.51, true),
                (0.0, -1.5, 0.49, false),
                (6.0, 9.0, 10.0, true),
                // Past the normal of a slope from its farthest point.
                (8.0, 1.0, 9.0, false),
                (-8.0, 1.0, 9.0, false),
                (8.0, -0.9, 9.0, false),
                (-8.0, -0.9, 9.0, false),
            ],
        ),
    ] {
        let profile = Profile::new("terrain", points, Surface::sharp(0.9), true);
        let lane = Lane::new(&profile.expect("it is ground"));
        let stretch = lane.index.levels[0][0];
        for (x, y, reach, may) in places {
            let found = stretch.may_face(Vector::new(*x, *y), *reach);
            assert_eq!(found, *may, "{x} {y} within {reach} m");
        }
    }
}
