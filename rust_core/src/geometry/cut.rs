//! The part of a solid below a polyline that lies inside an envelope: its connected pieces, area and depth.

use super::Envelope;
use super::search::maximise;
use super::{Vector, cross};
use crate::units::Metres;

/// [m] Shorter chords only touch the envelope.
const TOUCHES: Metres = Metres(1e-9);

/// A stretch of the polyline inside the envelope, from left to right; the solid lies on its right.
pub(crate) struct Chord {
    /// [m] Its corners; the first and the last lie on the envelope or end the polyline.
    pub points: Vec<Vector>,
    /// Indices of the polyline's points strictly inside.
    pub vertices: std::ops::Range<usize>,
    /// Where it begins and ends on the polyline: index of the segment and a fraction of it.
    pub span: [(usize, f64); 2],
    /// [m] Positions along the envelope at which it enters and leaves.
    enters: f64,
    leaves: f64,
}

/// A connected piece: the chords that bound it, in the order in which the envelope joins them.
pub(crate) struct Piece<'a>(Vec<&'a Chord>);

/// The stretches of a polyline inside the envelope.
pub(crate) fn chords(belt: &Envelope, polyline: &[Vector]) -> Vec<Chord> {
    let mut chords: Vec<Chord> = Vec::new();
    // The last chord continues, because it reached the end of the previous segment.
    let mut open = false;
    let depths: Vec<f64> = polyline.iter().map(|p| belt.depth(*p)).collect();
    for (i, ends) in polyline.windows(2).enumerate() {
        let Some((from, to)) = belt.clip([ends[0], ends[1]], [depths[i], depths[i + 1]]) else {
            open = false;
            continue;
        };
        let at = |fraction: f64| ends[0] + (ends[1] - ends[0]) * fraction;
        let (begin, end) = (at(from), at(to));
        match chords.last_mut() {
            Some(chord) if open && from <= 0.0 => {
                chord.vertices.end = i + 1;
                chord.points.push(end);
                chord.span[1] = (i, to);
            }
            _ => chords.push(Chord {
                points: vec![begin, end],
                vertices: i + 1..i + 1,
                span: [(i, from), (i, to)],
                enters: 0.0,
                leaves: 0.0,
            }),
        }
        open = to >= 1.0;
    }
    chords.retain(|c| {
        let length: f64 = c.points.windows(2).map(|p| (p[1] - p[0]).length()).sum();
        length > TOUCHES.value()
    });
    for chord in &mut chords {
        let ends = [chord.points[0], chord.points[chord.points.len() - 1]];
        [chord.enters, chord.leaves] = ends.map(|end| belt.position_of(end));
    }
    chords
}

/// Joins the chords that bound the same piece.
pub(crate) fn pieces<'a>(belt: &Envelope, chords: &'a [Chord]) -> Vec<Piece<'a>> {
    // Where a chord leaves the envelope, the rim of the solid follows that clockwise to the next chord that enters.
    let next = |chord: &Chord| {
        let travel = |other: &Chord| travel_between(belt, chord.leaves, other.enters);
        let order = |i: &usize, j: &usize| travel(&chords[*i]).total_cmp(&travel(&chords[*j]));
        (0..chords.len()).min_by(order).unwrap_or_default()
    };
    let mut taken = vec![false; chords.len()];
    let mut pieces = Vec::new();
    for start in 0..chords.len() {
        let (mut i, mut bounds) = (start, Vec::new());
        while !taken[i] {
            taken[i] = true;
            bounds.push(&chords[i]);
            i = next(&chords[i]);
        }
        if !bounds.is_empty() {
            pieces.push(Piece(bounds));
        }
    }
    pieces
}

/// [m] Distance along the envelope from one position to another.
fn travel_between(belt: &Envelope, from: f64, to: f64) -> f64 {
    let travel = (to - from).rem_euclid(belt.length());
    // Positions that are in the wrong order because of rounding are the same.
    if travel > belt.length() - TOUCHES.value() {
        0.0
    } else {
        travel
    }
}

impl Piece<'_> {
    /// The chords that bound the piece.
    pub(crate) fn chords(&self) -> impl Iterator<Item = &Chord> {
        self.0.iter().copied()
    }

    /// Stretches of the envelope that bound the piece, as pairs of positions [m].
    pub(crate) fn rim(&self) -> impl Iterator<Item = (f64, f64)> {
        let following = self.0.iter().cycle().skip(1);
        self.0
            .iter()
            .zip(following)
            .map(|(c, d)| (c.leaves, d.enters))
    }

    /// Whether the rim includes the point of the envelope at a position [m].
    pub(crate) fn reaches(&self, belt: &Envelope, position: f64) -> bool {
        let passes =
            |(from, to)| travel_between(belt, from, position) <= travel_between(belt, from, to);
        self.rim().any(passes)
    }

    /// [m^2] Its area.
    pub(crate) fn area(&self, belt: &Envelope) -> f64 {
        let along_chords: f64 = self
            .chords()
            .flat_map(|c| c.points.windows(2))
            .map(|p| cross(p[0], p[1]))
            .sum();
        let along_rim: f64 = self
            .rim()
            .map(|(from, to)| belt.swept(from, from + travel_between(belt, from, to)))
            .sum();
        -0.5 * (along_chords + along_rim)
    }

    /// The point of its chords that lies deepest below an envelope.
    pub(crate) fn deepest_on_chords(&self, belt: &Envelope) -> Vector {
        let points = self.chords().flat_map(|c| &c.points);
        let of_points: Vec<_> = points.map(|p| (belt.depth(*p), *p)).collect();
        let start = (f64::NEG_INFINITY, Vector::ZERO);
        let mut deepest = of_points.iter().copied().fold(start, deeper);
        let mut rest = &of_points[..];
        for chord in self.chords() {
            let (of_chord, others) = rest.split_at(chord.points.len());
            rest = others;
            for ends in of_chord.windows(2) {
                let [(of_a, a), (of_b, b)] = [ends[0], ends[1]];
                let at = |fraction: f64| a + (b - a) * fraction;
                // Depth changes by no more than the distance moved, so most segments cannot contain the deepest
                // point. On others, the depth may be that below a single straight run.
                let most = 0.5 * (of_a + of_b + (b - a).length());
                if most > deepest.0 && belt.depth_below_runs([a, b]) > deepest.0 {
                    // The depth below a convex rim is concave along a line.
                    let point = at(maximise(0.0, 1.0, |t| belt.depth(at(t))));
                    deepest = deeper(deepest, (belt.depth(point), point));
                }
            }
        }
        deepest.1
    }
}

/// The deeper of two; the first if equal.
fn deeper(a: (f64, Vector), b: (f64, Vector)) -> (f64, Vector) {
    if b.0 > a.0 { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Disc;

    #[test]
    fn the_way_between_two_places_of_a_belt_is_that_ahead_round_it() {
        let discs = [-0.3, 0.3].map(|x| Disc {
            center: Vector::new(x, 0.0),
            radius: 0.1,
        });
        let belt = Envelope::new(&discs);
        let whole = belt.length();
        for (from, to, expected) in [
            (0.1, 0.3, 0.2),
            (0.3, 0.1, whole - 0.2),
            (0.2, 0.2, 0.0),
            (0.2, 0.2 - 1e-15, 0.0),
            (whole - 0.05, 0.05, 0.1),
        ] {
            let found = travel_between(&belt, from, to);
            assert!((found - expected).abs() < 1e-12, "{from} {to}: {found} m");
        }
    }
}
