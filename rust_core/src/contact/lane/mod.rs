//! One lane of the ground for contacts: straight faces and the corners between them.
//!
//! A sharp corner is a rounded one of radius 0, so a part bears either on a face or on the disc of a
//! corner, and rounded edges are true arcs.
//!
//! The equations: docs/physics.md, "Contacts".

mod features;
mod index;
mod roof;
#[cfg(test)]
mod tests;

use features::{Face, corners_of};
use index::Index;
use roof::{Chord, SAME_FACE};

use crate::geometry::{Vector, cross, left_of};
use crate::terrain::{Profile, facet_along};

use crate::units::Metres;
pub(super) use features::{Corner, On, ROUNDING, Touch};
pub(super) use index::{Region, Stretch};

/// [m] Deeper ground did not get there by penetration.
pub(super) const SHALLOW: Metres = Metres(1e-3);

/// Corners at either end of finely divided ground that are searched for one that bears.
const NEAR_END: usize = 16;
/// [m] A contact this close to the end of a face touches the edge.
const AT_CORNER: Metres = Metres(1e-7);

/// Faces and corners from left to right; face i lies between corners i and i + 1.
pub(crate) struct Lane {
    faces: Vec<Face>,
    corners: Vec<Corner>,
    index: Index,
    /// [m] The points of the profile.
    points: Vec<Vector>,
}

impl Lane {
    /// The lane of a profile.
    pub(crate) fn new(profile: &Profile) -> Self {
        let corners = corners_of(profile);
        let end_of = |c: &Corner| profile.points[c.facet + c.facets];
        let faces: Vec<Face> = corners
            .windows(2)
            .map(|ends| {
                let begin = end_of(&ends[0]);
                let facets = ends[0].facet + ends[0].facets..ends[1].facet;
                let chord = profile.points[facets.end] - begin;
                let length = chord.length();
                let normal = left_of(chord.normalize_or(Vector::X));
                let adjoining = length == 0.0;
                let normal = if adjoining {
                    ends[0].normals[1]
                } else {
                    normal
                };
                Face {
                    begin,
                    along: Vector::new(normal.y, -normal.x),
                    normal,
                    length,
                    extent: ends[0].arc_length() + length + ends[1].arc_length(),
                    facets,
                    edges: [ends[0].edge, ends[1].edge],
                }
            })
            .collect();
        let index = Index::new(profile, &faces, &corners);
        Self {
            faces,
            corners,
            index,
            points: profile.points.clone(),
        }
    }

    pub(super) fn corner(&self, corner: usize) -> &Corner {
        &self.corners[corner]
    }

    /// A region's corners left of a range of x, in it and right of it.
    pub(super) fn split(&self, region: &Region, [low, high]: [f64; 2]) -> [Region; 3] {
        self.index.split(region, low, high)
    }

    /// The ground in a range of x.
    pub(super) fn region(&self, low: f64, high: f64) -> Region {
        self.index.region(low, high)
    }

    /// [m] Height of the highest ground.
    pub(super) fn highest(&self) -> f64 {
        self.index.highest_of_all()
    }

    /// [m] An upper bound of the height of a region.
    pub(super) fn top(&self, region: &Region) -> f64 {
        self.index.top(region)
    }

    /// Whether a region may have a convex corner.
    pub(super) fn may_be_convex(&self, region: &Region) -> bool {
        region.is_long() || region.corners().any(|i| self.corners[i].is_convex)
    }

    /// Finds everything in a region on which a disc bears with a gap below `prediction`; a corner of a part is a disc
    /// of radius 0. Ground more than `depth` [m] above the centre did not get there by penetration; soft contacts are
    /// searched down to `SHALLOW`.
    pub(super) fn touches_of_disc(
        &self,
        within: &Region,
        center: Vector,
        radius: f64,
        (prediction, depth): (f64, f64),
        mut add: impl FnMut(Touch),
    ) {
        let reach = radius + prediction.max(depth.min(SHALLOW.value()));
        let mut region = self
            .index
            .narrow(within, center.x - reach, center.x + reach);
        if region.is_long() {
            // If all of the ground lies below the centre, only part of the region is near.
            let room = (center.y - self.top(&region)).max(0.0);
            if room > reach {
                return;
            }
            let half = (reach * reach - room * room).sqrt();
            region = self.index.narrow(&region, center.x - half, center.x + half);
        }
        self.index.visit(
            &region,
            |node: &Stretch| node.may_face(center, reach),
            |i, is_face| {
                if is_face {
                    let touch = self.face_under_disc(i, center, radius);
                    let near = |t: &Touch| t.distance < prediction && t.distance + radius > -depth;
                    touch.filter(near).into_iter().for_each(&mut add);
                }
                let touch = self.corner_under_disc(i, center, radius);
                touch
                    .filter(|t| t.distance < prediction)
                    .into_iter()
                    .for_each(&mut add);
            },
        );
    }

