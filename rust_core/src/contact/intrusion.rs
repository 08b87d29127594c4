//! Intrusions: the connected pieces of the ground inside the taut belt round the robot's own bodies.
//!
//! The equations: docs/physics.md, "Shapes".

#[cfg(test)]
mod tests;

use std::sync::OnceLock;

use super::Contact;
use crate::geometry::cut::{self, Chord, Piece};
use crate::geometry::{Disc, Envelope, Pose, Vector};
use crate::robot::{BodyKind, Mount, Part};
use crate::terrain::{Profile, Side};
use crate::units::Metres;

/// [m] A contact this close to a piece of the ground bears on it.
const BEARS: Metres = Metres(5e-4);

/// [m] If edges are equally deep within this, the leftmost counts, regardless of rounding.
const SAME_DEPTH: Metres = Metres(1e-6);

/// The taut belts round a track's bodies, in the frame of their carrier.
#[derive(Clone, Debug)]
pub(crate) struct TrackEnvelope {
    /// The lane under the track.
    pub lane: usize,
    /// The carrier: the chassis or a flipper.
    pub mount: Mount,
    /// Circumscribed circles.
    discs: Vec<Disc>,
    /// The part of each disc.
    parts: Vec<usize>,
    /// The belt round the circumscribed circles.
    tips: Belt,
    /// The belt round the root circles.
    roots: Belt,
    /// [m] Inward offset of the belts from the circles.
    margin: f64,
}

/// A taut belt and the deepest point inside it, which is computed on request.
#[derive(Clone, Debug)]
struct Belt {
    hull: Envelope,
    middle: OnceLock<Vector>,
}

impl Belt {
    fn new(discs: &[Disc]) -> Self {
        Self {
            hull: Envelope::new(discs),
            middle: OnceLock::new(),
        }
    }

    fn middle(&self) -> Vector {
        *self.middle.get_or_init(|| self.hull.deepest())
    }
}

/// A connected piece of the ground inside the envelope of the track.
#[derive(Clone, Debug, PartialEq)]
pub struct Intrusion {
    /// The lane of the piece.
    pub side: Side,
    /// Index of that lane.
    pub(crate) lane: usize,
    /// The carrier of the track.
    pub(crate) mount: Mount,
    /// Edges inside the envelope, from the left.
    pub edges: Vec<i32>,
    /// The deepest convex edge, or -1.
    pub edge: i32,
    /// Bodies on either side of the deepest point, in the order in which the belt passes them.
    pub bodies: [usize; 2],
    /// [m] Largest depth below the belt round the circumscribed circles.
    pub depth: f64,
    /// [m] Largest depth below the belt round the root circles, 0 if the piece does not reach it.
    pub root_depth: f64,
    /// [m] x of the deepest point.
    pub x: f64,
    /// [m] y of the deepest point.
    pub y: f64,
    /// [m^2] Area of the piece.
    pub area: f64,
    /// Stretches of the profile that bound it, as facet index plus fraction of the facet.
    stretches: Vec<(f64, f64)>,
}

impl TrackEnvelope {
    /// The envelope of the parts that `mount` carries on a lane.
    ///
    /// Wheels penetrate the ground by micrometres, and a belt along their lowest points would join all ground under the
    /// robot into one piece; `margin` [m] is an inward offset that avoids this.
    pub(crate) fn new(parts: &[Part], (lane, mount): (usize, Mount), margin: f64) -> Self {
        let of_track: Vec<(usize, Disc, Disc)> = parts
            .iter()
            .enumerate()
            .filter(|(_, part)| part.lane == lane && part.mount == mount)
            .flat_map(|(i, part)| part.discs().map(move |(tip, root)| (i, tip, root)))
            .collect();
        let within = |disc: &Disc| Disc {
            radius: disc.radius - margin,
            ..*disc
        };
        let discs: Vec<Disc> = of_track.iter().map(|(_, tip, _)| within(tip)).collect();
        let roots: Vec<Disc> = of_track.iter().map(|(_, _, root)| within(root)).collect();
        Self {
            lane,
            mount,
            parts: of_track.iter().map(|(part, ..)| *part).collect(),
            tips: Belt::new(&discs),
            roots: Belt::new(&roots),
            discs,
            margin,
        }
    }

