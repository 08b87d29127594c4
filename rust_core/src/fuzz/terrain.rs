//! Terrains made of points: each is a ground on which a robot is put, or is refused.

use std::sync::OnceLock;

use super::TEXTS;
use super::scenario::is_told;
use crate::draw::{Draw, Source};
use crate::geometry::Vector;
use crate::{Ground, Profile, Simulation, Surface, Terrain, ValidScenario};

/// [m] Points closer than this to the line through their neighbours may be left out.
const LEFT_OUT: f64 = 1e-9;

/// Builds the terrain that bytes describe.
///
/// # Panics
/// If a rule is broken.
pub fn terrain(data: &[u8]) {
    static BASE: OnceLock<ValidScenario> = OnceLock::new();
    let base = BASE.get_or_init(|| ValidScenario::from_json(TEXTS[0]).expect("it is shared"));

    let mut draw = Draw(data);
    let terrain = if draw.chance(0.2) {
        Terrain::Lanes {
            left: Box::new(drawn(&mut draw)),
            right: Box::new(drawn(&mut draw)),
            middle: draw.chance(0.3).then(|| Box::new(drawn(&mut draw))),
        }
    } else {
        drawn(&mut draw)
    };
    match Ground::new(&terrain, base.scenario().robot.gauge) {
        Ok(ground) => is_ground(&ground, &terrain),
        Err(error) => is_told(&error.into()),
    }
    let mut scenario = base.scenario().clone();
    scenario.terrain = terrain;
    match ValidScenario::from_json_like(&scenario.to_json(), Some(base)) {
        Ok(read) => {
            let place = Simulation::new(&read).reading().position;
            assert!(place.is_finite(), "{place}");
        }
        Err(error) => is_told(&error),
    }
}

/// Points from left to right, most on a grid of centimetres, some close together, some far away.
fn drawn<S: Source>(draw: &mut Draw<S>) -> Terrain {
    let way = |draw: &mut Draw<S>| match draw.below(8) {
        0 => 0.0,
        1 => draw.size(1e-13, 1e-6),
        2 => draw.size(1e-6, 1e-2),
        3 => draw.size(1.0, 1e7),
        _ => 0.01 * draw.below(100) as f64,
    };
    let mut x = -2.0 + way(draw);
    let mut points = Vec::new();
    for _ in 0..draw.below(24) {
        let y = way(draw) * if draw.chance(0.5) { 1.0 } else { -1.0 };
        points.push([x.min(1e7), y]);
        x += way(draw);
    }
    if draw.chance(0.7) {
        points.push([x.min(1e7), 0.0]);
        points.push([1e7_f64.min(x + 3.0), 0.0]);
    }
    if draw.chance(0.1) {
        points.reverse();
    }
    let edge_radius = if draw.chance(0.5) {
        0.0
    } else {
        draw.size(1e-10, 10.0)
    };
    let count = points.len().saturating_sub(1) + usize::from(draw.chance(0.05));
    let segment_friction = draw
        .chance(0.2)
        .then(|| (0..count).map(|_| draw.between(0.0, 2.0)).collect());
    Terrain::Points {
        points,
        goal: way(draw),
        surface: Surface::rounded(edge_radius, draw.between(0.0, 1.5)),
        segment_friction,
    }
}

/// Asserts what holds of any ground.
fn is_ground(ground: &Ground, terrain: &Terrain) {
    let (low, high) = ground.extent();
    assert!(low < high && (low..=high).contains(&ground.goal));
    assert!(ground.first_edge.is_finite());
    for lane in &ground.lanes {
        is_lane(lane);
    }
    if let Terrain::Points {
        points, surface, ..
    } = terrain
        && surface.edge_radius == 0.0
    {
        let lane = &ground.lanes[0];
        for [x, y] in points {
            let off = distance(lane, Vector::new(*x, *y));
            // What is left out is between what stays, and so may be what was left out beside it.
            let most = LEFT_OUT * points.len() as f64 + 1e-15 * (high - low);
            assert!(off <= most, "({x}, {y}) is {off:e} m off the ground");
        }
    }
}

/// Asserts that a lane goes from left to right without a gap, and that edges and bends are on it.
fn is_lane(lane: &Profile) {
    let count = lane.points.len();
    assert!(count >= 2 && lane.edge_of_point.len() == count);
    assert!(lane.points.iter().all(|point| point.is_finite()));
    for pair in lane.points.windows(2) {
        assert!(pair[0] != pair[1]);
        let rounding = 1e-12 * (1.0 + pair[0].length());
        assert!(
            pair[0].x <= pair[1].x + rounding,
            "{} then {}",
            pair[0],
            pair[1]
        );
    }
    let edges = lane.edges.len() as i32;
    assert!(
        lane.edge_of_point
            .iter()
            .all(|edge| (-1..edges).contains(edge))
    );
    for (number, edge) in lane.edges.iter().enumerate() {
        assert_eq!(edge.id, number as i32);
        assert!(edge.angle.abs() <= std::f64::consts::PI && edge.center.is_finite());
        assert!(edge.span[0] <= edge.span[1] && (edge.span[1] as usize) < count);
    }
    let bends = lane.bends();
    assert!(bends.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!([bends[0], bends[bends.len() - 1]], [0, count as u32 - 1]);
}

/// [m] Distance of a point from a lane.
fn distance(lane: &Profile, point: Vector) -> f64 {
    let pieces = lane.points.windows(2).map(|pair| {
        let (from, along) = (point - pair[0], pair[1] - pair[0]);
        let share = (from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (from - along * share).length()
    });
    pieces.fold(f64::INFINITY, f64::min)
}
