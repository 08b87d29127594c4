//! Contacts of the convex hull of discs with a lane, a belt's or a polygon's: exact, and as good when
//! the ground reaches deep inside.
//!
//! A hull meets the ground in two ways only: an arc, or a corner, bears on a face, or a corner of the
//! ground on the hull.

use std::f64::consts::{PI, TAU};

use rapier2d_f64::math::{Pose, Vector};

use super::Contact;
use super::lane::{Corner, Lane, On, Region, Stretch, Touch};
use super::overlap::{self, Tip};
use crate::outline::{Disc, Envelope};
use crate::plane::{cross, direction};
use crate::robot::{Part, Shape};

/// [m] Ground that is deeper inside did not get there by sinking in.
pub(super) const SHALLOW: f64 = 1e-3;
/// [rad] On a face that is parallel to a run but for this, both ends of the run bear: an arc reaches
/// less than 0.1 mm out of the hull where it goes on by as much.
const NEARLY: f64 = 0.05;

/// A part that is the hull of discs, or of points.
pub(super) struct HullContact {
    part: usize,
    hull: Envelope,
    arcs: Vec<Arc>,
}

/// An arc of the hull, or a corner.
struct Arc {
    disc: Disc,
    /// Its outward directions, ...
    sector: Sector,
    /// ... and those within `NEARLY` of one.
    nearly: Sector,
    /// Outward normals of the runs that meet it, counter-clockwise.
    runs: [Vector; 2],
}

/// A range of directions.
struct Sector {
    /// The first and the last, counter-clockwise.
    ends: [Vector; 2],
    /// Whether it is more than a half turn.
    is_wide: bool,
}

impl Sector {
    /// From an angle [rad] by another, counter-clockwise.
    fn new(from: f64, sweep: f64) -> Self {
        let sweep = sweep.min(TAU);
        Self {
            ends: [from, from + sweep].map(direction),
            is_wide: sweep > PI,
        }
    }

    fn holds(&self, d: Vector) -> bool {
        let [first, last] = self.ends;
        if self.is_wide {
            cross(last, d) <= 0.0 || cross(d, first) <= 0.0
        } else {
            cross(first, d) >= 0.0 && cross(d, last) >= 0.0
        }
    }
}

impl Arc {
    /// The same as a sharp corner.
    fn tip(&self, pose: Pose) -> Tip {
        Tip {
            place: pose.transform_point(self.disc.center),
            normals: self.runs.map(|n| pose.rotation * n),
        }
    }
}

impl HullContact {
    /// That of a part of discs or points.
    pub(super) fn new(index: usize, part: &Part) -> Self {
        let discs: Vec<Disc> = match &part.shape {
            Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
            _ => part.discs().map(|(tip, _)| tip).collect(),
        };
        let hull = Envelope::new(&discs);
        let arc = |(disc, from, sweep)| Arc {
            disc,
            sector: Sector::new(from - sweep, sweep),
            nearly: Sector::new(from - sweep - NEARLY, sweep + 2.0 * NEARLY),
            runs: [from - sweep, from].map(direction),
        };
        Self {
            part: index,
            arcs: hull.arcs().into_iter().map(arc).collect(),
            hull,
        }
    }

    /// Adds every contact with a gap below `prediction`.
    pub(super) fn find(
        &self,
        lane: &Lane,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let center = |arc: &Arc| pose.transform_point(arc.disc.center);
        let (mut low, mut high) = (Vector::INFINITY, Vector::NEG_INFINITY);
        for arc in &self.arcs {
            let reach = Vector::splat(arc.disc.radius + prediction);
            low = low.min(center(arc) - reach);
            high = high.max(center(arc) + reach);
        }
        let region = lane.region(low.x, high.x);
        if lane.top(&region) < low.y {
            return;
        }
        for arc in &self.arcs {
            let reach = (prediction, SHALLOW);
            lane.touches_of_disc(center(arc), arc.disc.radius, reach, |touch| {
                let on_face = matches!(touch.on, On::Face(_));
                let yields =
                    || arc.disc.radius == 0.0 && overlap::tip_yields(lane, &arc.tip(pose), &touch);
                if on_face && arc.nearly.holds(pose.rotation.inverse() * -touch.normal) && !yields()
                {
                    contacts.push(touch.contact(self.part));
                }
            });
        }
        self.find_corners(lane, &region, pose, prediction, contacts);
    }

    /// Corners of the ground on the hull; where the hull's normal lies outside the corner's cone, a
    /// face is nearer.
    fn find_corners(
        &self,
        lane: &Lane,
        region: &Region,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let may_bear = |stretch: &Stretch| self.may_bear(stretch, pose, prediction);
        let mut meet = |i: usize| {
            let touch = self.corner_in_hull(i, lane.corner(i), pose, prediction);
            touch.inspect(|touch| contacts.push(touch.contact(self.part)))
        };
        let [left, below, right] = lane.split(region, self.lowest_run(pose));
        lane.visit_corners_below_run(&below, may_bear, &mut meet);
        for side in [left, right] {
            lane.visit_corners(&side, may_bear, |i| {
                meet(i);
            });
        }
    }

