//! Possible contacts in a cell, and their forces.

use std::f64::consts::FRAC_PI_2;

use super::cell::{Cell, Turns};
use super::family::{Family, Spot};
use super::interval::{Interval, MARGIN, Rectangle};
use crate::geometry::{Disc, Envelope, Vector, left_of, right_of};
use crate::jams::layout::{Grip, Outline};
use crate::jams::places::Facing;

/// A contact that is possible somewhere in a cell, and all forces that it can exert there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub surface: usize,
    pub place: usize,
    pub normals: Normals,
    /// Friction over normal force.
    pub slopes: [f64; 2],
    /// [m] From the centre of mass to the axle, or to the corner under a straight run.
    pub arm: Rectangle,
    /// [m] Radius at which friction acts: that of the disc, or minus that of a corner under a straight run.
    pub radius: f64,
    /// Whether it slides in a known direction.
    pub slides: bool,
}

/// The normals at which something can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normals {
    pub bisector: Vector,
    /// Sines of the angles from the bisector.
    pub sines: [f64; 2],
    /// [m] Radius of the circle on which the axle stays while it touches; `None` if the normal does not turn with the
    /// axle.
    pub circle: Option<f64>,
    /// Whether it is entirely on a face.
    pub is_on_face: bool,
}

/// The contacts that are possible in a cell.
pub(super) enum Possible {
    /// A part overlaps with the ground everywhere in it.
    Overlap,
    Touches(Vec<Touch>),
}

impl Touch {
    /// Forces divided by the normal force: for each end of the friction, those at both ends of the normals.
    pub(super) fn forces(&self) -> [(f64, [Vector; 2]); 2] {
        let normals = self.normals.ends();
        self.slopes.map(|slope| {
            let force = |normal: Vector| normal + right_of(normal) * slope;
            (slope, normals.map(force))
        })
    }
}

impl Normals {
    fn ends(&self) -> [Vector; 2] {
        self.sines.map(|sine| {
            let cosine = (1.0 - sine * sine).max(0.0).sqrt();
            self.bisector * cosine + left_of(self.bisector) * sine
        })
    }

    /// A rectangle that contains all of them.
    pub(super) fn all(&self) -> Rectangle {
        let ends = self.ends();
        // An arc is within the rectangle round its ends and its points on the axes.
        let axes = [Vector::X, Vector::Y, Vector::NEG_X, Vector::NEG_Y];
        let on_arc = axes.into_iter().filter(|axis| {
            let sine = left_of(self.bisector).dot(*axis);
            self.bisector.dot(*axis) > 0.0 && sine > self.sines[0] && sine < self.sines[1]
        });
        let points = || ends.into_iter().chain(on_arc.clone());
        let low = points().fold(ends[0], Vector::min);
        let high = points().fold(ends[0], Vector::max);
        Rectangle {
            middle: (low + high) * 0.5,
            half: (high - low) * 0.5,
        }
    }

    /// Whether they are all inside the cone of a corner.
    pub(super) fn are_within_cone(&self, shape: Facing) -> bool {
        let Facing::Corner { cone, .. } = shape else {
            return false;
        };
        let all = self.all();
        all.along(left_of(cone[0])).is_above(0.0) && all.along(-left_of(cone[1])).is_above(0.0)
    }
}

