//! Depth of the ground inside a track: if there is none, a belt can stand there like the wheels that it runs round.

use super::cell::{Cell, Turns};
use super::family::{Family, Spot, Track};
use super::interval::{Interval, Rectangle};
use crate::geometry::search::maximise;
use crate::geometry::{Disc, Vector, right_of};
use crate::jams::contact::{Posture, Turn};
use crate::jams::places::{Facing, Place};

impl Family {
    /// Whether no ground is deeper inside a track than a limit, anywhere in a cell.
    pub(super) fn is_as_on_belt(&self, cell: &Cell, depth: f64) -> bool {
        let turns = Turns::of(cell);
        self.places.iter().all(|spot| {
            self.tracks
                .iter()
                .all(|track| spot.is_outside(track, cell, &turns, self.reach, depth))
        })
    }

    /// \[m\] Depth of the ground inside a track in a pose.
    pub(super) fn depth(&self, places: &[Place], posture: &Posture) -> f64 {
        let back = Turn::by(-posture.angle);
        let of_place = |place: &Place| {
            let (ends, radius) = match place.shape {
                Facing::Face { ends, .. } => (ends, 0.0),
                Facing::Corner { center, radius, .. } => ([center; 2], radius),
            };
            // In the robot's frame, and no farther away than it reaches.
            let [from, to] = ends.map(|end| back.apply(end - posture.position));
            let along = (to - from).normalize_or(Vector::ZERO);
            let length = (to - from).length();
            let near = -from.dot(along);
            let reached = [near - self.reach, near + self.reach].map(|s| s.clamp(0.0, length));
            let of = |track: &Track| {
                let depth = |s: f64| track.belt.depth(from + along * s);
                depth(maximise(reached[0], reached[1], depth)) + radius
            };
            self.tracks.iter().map(of).fold(0.0, f64::max)
        };
        places.iter().map(of_place).fold(0.0, f64::max)
    }
}

impl Spot {
    /// Whether it is nowhere deeper inside a track than a limit in any pose without overlap: off all wheels along its
    /// normal, or beyond a straight run or a disc. The robot reaches no farther than `reach` [m] from its position.
    fn is_outside(
        &self,
        track: &Track,
        cell: &Cell,
        turns: &Turns,
        reach: f64,
        depth: f64,
    ) -> bool {
        let [from, to] = self.ends.map(|end| end.over(cell) - cell.position());
        match self.place.shape {
            Facing::Corner { radius, .. } => {
                let (corner, off) = turns.seen(from);
                track.belt.depth(corner) + radius + off < depth
            }
            Facing::Face { normal, .. } => {
                let (height, along) = (from.along(normal), right_of(normal));
                // A disc over the face is off it, or overlaps with the ground: if above, because its nearest point on
                // the line is on the face, and if below, because it is under the surface.
                let is_off = |disc: &Disc| {
                    let axle = turns.apply(disc.center);
                    let gap = axle.along(normal) - height - Interval::at(disc.radius);
                    let is_between = |direction: Vector| {
                        (axle - from).along(direction).is_above(0.0)
                            && (to - axle).along(direction).is_above(0.0)
                    };
                    let is_over = is_between(along) && is_between(Vector::X);
                    is_over || gap.is_above(-depth)
                };
                if track.discs.iter().all(is_off) {
                    return true;
                }
                let first = from.along(along).low.max(-reach);
                let last = to.along(along).high.min(reach);
                if first >= last {
                    return true;
                }
                let ends = [first, last].map(|s| {
                    turns.seen(Rectangle {
                        middle: along * s + normal * height.middle(),
                        half: normal.abs() * height.half(),
                    })
                });
                let off = ends[0].1.max(ends[1].1);
                let ends = ends.map(|(end, _)| end);
                track.belt.depth_below_runs(ends) + off < depth
                    || track.depth_beyond_a_disc(ends) + off < depth
            }
        }
    }
}

impl Track {
    /// \[m\] An upper bound for the depth of points of a segment: the depth of its deeper end along the line from the
    /// centre of the nearest disc.
    fn depth_beyond_a_disc(&self, [from, to]: [Vector; 2]) -> f64 {
        let along = to - from;
        let nearest = |disc: &Disc| {
            let share = (disc.center - from).dot(along) / along.length_squared();
            from + along * share.clamp(0.0, 1.0) - disc.center
        };
        let gap = |disc: &&Disc| nearest(disc).length() - disc.radius;
        let disc = self.discs.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let outward = disc.and_then(|disc| nearest(disc).try_normalize());
        let Some(outward) = outward else {
            return f64::INFINITY;
        };
        let reach = |disc: &Disc| outward.dot(disc.center) + disc.radius;
        let farthest = self
            .discs
            .iter()
            .map(reach)
            .fold(f64::NEG_INFINITY, f64::max);
        farthest - outward.dot(from).min(outward.dot(to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::Envelope;

    /// Two wheels of 0.1 m, 0.6 m apart, with their middle there.
    fn wheels(middle: Vector) -> Track {
        let discs = [-0.3, 0.3].map(|x| Disc {
            center: middle + Vector::new(x, 0.0),
            radius: 0.1,
        });
        let belt = Envelope::new(&discs);
        Track {
            discs: discs.into(),
            belt,
        }
    }

    #[test]
    fn no_point_of_a_segment_is_deeper_than_its_deeper_end_beyond_the_nearest_disc() {
        let (track, mut draw) = (wheels(Vector::ZERO), Draw(20_270_602));
        let mut inside = 0;
        for _ in 0..500 {
            let [a, b] =
                [0.0; 2].map(|_| Vector::new(draw.between(-0.5, 0.5), draw.between(-0.2, 0.2)));
            let place = |k: u32| a + (b - a) * (f64::from(k) / 100.0);
            let depths = (0..=100).map(|k| track.belt.depth(place(k)));
            let deepest = depths.fold(f64::NEG_INFINITY, f64::max);
            assert!(
                track.depth_beyond_a_disc([a, b]) > deepest - 1e-12,
                "{a} {b}"
            );
            inside += u32::from(deepest > 0.0);
        }
        assert!(inside > 100, "{inside}");
        // A segment perpendicular to the line from a wheel's centre is equally deep everywhere; one that ends beside
        // the line is as deep as its nearer end.
        for side in [-1.0, 1.0] {
            for (a, b, depth) in [
                ([0.35, -0.05], [0.35, 0.05], 0.05),
                ([0.45, -0.05], [0.45, 0.05], -0.05),
                // Its nearest point is 0.06 m ahead of the wheel and 0.08 m above it.
                ([0.36 - 0.04, 0.08 + 0.03], [0.36 + 0.04, 0.08 - 0.03], 0.0),
                // It continues away from the wheel, along a line from its centre.
                ([0.35, 0.0], [0.45, 0.0], 0.05),
            ] {
                for middle in [Vector::ZERO, Vector::new(0.2, -0.7)] {
                    let track = wheels(middle);
                    let ends = [a, b].map(|[x, y]| middle + Vector::new(side * x, y));
                    let found = track.depth_beyond_a_disc(ends);
                    assert!((found - depth).abs() < 1e-12, "{ends:?}: {found} m");
                    let [b, a] = ends;
                    assert!((track.depth_beyond_a_disc([a, b]) - depth).abs() < 1e-12);
                }
            }
        }
    }
}
