//! Contacts of a convex hull of discs, such as a belt or a polygon, with a lane: exact, however deep the
//! ground reaches inside.
//!
//! A hull meets the ground in only two ways: an arc or a corner of the hull bears on a face, or a corner of
//! the ground bears on the hull.
//!
//! The equations: docs/physics.md, "Contacts".

use std::f64::consts::{PI, TAU};

use super::Contact;
use super::lane::{Corner, Lane, On, Region, SHALLOW, Stretch, Touch};
use super::redundant::{NEARLY_PARALLEL, Tip, thin_out, tip_yields};
use crate::geometry::{Disc, Envelope, Pose, Vector, cross, direction};
use crate::robot::{Part, Shape};

/// A part that is the hull of discs or of points.
pub(super) struct HullContact {
    part: usize,
    hull: Envelope,
    arcs: Vec<Arc>,
}

/// An arc of the hull, or a corner.
struct Arc {
    disc: Disc,
    /// Its outward directions.
    sector: Sector,
    /// The same, extended by `NEARLY_PARALLEL` at both ends; there an arc protrudes from the hull by less than 0.1 mm.
    widened: Sector,
    /// Outward normals of the two runs that it joins, counter-clockwise.
    runs: [Vector; 2],
}

impl Arc {
    /// The arc as a sharp corner.
    fn tip(&self, pose: Pose) -> Tip {
        Tip {
            place: pose.transform_point(self.disc.center),
            normals: self.runs.map(|n| pose.rotation * n),
        }
    }
}

impl HullContact {
    /// The hull of a part made of discs or points.
    pub(super) fn new(index: usize, part: &Part) -> Self {
        let discs: Vec<Disc> = match &part.shape {
            Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
            Shape::Grouser(grouser) => grouser.corners().map(Disc::point).to_vec(),
            _ => part.discs().map(|(_, root)| root).collect(),
        };
        let hull = Envelope::new(&discs);
        let arc = |(disc, from, sweep)| Arc {
            disc,
            sector: Sector::new(from - sweep, sweep),
            widened: Sector::new(
                from - sweep - NEARLY_PARALLEL,
                sweep + 2.0 * NEARLY_PARALLEL,
            ),
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
            let reach = Vector::splat(arc.disc.radius + prediction.max(SHALLOW.value()));
            low = low.min(center(arc) - reach);
            high = high.max(center(arc) + reach);
        }
        if lane.highest() < low.y {
            return;
        }
        let region = lane.region(low.x, high.x);
        if lane.top(&region) < low.y {
            return;
        }
        let first = contacts.len();
        // A part fast enough to have a large prediction may be this deep in the middle of a step.
        let reach = (prediction, SHALLOW.value().max(prediction));
        for arc in &self.arcs {
            lane.touches_of_disc(&region, center(arc), arc.disc.radius, reach, |touch| {
                // There is ground behind a face, but behind thin ground there is air again.
                let is_real = touch.distance >= -SHALLOW.value().min(prediction)
                    || lane.contains(center(arc) - touch.normal * arc.disc.radius);
                let on_face = is_real && matches!(touch.on, On::Face(_));
                let yields = || arc.disc.radius == 0.0 && tip_yields(lane, &arc.tip(pose), &touch);
                if on_face
                    && arc
                        .widened
                        .contains(pose.rotation.inverse() * -touch.normal)
                    && !yields()
                {
                    contacts.push(touch.contact(self.part));
                }
            });
        }
        self.find_corners(lane, &region, pose, prediction, contacts);
        for arc in &self.arcs {
            let disc = Disc {
                center: center(arc),
                ..arc.disc
            };
            thin_out(contacts, first, lane, &disc, prediction);
        }
    }

