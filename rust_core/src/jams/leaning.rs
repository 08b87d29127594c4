//! All poses in which one or two contacts carry a robot: it leans against a wall, or balances on a corner.
//!
//! Two contacts leave one degree of freedom of the pose, and two forces for three balances. One more equation is that
//! the lines of both forces and of the weight meet in a point. Where the origin is on a circle, the product of both
//! branches has no square root: it is a polynomial in cosine and sine of the angle, of degree at most 10, over a power
//! of a distance.

use std::f64::consts::TAU;

use super::contact::{Contact, Kind, Locus, Posture, Turn, meeting, radical};
use super::fixed::{apart, line, on_circle, solve};
use super::forces::Push;
use super::setting::{Partner, Setting, is_same};
use super::zeros::{Difference, graded, zeros};
use crate::error::Error;
use crate::geometry::{Vector, left_of};
use crate::limits::Cancel;

/// Imbalance, in weights, of a pose that is found.
const FOUND: f64 = 1e-11;

impl Setting {
    /// Every pose in which one or two contacts carry the robot.
    pub(super) fn leaning(&self, cancel: &Cancel) -> Result<Vec<Posture>, Error> {
        let mut found = Vec::new();
        for i in 0..self.contacts.len() {
            for push in self.pushes(i) {
                self.on_one(push, &mut found);
            }
        }
        for i in 0..self.contacts.len() {
            cancel.check()?;
            for partner in &self.partners[i] {
                self.on_two(i, partner, &mut found);
            }
        }
        Ok(found)
    }

    fn keep(&self, contacts: &[usize], posture: Posture, found: &mut Vec<Posture>) {
        let is_real = |i: &usize| self.is_real(&self.contacts[*i], &posture);
        if posture.position.is_finite()
            && self.bins.hold(posture.angle)
            && contacts.iter().all(is_real)
            && !found.iter().any(|known| is_same(known, &posture))
        {
            found.push(posture);
        }
    }

    /// Adds the poses in which one force is vertical, and the centre of mass above it.
    fn on_one(&self, push: Push, found: &mut Vec<Posture>) {
        let contact = &self.contacts[push.contact];
        let center_of_mass = self.layout.center_of_mass;
        let up = Vector::new(-push.slope, 1.0).normalize();
        match contact.kind {
            // On a level face it is vertical only without friction, and then anywhere on the face.
            Kind::OnFace(..) => {}
            Kind::OnCorner(disc, center, radius) => {
                let arm = center_of_mass - disc.center;
                let size = arm.length() + disc.radius;
                let beside = |angle: f64| [Turn::by(angle).apply(arm).x + disc.radius * up.x, size];
                for angle in zeros(self.bins.ranges(u128::MAX), beside) {
                    let axle = center + up * (radius + disc.radius);
                    let position = axle - Turn::by(angle).apply(disc.center);
                    self.keep(&[push.contact], Posture { position, angle }, found);
                }
            }
            Kind::Across(outward, distance, center, radius) => {
                let angle = libm::atan2(-up.y, -up.x) - libm::atan2(outward.y, outward.x);
                let angle = within_half_a_turn(angle);
                let arm = Turn::by(angle).apply(center_of_mass);
                let point = center + up * radius;
                let x = point.x - arm.x;
                let y = center.y + (distance + radius - up.x * (x - center.x)) / up.y;
                let position = Vector::new(x, y);
                self.keep(&[push.contact], Posture { position, angle }, found);
            }
        }
    }

    /// Adds the poses in which two contacts touch and two of their forces carry the weight.
    fn on_two(&self, one: usize, partner: &Partner, found: &mut Vec<Posture>) {
        let pair = [one, partner.contact];
        let pushes: Vec<Push> = pair.iter().flat_map(|i| self.pushes(*i)).collect();
        let origin = self.contacts[pair[0]].anchor();
        for (k, one) in pushes.iter().enumerate() {
            for other in &pushes[k + 1..] {
                let both = Both {
                    setting: self,
                    pair: pair.map(|i| self.contacts[i].seen_from(origin)),
                    origin,
                    pushes: [*one, *other],
                };
                for near in both.candidates(partner.angles) {
                    if let Some(local) = both.polished(near) {
                        let position = local.position + origin;
                        self.keep(&pair, Posture { position, ..local }, found);
                    }
                }
            }
        }
    }
}

