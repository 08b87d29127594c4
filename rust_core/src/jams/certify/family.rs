//! A robot over grounds that depend on parameters: its outline is fixed; corners of the ground, friction and the centre
//! of mass change linearly.

use super::cell::{Affine, Cell, MOST_PARAMETERS, Shares};
use super::interval::Interval;
use crate::error::Error;
use crate::geometry::{Disc, Envelope, Pose, Vector};
use crate::jams::layout::{Grip, Layout, Outline, Surface};
use crate::jams::places::{Facing, Place};
use crate::jams::setting::Setting;
use crate::limits::Cancel;
use crate::robot::Model;
use crate::scenario::ScenarioError;
use crate::terrain::Ground;

/// [m] and fractions: allowed deviation of a value from linearity, by rounding.
const PROPORTIONAL: f64 = 1e-12;

/// Robot and ground for all values of the parameters.
#[derive(Clone, Debug)]
pub(super) struct Family {
    /// The robot at the smallest values.
    pub layout: Layout,
    /// Circles that may not overlap with the ground.
    pub discs: Vec<Disc>,
    /// Parts that may not contain a corner of the ground: hulls of several discs.
    pub hulls: Vec<Envelope>,
    pub tracks: Vec<Track>,
    pub places: Vec<Spot>,
    pub center_of_mass: Affine<Vector>,
    /// [m] Radius of the smallest wheel.
    pub radius: f64,
    /// [m] Largest distance of a point of the robot from the origin of its frame.
    pub reach: f64,
    /// [m^2] Moment of inertia over mass.
    pub inertia: Interval,
    /// [rad] Largest angle of the chassis.
    pub most_angle: f64,
    /// Number of parameters.
    pub parameters: usize,
}

/// The wheels of a track and a taut belt round them, in the chassis frame.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub discs: Vec<Disc>,
    pub belt: Envelope,
}

/// A face or a corner of the ground for all values of the parameters.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    /// The place at the smallest values.
    pub place: Place,
    /// [m] Both ends of a face, or twice the centre of a corner.
    pub ends: [Affine<Vector>; 2],
    pub friction: Affine<f64>,
}

/// One member of the family: at the smallest values, or with one parameter or all at the largest.
struct Member {
    layout: Layout,
    places: Vec<Place>,
}

impl Family {
    /// Builds it from robot and ground with the smallest values of all parameters, the largest of each alone, the
    /// largest of all, and the middle of all.
    ///
    /// # Errors
    /// A robot that [`Layout::new`] refuses; parameters that change anything else, or not linearly.
    pub(super) fn new(
        built: &[(&Model, &Ground)],
        names: &[String],
        forwards: bool,
        most_angle: f64,
    ) -> Result<Self, ScenarioError> {
        let member = |(model, ground): &(&Model, &Ground)| {
            Ok(Member {
                layout: Layout::new(model, forwards)?,
                places: Place::of(ground),
            })
        };
        let members: Vec<Member> = built.iter().map(member).collect::<Result<_, _>>()?;
        let count = names.len();
        let first = &members[0];
        let rule =
            "must move the centre of mass, corners of the ground or friction, and nothing else";
        for (k, other) in members.iter().enumerate().skip(1) {
            let idle = k <= count && is_at(first, other);
            if idle || !is_alike(first, other) {
                let name = names.get(k - 1).or(names.first());
                return Err(ScenarioError::new(
                    "over",
                    name.cloned().unwrap_or_default(),
                    rule,
                ));
            }
        }
        let own = &members[..=count];
        let end = |i: usize, end: usize| {
            Affine::through(
                own.iter()
                    .map(|member| points(&member.places[i].shape)[end]),
            )
        };
        let places = (0..first.places.len()).map(|i| Spot {
            place: first.places[i],
            ends: [end(i, 0), end(i, 1)],
            friction: Affine::through(own.iter().map(|member| member.places[i].friction)),
        });
        let family = Self {
            most_angle,
            parameters: count,
            layout: first.layout.clone(),
            discs: discs(&first.layout),
            hulls: hulls(&first.layout),
            tracks: tracks(built[0].0),
            places: places.collect(),
            center_of_mass: Affine::through(own.iter().map(|member| member.layout.center_of_mass)),
            radius: smallest(&first.layout),
            reach: first.layout.reach + first.layout.center_of_mass.length(),
            inertia: inertias(built, &members),
        };
        for (member, share) in members[count + 1..].iter().zip([1.0, 0.5]) {
            if !family.holds(member, share) {
                let rule = "must move the centre of mass, corners of the ground and friction in proportion";
                return Err(ScenarioError::new("over", names.join(", "), rule));
            }
        }
        Ok(family)
    }