    /// Whether a convex edge is inside.
    pub(crate) fn holds_edge(&self, profile: &Profile, pose: Pose) -> bool {
        let is_convex = |i: &usize| {
            let edge = profile.edge_of_point[*i];
            edge >= 0 && profile.edges[edge as usize].angle > 0.0
        };
        let lowest = |disc: &Disc| pose.transform_point(disc.center).y - disc.radius;
        let bottom = self.discs.iter().map(lowest).fold(f64::INFINITY, f64::min);
        let inside = |i: usize| {
            if profile.points[i].y < bottom {
                return false;
            }
            let point = pose.inverse_transform_point(profile.points[i]);
            self.tips.hull.depth(point) > 0.0
        };
        self.points_under(profile, pose)
            .iter()
            .map(|i| *i as usize)
            .filter(is_convex)
            .any(inside)
    }

    /// Every piece of the ground inside the envelope, from the left.
    pub(crate) fn intrusions(&self, profile: &Profile, pose: Pose) -> Vec<Intrusion> {
        let under = self.points_under(profile, pose);
        let place = |i: &u32| pose.inverse_transform_point(profile.points[*i as usize]);
        let polyline: Vec<Vector> = under.iter().map(place).collect();
        let chords = cut::chords(&self.tips.hull, &polyline);
        if chords.is_empty() {
            // The whole envelope is on one side of the ground, so any of its points decides.
            let some_point = self.discs.first().map(|disc| disc.center);
            let buried = some_point.is_some_and(|point| below_ground(profile, pose, point));
            let buried = buried.then(|| self.buried(profile.side, pose));
            return buried.into_iter().collect();
        }
        cut::pieces(&self.tips.hull, &chords)
            .iter()
            .map(|piece| self.intrusion(profile, under, pose, piece))
            .collect()
    }