/// The same angle [rad] from -pi to pi.
fn within_half_a_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Two contacts, relative to a point of the ground, and one force of each.
struct Both<'a> {
    setting: &'a Setting,
    pair: [Contact; 2],
    origin: Vector,
    pushes: [Push; 2],
}

impl Both<'_> {
    /// A polynomial of the position, of degree at most 2, that is zero if the two forces and the weight meet in a point
    /// or are parallel.
    fn imbalance(&self, position: Vector, turn: Turn) -> f64 {
        let [value, _] = self.difference(position, turn);
        value
    }

    fn difference(&self, position: Vector, turn: Turn) -> Difference {
        let wrench = |push: Push| self.setting.wrench(push, position + self.origin, turn);
        let [a, b] = self.pushes.map(wrench);
        let (one, other) = (a[0] * b[2], b[0] * a[2]);
        [one - other, one.abs() + other.abs()]
    }

    /// Poses near all zeros of this function.
    fn candidates(&self, bins: u128) -> Vec<Posture> {
        let ranges = self.setting.bins.ranges(bins);
        let [one, other] = &self.pair;
        if one.is_parallel_to(other) {
            let between = |angle: f64| {
                let [one, other] = self.loci(Turn::by(angle)).map(line);
                apart(one, other)
            };
            let angles = zeros(ranges, between).into_iter();
            return angles.filter_map(|angle| self.along_line(angle)).collect();
        }
        let equation = |angle: f64| self.equation(Turn::by(angle));
        let angles = match self.closest() {
            Some((at, least)) => {
                let pieces = ranges.flat_map(|range| graded(range, at, least));
                let mut angles = zeros(pieces, equation);
                // Where both circles are one, the equation tells of two of their places only.
                angles.push(at);
                angles
            }
            None => zeros(ranges, equation),
        };
        let on = |angle: f64| {
            let positions = self.positions(Turn::by(angle));
            positions
                .into_iter()
                .map(move |position| Posture { position, angle })
        };
        angles.into_iter().flat_map(on).collect()
    }

    /// For two discs on two corners, the angle at which both circles almost coincide, and the range about it [rad] in
    /// which their intersections move fast.
    fn closest(&self) -> Option<(f64, f64)> {
        let [Kind::OnCorner(one, p, _), Kind::OnCorner(other, q, _)] =
            self.pair.map(|contact| contact.kind)
        else {
            return None;
        };
        let (discs, corners) = (other.center - one.center, q - p);
        if discs == Vector::ZERO || corners == Vector::ZERO {
            return None;
        }
        let angle = libm::atan2(corners.y, corners.x) - libm::atan2(discs.y, discs.x);
        let least = (corners.length() - discs.length()).abs() / discs.length();
        Some((within_half_a_turn(angle), least.max(1e-7)))
    }

    fn loci(&self, turn: Turn) -> [Locus; 2] {
        self.pair.map(|contact| contact.locus(turn))
    }

    /// The imbalance, multiplied by its denominator where two lines meet; for a circle, the product of both
    /// intersections.
    fn equation(&self, turn: Turn) -> Difference {
        let (line, circle) = match self.loci(turn) {
            [Locus::Line(n, k), Locus::Line(m, l)] => {
                let (point, scale) = meeting((n, k), (m, l));
                let at = |p: Vector| self.imbalance(p, turn);
                let [constant, size] = self.difference(Vector::ZERO, turn);
                let slope = Vector::new(at(Vector::X), at(Vector::Y)) - Vector::ONE * constant;
                let size = size * scale.abs() + point.length();
                return [constant * scale + slope.dot(point), size];
            }
            [Locus::Line(n, k), Locus::Circle(o, r)] | [Locus::Circle(o, r), Locus::Line(n, k)] => {
                ((n, k), (o, r))
            }
            [Locus::Circle(o, r), Locus::Circle(q, s)] => (radical((o, r), (q, s)), (o, r)),
        };
        let ((normal, offset), (center, radius)) = (line, circle);
        let square = normal.length_squared();
        let off = offset - normal.dot(center);
        // On the circle it is center + foot +- root along, where the root may be imaginary. A polynomial of degree 2 in
        // the root has an even and an odd part, known from three values.
        let foot = center + normal * (off / square);
        let along = left_of(normal) * (radius / square.sqrt());
        let root = 1.0 - off * off / (radius * radius * square);
        let [behind, here, ahead] =
            [-1.0, 0.0, 1.0].map(|s| self.difference(foot + along * s, turn));
        let size = behind[1].max(here[1]).max(ahead[1]);
        let [behind, here, ahead] = [behind[0], here[0], ahead[0]];
        let (slope, bend) = (0.5 * (ahead - behind), 0.5 * (ahead + behind) - here);
        let even = here + bend * root;
        [even * even - slope * slope * root, size * size]
    }

    /// The positions of the origin at an angle, up to two.
    fn positions(&self, turn: Turn) -> Vec<Vector> {
        match self.loci(turn) {
            [Locus::Line(n, k), Locus::Line(m, l)] => {
                let (point, scale) = meeting((n, k), (m, l));
                vec![point / scale]
            }
            [Locus::Line(n, k), Locus::Circle(o, r)] | [Locus::Circle(o, r), Locus::Line(n, k)] => {
                on_circle((n, k), (o, r)).to_vec()
            }
            [Locus::Circle(o, r), Locus::Circle(q, s)] if (o - q).length() > 1e-9 * r => {
                on_circle(radical((o, r), (q, s)), (o, r)).to_vec()
            }
            // The circles coincide: both forces are parallel, and so vertical.
            [Locus::Circle(o, r), _] => {
                let up = |push: Push| Vector::new(-push.slope, 1.0).normalize();
                self.pushes.map(|push| o + up(push) * r).to_vec()
            }
        }
    }

    /// The pose on two lines that coincide at an angle.
    fn along_line(&self, angle: f64) -> Option<Posture> {
        let turn = Turn::by(angle);
        let [Locus::Line(normal, offset), _] = self.loci(turn) else {
            return None;
        };
        let at = |s: f64| normal * offset + left_of(normal) * s;
        let (here, ahead) = (self.imbalance(at(0.0), turn), self.imbalance(at(1.0), turn));
        let position = at(here / (here - ahead));
        Some(Posture { position, angle })
    }

    /// The pose near another in which both contacts touch and both forces carry the weight.
    fn polished(&self, near: Posture) -> Option<Posture> {
        let reach = self.setting.layout.reach;
        let step = 1e-6;
        let errors = |posture: &Posture| {
            let gaps = self.pair.map(|contact| contact.touch(posture).gap / reach);
            let imbalance = self.imbalance(posture.position, Turn::by(posture.angle));
            [gaps[0], gaps[1], imbalance]
        };
        let moved = |posture: &Posture, by: [f64; 3]| Posture {
            position: posture.position + Vector::new(by[0], by[1]) * reach,
            angle: posture.angle + by[2],
        };
        let mut posture = near;
        for _ in 0..12 {
            let now = errors(&posture);
            if now.iter().all(|error| error.abs() < FOUND) {
                return Some(posture);
            }
            if now.iter().any(|error| error.is_nan() || error.abs() > 1e-2) {
                return None;
            }
            let mut rows = [[0.0; 3]; 3];
            for axis in 0..3 {
                let mut by = [0.0; 3];
                by[axis] = step;
                let ahead = errors(&moved(&posture, by));
                by[axis] = -step;
                let behind = errors(&moved(&posture, by));
                for (row, (a, b)) in rows.iter_mut().zip(ahead.iter().zip(behind)) {
                    row[axis] = (a - b) / (2.0 * step);
                }
            }
            posture = moved(&posture, solve(&rows, &now)?.map(|change| -change));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::Disc;
    use crate::jams::layout::{Grip, Layout, Outline, Surface};
    use crate::jams::places::{Facing, Place};
    use crate::jams::tests::{
        Pair, Standing, contact_of, on_two, place, posture, surface, touching,
    };
    use crate::robot::BodyKind;

    /// Two discs of one radius [m], each on a point of the ground.
    fn setting(discs: [Vector; 2], points: [Vector; 2]) -> Setting {
        let surface = |center| Surface {
            part: 0,
            kind: BodyKind::Wheel,
            lane: 0,
            shape: Outline::Round(Disc {
                center,
                radius: 0.05,
            }),
            grip: Grip::Free,
            friction_limit: f64::INFINITY,
        };
        let place = |center| Place {
            lane: 0,
            edge: None,
            shape: Facing::Corner {
                center,
                radius: 0.0,
                cone: [Vector::X, Vector::NEG_X],
            },
            friction: 0.5,
        };
        let layout = Layout {
            center_of_mass: Vector::ZERO,
            reach: 0.5,
            surfaces: discs.map(surface).to_vec(),
            solids: Vec::new(),
        };
        let (places, all) = (points.map(place).to_vec(), [-3.0, 3.0]);
        Setting::new(layout, places, all, &Cancel::default()).expect("there are few contacts")
    }

    /// Both of its contacts of one disc on the point of its number.
    fn both(setting: &Setting) -> Both<'_> {
        let of = |k: usize| {
            let is_it = |c: &&Contact| (c.surface, c.place) == (k, k);
            *setting.contacts.iter().find(is_it).expect("it can touch")
        };
        let index = |k: usize| {
            let is_it = |c: &Contact| (c.surface, c.place) == (k, k);
            let found = setting.contacts.iter().position(is_it);
            let mut pushes = setting.pushes(found.expect("it can touch"));
            pushes.next().expect("it has one")
        };
        Both {
            setting,
            pair: [of(0), of(1)],
            origin: Vector::ZERO,
            pushes: [index(0), index(1)],
        }
    }

    /// The first force of each of the contacts of two surfaces on two places.
    fn first_of(setting: &Setting) -> Both<'_> {
        let contacts = [0, 1].map(|k| contact_of(setting, k));
        Both {
            setting,
            pair: contacts.map(|i| setting.contacts[i]),
            origin: Vector::ZERO,
            pushes: contacts.map(|i| setting.pushes(i).next().expect("it has one")),
        }
    }

    #[test]
    fn where_two_forces_carry_the_weight_their_equation_is_zero_and_the_place_is_found() {
        let mut draw = Draw(81);
        let (mut tried, mut on_circles) = (0, 0);
        for case in 0..300 {
            let Some(Standing { at, setting, .. }) = on_two(&mut draw, case) else {
                continue;
            };
            tried += 1;
            let (both, turn) = (first_of(&setting), Turn::by(at.angle));
            // Forces of some weights, at arms of some metres.
            assert!(both.imbalance(at.position, turn).abs() < 1e-14, "{case}");
            let [value, size] = both.equation(turn);
            assert!(value.abs() < 1e-12 * size, "{case}: {value} {size}");
            let found = both.positions(turn);
            let is_at = |place: &Vector| (*place - at.position).length() < 1e-7;
            assert!(found.iter().any(is_at), "{case}: {found:?} {at:?}");
            // Beside it, it is no larger than terms of that size, and in proportion to the square of moments on a
            // circle.
            let beside = Turn::by(at.angle + 1e-3);
            let [value, size] = both.equation(beside);
            assert!(value.abs() < 4.0 * size, "{case}: {value} {size}");
            let has_circle = both
                .loci(turn)
                .iter()
                .any(|l| matches!(l, Locus::Circle(..)));
            if has_circle {
                on_circles += 1;
                let mut long = setting.clone();
                long.layout.reach *= 1e3;
                let [small, small_size] = first_of(&long).equation(beside);
                for (found, before) in [(small, value), (small_size, size)] {
                    assert!((found * 1e6 / before - 1.0).abs() < 1e-6, "{case}");
                }
            }
        }
        assert!(tried > 80 && on_circles > 20, "{tried} {on_circles}");
    }

    /// Along lines of one direction, the moment of one force over the other's is linear.
    #[test]
    fn a_place_on_a_line_has_no_imbalance() {
        let mut draw = Draw(82);
        for case in 0..50 {
            let at = posture(&mut draw);
            let normal = Vector::from_angle(draw.between(1.0, 2.1));
            let pieces = [normal, -normal].map(|n| touching(&mut draw, Pair::Across, &at, n));
            let surfaces = pieces
                .map(|piece| surface(piece.0, Grip::Driven(1.0)))
                .to_vec();
            let places = [0, 1].map(|k| place(pieces[k].1, [0.2, 0.9][k])).to_vec();
            let setting = crate::jams::tests::setting(surfaces, places, Vector::new(0.1, 0.05));
            let both = first_of(&setting);
            let found = both.along_line(at.angle).expect("both are on lines");
            let turn = Turn::by(found.angle);
            assert!((found.angle - at.angle).abs() < 1e-15);
            // A place some metres away, at which forces have moments of some weights.
            let off = both.imbalance(found.position, turn);
            assert!(
                off.abs() < 1e-12 * (1.0 + found.position.length_squared()),
                "{case}: {off}"
            );
            let Locus::Line(along, offset) = both.loci(turn)[0] else {
                panic!("it is one");
            };
            let gap = along.dot(found.position) - offset;
            assert!(
                gap.abs() < 1e-13 * (1.0 + found.position.length()),
                "{case}: {gap}"
            );
        }
    }

    #[test]
    fn an_angle_is_the_same_but_for_full_turns() {
        for (angle, turns) in [
            (0.3, 0.0),
            (3.1, 0.0),
            (3.2, 1.0),
            (-3.2, -1.0),
            (13.0, 2.0),
        ] {
            let found = within_half_a_turn(angle);
            assert!(
                (angle - turns * TAU - found).abs() < 1e-14,
                "{angle}: {found}"
            );
        }
    }

    /// Off that angle by as much as it says, they are some square root of 2 times as far from being one.
    #[test]
    fn two_circles_are_closest_where_discs_lie_as_the_points_do() {
        let discs = [Vector::new(0.1, 0.02), Vector::new(-0.2, -0.05)];
        let points = [Vector::new(0.3, 0.1), Vector::new(0.05, 0.3)];
        let setting = setting(discs, points);
        let both = both(&setting);
        let (at, least) = both.closest().expect("both are apart");
        let distance = |angle: f64| {
            let [Locus::Circle(one, _), Locus::Circle(other, _)] = both.loci(Turn::by(angle))
            else {
                panic!("of discs on points they are circles");
            };
            (one - other).length()
        };
        let nearest = distance(at);
        assert!(nearest < distance(at - 1e-3) && nearest < distance(at + 1e-3));
        assert!(at.abs() <= std::f64::consts::PI);
        for off in [-least, least] {
            let share = distance(at + off) / nearest;
            assert!(share > 1.35 && share < 1.5, "{share}");
        }
    }

    #[test]
    fn circles_of_one_centre_or_one_point_are_closest_nowhere() {
        let (one, other) = (Vector::new(0.1, 0.02), Vector::new(-0.2, -0.05));
        for (discs, points) in [([one; 2], [one, other]), ([one, other], [one; 2])] {
            let setting = setting(discs, points);
            assert_eq!(both(&setting).closest(), None);
        }
    }

    /// Without friction both forces go through the axles, and meet above the centre of mass by symmetry. What is off by more than a
    /// hundredth of the reach of 0.5 m is not near.
    #[test]
    fn a_pose_a_little_off_is_brought_to_where_two_forces_carry_the_weight() {
        let axles = [Vector::new(-0.2, 0.0), Vector::new(0.2, 0.0)];
        let normals = [Vector::new(0.6, 0.8), Vector::new(-0.6, 0.8)];
        let points = [0, 1].map(|k| axles[k] - normals[k] * 0.05);
        let setting = setting(axles, points);
        let both = both(&setting);
        for (x, y, angle, is_near) in [
            (0.0, 0.0, 0.0, true),
            (2e-4, -1e-4, 1e-3, true),
            (-1e-4, 2e-4, -2e-4, true),
            (0.0, 4e-3, 0.0, true),
            (0.0, 8e-3, 0.0, false),
        ] {
            let position = Vector::new(x, y);
            let found = both.polished(Posture { position, angle });
            assert_eq!(found.is_some(), is_near, "{x} {y} {angle}");
            if let Some(Posture { position, angle }) = found {
                assert!(
                    position.length() < 1e-9 && angle.abs() < 1e-9,
                    "{position} {angle}"
                );
            }
        }
    }
}
