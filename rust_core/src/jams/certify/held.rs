//! Shows that a robot can jam at every value of the parameters, in a pose on three contacts that moves with them.
//!
//! Krawczyk's operator (1969) shows that three gaps have a common zero in a box of poses for any values of the
//! parameters; then loads are bounded over that box.

use super::cell::{Cell, Shares, Turns};
use super::family::Family;
use super::interval::{Interval, MARGIN, Rectangle};
use super::tipping::Wrench;
use super::touch::{Possible, Touch};
use crate::error::Error;
use crate::geometry::{Vector, right_of};
use crate::jams::contact::Posture;
use crate::jams::fixed::solve;
use crate::jams::layout::Outline;
use crate::jams::places::Facing;
use crate::limits::Cancel;

/// Number of times that a box of poses is enlarged before it is given up.
const TRIES: usize = 8;

type Row = [Interval; 3];

/// A jam and its contacts: surfaces and places.
pub(super) type Stand = (Posture, [(usize, usize); 3]);

impl Family {
    /// Jams on three contacts at fractions of the parameters' ranges.
    pub(super) fn stands(&self, shares: &Shares, cancel: &Cancel) -> Result<Vec<Stand>, Error> {
        let setting = self.setting(shares, cancel)?;
        let of = |posture: Posture| {
            let contacts = setting.touching(&posture)?;
            setting.loads(&contacts, &posture)?;
            let three: [usize; 3] = contacts.try_into().ok()?;
            let on = |i: usize| (setting.contacts[i].surface, setting.contacts[i].place);
            Some((posture, three.map(on)))
        };
        Ok(setting.fixed(cancel)?.into_iter().filter_map(of).collect())
    }

    /// Whether one of the jams in the middle of a range exists at every value of the parameters.
    pub(super) fn is_held(&self, range: &Cell, stands: &[Stand]) -> bool {
        stands.iter().any(|(posture, three)| {
            let cell = self.enclosed(range, posture, three);
            cell.is_some_and(|cell| self.carries(&cell, three))
        })
    }

    /// A box of poses that, at every value of the parameters, contains one in which three surfaces touch.
    fn enclosed(&self, range: &Cell, near: &Posture, three: &[(usize, usize); 3]) -> Option<Cell> {
        let middle = [near.position.x, near.position.y, near.angle];
        let boxed = |half: [f64; 3]| {
            let mut cell = *range;
            for k in 0..3 {
                (cell.low[k], cell.high[k]) = (middle[k] - half[k], middle[k] + half[k]);
            }
            cell
        };
        let at_middle = boxed([0.0; 3]);
        let gaps = three.map(|contact| self.gap(&at_middle, contact).0);
        let rows = three.map(|contact| self.gap(&at_middle, contact).1);
        let points = rows.map(|row| row.map(Interval::middle));
        // Columns of the inverse.
        let unit = |k: usize| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let columns = [
            solve(&points, &unit(0))?,
            solve(&points, &unit(1))?,
            solve(&points, &unit(2))?,
        ];
        let inverse = |i: usize, k: usize| Interval::at(columns[k][i]);
        let mut half = [1e-9; 3];
        for _ in 0..TRIES {
            let cell = boxed(half);
            let rows = three.map(|contact| self.gap(&cell, contact).1);
            let image: [Interval; 3] = std::array::from_fn(|i| {
                let of_gap = |k: usize| inverse(i, k) * gaps[k];
                let of_half = |j: usize| {
                    let sum = inverse(i, 0) * rows[0][j]
                        + inverse(i, 1) * rows[1][j]
                        + inverse(i, 2) * rows[2][j];
                    let unit = Interval::at(if i == j { 1.0 } else { 0.0 });
                    (unit - sum) * Interval::around(0.0, half[j])
                };
                of_half(0) + of_half(1) + of_half(2) - of_gap(0) - of_gap(1) - of_gap(2)
            });
            let most = image.map(|value| value.low.abs().max(value.high.abs()) + MARGIN);
            if (0..3).all(|k| most[k] < half[k]) {
                return Some(boxed(most));
            }
            half = most.map(|value| 1.5 * value);
        }
        None
    }

