//! Wheels instead of a track: their positions and drives.
//!
//! A wheel on a fixed axle needs no body of its own: its mass belongs to the chassis, and its spin is a degree of
//! freedom of the drive.

use super::TrackModel;
use crate::geometry::search::zero;
use crate::geometry::{Disc, Envelope, Gear, Vector, end_discs, outline_discs};
use crate::robot::{BodyKind, Part, Shape};
use crate::scenario::{
    CircumferentialWheels, ForceSupport, HybridWheels, LineOfWheels, Robot, ScenarioError,
    TorqueSharing, Track, TrackOutline, Wheel,
};

/// Wheels driven by one motor together, or by one motor each.
pub(super) fn driven(robot: &Robot, wheel: &Wheel) -> Result<TrackModel, ScenarioError> {
    let own_motors = robot.drivetrain.torque_sharing == TorqueSharing::Wheel;
    let part = |(i, disc): (usize, Disc)| {
        let shape = match wheel {
            Wheel::Round => round(disc),
            Wheel::Gear(wheel) => Shape::Gear {
                center: disc.center,
                gear: Gear::new(wheel, &robot.outline, disc.radius, i)?,
            },
        };
        let drive = if own_motors { i } else { 0 };
        Ok(Part::new(BodyKind::Wheel, shape, Some(drive)))
    };
    let discs = discs_of_wheels(robot)?.into_iter().enumerate();
    let parts: Vec<Part> = discs.map(part).collect::<Result<_, ScenarioError>>()?;
    let drives = if own_motors { parts.len() } else { 1 };
    Ok(TrackModel::driven(parts, drives))
}

/// Round wheels that turn freely and independently, with drives numbered from `first`.
pub(super) fn passive(robot: &Robot, first: usize) -> Result<Vec<Part>, ScenarioError> {
    let discs = discs_of_wheels(robot)?.into_iter().zip(first..);
    let part = |(disc, drive)| Part::new(BodyKind::Wheel, round(disc), Some(drive));
    Ok(discs.map(part).collect())
}

fn round(Disc { center, radius }: Disc) -> Shape {
    Shape::Disc { center, radius }
}

/// The wheels of one side, in the order of eq. (1); empty for a model without wheels.
///
/// # Errors
/// Wheels that do not fit the outline.
pub(crate) fn discs_of_wheels(robot: &Robot) -> Result<Vec<Disc>, ScenarioError> {
    let outline = &robot.outline;
    match &robot.track {
        Track::Line(LineOfWheels {
            count,
            wheel_radius,
            ..
        }) => Ok(line(outline, *count, *wheel_radius)),
        Track::Circumferential(wheels) => circumferential(outline, wheels),
        Track::Hybrid(HybridWheels { placements, .. }) => {
            Ok(placements.iter().copied().map(Disc::from).collect())
        }
        Track::Force(force) if force.support == ForceSupport::Wheels => {
            Ok(line(outline, force.wheel_count, None))
        }
        Track::Belt(_)
        | Track::GrouserBelt(_)
        | Track::Segmental(_)
        | Track::Force(_)
        | Track::Closed(_) => Ok(Vec::new()),
    }
}

/// Wheels from the rear, evenly spaced between the end axles; radii linear between unequal ends.
fn line(outline: &TrackOutline, count: u32, wheel_radius: Option<f64>) -> Vec<Disc> {
    let [rear, front] = end_discs(outline);
    let last = f64::from(count - 1);
    (0..count)
        .map(|i| {
            let share = f64::from(i) / last;
            let radius = rear.radius + share * (front.radius - rear.radius);
            Disc {
                center: rear.center + (front.center - rear.center) * share,
                radius: wheel_radius.unwrap_or(radius),
            }
        })
        .collect()
}

/// Wheels from the rear end of the lower run along belt travel: up round the rear, forward on top, down round the
/// front, back along the ground.
fn circumferential(
    outline: &TrackOutline,
    wheels: &CircumferentialWheels,
) -> Result<Vec<Disc>, ScenarioError> {
    let smallest = outline.smallest_radius();
    let (radius, centers) = match wheels.wheel_radius {
        Some(radius) if radius < smallest => {
            let path = path_of_centers(outline, radius);
            let spacing = path.length() / f64::from(wheels.count);
            let center = |i: u32| path.point_at(f64::from(i) * spacing);
            (radius, (0..wheels.count).map(center).collect())
        }
        Some(radius) => {
            let rule = format!("must be less than the smaller radius of the outline, {smallest} m");
            return Err(ScenarioError::new("robot.track.wheel_radius", radius, rule));
        }
        None => tight(outline, wheels.count)?,
    };
    let disc = |center| Disc { center, radius };
    Ok(centers.into_iter().map(disc).collect())
}

/// Radius and centres of wheels that touch their neighbours all the way round.
fn tight(outline: &TrackOutline, count: u32) -> Result<(f64, Vec<Vector>), ScenarioError> {
    // Larger wheels would touch those on the other run before their neighbours.
    let largest = 0.5 * outline.smallest_radius();
    // Larger wheels leave a shorter path for their centres, and need more of it.
    let overlap = |radius: f64| {
        let path = path_of_centers(outline, radius);
        let next = |at, _| path.position_at_distance(at, 2.0 * radius);
        (0..count).fold(0.0, next) - path.length()
    };
    if overlap(largest) < 0.0 {
        let rule = format!(
            "must be larger: to touch each other, so few wheels would need a radius above {largest} m, half the outline's (give wheel_radius to space them instead)"
        );
        return Err(ScenarioError::new("robot.track.count", count, rule));
    }
    let radius = zero(0.0, largest, overlap);
    let path = path_of_centers(outline, radius);
    let mut at = 0.0;
    let centers = (0..count).map(|_| {
        let center = path.point_at(at);
        at = path.position_at_distance(at, 2.0 * radius);
        center
    });
    Ok((radius, centers.collect()))
}

/// The path of the centres of wheels that touch the outline from inside.
fn path_of_centers(outline: &TrackOutline, radius: f64) -> Envelope {
    let discs = outline_discs(outline).into_iter();
    Envelope::new(&discs.map(|disc| disc.grown(-radius)).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Their centres go round two half circles of 0.05 m and two straight runs of 0.4 m: a quarter of the way is half
    /// of a half circle and of a run.
    #[test]
    fn wheels_of_a_given_radius_stand_evenly_round_the_outline() {
        let outline = TrackOutline {
            discs: TrackOutline::two_discs(0.4, [0.07; 2]),
            grouser_height: 0.0,
            grouser_pitch: 0.05,
            grouser_thickness: 0.0,
        };
        let wheels = CircumferentialWheels {
            count: 4,
            wheel_radius: Some(0.02),
            wheel: Wheel::Round,
        };
        let found = circumferential(&outline, &wheels).expect("they fit");
        // The rest of a quarter beyond the rear half circle is this far behind the middle.
        let behind = 0.5 * PI * 0.05;
        let expected = [(-0.2, -0.05), (-behind, 0.05), (0.2, 0.05), (behind, -0.05)];
        assert_eq!(found.len(), 4);
        for (disc, (x, y)) in found.iter().zip(expected) {
            let off = disc.center - Vector::new(x, y);
            assert!(off.length() < 1e-12, "{} is not at ({x}, {y})", disc.center);
            assert!((disc.radius - 0.02).abs() < 1e-15, "{} m", disc.radius);
        }
    }
}