    /// Whether a point is in the ground below a concave corner, beyond the ends of both faces by less than their
    /// length, and so behind both.
    fn is_under(&self, i: usize, point: Vector) -> bool {
        if i == 0 || i == self.faces.len() {
            return false;
        }
        let corner = &self.corners[i];
        let [before, behind] = corner.normals;
        let spoke = point - corner.center;
        !corner.is_convex
            && cross(before, spoke) <= 0.0
            && cross(behind, spoke) >= 0.0
            && spoke.dot(before + behind) < 0.0
            && spoke.length() < self.faces[i - 1].extent.min(self.faces[i].extent)
            && self.contains(point)
    }

    /// Whether a point is in the ground.
    pub(super) fn contains(&self, point: Vector) -> bool {
        let under = self.region(point.x, point.x);
        under.pieces().all(|i| {
            let (corner, face) = (&self.corners[i], &self.faces[i]);
            if face.begin.x <= point.x {
                return (point - face.begin).dot(face.normal) < 0.0;
            }
            let spoke = point - corner.center;
            spoke.y < 0.0 || spoke.length() < corner.radius
        })
    }

    /// The touch of a disc on a face, if the foot of its centre lies on the face.
    fn face_under_disc(&self, i: usize, center: Vector, radius: f64) -> Option<Touch> {
        let face = &self.faces[i];
        let spoke = center - face.begin;
        let along = spoke.dot(face.along);
        let is_past = (along < 0.0 && !self.is_under(i, center))
            || (along > face.length && !self.is_under(i + 1, center));
        if is_past {
            return None;
        }
        let edge = if along < AT_CORNER.value() {
            face.edges[0]
        } else if face.length - along < AT_CORNER.value() {
            face.edges[1]
        } else {
            -1
        };
        Some(Touch {
            place: face.begin + face.along * along,
            normal: face.normal,
            distance: spoke.dot(face.normal) - radius,
            facet: facet_along(&self.points, face.facets.clone(), along / face.length),
            edge,
            on: On::Face(i),
        })
    }

    /// The touch of a disc on a corner, if its centre lies in the corner's cone.
    fn corner_under_disc(&self, i: usize, center: Vector, radius: f64) -> Option<Touch> {
        let corner = &self.corners[i];
        if !corner.is_convex {
            return None;
        }
        let spoke = center - corner.center;
        let far = spoke.length();
        // At the corner itself there is no direction, and no normal.
        let normal = spoke / far;
        let bears = corner.has_normal(normal);
        bears.then(|| corner.touch(i, normal, far - radius - corner.radius))
    }

    /// The ground that straight runs of a part in a range of x may touch with a gap below `prediction`.
    pub(super) fn region_of_runs(&self, [low, high]: [f64; 2], prediction: f64) -> Region {
        let margin = self.margin(prediction);
        self.region(low - margin, high + margin)
    }

    /// The same within a region.
    pub(super) fn narrow_of_runs(
        &self,
        within: &Region,
        [low, high]: [f64; 2],
        prediction: f64,
    ) -> Region {
        let margin = self.margin(prediction);
        self.index.narrow(within, low - margin, high + margin)
    }

    /// [m] Largest distance of corners from a run that touches them: the centre of an arc is off its corner by at most
    /// its radius.
    fn margin(&self, prediction: f64) -> f64 {
        prediction + self.index.largest_radius()
    }