impl Family {
    /// What can touch in a cell.
    pub(super) fn possible(&self, cell: &Cell) -> Possible {
        let turns = Turns::of(cell);
        let position = cell.position();
        let over = |spot: &Spot| spot.ends.map(|end| end.over(cell));
        let grounds: Vec<[Rectangle; 2]> = self.places.iter().map(over).collect();
        let axle = |disc: &Disc| position + turns.apply(disc.center);
        let is_inside = |disc: &Disc| self.is_inside(&grounds, axle(disc), disc.radius);
        let holds_corner = |(spot, ends): (&Spot, &[Rectangle; 2])| {
            let (corner, off) = turns.seen(ends[0] - position);
            let is_corner = matches!(spot.place.shape, Facing::Corner { .. });
            let holds = |hull: &Envelope| hull.depth(corner) - off > MARGIN;
            is_corner && self.hulls.iter().any(holds)
        };
        if self.discs.iter().any(is_inside) || self.places.iter().zip(&grounds).any(holds_corner) {
            return Possible::Overlap;
        }
        let center = self.center_of_mass.over(cell);
        let mut touches = Vec::new();
        for (i, surface) in self.layout.surfaces.iter().enumerate() {
            let all = self.places.iter().zip(&grounds).enumerate();
            match surface.shape {
                Outline::Round(disc) => {
                    let (axle, arm) = (
                        axle(&disc),
                        turns.apply_all(Rectangle::at(disc.center) - center),
                    );
                    let of = |(j, (spot, ends)): (usize, (&Spot, &[Rectangle; 2]))| {
                        let normals = spot.seen(ends, axle, disc)?;
                        Some(self.touch(cell, (i, j), normals, (arm, disc.radius)))
                    };
                    touches.extend(all.filter_map(of));
                }
                Outline::Flat { ends: run, outward } => {
                    let center = position + turns.apply_all(center);
                    let of = |(j, (spot, ends)): (usize, (&Spot, &[Rectangle; 2]))| {
                        let (normals, radius) =
                            spot.seen_across(ends, position, &turns, (run, outward))?;
                        Some(self.touch(cell, (i, j), normals, (ends[0] - center, -radius)))
                    };
                    touches.extend(all.filter_map(of));
                }
            }
        }
        Possible::Touches(touches)
    }

    fn touch(
        &self,
        cell: &Cell,
        (surface, place): (usize, usize),
        normals: Normals,
        (arm, radius): (Rectangle, f64),
    ) -> Touch {
        let of_surface = &self.layout.surfaces[surface];
        let friction = self.places[place].friction.over(cell);
        let limit = of_surface.friction_limit;
        let (low, high) = (friction.low.min(limit), friction.high.min(limit));
        let (slopes, slides) = match of_surface.grip {
            Grip::Driven(sign) if sign > 0.0 => ([low, high], true),
            Grip::Driven(_) => ([-high, -low], true),
            Grip::Free => ([0.0; 2], true),
            Grip::Still => ([-high, high], false),
        };
        Touch {
            surface,
            place,
            normals,
            slopes,
            arm,
            radius,
            slides,
        }
    }

    /// Whether a disc overlaps with the ground wherever its axle is.
    fn is_inside(&self, grounds: &[[Rectangle; 2]], axle: Rectangle, radius: f64) -> bool {
        self.places.iter().zip(grounds).any(|(spot, ends)| {
            let from = axle - ends[0];
            match spot.place.shape {
                Facing::Face { normal, .. } => {
                    // Of a face that looks up, the end on the right is the second.
                    let after = (axle.x() - ends[0].x()).low > MARGIN;
                    let before = (ends[1].x() - axle.x()).low > MARGIN;
                    let is_under = after && before && from.along(normal).is_below(0.0);
                    let along = right_of(normal);
                    let beside = from.along(along).low > MARGIN
                        && (ends[1] - axle).along(along).low > MARGIN;
                    let gap = from.along(normal);
                    is_under || beside && gap.is_below(radius) && gap.is_above(-radius)
                }
                Facing::Corner { radius: round, .. } => from.distance().is_below(radius + round),
            }
        })
    }
}

