//! Where the wheels of a model sit on the robot.

use rapier2d_f64::math::Vector;

use super::{Disc, Envelope, end_discs};
use crate::error::ScenarioError;
use crate::scenario::{
    CircumferentialWheels, ForceSupport, HybridWheels, LineOfWheels, Robot, Track, TrackOutline,
};

/// The wheels of one side, in the order of eq. (1); none for a model without wheels.
///
/// # Errors
/// Wheels that do not fit the outline.
pub(crate) fn wheels(robot: &Robot) -> Result<Vec<Disc>, ScenarioError> {
    let outline = &robot.outline;
    match &robot.track {
        Track::Line(LineOfWheels {
            count,
            wheel_radius,
            ..
        }) => Ok(line(outline, *count, *wheel_radius)),
        Track::Circumferential(wheels) => circumferential(outline, wheels),
        Track::Hybrid(HybridWheels { placements, .. }) => Ok(placements
            .iter()
            .map(|[x, y, radius]| Disc {
                center: Vector::new(*x, *y),
                radius: *radius,
            })
            .collect()),
        Track::Force(force) if force.support == ForceSupport::Wheels => {
            Ok(line(outline, force.wheel_count, None))
        }
        Track::Belt(_) | Track::Force(_) => Ok(Vec::new()),
    }
}

/// Rear first, evenly spaced between the end axles; radii linear between unequal ends.
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

/// From the rear end of the lower run along belt travel: up round the rear, forwards on top, down
/// round the front, back along the ground.
fn circumferential(
    outline: &TrackOutline,
    wheels: &CircumferentialWheels,
) -> Result<Vec<Disc>, ScenarioError> {
    let smallest = outline.front_radius.min(outline.rear_radius);
    let ring = |radius: f64| Ring::new(outline, radius, wheels.count);
    let radius = match wheels.wheel_radius {
        Some(radius) if radius < smallest => radius,
        Some(radius) => {
            let rule = format!("must be below the smaller radius of the outline, {smallest} m");
            return Err(ScenarioError::new("robot.track.wheel_radius", radius, rule));
        }
        None => {
            // Larger wheels leave a shorter way for their centres and need more of it.
            let overlap = |radius: f64| ring(radius).overshoot(2.0 * radius);
            let largest = smallest * (1.0 - 1e-9);
            if overlap(largest) <= 0.0 {
                let rule = format!(
                    "must be larger: so few wheels would have to exceed the outline's {smallest} m to touch; give wheel_radius for spaced ones"
                );
                return Err(ScenarioError::new("robot.track.count", wheels.count, rule));
            }
            bisect(0.0, largest, overlap)
        }
    };
    let disc = |center| Disc { center, radius };
    Ok(ring(radius).even().into_iter().map(disc).collect())
}

/// The way of the wheels' centres.
struct Ring {
    path: Envelope,
    count: u32,
}

impl Ring {
    fn new(outline: &TrackOutline, radius: f64, count: u32) -> Self {
        let discs = end_discs(outline).map(|end| Disc {
            radius: end.radius - radius,
            ..end
        });
        Self {
            path: Envelope::new(&discs),
            count,
        }
    }

    /// [m] How far beyond the start as many straight distances end as there are wheels.
    fn overshoot(&self, distance: f64) -> f64 {
        let end = (0..self.count).fold(0.0, |at, _| self.path.way_to_distance(at, distance));
        end - self.path.length()
    }

    /// Centres at equal straight distances, also from the last to the first.
    fn even(&self) -> Vec<Vector> {
        // A straight distance is never longer than the way it cuts short.
        let longest = self.path.length() / f64::from(self.count);
        let distance = bisect(0.0, longest, |distance| self.overshoot(distance));
        let mut at = 0.0;
        (0..self.count)
            .map(|_| {
                let center = self.path.point_at(at);
                at = self.path.way_to_distance(at, distance);
                center
            })
            .collect()
    }
}

/// The zero of an increasing function, to the last bit.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
