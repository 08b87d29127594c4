//! Corners of the parametric terrains.

use crate::scenario::{Surface, Terrain};
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
            surface: Surface::sharp(*friction),
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