    /// All poses over the ground for all values of the parameters.
    pub(super) fn root(&self) -> Cell {
        let mut all = Cell::ZERO;
        all.high[3..3 + self.parameters].fill(1.0);
        let over = |end: &Affine<Vector>| {
            let over = end.over(&all);
            [over.middle - over.half, over.middle + over.half]
        };
        let ends = self.places.iter().flat_map(|spot| &spot.ends);
        let bounds: Vec<Vector> = ends.flat_map(over).collect();
        let low = bounds.iter().copied().fold(bounds[0], Vector::min);
        let high = bounds.iter().copied().fold(bounds[0], Vector::max);
        let (reach, turn) = (self.reach, self.most_angle);
        // Where the ground ends, there is nothing to touch.
        all.low[..3].copy_from_slice(&[low.x + reach, low.y - reach, -turn]);
        all.high[..3].copy_from_slice(&[high.x - reach, high.y + reach, turn]);
        all
    }

    /// Robot and ground at fractions of the parameters' ranges.
    pub(super) fn at(&self, shares: &Shares) -> (Layout, Vec<Place>) {
        let of = |spot: &Spot| {
            let [from, to] = spot.ends.map(|end| end.at(shares));
            let shape = match spot.place.shape {
                Facing::Face { normal, .. } => Facing::Face {
                    ends: [from, to],
                    normal,
                },
                Facing::Corner { radius, cone, .. } => Facing::Corner {
                    center: from,
                    radius,
                    cone,
                },
            };
            Place {
                shape,
                friction: spot.friction.at(shares),
                ..spot.place
            }
        };
        let layout = Layout {
            center_of_mass: self.center_of_mass.at(shares),
            ..self.layout.clone()
        };
        (layout, self.places.iter().map(of).collect())
    }

    /// The same, with all possible contacts.
    ///
    /// # Errors
    /// As [`Setting::new`].
    pub(super) fn setting(&self, shares: &Shares, cancel: &Cancel) -> Result<Setting, Error> {
        let (layout, places) = self.at(shares);
        let most = self.most_angle;
        Setting::new(layout, places, [-most, most], cancel)
    }

    /// Whether a member with all parameters at a fraction of their ranges is as linearity predicts.
    fn holds(&self, member: &Member, share: f64) -> bool {
        let (layout, places) = self.at(&[share; MOST_PARAMETERS]);
        is_at(&Member { layout, places }, member)
    }
}

/// Refuses surfaces that move along straight runs: a belt has no pockets.
pub(super) fn check_wheels(layout: &Layout) -> Result<(), ScenarioError> {
    let is_belt = |surface: &Surface| {
        matches!(surface.shape, Outline::Flat { .. }) && surface.grip != Grip::Still
    };
    if layout.surfaces.iter().any(is_belt) {
        let rule = "must have wheels: it is a belt that they are certified to be as good as";
        return Err(ScenarioError::new("robot.track", "belt", rule));
    }
    Ok(())
}

fn points(shape: &Facing) -> [Vector; 2] {
    match shape {
        Facing::Face { ends, .. } => *ends,
        Facing::Corner { center, .. } => [*center; 2],
    }
}

/// Whether two members have the same ground, friction and centre of mass.
fn is_at(one: &Member, other: &Member) -> bool {
    let off = (one.layout.center_of_mass - other.layout.center_of_mass).length();
    let of_place = |(place, other): (&Place, &Place)| {
        let [from, to] = points(&place.shape);
        let [other_from, other_to] = points(&other.shape);
        let moved = (from - other_from).length().max((to - other_to).length());
        moved.max((place.friction - other.friction).abs())
    };
    let places = one.places.iter().zip(&other.places).map(of_place);
    places.fold(off, f64::max) < PROPORTIONAL
}