impl Spot {
    /// The normals at which a disc can touch it.
    fn seen(&self, ends: &[Rectangle; 2], axle: Rectangle, disc: Disc) -> Option<Normals> {
        let from = axle - ends[0];
        match self.place.shape {
            Facing::Face { normal, .. } => {
                let along = right_of(normal);
                let beyond = [from.along(along), (ends[1] - axle).along(along)];
                let is_over = beyond.iter().all(|along| along.high >= -MARGIN);
                let touches = from.along(normal).meets(Interval::at(disc.radius));
                (is_over && touches).then_some(Normals {
                    bisector: normal,
                    sines: [0.0; 2],
                    circle: None,
                    is_on_face: beyond.iter().all(|along| along.low > 0.0),
                })
            }
            Facing::Corner { radius, cone, .. } => {
                let circle = radius + disc.radius;
                if !from.distance().meets(Interval::at(circle)) {
                    return None;
                }
                let bisector = (cone[0] + cone[1]).normalize();
                let widest = left_of(bisector).dot(cone[1]);
                if circle <= 0.0 {
                    // A point on a point may have any normal in the cone.
                    return Some(Normals {
                        bisector,
                        sines: [-widest, widest],
                        circle: None,
                        is_on_face: false,
                    });
                }
                let (ahead, across) = (from.along(bisector), from.along(left_of(bisector)));
                // Along the bisector, at least as much as at the edge of the cone, and at most the radius of the
                // circle.
                let edge = (1.0 - widest * widest).max(0.0).sqrt();
                if ahead.is_below(edge * circle) || ahead.is_above(circle) {
                    return None;
                }
                let of_ahead = (1.0 - (ahead.low.max(0.0) / circle).powi(2))
                    .max(0.0)
                    .sqrt();
                let most = (widest.min(of_ahead) + MARGIN).min(1.0);
                let low = (across.low / circle - MARGIN).max(-most);
                let high = (across.high / circle + MARGIN).min(most);
                (low <= high).then_some(Normals {
                    bisector,
                    sines: [low, high],
                    circle: Some(circle),
                    is_on_face: false,
                })
            }
        }
    }

