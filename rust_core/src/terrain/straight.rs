//! Where the ground bends: finely divided ground counts as straight if it is straight within a fraction of a
//! micrometre.
//!
//! Leaving out points changes contacts by less than the penetration of a robot at rest.

use crate::geometry::{Vector, cross, is_between, left_of};
use crate::units::Metres;

/// [m] Points closer than this to the line through their neighbours do not make an edge.
pub(super) const COLLINEAR: Metres = Metres(1e-9);
/// [m] Ground within this of a straight line is straight: less than the 0.3 um of penetration of a robot at rest.
pub(crate) const STRAIGHT: Metres = Metres(0.25e-6);
/// [m] Ground in pieces shorter than this is finely divided; ground described by hand has larger pieces.
pub(crate) const FINE: Metres = Metres(1e-3);

/// The points at which a polyline bends, including both ends; `is_arc` says which belong to a rounded edge.
pub(super) fn bends(points: &[Vector], is_arc: impl Fn(usize) -> bool) -> Vec<u32> {
    let last = points.len() - 1;
    // An arc continues in the direction of the piece beside it.
    let is_fine = |i: usize| {
        (points[i + 1] - points[i]).length() < FINE.value() && !is_arc(i) && !is_arc(i + 1)
    };
    let mut bends = vec![0];
    let (mut begin, mut lines) = (points[0], Lines::default());
    for i in 1..last {
        lines.pass(points[i] - begin);
        let is_passed = is_fine(i - 1) && is_fine(i) && lines.reach(points[i + 1] - begin);
        if !is_passed {
            bends.push(i as u32);
            (begin, lines) = (points[i], Lines::default());
        }
    }
    bends.push(last as u32);
    bends
}

/// The range of directions of lines from one point that pass close enough to all points so far.
#[derive(Default)]
struct Lines(Option<[Vector; 2]>);

impl Lines {
    /// Keeps only the lines that pass close to a point.
    fn pass(&mut self, point: Vector) {
        let far = point.length();
        if far <= STRAIGHT.value() {
            return;
        }
        let sine = STRAIGHT.value() / far;
        let (along, across) = (point * (1.0 - sine * sine).sqrt(), left_of(point) * sine);
        let [mut right, mut left] = [along - across, along + across];
        if let Some([known_right, known_left]) = self.0 {
            if cross(right, known_right) > 0.0 {
                right = known_right;
            }
            if cross(known_left, left) > 0.0 {
                left = known_left;
            }
        }
        self.0 = Some([right, left]);
    }

    /// Whether one of the lines passes through a point.
    fn reach(&self, point: Vector) -> bool {
        self.0.is_none_or(|lines| is_between(point, lines, 0.0))
    }
}

/// Removes every point on the line through the last one kept and the next.
pub(super) fn without_collinear(points: &[Vector]) -> Vec<Vector> {
    let mut kept = vec![points[0]];
    for pair in points[1..].windows(2) {
        let (last, here, next) = (kept[kept.len() - 1], pair[0], pair[1]);
        let (back, chord) = (here - last, next - last);
        let off = (back.x * chord.y - back.y * chord.x).abs() / chord.length();
        let between = back.dot(chord) >= 0.0 && back.dot(chord) <= chord.length_squared();
        if off > COLLINEAR.value() || !between {
            kept.push(here);
        }
    }
    kept.push(points[points.len() - 1]);
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::print_stdout)] // prints how many points were joined

    use super::*;
    use crate::draw::Draw;

    #[test]
    fn what_comes_back_along_its_line_is_a_corner() {
        let line = |places: &[f64]| -> Vec<Vector> {
            places
                .iter()
                .map(|x| Vector::new(1.0 + x, 2.0 + 0.5 * x))
                .collect()
        };
        for (places, left) in [
            (&[0.0, 1.0, 2.0, 3.0][..], &[0.0, 3.0][..]),
            (&[0.0, 3.0, 2.0], &[0.0, 3.0, 2.0]),
            (&[0.0, -1.0, 2.0], &[0.0, -1.0, 2.0]),
            (&[0.0, 1.0, 3.0, 2.0, 2.5], &[0.0, 3.0, 2.0, 2.5]),
        ] {
            assert_eq!(without_collinear(&line(places)), line(left));
        }
    }

    /// A metre of ground in pieces of this length [m], whose ends are off a straight line by up to `jitter` [m].
    fn rough(length: f64, jitter: f64, draw: &mut Draw) -> Vec<Vector> {
        let (slope, curvature) = (draw.between(-1.0, 1.0), draw.between(-5.0, 5.0));
        let line = |x: f64| slope * x + 0.5 * curvature * x * x;
        let xs = (0..=(1.0 / length) as usize).map(|i| i as f64 * length);
        xs.map(|x| Vector::new(x, line(x) + draw.between(-jitter, jitter)))
            .collect()
    }

    #[test]
    fn no_point_of_joined_ground_is_off_it_by_more_than_a_quarter_of_a_micrometre() {
        const SEED: u64 = 20_261_122;
        let mut draw = Draw(SEED);
        let (mut given, mut left) = (0, 0);
        for _ in 0..100 {
            let (length, jitter) = (draw.size(2e-5, 9e-4), draw.size(1e-9, 1e-5));
            let points = rough(length, jitter, &mut draw);
            let bends = bends(&points, |_| false);
            for ends in bends.windows(2) {
                let [a, b] = [ends[0], ends[1]].map(|i| points[i as usize]);
                for point in &points[ends[0] as usize..ends[1] as usize] {
                    let fraction = (*point - a).dot(b - a) / (b - a).length_squared();
                    let off = (*point - a - (b - a) * fraction).length();
                    assert!(
                        (0.0..1.0).contains(&fraction) && off < STRAIGHT.value() * (1.0 + 1e-6)
                    );
                }
            }
            (given, left) = (given + points.len(), left + bends.len());
        }
        println!("seed {SEED}: {left} points of {given} left");
        assert!(left < given / 2);
    }

    #[test]
    fn flat_ground_of_heights_within_a_tenth_of_a_micrometre_is_one_piece() {
        let mut draw = Draw(1);
        for length in [1e-5, 1e-4, 9e-4] {
            let mut points = rough(length, 0.0, &mut draw);
            for point in &mut points {
                point.y = draw.between(-1e-7, 1e-7);
            }
            assert_eq!(bends(&points, |_| false).len(), 2);
        }
    }

    #[test]
    fn ground_in_pieces_of_a_millimetre_stays_as_it_is() {
        let mut draw = Draw(2);
        for _ in 0..100 {
            let (length, jitter) = (draw.size(1.001e-3, 1e-2), draw.size(1e-9, 1e-4));
            let points = rough(length, jitter, &mut draw);
            assert_eq!(bends(&points, |_| false).len(), points.len());
        }
    }

    #[test]
    fn ground_beside_an_arc_stays_as_it_is() {
        let points: Vec<Vector> = (0..100)
            .map(|i| Vector::new(5e-4 * f64::from(i), 0.0))
            .collect();
        let bends = bends(&points, |i| (40..50).contains(&i));
        let kept: Vec<u32> = [0].into_iter().chain(39..=50).chain([99]).collect();
        assert_eq!(bends, kept);
    }
}