/// Whether two members have the same outline, and faces with the same directions.
fn is_alike(one: &Member, other: &Member) -> bool {
    let near = |a: Vector, b: Vector| (a - b).length() < PROPORTIONAL;
    let same_disc =
        |a: &Disc, b: &Disc| near(a.center, b.center) && (a.radius - b.radius).abs() < PROPORTIONAL;
    let same_surface = |(a, b): (&Surface, &Surface)| {
        a.grip == b.grip
            && a.friction_limit.to_bits() == b.friction_limit.to_bits()
            && match (&a.shape, &b.shape) {
                (Outline::Round(a), Outline::Round(b)) => same_disc(a, b),
                (Outline::Flat { ends: a, .. }, Outline::Flat { ends: b, .. }) => {
                    near(a[0], b[0]) && near(a[1], b[1])
                }
                _ => false,
            }
    };
    let same_place = |(a, b): (&Place, &Place)| match (&a.shape, &b.shape) {
        (Facing::Face { normal: a, .. }, Facing::Face { normal: b, .. }) => near(*a, *b),
        (
            Facing::Corner { radius, cone, .. },
            Facing::Corner {
                radius: other_radius,
                cone: other_cone,
                ..
            },
        ) => {
            (radius - other_radius).abs() < PROPORTIONAL
                && near(cone[0], other_cone[0])
                && near(cone[1], other_cone[1])
        }
        _ => false,
    };
    let (surfaces, others) = (&one.layout.surfaces, &other.layout.surfaces);
    surfaces.len() == others.len()
        && one.places.len() == other.places.len()
        && surfaces.iter().zip(others).all(same_surface)
        && one.places.iter().zip(&other.places).all(same_place)
}

fn discs(layout: &Layout) -> Vec<Disc> {
    layout
        .solids
        .iter()
        .flat_map(|solid| solid.discs.clone())
        .collect()
}

fn smallest(layout: &Layout) -> f64 {
    let discs = layout.solids.iter().flat_map(|solid| &solid.discs);
    let radii = discs.map(|disc| disc.radius).filter(|radius| *radius > 0.0);
    radii.fold(f64::INFINITY, f64::min)
}

fn hulls(layout: &Layout) -> Vec<Envelope> {
    let solids = layout.solids.iter().filter(|solid| solid.discs.len() > 1);
    solids.map(|solid| Envelope::new(&solid.discs)).collect()
}

impl Spot {
    /// Whether it is a face with this corner at one of its ends, at all values of the parameters.
    pub(super) fn ends_at(&self, corner: &Self) -> bool {
        let (Facing::Face { normal, .. }, Facing::Corner { radius, .. }) =
            (self.place.shape, corner.place.shape)
        else {
            return false;
        };
        let near = |a: Vector, b: Vector| (a - b).length() < PROPORTIONAL;
        let center = corner.ends[0];
        let is_there = |end: &Affine<Vector>| {
            let mut slopes = end.slopes.iter().zip(center.slopes);
            near(end.base, center.base + normal * radius) && slopes.all(|(a, b)| near(*a, b))
        };
        self.ends.iter().any(is_there)
    }
}

fn tracks(model: &Model) -> Vec<Track> {
    let running = model.running_at_start(0.0);
    let of = |mount| {
        let place = running.mounted(mount, Pose::IDENTITY);
        let placed = model.discs_of_track(0, mount).map(move |(tip, _)| Disc {
            center: place.transform_point(tip.center),
            ..tip
        });
        let discs: Vec<Disc> = placed.collect();
        let belt = Envelope::new(&discs);
        Track { discs, belt }
    };
    model.mounts_of_tracks().map(of).collect()
}

/// [m^2] Moments of inertia over mass of all members.
fn inertias(built: &[(&Model, &Ground)], members: &[Member]) -> Interval {
    let pairs = built.iter().zip(members);
    let all = pairs.map(|((model, _), member)| inertia(model, member.layout.center_of_mass));
    let empty = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
    all.fold(empty, |range, value| {
        Interval::new(range.low.min(value), range.high.max(value))
    })
}