    /// Indices of the points of the profile at the ends of its straight pieces under the envelope.
    fn points_under<'a>(&self, profile: &'a Profile, pose: Pose) -> &'a [u32] {
        let sides = |disc: &Disc| {
            let x = pose.transform_point(disc.center).x;
            (x - disc.radius, x + disc.radius)
        };
        let (low, high) = self
            .discs
            .iter()
            .map(sides)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
                (low.min(a), high.max(b))
            });
        let (bends, x) = (profile.bends(), |i: &u32| profile.points[*i as usize].x);
        let first = bends.partition_point(|i| x(i) < low).saturating_sub(1);
        let end = bends.partition_point(|i| x(i) <= high) + 1;
        &bends[first..end.min(bends.len())]
    }

    /// Whether a point inside the envelope lies in a piece.
    fn contains(&self, profile: &Profile, pose: Pose, piece: &Piece, point: Vector) -> bool {
        // Everything below a point in the ground is ground, so the rim below it belongs to its piece.
        let down = pose.rotation.inverse() * -Vector::Y;
        let far = point + down * self.tips.hull.length();
        let hull = &self.tips.hull;
        let inside = hull.clip([point, far], [point, far].map(|p| hull.depth(p)));
        let (_, fraction) = inside.unwrap_or_default();
        let below = hull.position_of(point + (far - point) * fraction);
        below_ground(profile, pose, point) && piece.reaches(hull, below)
    }

    /// The point of a piece that lies deepest below a belt.
    fn deepest(&self, profile: &Profile, pose: Pose, piece: &Piece, belt: &Belt) -> Vector {
        if self.contains(profile, pose, piece, belt.middle()) {
            belt.middle()
        } else {
            piece.deepest_on_chords(&belt.hull)
        }
    }

    /// The intrusion of a piece; `under` are the points of its polyline.
    fn intrusion(&self, profile: &Profile, under: &[u32], pose: Pose, piece: &Piece) -> Intrusion {
        let deepest = self.deepest(profile, pose, piece, &self.tips);
        let root = self.deepest(profile, pose, piece, &self.roots);
        let mut edges: Vec<i32> = Vec::new();
        let mut edge = (f64::NEG_INFINITY, -1);
        for i in piece.chords().flat_map(|c| &under[c.vertices.clone()]) {
            let i = *i as usize;
            let id = profile.edge_of_point[i];
            if id < 0 {
                continue;
            }
            if edges.last() != Some(&id) {
                edges.push(id);
            }
            let point = pose.inverse_transform_point(profile.points[i]);
            let depth = self.tips.hull.depth(point);
            if profile.edges[id as usize].angle > 0.0 && depth > edge.0 + SAME_DEPTH.value() {
                edge = (depth, id);
            }
        }
        Intrusion {
            edges,
            edge: edge.1,
            area: piece.area(&self.tips.hull).max(0.0),
            stretches: piece.chords().map(|c| span(profile, under, c)).collect(),
            ..self.at(profile.side, pose, [deepest, root])
        }
    }

    /// The intrusion of an envelope that lies entirely in the ground.
    fn buried(&self, side: Side, pose: Pose) -> Intrusion {
        let hull = &self.tips.hull;
        Intrusion {
            area: -0.5 * hull.swept(0.0, hull.length()),
            ..self.at(side, pose, [self.tips.middle(), self.roots.middle()])
        }
    }

    /// An intrusion with the data of its deepest points below both belts.
    fn at(&self, side: Side, pose: Pose, [deepest, below_roots]: [Vector; 2]) -> Intrusion {
        let hull = &self.tips.hull;
        let nearest = hull.nearest(deepest);
        let place = pose.transform_point(deepest);
        Intrusion {
            side,
            lane: self.lane,
            mount: self.mount,
            edges: Vec::new(),
            edge: -1,
            bodies: hull
                .neighbours(deepest, nearest, &self.discs)
                .map(|disc| self.parts[disc]),
            depth: nearest.depth + self.margin,
            root_depth: (self.roots.hull.depth(below_roots) + self.margin).max(0.0),
            x: place.x,
            y: place.y,
            area: 0.0,
            stretches: Vec::new(),
        }
    }
}

/// The stretch of a profile along a chord, as facet index plus fraction of the facet.
fn span(profile: &Profile, under: &[u32], chord: &Chord) -> (f64, f64) {
    let place = |(piece, fraction): (usize, f64)| {
        profile.place_along(under[piece] as usize..under[piece + 1] as usize, fraction)
    };
    (place(chord.span[0]), place(chord.span[1]))
}

/// Whether a point of the chassis frame lies in the ground.
fn below_ground(profile: &Profile, pose: Pose, point: Vector) -> bool {
    let point = pose.transform_point(point);
    profile.height_under_disc(point.x, 0.0) > point.y
}

impl Intrusion {
    /// Whether a contact is between the track and the ground of the intrusion, for a robot with these parts. The belly
    /// is not part of a track: ground under it jams nothing.
    pub(crate) fn bears(&self, lanes: &[Profile], parts: &[Part], contact: &Contact) -> bool {
        let part = &parts[contact.part];
        let of_track = part.kind != BodyKind::Belly && part.mount.carrier() == self.mount;
        if part.lane != self.lane || !of_track {
            return false;
        }
        let lane = &lanes[self.lane];
        let place = lane.place_on(contact.facet, contact.point);
        let here = lane.point_at(place);
        let is_near = |end: f64| (lane.point_at(end) - here).length() <= BEARS.value();
        self.stretches.iter().any(|(start, end)| {
            (*start..=*end).contains(&place) || is_near(*start) || is_near(*end)
        })
    }
}