    /// Finds every corner of a region that bears on a straight run of a part, from `begin` to `end` counter-clockwise
    /// and with the normal `outward`, with a gap below `prediction` and a penetration below `depth`.
    pub(super) fn touches_of_run(
        &self,
        within: &Region,
        (begin, end): (Vector, Vector),
        outward: Vector,
        (prediction, depth): (f64, f64),
        mut add: impl FnMut(Touch),
    ) {
        // The ground has no overhangs, so none of its normals points down.
        if outward.y > ROUNDING {
            return;
        }
        let along = left_of(outward);
        let length = (end - begin).dot(along);
        let (low, high) = (begin.x.min(end.x), begin.x.max(end.x));
        let region = self.narrow_of_runs(within, [low, high], prediction);
        self.visit_corners_below_run(
            &region,
            |stretch| stretch.may_have_normal(-outward),
            |i| {
                let corner = &self.corners[i];
                let spoke = corner.center - begin;
                let gap = spoke.dot(outward) - corner.radius;
                let bears = corner.is_convex
                    && gap < prediction
                    && gap > -depth
                    && (0.0..=length).contains(&spoke.dot(along))
                    && corner.nearly_has_normal(-outward);
                let touch = bears.then(|| corner.touch(i, -outward, gap));
                touch.inspect(|touch| add(*touch))
            },
        );
    }

    /// Calls `meet` with the convex corners of a region that may matter.
    pub(super) fn visit_corners(
        &self,
        region: &Region,
        matters: impl Fn(&Stretch) -> bool,
        mut meet: impl FnMut(usize),
    ) {
        let matters = |stretch: &Stretch| stretch.is_convex && matters(stretch);
        self.index.visit(region, matters, |i, _| meet(i));
    }

    /// The same below a straight run of a part; `meet` returns the touch of a corner on it, if any. On finely divided
    /// ground, it finds one touch near each end; then only corners above the chord between them matter.
    pub(super) fn visit_corners_below_run(
        &self,
        region: &Region,
        matters: impl Fn(&Stretch) -> bool,
        mut meet: impl FnMut(usize) -> Option<Touch>,
    ) {
        let mut corners = region.corners();
        let mut chord = None;
        if region.is_long() && self.index.any(region, |s| s.is_convex && matters(s)) {
            let first = corners.by_ref().take(NEAR_END).find_map(&mut meet);
            // The last corner may lie beyond the run.
            let joins = |last: &Touch| first.as_ref().is_some_and(|f| Chord::joins(f, last));
            let of_run = |i| meet(i).filter(joins);
            let last = corners.by_ref().rev().take(NEAR_END).find_map(of_run);
            if let Some((first, last)) = first.zip(last) {
                if self.index.is_fine(region) {
                    let end = (*corners.end() + 1).min(self.faces.len());
                    let between = Region::between(*corners.start(), end);
                    self.visit_highest(between, (first, last), &mut meet);
                    return;
                }
                chord = Chord::new(&first, &last);
            }
        }
        let hides = |hidden: &dyn Fn(&Chord) -> bool| chord.as_ref().is_some_and(hidden);
        if !corners.is_empty() {
            self.visit_corners(
                &Region::between(*corners.start(), *corners.end()),
                |stretch| matters(stretch) && !hides(&|chord| chord.hides_all(&stretch.roof)),
                |i| {
                    if !hides(&|chord| chord.hides_corner(&self.corners[i])) {
                        meet(i);
                    }
                },
            );
        }
    }

    /// Calls `meet` with corners between two touches on a straight run until no corner rises above the chords
    /// between those that bear.
    fn visit_highest(
        &self,
        region: Region,
        (first, last): (Touch, Touch),
        meet: &mut impl FnMut(usize) -> Option<Touch>,
    ) {
        let mut open = vec![(region, first, last)];
        while let Some((region, first, last)) = open.pop() {
            let Some(chord) = Chord::new(&first, &last).filter(|_| !region.is_empty()) else {
                continue;
            };
            let highest = self.index.highest(
                &region,
                SAME_FACE.value(),
                |stretch| chord.rise_of(&stretch.roof),
                |i| chord.rise(&self.corners[i]),
            );
            if let Some(highest) = highest {
                let [before, behind] = region.around(highest);
                // A corner that does not bear on the run leaves the chord as it is.
                let is_between = |t: &Touch| Chord::joins(&first, t) && Chord::joins(t, &last);
                let touch = meet(highest).filter(is_between);
                open.push((before, first, touch.unwrap_or(last)));
                open.push((behind, touch.unwrap_or(first), last));
            }
        }
    }

    /// Whether the ground within reach of a place is finely divided.
    pub(super) fn is_fine(&self, center: Vector, reach: f64) -> bool {
        let region = self.region(center.x - reach, center.x + reach);
        self.index.is_fine(&region)
    }
}