/// [m^2] Moment of inertia over mass, with flippers and drives fixed to the chassis.
fn inertia(model: &Model, center: Vector) -> f64 {
    let about = |point: Vector| (point - center).length_squared();
    let running = model.running_at_start(0.0);
    let arms = model.flippers.iter().zip(&running.flippers);
    let of_arms =
        arms.map(|(arm, at)| arm.moment_of_inertia + arm.mass * about(at.pose.translation));
    let of_chassis = model.locked_inertia() + model.mass * about(model.center_of_mass);
    (of_chassis + of_arms.sum::<f64>()) / model.total_mass()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jams::certify::tests::{built, scenario};

    /// The Engineer with a belly on wheels before a step of 80 mm with a rounded edge.
    fn member() -> Member {
        let (model, ground) = built(&scenario(0.08, 0.7));
        Member {
            layout: Layout::new(&model, true).expect("it has round wheels"),
            places: Place::of(&ground),
        }
    }

    fn wheel(member: &mut Member) -> &mut Disc {
        let shapes = member.layout.surfaces.iter_mut().map(|s| &mut s.shape);
        let mut discs = shapes.filter_map(|shape| match shape {
            Outline::Round(disc) if disc.radius > 0.0 => Some(disc),
            _ => None,
        });
        discs.next().expect("it has one")
    }

    fn run(member: &mut Member) -> &mut [Vector; 2] {
        let shapes = member.layout.surfaces.iter_mut().map(|s| &mut s.shape);
        let mut runs = shapes.filter_map(|shape| match shape {
            Outline::Flat { ends, .. } => Some(ends),
            Outline::Round(_) => None,
        });
        runs.next().expect("it has a belly")
    }

    fn face(member: &mut Member) -> (&mut [Vector; 2], &mut Vector) {
        let shapes = member.places.iter_mut().map(|place| &mut place.shape);
        let mut faces = shapes.filter_map(|shape| match shape {
            Facing::Face { ends, normal } => Some((ends, normal)),
            Facing::Corner { .. } => None,
        });
        faces.next().expect("it has some")
    }

    fn edge(member: &mut Member) -> (&mut Vector, &mut f64, &mut [Vector; 2]) {
        let shapes = member.places.iter_mut().map(|place| &mut place.shape);
        let mut edges = shapes.filter_map(|shape| match shape {
            Facing::Corner {
                center,
                radius,
                cone,
            } => Some((center, radius, cone)),
            Facing::Face { .. } => None,
        });
        edges.next().expect("it has one")
    }

    type Change = fn(&mut Member);

    /// A nanometre is more than rounding.
    const OFF: Vector = Vector::new(0.6e-9, -0.8e-9);

    #[test]
    fn a_robot_or_a_ground_of_another_shape_is_not_alike() {
        let is_alike = |change: Change| {
            let mut other = member();
            change(&mut other);
            [
                super::is_alike(&member(), &other),
                super::is_alike(&other, &member()),
            ]
        };
        assert_eq!(is_alike(|_| {}), [true; 2]);
        let others: [(&str, Change); 13] = [
            ("centre", |m| wheel(m).center += OFF),
            ("radius", |m| wheel(m).radius += 1e-9),
            ("one end of a run", |m| run(m)[0] += OFF),
            ("its other end", |m| run(m)[1] += OFF),
            ("grip", |m| m.layout.surfaces[0].grip = Grip::Free),
            ("friction", |m| m.layout.surfaces[0].friction_limit = 0.5),
            ("a surface more", |m| {
                m.layout.surfaces.push(m.layout.surfaces[0]);
            }),
            ("a place more", |m| m.places.push(m.places[0])),
            ("direction", |m| *face(m).1 += OFF),
            ("round", |m| *edge(m).1 += 1e-9),
            ("one side of its cone", |m| edge(m).2[0] += OFF),
            ("the other side", |m| edge(m).2[1] += OFF),
            ("order", |m| m.places.reverse()),
        ];
        for (what, change) in others {
            assert_eq!(is_alike(change), [false; 2], "{what}");
        }
    }

    #[test]
    fn what_parameters_may_move_is_elsewhere_and_yet_alike() {
        let changes: [Change; 5] = [
            |m| m.layout.center_of_mass += OFF,
            |m| m.places[0].friction += 1e-9,
            |m| face(m).0[0] += OFF,
            |m| face(m).0[1] += OFF,
            |m| *edge(m).0 += OFF,
        ];
        assert!(is_at(&member(), &member()));
        for (number, change) in changes.into_iter().enumerate() {
            let mut other = member();
            change(&mut other);
            assert!(is_alike(&member(), &other), "{number}");
            assert!(
                !is_at(&member(), &other) && !is_at(&other, &member()),
                "{number}"
            );
        }
    }

    #[test]
    fn the_parts_of_a_family_are_its_wheels_and_its_belly() {
        let layout = member().layout;
        // Four wheels, and the corners of a belly.
        assert_eq!(discs(&layout).len(), 4 + 4);
        assert_eq!(hulls(&layout).len(), 1);
        let radius = smallest(&layout);
        assert!((radius - wheel(&mut member()).radius).abs() < 1e-15);
    }
}