    /// The normals at which a straight run can lie on it, and its radius [m], if it is a corner.
    fn seen_across(
        &self,
        ends: &[Rectangle; 2],
        position: Rectangle,
        turns: &Turns,
        (run, outward): ([Vector; 2], Vector),
    ) -> Option<(Normals, f64)> {
        let Facing::Corner { radius, .. } = self.place.shape else {
            return None;
        };
        let (corner, off) = turns.seen(ends[0] - position);
        let along = (run[1] - run[0]).normalize_or(Vector::X);
        let (here, length) = ((corner - run[0]).dot(along), (run[1] - run[0]).length());
        let gap = outward.dot(corner - run[0]) - radius;
        let slack = off + MARGIN;
        let is_possible = gap.abs() <= slack && here >= -slack && here <= length + slack;
        let most = (libm::sin(turns.half.min(FRAC_PI_2)) + MARGIN).min(1.0);
        let normals = Normals {
            bisector: -turns.middle(outward),
            sines: [-most, most],
            circle: None,
            is_on_face: false,
        };
        is_possible.then_some((normals, radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jams::certify::tests::family_on_a_step;

    /// A run from (-0.05, -0.22) m that goes 0.25 m down at a slope of 3 to 4, and a round of 10 mm that it may lie on.
    const RUN: ([Vector; 2], Vector) = (
        [Vector::new(-0.05, -0.22), Vector::new(0.15, -0.37)],
        Vector::new(-0.6, -0.8),
    );
    const ROUND: f64 = 0.01;

    /// A range of angles about 0.3 rad, with the chassis frame at one place.
    fn cell(half: f64) -> Cell {
        let mut cell = Cell::ZERO;
        cell.low[..3].copy_from_slice(&[0.7, 0.4, 0.3 - half]);
        cell.high[..3].copy_from_slice(&[0.7, 0.4, 0.3 + half]);
        cell
    }

    /// What a run sees of a corner so far along it and off it [m], in the middle of a cell.
    fn seen(cell: &Cell, along: f64, gap: f64) -> Option<(Normals, f64)> {
        let family = family_on_a_step();
        let is_corner = |spot: &&Spot| matches!(spot.place.shape, Facing::Corner { .. });
        let found = family.places.iter().find(is_corner);
        let mut spot = found.expect("a step has one").clone();
        if let Facing::Corner { radius, .. } = &mut spot.place.shape {
            *radius = ROUND;
        }
        let ([from, to], outward) = RUN;
        let corner = from + (to - from).normalize() * along + outward * (gap + ROUND);
        let turns = Turns::of(cell);
        let center = Rectangle::at(cell.position().middle + turns.middle(corner));
        spot.seen_across(&[center; 2], cell.position(), &turns, RUN)
    }

    /// What a disc of 50 mm sees of a corner of 10 mm whose cone is 45 degrees wide either way of straight up, in
    /// radii of the circle of 60 mm on which its axle stays: in a range about a place ahead of it and across, to the
    /// left.
    fn of_corner(middle: [f64; 2], half: [f64; 2]) -> Option<Normals> {
        let family = family_on_a_step();
        let is_corner = |spot: &&Spot| matches!(spot.place.shape, Facing::Corner { .. });
        let found = family.places.iter().find(is_corner);
        let mut spot = found.expect("a step has one").clone();
        let center = Vector::new(0.7, 0.4);
        spot.place.shape = Facing::Corner {
            center,
            radius: ROUND,
            cone: [Vector::new(1.0, 1.0), Vector::new(-1.0, 1.0)].map(Vector::normalize),
        };
        let disc = Disc {
            center: Vector::ZERO,
            radius: 0.05,
        };
        let circle = 0.05 + ROUND;
        let axle = Rectangle {
            middle: center + Vector::new(-middle[1], middle[0]) * circle,
            half: Vector::new(half[1], half[0]) * circle,
        };
        spot.seen(&[Rectangle::at(center); 2], axle, disc)
    }

    #[test]
    fn a_disc_touches_a_corner_at_the_normals_on_which_its_axle_may_be() {
        let at = |angle: f64, share: f64| {
            let (sine, cosine) = libm::sincos(angle);
            of_corner([share * cosine, share * sine], [0.0; 2])
        };
        for angle in [-0.7, -0.3, 0.0, 0.5, 0.78] {
            let found = at(angle, 1.0).expect("it touches");
            for sine in found.sines {
                assert!((sine - libm::sin(angle)).abs() < 2.0 * MARGIN, "{angle}");
            }
            assert!(
                found
                    .circle
                    .is_some_and(|circle| (circle - 0.06).abs() < 1e-15)
            );
            assert!((found.bisector - Vector::Y).length() < 1e-15 && !found.is_on_face);
            assert!(at(angle, 1.0 - 1e-6).is_none() && at(angle, 1.0 + 1e-6).is_none());
        }
        assert!(at(0.8, 1.0).is_none() && at(-0.8, 1.0).is_none() && at(3.0, 1.0).is_none());
    }

    /// On ground whose friction is from 0.5 to 0.9.
    #[test]
    fn friction_is_along_the_drive_and_no_more_than_the_surface_has() {
        let mut family = family_on_a_step();
        let root = family.root();
        let (low, high) = (0.5, 0.9);
        for (grip, limit, slopes, slides) in [
            (Grip::Driven(1.0), 2.0, [low, high], true),
            (Grip::Driven(-1.0), 2.0, [-high, -low], true),
            (Grip::Driven(1.0), 0.6, [low, 0.6], true),
            (Grip::Driven(-1.0), 0.4, [-0.4, -0.4], true),
            (Grip::Free, 2.0, [0.0, 0.0], true),
            (Grip::Still, 2.0, [-high, high], false),
            (Grip::Still, 0.6, [-0.6, 0.6], false),
        ] {
            let surface = &mut family.layout.surfaces[0];
            (surface.grip, surface.friction_limit) = (grip, limit);
            let normals = of_corner([1.0, 0.0], [0.0; 2]).expect("it touches");
            let arm = Rectangle::at(Vector::X);
            let touch = family.touch(&root, (0, 0), normals, (arm, 0.05));
            let off = [0, 1].map(|k| (touch.slopes[k] - slopes[k]).abs());
            assert!(off[0].max(off[1]) < 1e-12, "{grip:?} {limit}: {touch:?}");
            assert_eq!((touch.slides, touch.surface, touch.place), (slides, 0, 0));
        }
    }

    /// Of 45 degrees either way of straight up.
    #[test]
    fn normals_are_within_a_cone_if_the_outermost_of_them_are() {
        let cone = [Vector::new(1.0, 1.0), Vector::new(-1.0, 1.0)].map(Vector::normalize);
        let corner = Facing::Corner {
            center: Vector::ZERO,
            radius: 0.0,
            cone,
        };
        let of = |from: f64, to: f64| Normals {
            bisector: Vector::from_angle(0.5 * (from + to)),
            sines: [-1.0, 1.0].map(|side| side * libm::sin(0.5 * (to - from))),
            circle: None,
            is_on_face: false,
        };
        let degrees = |from: f64, to: f64| of(from.to_radians(), to.to_radians());
        for (from, to, is_within) in [
            (90.0, 90.0, true),
            (46.0, 46.0, true),
            (134.0, 134.0, true),
            (44.0, 44.0, false),
            (136.0, 136.0, false),
            (43.0, 50.0, false),
            (130.0, 137.0, false),
        ] {
            let found = degrees(from, to).are_within_cone(corner);
            assert_eq!(found, is_within, "{from} to {to}");
        }
        let face = Facing::Face {
            ends: [Vector::ZERO, Vector::X],
            normal: Vector::Y,
        };
        assert!(!degrees(90.0, 90.0).are_within_cone(face));
    }

    /// The circle is cut where it is as far ahead as the nearest axle, or leaves the cone.
    #[test]
    fn a_range_of_axles_touches_a_corner_where_it_meets_the_arc_of_its_cone() {
        let sines = |middle, half| of_corner(middle, half).map(|found| found.sines);
        for (middle, half, expected) in [
            ([0.97, 0.0], [0.02, 0.9], Some([-0.312_25, 0.312_25])),
            ([0.97, 0.2], [0.02, 0.05], Some([0.15, 0.25])),
            (
                [0.5, 0.0],
                [0.5, 1.0],
                Some([-0.5_f64.sqrt(), 0.5_f64.sqrt()]),
            ),
            // Of the circle it holds only what is beside the cone.
            ([0.35, 0.0], [0.05, 0.95], None),
            ([0.0, 0.8], [0.9, 0.05], None),
            // Or nothing, below it and beyond it.
            ([0.3, 0.0], [0.2, 0.2], None),
            ([1.1, 0.0], [0.05, 0.9], None),
        ] {
            let found = sines(middle, half);
            assert_eq!(found.is_some(), expected.is_some(), "{middle:?} {half:?}");
            for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((a - b).abs() < 1e-5, "{middle:?} {half:?}: {found:?}");
            }
        }
    }

    #[test]
    fn a_run_lies_on_a_round_that_touches_it_between_its_ends() {
        let one = cell(0.0);
        for along in [0.0, 0.1, 0.25] {
            let (normals, radius) = seen(&one, along, 0.0).expect("it touches");
            // The normal of the ground is against that of the run.
            let expected = -Vector::from_angle(0.3).rotate(RUN.1);
            assert!((normals.bisector - expected).length() < 1e-15);
            let [right, left] = normals.sines;
            assert!(right <= 0.0 && left >= 0.0 && left - right < 3.0 * MARGIN);
            assert!((radius - ROUND).abs() < 1e-15);
            assert!(seen(&one, along, 1e-6).is_none() && seen(&one, along, -1e-6).is_none());
        }
        assert!(seen(&one, -1e-6, 0.0).is_none() && seen(&one, 0.25 + 1e-6, 0.0).is_none());
    }

    /// Turned by 0.02 rad, the corner, some 0.3 m from the chassis frame, moves by some 6 mm over the run.
    #[test]
    fn in_a_range_of_angles_a_run_lies_on_rounds_as_far_off_as_it_turns() {
        let range = cell(0.02);
        for (along, gap, is_seen) in [
            (0.1, 5e-3, true),
            (0.1, -5e-3, true),
            (0.1, 8e-3, false),
            (0.1, -8e-3, false),
            (-4e-3, 0.0, true),
            (-6e-3, 0.0, false),
            (0.257, 0.0, true),
            (0.26, 0.0, false),
        ] {
            let found = seen(&range, along, gap);
            assert_eq!(found.is_some(), is_seen, "{along} m along, {gap} m off");
            if let Some((normals, _)) = found {
                let [right, left] = normals.sines.map(libm::asin);
                assert!((left - 0.02).abs() < 1e-8 && (right + 0.02).abs() < 1e-8);
            }
        }
        // All angles within more than a quarter of a turn: the normal may be any.
        for half in [1.6, 3.0] {
            let found = seen(&cell(half), 0.1, 0.0);
            assert_eq!(found.map(|(normals, _)| normals.sines), Some([-1.0, 1.0]));
        }
    }
}
