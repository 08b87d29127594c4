//! Possible contacts in a cell, and their forces.

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
                    let is_under = normal.y > 0.0 && {
                        let after = (axle.x() - ends[0].x()).low > MARGIN;
                        let before = (ends[1].x() - axle.x()).low > MARGIN;
                        after && before && from.along(normal).is_below(0.0)
                    };
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
        let most = if turns.half < 1.5 {
            libm::sin(turns.half) + MARGIN
        } else {
            1.0
        };
        let normals = Normals {
            bisector: -turns.middle(outward),
            sines: [-most, most],
            circle: None,
            is_on_face: false,
        };
        is_possible.then_some((normals, radius))
    }
}
