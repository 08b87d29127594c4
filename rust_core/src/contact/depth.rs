//! How deep a part is in the ground, by its outline alone: also where no contact was found that would tell.
//!
//! The equations: docs/physics.md, "Softness".

use crate::geometry::{Disc, Pose, Vector};
use crate::robot::{Part, Shape};
use crate::terrain::Profile;

/// [m] How deep a part at a place is in a lane, at most; 0 above it, and at the ends of the ground: they have no faces,
/// and what hangs over one may fall beside it.
pub(crate) fn depth(part: &Part, place: Pose, lane: &Profile) -> f64 {
    let (middle, bound) = part.bound();
    let center = place.transform_point(middle);
    let (low, high) = lane.extent();
    let hangs_over = center.x - bound < low || center.x + bound > high;
    if hangs_over || lane.is_clear_of(center, bound) {
        return 0.0;
    }
    let rounds = rounds(part).into_iter();
    let depth = |d: Disc| depth_of_disc(place.transform_point(d.center), d.radius, lane);
    rounds.map(depth).fold(0.0, f64::max)
}

/// Arcs and corners of a part in its own frame.
fn rounds(part: &Part) -> Vec<Disc> {
    match &part.shape {
        Shape::Disc { radius, .. } => vec![Disc {
            center: Vector::ZERO,
            radius: *radius,
        }],
        Shape::Gear { gear, .. } => {
            let root = Disc {
                center: Vector::ZERO,
                radius: gear.root_radius,
            };
            let corners = gear.directions().flat_map(|d| gear.corners(d));
            std::iter::once(root)
                .chain(corners.map(Disc::point))
                .collect()
        }
        Shape::Hull { .. } => part.discs().map(|(_, root)| root).collect(),
        Shape::Grouser(grouser) => grouser.corners().map(Disc::point).to_vec(),
        Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
    }
}

/// [m] How far a disc would have to move to be out of the ground; a corner is a disc of radius 0.
fn depth_of_disc(center: Vector, radius: f64, lane: &Profile) -> f64 {
    let below = lane.height_under_disc(center.x, 0.0) - center.y;
    let is_inside = below > 0.0;
    // Inside, the nearest ground is no farther than that right above.
    let far = if is_inside { below } else { radius };
    let distance = |facet: usize| {
        let (a, b) = (lane.points[facet], lane.points[facet + 1]);
        let way = b - a;
        let share = ((center - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        (a + way * share - center).length()
    };
    let facets = lane.facets(center.x - far, center.x + far);
    let nearest = facets.map(distance).fold(far, f64::min);
    if is_inside {
        radius + nearest
    } else {
        radius - nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_as_deep_as_the_shortest_way_out() {
        let step = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
        let lane = Profile::new("terrain", &step, 0.0, 0.9, true).expect("a profile");
        for (x, y, radius, depth) in [
            (-0.5, 0.06, 0.05, -0.01),
            (-0.5, 0.03, 0.05, 0.02),
            (-0.04, 0.06, 0.05, 0.01),
            (0.5, 0.09, 0.0, 0.01),
            (0.02, 0.03, 0.0, 0.02),
            (0.02, 0.03, 0.05, 0.07),
            (0.5, 0.11, 0.0, 0.0),
        ] {
            let found = depth_of_disc(Vector::new(x, y), radius, &lane);
            assert!(
                (found - f64::max(depth, 0.0)).abs() < 1e-12,
                "{x} {y} {radius}: {found}"
            );
        }
    }
}