    /// Adds the contacts of corners of the ground on the hull; where the hull's normal lies outside a
    /// corner's cone, a face is nearer.
    fn find_corners(
        &self,
        lane: &Lane,
        region: &Region,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        if !lane.may_be_convex(region) {
            return;
        }
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

    /// How a corner of the ground bears on the hull, if it does.
    fn corner_in_hull(
        &self,
        i: usize,
        corner: &Corner,
        pose: Pose,
        prediction: f64,
    ) -> Option<Touch> {
        if !corner.is_convex {
            return None;
        }
        let place = pose.inverse_transform_point(corner.center);
        let inside = self.hull.depth(place);
        let depth = inside + corner.radius;
        if -depth >= prediction {
            return None;
        }
        let (outward, is_run) = self.outward_at(place, inside);
        let normal = -(pose.rotation * outward);
        // Deep inside, every corner bears on the hull independently.
        if depth > SHALLOW.value()
            || corner.has_normal(normal)
            || (is_run && corner.nearly_has_normal(normal))
        {
            return Some(corner.touch(i, normal, -depth));
        }
        let (depth, normal) = self.entered_run(corner, place, pose)?;
        Some(corner.touch(i, normal, -depth))
    }

    /// Depth and normal of the run through which a corner of the ground has entered, if the corner does not
    /// face the nearest run; `None` if the hull is less deep below a face next to the corner.
    fn entered_run(&self, corner: &Corner, place: Vector, pose: Pose) -> Option<(f64, Vector)> {
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
            .fold(SHALLOW.value(), f64::min);
        let met = self
            .arcs
            .iter()
            .map(of_run)
            .filter(|(_, normal)| corner.has_normal(*normal));
        let (inside, normal) = met.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // Where two sharp corners overlap, the ground corner lies outside the hull, by less than that.
        let is_met = 0.0 < inside && inside < limit && -self.hull.depth(place) < inside;
        is_met.then_some((inside + corner.radius, normal))
    }

    /// The outward normal of the hull at the point nearest to a place `depth` [m] inside, and whether that point is on
    /// a run.
    fn outward_at(&self, place: Vector, depth: f64) -> (Vector, bool) {
        // Near the end of an arc, its run is equally near within rounding, but has a different normal.
        let of_arc = |arc: &Arc| {
            let spoke = place - arc.disc.center;
            let is_nearest =
                arc.disc.radius - spoke.length() <= depth && arc.sector.contains(spoke);
            spoke.try_normalize().filter(|_| is_nearest)
        };
        let outward = self.arcs.iter().find_map(of_arc);
        outward.map_or_else(
            || (self.hull.outward_at(place), true),
            |outward| (outward, false),
        )
    }
}

impl HullContact {
    /// [m] Range of x of the run that follows an arc.
    fn run_behind(&self, i: usize, pose: Pose) -> [f64; 2] {
        let outward = self.arcs[i].runs[0];
        let x = |arc: &Arc| {
            let end = arc.disc.center + outward * arc.disc.radius;
            pose.transform_point(end).x
        };
        let (a, b) = (x(&self.arcs[i]), x(&self.arcs[(i + 1) % self.arcs.len()]));
        [a.min(b), a.max(b)]
    }

    /// [m] Range of x of the lowest run.
    fn lowest_run(&self, pose: Pose) -> [f64; 2] {
        let fall = |i: &usize| (pose.rotation * self.arcs[*i].runs[0]).y;
        let lowest = (0..self.arcs.len()).min_by(|a, b| fall(a).total_cmp(&fall(b)));
        self.run_behind(lowest.unwrap_or_default(), pose)
    }

    /// Whether a corner in a stretch of the ground may bear on the hull.
    fn may_bear(&self, stretch: &Stretch, pose: Pose, prediction: f64) -> bool {
        let room = self.room_above(stretch, pose);
        let is_faced = |i: usize| {
            let arc = &self.arcs[i];
            let (outward, reach) = (pose.rotation * arc.runs[0], arc.disc.radius + prediction);
            (stretch.reaches(self.run_behind(i, pose), prediction)
                && stretch.may_have_normal(-outward))
                || stretch.may_face(pose.transform_point(arc.disc.center), reach)
        };
        room < prediction && (room < 0.0 || (0..self.arcs.len()).any(is_faced))
    }

    /// [m] Lower bound of the distance to the ground below a roof: how far the roof lies beyond a tangent
    /// of the hull's underside.
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
                if outward.y < 0.0 && arc.sector.contains(pose.rotation.inverse() * outward) {
                    room = room.max(beyond(arc, center, outward));
                }
            }
        }
        room
    }
}

/// A range of directions.
struct Sector {
    /// The first and the last direction, counter-clockwise.
    ends: [Vector; 2],
    /// Whether it spans more than half a turn.
    is_wide: bool,
}

impl Sector {
    /// The range that starts at an angle [rad] and sweeps another, counter-clockwise.
    fn new(from: f64, sweep: f64) -> Self {
        let sweep = sweep.min(TAU);
        Self {
            ends: [from, from + sweep].map(direction),
            is_wide: sweep > PI,
        }
    }

    /// Whether a direction lies in the range, ends included.
    fn contains(&self, d: Vector) -> bool {
        let [first, last] = self.ends;
        if self.is_wide {
            cross(last, d) <= 0.0 || cross(d, first) <= 0.0
        } else {
            cross(first, d) >= 0.0 && cross(d, last) >= 0.0
        }
    }
}

#[cfg(test)]
mod tests;