    /// The gap \[m\] over a cell, near 0, and its derivatives with respect to the pose.
    pub(super) fn gap(&self, cell: &Cell, (surface, place): (usize, usize)) -> (Interval, Row) {
        let turns = Turns::of(cell);
        let (position, spot) = (cell.position(), &self.places[place]);
        let ground = spot.ends[0].over(cell);
        let row = |normal: Rectangle, arm: Rectangle| {
            let (x, y) = (normal.x(), normal.y());
            [x, y, arm.x() * y - arm.y() * x]
        };
        match (self.layout.surfaces[surface].shape, spot.place.shape) {
            (Outline::Round(disc), Facing::Face { normal, .. }) => {
                let arm = turns.apply(disc.center);
                let gap = (position + arm - ground).along(normal) - Interval::at(disc.radius);
                (gap, row(Rectangle::at(normal), arm))
            }
            (Outline::Round(disc), Facing::Corner { radius, .. }) => {
                // Half the difference of squares divided by the radius, which has the slope of the gap where this is 0.
                let (arm, circle) = (turns.apply(disc.center), radius + disc.radius);
                let spoke = position + arm - ground;
                let (x, y) = (spoke.x(), spoke.y());
                let over = Interval::at(0.5 / circle);
                let gap = over * (x * x + y * y - Interval::at(circle * circle));
                (gap, row(spoke.times(1.0 / circle), arm))
            }
            (Outline::Flat { ends, outward }, shape) => {
                let radius = match shape {
                    Facing::Corner { radius, .. } => radius,
                    Facing::Face { .. } => 0.0,
                };
                let normal = turns.apply(-outward);
                let arm = ground - position;
                let (x, y) = (normal.x(), normal.y());
                let along = -(arm.x() * x + arm.y() * y);
                let gap = along - Interval::at(outward.dot(ends[0]) + radius);
                (gap, row(normal, arm))
            }
        }
    }

    /// Whether three contacts carry the weight wherever they touch in a cell, and nothing else can touch there.
    fn carries(&self, cell: &Cell, three: &[(usize, usize); 3]) -> bool {
        let Possible::Touches(touches) = self.possible(cell) else {
            return false;
        };
        let is_of_three = |touch: &Touch| three.contains(&(touch.surface, touch.place));
        if touches.len() != 3
            || !touches
                .iter()
                .all(|t| is_of_three(t) && self.is_real(cell, t))
        {
            return false;
        }
        let [a, b, c] = [0, 1, 2].map(|i| Wrench::of(&touches[i]).parts);
        let weight = [0.0, 1.0, 0.0].map(Interval::at);
        let all = determinant(a, b, c);
        let loads = [
            determinant(weight, b, c),
            determinant(a, weight, c),
            determinant(a, b, weight),
        ];
        let same = |load: &Interval| (*load * all).is_above(0.0);
        loads.iter().all(same)
    }

    /// Whether the piece of the ground exists wherever it is touched in a cell.
    fn is_real(&self, cell: &Cell, touch: &Touch) -> bool {
        let spot = &self.places[touch.place];
        let turns = Turns::of(cell);
        match (self.layout.surfaces[touch.surface].shape, spot.place.shape) {
            (Outline::Round(disc), Facing::Face { normal, .. }) => {
                let axle = cell.position() + turns.apply(disc.center);
                let along = right_of(normal);
                let [from, to] = spot.ends.map(|end| end.over(cell));
                (axle - from).along(along).is_above(0.0) && (to - axle).along(along).is_above(0.0)
            }
            (Outline::Flat { ends, .. }, Facing::Corner { .. }) => {
                let (corner, off) = turns.seen(spot.ends[0].over(cell) - cell.position());
                let along = (ends[1] - ends[0]).normalize_or(Vector::X);
                let here = Interval::around((corner - ends[0]).dot(along), off);
                here.is_above(0.0)
                    && here.is_below((ends[1] - ends[0]).length())
                    && touch.normals.are_within_cone(spot.place.shape)
            }
            _ => touch.normals.are_within_cone(spot.place.shape),
        }
    }
}

