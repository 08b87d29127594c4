//! Roofs and chords: lines above finely divided ground. If two corners bear on the same straight run of a part, a
//! corner between them that is no higher than the line through both does not bear.
//!
//! The equations: docs/physics.md, "Contacts".

use super::{Corner, Touch};
use crate::geometry::{Vector, left_of};
use crate::units::Metres;

/// [m] Ground that rises above a chord by less than this is left to the ends of the chord: it is a thousandth of the
/// largest overlap that should ever occur.
pub(super) const SAME_FACE: Metres = Metres(1e-6);

/// The ends of a line above all corners of a stretch of ground, roughly parallel to the stretch.
pub(super) type Roof = [Vector; 2];

/// The roof of a few neighbouring corners.
pub(super) fn roof(corners: &[Corner]) -> Roof {
    let (first, last) = (corners[0].center, corners[corners.len() - 1].center);
    let (line, steepest) = (last - first, 10.0);
    let slope = if line.y.abs() < steepest * line.x {
        line.y / line.x
    } else {
        0.0
    };
    let above = |c: &Corner| {
        let rise = c.radius * (1.0 + slope * slope).sqrt();
        c.center.y + rise - slope * (c.center.x - first.x)
    };
    let most = corners.iter().map(above).fold(f64::NEG_INFINITY, f64::max);
    let reach = corners.iter().map(|c| c.radius).fold(0.0, f64::max);
    [first.x - reach, last.x + reach].map(|x| Vector::new(x, most + slope * (x - first.x)))
}

/// The line through two corners that bear on the same straight run.
pub(super) struct Chord {
    ends: [Vector; 2],
    up: Vector,
}

impl Chord {
    /// Whether two touches are on the same run, the first on the left.
    pub(super) fn joins(first: &Touch, last: &Touch) -> bool {
        first.normal.dot(last.normal) > 1.0 - 1e-12 && first.place.x < last.place.x
    }

    /// The chord from left to right, if both touches are on the same run.
    pub(super) fn new(first: &Touch, last: &Touch) -> Option<Self> {
        let [a, b] = [first.place, last.place];
        Self::joins(first, last).then(|| Self {
            ends: [a, b],
            up: left_of((b - a).normalize()),
        })
    }

    /// Whether a point lies between the ends of the chord and no higher than it.
    fn hides(&self, point: Vector) -> bool {
        let [a, b] = self.ends;
        a.x <= point.x && point.x <= b.x && (point - a).dot(self.up) < SAME_FACE.value()
    }

    /// [m] Height of a corner above the line.
    pub(super) fn rise(&self, corner: &Corner) -> f64 {
        (corner.center - self.ends[0]).dot(self.up) + corner.radius
    }

    /// [m] An upper bound for the rise of corners below a roof.
    pub(super) fn rise_of(&self, roof: &Roof) -> f64 {
        let rises = roof.map(|end| (end - self.ends[0]).dot(self.up));
        rises[0].max(rises[1])
    }

    /// Whether a corner lies between the ends of the chord and no higher than it.
    pub(super) fn hides_corner(&self, corner: &Corner) -> bool {
        self.hides(corner.center + self.up * corner.radius)
    }

    /// Whether everything below a roof is hidden like this.
    pub(super) fn hides_all(&self, roof: &Roof) -> bool {
        roof.iter().all(|end| self.hides(*end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::lane::Lane;
    use crate::scenario::Surface;
    use crate::terrain::Profile;

    #[test]
    fn nothing_between_its_ends_rises_above_a_roof() {
        let points = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.4],
            [1.1, 0.4],
            [1.1, 0.1],
            [1.6, 0.3],
            [1.7, 0.31],
            [1.7, 0.9],
            [3.0, 0.2],
        ];
        for edge_radius in [0.0, 0.02] {
            let profile = Profile::new("ground", &points, Surface::rounded(edge_radius, 0.9), true)
                .expect("valid");
            let lane = Lane::new(&profile);
            let count = lane.corners.len();
            for (first, last) in (0..count).flat_map(|i| (i..count).map(move |j| (i, j))) {
                let corners = &lane.corners[first..=last];
                let [a, b] = roof(corners);
                for c in corners {
                    let top = c.center + Vector::Y * c.radius;
                    let share = ((top.x - a.x) / (b.x - a.x).max(1e-12)).clamp(0.0, 1.0);
                    assert!(
                        top.y <= a.y + (b.y - a.y) * share + 1e-12,
                        "{first} to {last}"
                    );
                    assert!(a.x <= c.center.x - c.radius && c.center.x + c.radius <= b.x);
                }
            }
        }
    }

    /// A touch of level ground there [m].
    fn at(x: f64, y: f64) -> Touch {
        Touch {
            place: Vector::new(x, y),
            normal: Vector::Y,
            distance: 0.0,
            facet: 0,
            edge: 0,
            on: crate::contact::lane::On::Corner(0),
        }
    }

    #[test]
    fn a_chord_hides_what_lies_between_its_ends_and_no_higher() {
        let chord = Chord::new(&at(0.0, 0.0), &at(2.0, 0.2)).expect("they bear on one run");
        assert!(chord.hides(Vector::new(1.0, 0.1 + 0.5e-6)));
        assert!(!chord.hides(Vector::new(1.0, 0.1 + 2e-6)));
        assert!(!chord.hides(Vector::new(2.1, 0.0)));
        // The same at another place.
        let chord = Chord::new(&at(3.0, 1.0), &at(5.0, 1.2)).expect("they bear on one run");
        assert!(chord.hides(Vector::new(4.0, 1.1 + 0.5e-6)));
        assert!(!chord.hides(Vector::new(4.0, 1.1 + 2e-6)));
        let tilted = Touch {
            normal: Vector::new(0.1, 0.995),
            ..at(2.0, 0.2)
        };
        assert!(Chord::new(&at(0.0, 0.0), &tilted).is_none());
    }

    #[test]
    fn a_roof_is_parallel_to_its_stretch_and_touches_the_corner_that_rises_highest() {
        let points = [
            [1.0, 2.0],
            [2.0, 2.5],
            [3.0, 2.4],
            [4.0, 3.2],
            [5.0, 3.6],
            [6.0, 3.0],
            [7.0, 4.4],
        ];
        let profile =
            Profile::new("ground", &points, Surface::sharp(0.9), true).expect("it is ground");
        let [a, b] = roof(&Lane::new(&profile).corners);
        // From end to end it rises by 0.4; the second point is 0.1 m above that line.
        let off = [a - Vector::new(1.0, 2.1), b - Vector::new(7.0, 4.5)].map(Vector::length);
        assert!(off[0] < 1e-12 && off[1] < 1e-12, "{a} {b}");
    }

    #[test]
    fn a_chord_hides_a_round_corner_if_all_of_its_arc_lies_below() {
        let chord = Chord::new(&at(0.0, 0.0), &at(2.0, 0.2)).expect("they bear on one run");
        let down = Vector::new(0.1, -1.0).normalize();
        for (below, is_hidden) in [(0.021, true), (0.019, false), (0.5, true)] {
            let corner = Corner {
                center: Vector::new(1.0, 0.1) + down * below,
                radius: 0.02,
                normals: [Vector::NEG_X, Vector::X],
                is_convex: true,
                edge: 0,
                facet: 0,
                facets: 0,
            };
            assert_eq!(chord.hides_corner(&corner), is_hidden, "{below} m below");
        }
    }
}
