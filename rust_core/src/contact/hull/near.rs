//! Which stretches of finely divided ground may bear on a hull.
//!
//! The equations: docs/physics.md, "Contacts".

use super::super::lane::Stretch;
use super::{Arc, HullContact};
use crate::geometry::{Pose, Vector};

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
    pub(super) fn lowest_run(&self, pose: Pose) -> [f64; 2] {
        let fall = |i: &usize| (pose.rotation * self.arcs[*i].runs[0]).y;
        let lowest = (0..self.arcs.len()).min_by(|a, b| fall(a).total_cmp(&fall(b)));
        self.run_behind(lowest.unwrap_or_default(), pose)
    }

    /// Whether a corner in a stretch of the ground may bear on the hull.
    pub(super) fn may_bear(&self, stretch: &Stretch, pose: Pose, prediction: f64) -> bool {
        let room = self.room_above(stretch, pose);
        let is_faced = |i: usize| {
            let arc = &self.arcs[i];
            let (outward, reach) = (pose.rotation * arc.runs[0], arc.disc.radius + prediction);
            (stretch.reaches(self.run_behind(i, pose), prediction) && stretch.may_have(-outward))
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
                if outward.y < 0.0 && arc.sector.holds(pose.rotation.inverse() * outward) {
                    room = room.max(beyond(arc, center, outward));
                }
            }
        }
        room
    }
}
