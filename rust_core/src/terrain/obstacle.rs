//! Corners of the parametric terrains.

use crate::scenario::Terrain;
use crate::units::Metres;

/// [m] Length of level ground before and behind a parametric obstacle.
pub(super) const RUN_OUT: Metres = Metres(100.0);

/// A described terrain, as corners.
pub(super) struct Obstacle {
    /// [m] Corners from left to right.
    pub points: Vec<[f64; 2]>,
    /// [m] The x that the whole robot must pass: the last edge.
    pub goal: f64,
    /// [m] Radius of the convex edges.
    pub edge_radius: f64,
    /// Coulomb friction with the robot.
    pub friction: f64,
}

/// The corners of a terrain with one profile.
pub(super) fn of(terrain: &Terrain) -> Obstacle {
    match terrain {
        Terrain::Flat { length, friction } => level(*length, *friction),
        Terrain::Step {
            height,
            edge_radius,
            friction,
        } => between_levels(&[[0.0, 0.0], [0.0, *height]], *edge_radius, *friction),
        Terrain::Ramp {
            angle,
            length,
            edge_radius,
            friction,
        } => {
            let top = length * libm::tan(*angle);
            between_levels(&[[0.0, 0.0], [*length, top]], *edge_radius, *friction)
        }
        Terrain::Barrier {
            height,
            thickness,
            edge_radius,
            friction,
        } => block(*height, *thickness, *edge_radius, *friction),
        Terrain::Ridge {
            height,
            edge_angle,
            edge_radius,
            friction,
        } => {
            let half = height * libm::tan(0.5 * edge_angle);
            let corners = [[0.0, 0.0], [half, *height], [2.0 * half, 0.0]];
            between_levels(&corners, *edge_radius, *friction)
        }
        Terrain::Gap {
            width,
            depth,
            edge_radius,
            friction,
        } => block(-depth, *width, *edge_radius, *friction),
        Terrain::Stairs {
            count,
            rise,
            run,
            edge_radius,
            friction,
        } => {
            let corner = |i: u32, height: f64| [f64::from(i) * run, height * rise];
            let step = |i: u32| [corner(i, f64::from(i)), corner(i, f64::from(i + 1))];
            let corners: Vec<[f64; 2]> = (0..*count).flat_map(step).collect();
            between_levels(&corners, *edge_radius, *friction)
        }
        // Two quarter circles that meet on top.
        Terrain::HalfRound { radius, friction } => block(*radius, 2.0 * radius, *radius, *friction),
        Terrain::Points {
            points,
            goal,
            edge_radius,
            friction,
        } => Obstacle {
            points: points.clone(),
            goal: *goal,
            edge_radius: *edge_radius,
            friction: *friction,
        },
        Terrain::DiagonalBarrier { .. } | Terrain::RandomStepfield(_) | Terrain::Lanes { .. } => {
            unreachable!("a lane is a terrain of one profile")
        }
    }
}

fn level(length: f64, friction: f64) -> Obstacle {
    Obstacle {
        points: vec![[-RUN_OUT.value(), 0.0], [length + RUN_OUT.value(), 0.0]],
        goal: length,
        edge_radius: 0.0,
        friction,
    }
}

/// A block on the ground, or a trench in it if `height` is negative.
fn block(height: f64, length: f64, edge_radius: f64, friction: f64) -> Obstacle {
    let corners = [[0.0, 0.0], [0.0, height], [length, height], [length, 0.0]];
    between_levels(&corners, edge_radius, friction)
}

/// The corners, with level ground before the first and behind the last.
fn between_levels(corners: &[[f64; 2]], edge_radius: f64, friction: f64) -> Obstacle {
    let ([x0, y0], [x1, y1]) = (corners[0], corners[corners.len() - 1]);
    let mut points = vec![[x0 - RUN_OUT.value(), y0]];
    points.extend(corners);
    points.push([x1 + RUN_OUT.value(), y1]);
    Obstacle {
        points,
        goal: x1,
        edge_radius,
        friction,
    }
}