    /// [m] From where to where the run behind an arc reaches along x.
    fn run_behind(&self, i: usize, pose: Pose) -> [f64; 2] {
        let outward = self.arcs[i].runs[0];
        let x = |arc: &Arc| {
            let end = arc.disc.center + outward * arc.disc.radius;
            pose.transform_point(end).x
        };
        let (a, b) = (x(&self.arcs[i]), x(&self.arcs[(i + 1) % self.arcs.len()]));
        [a.min(b), a.max(b)]
    }

    /// [m] From where to where its lowest run does.
    fn lowest_run(&self, pose: Pose) -> [f64; 2] {
        let fall = |i: &usize| (pose.rotation * self.arcs[*i].runs[0]).y;
        let lowest = (0..self.arcs.len()).min_by(|a, b| fall(a).total_cmp(&fall(b)));
        self.run_behind(lowest.unwrap_or_default(), pose)
    }

    /// Whether a corner in a stretch of the ground may bear.
    fn may_bear(&self, stretch: &Stretch, pose: Pose, prediction: f64) -> bool {
        let room = self.room_above(stretch, pose);
        let is_faced = |i: usize| {
            let arc = &self.arcs[i];
            let (outward, reach) = (pose.rotation * arc.runs[0], arc.disc.radius + prediction);
            (stretch.reaches(self.run_behind(i, pose), prediction) && stretch.may_have(-outward))
                || stretch.may_face(pose.transform_point(arc.disc.center), reach)
        };
        room < prediction && (room < 0.0 || (0..self.arcs.len()).any(is_faced))
    }

    /// [m] How far at least the ground below a roof is away: by how much it lies beyond some tangent of the
    /// hull from below.
    fn room_above(&self, stretch: &Stretch, pose: Pose) -> f64 {
        let beyond = |arc: &Arc, center: Vector, outward: Vector| {
            let gap = |end: &Vector| (*end - center).dot(outward) - arc.disc.radius;
            stretch.roof.iter().map(gap).fold(f64::INFINITY, f64::min)
        };
        let mut room = f64::NEG_INFINITY;
        for arc in &self.arcs {
            let center = pose.transform_point(arc.disc.center);
            let outward = pose.rotation * arc.runs[0];
            if outward.y < 0.0 {
                room = room.max(beyond(arc, center, outward));
            }
            for end in &stretch.roof {
                let outward = (*end - center).normalize_or_zero();
                if outward.y < 0.0 && arc.sector.holds(pose.rotation.inverse() * outward) {
                    room = room.max(beyond(arc, center, outward));
                }
            }
        }
        room
    }

    /// How a corner of the ground bears on the hull.
    fn corner_in_hull(
        &self,
        i: usize,
        corner: &Corner,
        pose: Pose,
        prediction: f64,
    ) -> Option<Touch> {
        if !corner.stands_out {
            return None;
        }
        let place = pose.inverse_transform_point(corner.center);
        let inside = self.hull.depth(place);
        let depth = inside + corner.radius;
        if -depth >= prediction {
            return None;
        }
        let normal = -(pose.rotation * self.outward_at(place, inside));
        // Deep inside, every corner bears on the hull by itself.
        if depth > SHALLOW || corner.faces(normal) {
            return Some(corner.touch(i, normal, -depth));
        }
        let (depth, normal) = self.way_out(corner, place, pose)?;
        Some(corner.touch(i, normal, -depth))
    }

    /// Depth and normal of the run that a corner of the ground has come through where the nearest is
    /// none that it faces, unless the hull is less deep in a face beside.
    fn way_out(&self, corner: &Corner, place: Vector, pose: Pose) -> Option<(f64, Vector)> {
        let of_run = |arc: &Arc| {
            let [outward, _] = arc.runs;
            let inside = (arc.disc.center - place).dot(outward) + arc.disc.radius;
            (inside, -(pose.rotation * outward))
        };
        let below_face = |normal: Vector| {
            let inward = pose.rotation.inverse() * -normal;
            let reach = |arc: &Arc| (arc.disc.center - place).dot(inward) + arc.disc.radius;
            self.arcs.iter().map(reach).fold(0.0, f64::max)
        };
        let limit = corner
            .normals
            .map(below_face)
            .into_iter()
            .fold(SHALLOW, f64::min);
        let met = self
            .arcs
            .iter()
            .map(of_run)
            .filter(|(_, normal)| corner.faces(*normal));
        let (inside, normal) = met.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // Where two sharp corners have crossed, it lies beside the hull, by less than that.
        let is_met = 0.0 < inside && inside < limit && -self.hull.depth(place) < inside;
        is_met.then_some((inside + corner.radius, normal))
    }

    /// The outward normal where the hull lies nearest to a place, which is `depth` [m] inside.
    fn outward_at(&self, place: Vector, depth: f64) -> Vector {
        // Close to an arc's end its run is as near but for rounding, but faces another way.
        let of_arc = |arc: &Arc| {
            let spoke = place - arc.disc.center;
            let is_nearest = arc.disc.radius - spoke.length() <= depth && arc.sector.holds(spoke);
            spoke.try_normalize().filter(|_| is_nearest)
        };
        let outward = self.arcs.iter().find_map(of_arc);
        outward.unwrap_or_else(|| self.hull.outward_at(place))
    }
}