fn determinant(a: Row, b: Row, c: Row) -> Interval {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jams::certify::family::Spot;
    use crate::jams::certify::tests::family_on_a_step;
    use crate::jams::certify::touch::Normals;
    use crate::jams::layout::Surface;

    /// The belly, nose up by 0.3 rad, on the rounded edge of the step, at any place along it; and the edge's place.
    fn on_the_edge(family: &Family, along: f64, half: f64) -> (Cell, (usize, usize)) {
        let is_below = |surface: &Surface| match surface.shape {
            Outline::Flat { outward, .. } => outward.y < -0.5,
            Outline::Round(_) => false,
        };
        let surfaces = &family.layout.surfaces;
        let surface = surfaces.iter().position(is_below).expect("it has a belly");
        let is_corner = |spot: &Spot| matches!(spot.place.shape, Facing::Corner { .. });
        let place = family
            .places
            .iter()
            .position(is_corner)
            .expect("a step has an edge");
        let Outline::Flat { ends, outward } = surfaces[surface].shape else {
            panic!("it is one");
        };
        let Facing::Corner { center, radius, .. } = family.places[place].place.shape else {
            panic!("it is one");
        };
        let here = ends[0] + (ends[1] - ends[0]).normalize() * along + outward * radius;
        let position = center - Vector::from_angle(0.3).rotate(here);
        let mut cell = Cell::ZERO;
        cell.low[..3].copy_from_slice(&[position.x - half, position.y - half, 0.3]);
        cell.high[..3].copy_from_slice(&[position.x + half, position.y + half, 0.3]);
        (cell, (surface, place))
    }

    /// With a sign for the order of its sides; a range of one of them is a range of the volume.
    #[test]
    fn a_determinant_is_the_volume_of_a_box() {
        let row = |x: f64, y: f64, z: f64| [x, y, z].map(Interval::at);
        let sides = [row(2.0, 0.0, 0.0), row(0.0, 3.0, 0.0), row(0.0, 0.0, 5.0)];
        for (order, volume) in [
            ([0, 1, 2], 30.0),
            ([1, 2, 0], 30.0),
            ([2, 0, 1], 30.0),
            ([1, 0, 2], -30.0),
            ([0, 2, 1], -30.0),
            ([2, 1, 0], -30.0),
        ] {
            let [a, b, c] = order.map(|side| sides[side]);
            assert_eq!(determinant(a, b, c), Interval::at(volume), "{order:?}");
        }
        // Sheared, it keeps its volume; a range of a side is one of it.
        let sheared = row(7.0, 3.0, -2.0);
        assert_eq!(determinant(sides[0], sheared, sides[2]), Interval::at(30.0));
        let long = [
            Interval::new(2.0, 4.0),
            Interval::at(0.0),
            Interval::at(0.0),
        ];
        let found = determinant(long, sides[1], sides[2]);
        assert_eq!(found, Interval::new(30.0, 60.0));
    }

    #[test]
    fn the_gap_between_a_run_and_an_edge_is_how_far_the_run_is_raised() {
        let family = family_on_a_step();
        let (touching, pair) = on_the_edge(&family, 0.1, 0.0);
        let up = Vector::from_angle(0.3).rotate(Vector::Y);
        for height in [-1e-3, 0.0, 2e-3] {
            let mut raised = touching;
            for (k, part) in [up.x, up.y].into_iter().enumerate() {
                raised.low[k] += height * part;
                raised.high[k] += height * part;
            }
            let (gap, row) = family.gap(&raised, pair);
            assert!((gap.middle() - height).abs() < 1e-12 && gap.half() < 1e-12);
            assert!((row[0].middle() - up.x).abs() < 1e-12);
            assert!((row[1].middle() - up.y).abs() < 1e-12);
        }
    }

    /// Its arc of 4 mm is inside if its centre is, in all of a cell. Wheels do not matter here.
    #[test]
    fn an_edge_whose_centre_is_inside_the_belly_overlaps_with_it() {
        let mut family = family_on_a_step();
        family.discs.clear();
        let (touching, _) = on_the_edge(&family, 0.15, 0.0);
        let down = -Vector::from_angle(0.3).rotate(Vector::Y);
        for (depth, half, is_inside) in [
            (3.9e-3, 0.0, false),
            (4.1e-3, 0.0, true),
            (6e-3, 1e-3, true),
            (6e-3, 3e-3, false),
            (-1e-3, 0.0, false),
        ] {
            let mut cell = touching;
            for (k, part) in [down.x, down.y].into_iter().enumerate() {
                cell.low[k] += depth * part - half;
                cell.high[k] += depth * part + half;
            }
            let found = matches!(family.possible(&cell), Possible::Overlap);
            assert_eq!(found, is_inside, "{depth} m, {half} m");
        }
    }

    /// The belly is 0.365 m long. Whether wheels are in the way does not matter here.
    #[test]
    fn a_run_is_on_an_edge_if_it_is_there_between_its_ends_all_over_a_cell() {
        let family = family_on_a_step();
        let (_, (surface, place)) = on_the_edge(&family, 0.1, 0.0);
        let touch = Touch {
            surface,
            place,
            normals: Normals {
                bisector: Vector::from_angle(0.3).rotate(Vector::Y),
                sines: [0.0; 2],
                circle: None,
                is_on_face: false,
            },
            slopes: [0.0; 2],
            arm: Rectangle::at(Vector::ZERO),
            radius: 0.0,
            slides: false,
        };
        for (along, half, is_there) in [
            (1e-3, 0.0, true),
            (0.2, 0.0, true),
            (0.364, 0.0, true),
            (-1e-3, 0.0, false),
            (0.366, 0.0, false),
            (0.36, 1e-3, true),
            (0.36, 0.01, false),
            (0.005, 0.01, false),
        ] {
            let (cell, _) = on_the_edge(&family, along, half);
            assert_eq!(family.is_real(&cell, &touch), is_there, "{along} {half}");
        }
    }
}
