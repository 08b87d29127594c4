//! What a chain of shoes runs on without a guide: sprocket, idler, road wheels and return rollers.

use crate::geometry::{Disc, ShoeLoop, Vector, left_of, lower_tangent};
use crate::robot::{BodyKind, Mount, Part, Shape, Sprocket};
use crate::scenario::SegmentalTrack;

/// Largest diameter of road wheels and return rollers, as a share of their spacing, ...
const FILLED: f64 = 0.96;
/// ... and their largest radii, as shares of that of the smaller end.
const ROAD_WHEEL: f64 = 0.9;
const ROLLER: f64 = 0.25;
/// Largest gaps between wheels under the lower and the upper run, in pitches.
const LOWER_SPAN: f64 = 1.0;
const UPPER_SPAN: f64 = 2.0;

/// Wheels on the inner faces of the plates.
pub(super) struct RunningGear {
    pub ends: [Disc; 2],
    pub road_wheels: Vec<Disc>,
    pub rollers: Vec<Disc>,
}

impl RunningGear {
    /// For the ends of a chain's path; road wheels follow the lower run of the `built` ends.
    pub(super) fn new(
        path: &ShoeLoop,
        built: &[Disc],
        plate_thickness: f64,
        track: &SegmentalTrack,
    ) -> Self {
        let of_path = path.ends(path.pitch);
        let ends = [of_path[0], of_path[1]].map(|end| Disc {
            radius: end.radius - 0.5 * plate_thickness,
            ..end
        });
        let [rear, front] = ends;
        let smaller = rear.radius.min(front.radius);
        let distance = (front.center - rear.center).length();
        let enough = |span: f64| (distance / (span * path.pitch)).ceil().max(1.0) as u32 - 1;
        // The upper tangent is the lower tangent of the mirrored ends.
        let upwards = |disc: Disc| Disc {
            center: Vector::new(disc.center.x, -disc.center.y),
            ..disc
        };
        let on_run = |[rear, front]: [Disc; 2], count: u32, largest: f64| -> Vec<Disc> {
            let [from, to] = lower_tangent(rear, front);
            let gap = (to - from) / f64::from(count + 1);
            let inwards = left_of(gap.normalize());
            let radius = (0.5 * FILLED * gap.length()).min(largest * smaller);
            let wheel = |i: u32| Disc {
                center: from + gap * f64::from(i) + inwards * radius,
                radius,
            };
            (1..=count).map(wheel).collect()
        };
        let road_wheels = track.road_wheel_count.unwrap_or_else(|| enough(LOWER_SPAN));
        let rollers = track
            .return_roller_count
            .unwrap_or_else(|| enough(UPPER_SPAN));
        let upper = on_run(ends.map(upwards), rollers, ROLLER);
        Self {
            ends,
            road_wheels: on_run([built[0], built[1]], road_wheels, ROAD_WHEEL),
            rollers: upper.into_iter().map(upwards).collect(),
        }
    }

    /// The sprocket: as heavy as the shoes on it, our assumption. Its teeth reach no farther out than `most` [m], where
    /// the tips of the grousers are.
    pub(super) fn sprocket(path: &ShoeLoop, shoe_mass: f64, most: f64) -> Option<Sprocket> {
        let teeth = path.teeth(most)?;
        let mass = shoe_mass * teeth.count as f64;
        Some(Sprocket {
            first_seat: path.first_seat(),
            inertia: 0.5 * mass * teeth.radius * teeth.radius,
            teeth,
        })
    }

    /// The wheels that could meet the ground between the shoes, whose tips reach `beyond` [m] their surface; they turn
    /// with what they touch.
    pub(super) fn parts(&self, beyond: f64) -> impl Iterator<Item = Part> {
        let of = |kind, discs: Vec<Disc>| {
            discs.into_iter().map(move |disc| Part {
                kind,
                shape: Shape::Hull {
                    discs: vec![disc],
                    grouser_height: beyond,
                },
                drive: None,
                friction_limit: 0.0,
                lane: 0,
                mount: Mount::Chassis,
            })
        };
        let [rear, front] = self.ends;
        of(BodyKind::Sprocket, vec![rear])
            .chain(of(BodyKind::Idler, vec![front]))
            .chain(of(BodyKind::RoadWheel, self.road_wheels.clone()))
            .chain(of(BodyKind::Roller, self.rollers.clone()))
    }
}
