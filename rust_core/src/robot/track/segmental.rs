//! A chain of rigid shoes linked by pins (section 2.3 of the paper), on a guide of the chassis or on wheels.
//!
//! The outer faces of the plates run along the roots of the outline, the pins along the middle of the plates, and
//! guide or wheels are under their inner faces, so that the robot stands as high as the real one.

use super::TrackModel;
use crate::geometry::{Disc, Envelope, ShoeLoop, Vector, left_of, lower_tangent, outline_discs};
use crate::robot::{BodyKind, Bushing, ChainOfShoes, Mount, Part, Shape, Sprocket, Tensioner};
use crate::scenario::{ChainMechanism, MAX_SHOES, Robot, ScenarioError, SegmentalTrack, ShoeShape};

/// Largest mass of the rest of the robot, in shoes; docs/decisions/0008 has the gaps of pins beyond this.
const HEAVIEST: f64 = 3000.0;
/// Travel of the tensioner from its pre-tension to no force, in pitches.
const SOFTNESS: f64 = 0.1;
/// Travel by which an idler can be pressed in, in pitches.
const STOP: f64 = 0.06;
/// The same, including the compliance of its stop.
const PRESSED_IN: f64 = 0.07;

/// Shoes on a guide or on wheels.
pub(super) fn build(robot: &Robot, track: &SegmentalTrack) -> Result<TrackModel, ScenarioError> {
    let outline = &robot.outline;
    let discs = |inside: f64| -> Vec<Disc> {
        let discs = outline_discs(outline).into_iter();
        discs.map(|disc| disc.grown(-inside)).collect()
    };
    let roots = Envelope::new(&discs(outline.grouser_height));
    let count = match track.shoe_count {
        Some(count) => count,
        None => outline.pitches_along(roots.length(), [3, MAX_SHOES])?,
    };
    let count = count as usize;
    let plate = |count: usize| {
        let default = roots.length() / count as f64 / 16.0;
        track.plate_thickness.unwrap_or(default)
    };
    let plate_thickness = plate(count);
    let guide = discs(outline.grouser_height + plate_thickness);
    if let Some(disc) = guide.iter().find(|disc| disc.radius <= 0.0) {
        let rule = format!(
            "must leave room for a guide, whose smaller end would have a radius of {} m",
            disc.radius
        );
        let value = plate_thickness;
        return Err(ScenarioError::new(
            "robot.track.plate_thickness",
            value,
            rule,
        ));
    }
    let loop_of = |count: usize| {
        let pins = discs(outline.grouser_height + 0.5 * plate(count));
        let on_guide = ShoeLoop::new(pins, count)?;
        match track.mechanism {
            ChainMechanism::Guide => Some(on_guide),
            ChainMechanism::Sprocket => on_guide.on_sprocket(),
        }
    };
    let Some(path) = loop_of(count) else {
        return Err(too_long(count, |count| loop_of(count).is_some()));
    };
    let tensioner = tensioner(robot, track, path.pitch);
    let shoe_mass = shoe_mass(robot, count)?;
    let pieces = shapes(robot, track.shoe_shape, path.pitch, plate_thickness);
    let mut parts: Vec<Part> = (0..count).flat_map(|shoe| of_shoe(shoe, &pieces)).collect();
    let beyond = plate_thickness + outline.grouser_height;
    let (ends, between) = match track.mechanism {
        ChainMechanism::Guide => {
            parts.push(guide_of(&guide, PRESSED_IN * path.pitch, beyond));
            ([guide[0], guide[1]], guide[2..].to_vec())
        }
        ChainMechanism::Sprocket => {
            let gear = RunningGear::new(&path, &guide, plate_thickness, track);
            parts.extend(gear.parts(beyond));
            (gear.ends, [gear.road_wheels, gear.rollers].concat())
        }
    };
    let of_one_track = Bushing {
        stiffness: track.pin_stiffness,
        damping: track.pin_damping,
    };
    let chain = ChainOfShoes {
        number: 0,
        shoes: 0..count,
        tensioner,
        bushing: of_one_track.times(2.0),
        plate_thickness,
        shoe_mass,
        // A thin plate between its pins.
        shoe_inertia: shoe_mass * path.pitch * path.pitch / 12.0,
        hull: match track.mechanism {
            ChainMechanism::Guide => Envelope::new(&guide),
            ChainMechanism::Sprocket => Envelope::new(&ends),
        },
        ends,
        between,
        sprocket: RunningGear::sprocket(&path, shoe_mass, outline.rear_radius()),
        path,
    };
    Ok(TrackModel {
        chains: vec![chain],
        ..TrackModel::driven(parts, 1)
    })
}

/// The parts of one shoe.
fn of_shoe(shoe: usize, pieces: &[(BodyKind, Vec<Vector>)]) -> impl Iterator<Item = Part> {
    pieces.iter().cloned().map(move |(kind, corners)| Part {
        mount: Mount::Shoe(shoe),
        ..Part::new(kind, Shape::Polygon { corners }, Some(0))
    })
}

/// The guide for contacts with the ground, at its initial position. Its front end may be pressed in, and it must not
/// touch ground under plates that are in place, so it is `inside` [m] smaller.
fn guide_of(discs: &[Disc], inside: f64, beyond: f64) -> Part {
    let hull = Shape::Hull {
        discs: discs.iter().map(|disc| shrunk(*disc, inside)).collect(),
        grouser_height: beyond + inside,
    };
    Part::new(BodyKind::Guide, hull, None)
}

/// [kg] Mass of a shoe in a chain of `count`.
fn shoe_mass(robot: &Robot, count: usize) -> Result<f64, ScenarioError> {
    let (given, shoes) = (robot.track_mass, count as f64);
    if (robot.mass - given) * shoes <= HEAVIEST * given {
        return Ok(given / shoes);
    }
    let least = robot.mass * shoes / (HEAVIEST + shoes);
    let rule = format!(
        "must be at least {least:.4} kg for {count} shoes: if a shoe weighs less than 1/{HEAVIEST} of the rest of the robot, its pins open"
    );
    Err(ScenarioError::new("robot.track_mass", given, rule))
}

/// The error for a chain of `count` shoes that are too long; it says which counts are possible.
fn too_long(count: usize, goes_round: impl Fn(usize) -> bool) -> ScenarioError {
    let most = MAX_SHOES as usize;
    let allowed = if goes_round(most) {
        // Shorter shoes fit better; trying one count takes some milliseconds.
        let (mut too_few, mut least) = (count, most);
        while least - too_few > 1 {
            let between = too_few.midpoint(least);
            if goes_round(between) {
                least = between;
            } else {
                too_few = between;
            }
        }
        format!("must be from {least} to {most} here")
    } else {
        format!("must be more than {most} here, but that is the maximum")
    };
    let rule = format!(
        "{allowed}: a shoe must not be longer than the diameter of the smallest disc, half the axle distance or a straight run"
    );
    ScenarioError::new("robot.track.shoe_count", count, rule)
}

/// A disc `inside` [m] smaller than another, if there is room for it.
fn shrunk(disc: Disc, inside: f64) -> Disc {
    Disc {
        radius: (disc.radius - inside).max(0.5 * disc.radius),
        ..disc
    }
}

/// The tensioners of both tracks, lumped together.
fn tensioner(robot: &Robot, track: &SegmentalTrack, pitch: f64) -> Tensioner {
    let pre_tension = track.pre_tension.unwrap_or(robot.earth_weight() / 40.0);
    let stiffness = track
        .tensioner_stiffness
        .unwrap_or(pre_tension / (SOFTNESS * pitch));
    let damping = track
        .tensioner_damping
        .unwrap_or_else(|| (2.0 * stiffness * robot.track_mass).sqrt());
    Tensioner {
        pre_tension: 2.0 * pre_tension,
        stiffness: 2.0 * stiffness,
        damping: 2.0 * damping,
        stop: STOP * pitch,
    }
}

/// The convex pieces of a shoe in its own frame, counter-clockwise.
fn shapes(
    robot: &Robot,
    shape: ShoeShape,
    pitch: f64,
    plate_thickness: f64,
) -> Vec<(BodyKind, Vec<Vector>)> {
    let (half, face) = (0.5 * pitch, 0.5 * plate_thickness);
    let (height, tip) = (
        robot.outline.grouser_height,
        0.5 * robot.outline.grouser_thickness.min(pitch),
    );
    let corners = |points: &[(f64, f64)]| points.iter().map(|(x, y)| Vector::new(*x, *y)).collect();
    let plate = corners(&[(-half, -face), (half, -face), (half, face), (-half, face)]);
    if height == 0.0 {
        return vec![(BodyKind::Shoe, plate)];
    }
    let top = face + height;
    match shape {
        ShoeShape::Rectangle => vec![
            (BodyKind::Shoe, plate),
            (
                BodyKind::Grouser,
                corners(&[(-tip, -face), (tip, -face), (tip, top), (-tip, top)]),
            ),
        ],
        ShoeShape::Trapezoid => vec![(
            BodyKind::Shoe,
            corners(&[
                (-half, -face),
                (half, -face),
                (half, face),
                (tip, top),
                (-tip, top),
                (-half, face),
            ]),
        )],
    }
}

/// Largest diameter of road wheels and return rollers, as a share of their spacing, ...
const FILLED: f64 = 0.96;
/// ... and their largest radii, as shares of that of the smaller end.
const ROAD_WHEEL: f64 = 0.9;
const ROLLER: f64 = 0.25;
/// Largest gaps between wheels under the lower and the upper run, in pitches.
const LOWER_SPAN: f64 = 1.0;
const UPPER_SPAN: f64 = 2.0;

/// Wheels on the inner faces of the plates.
pub(super) struct RunningGear {
    pub ends: [Disc; 2],
    pub road_wheels: Vec<Disc>,
    pub rollers: Vec<Disc>,
}

impl RunningGear {
    /// For the ends of a chain's path; road wheels follow the lower run of the `built` ends.
    pub(super) fn new(
        path: &ShoeLoop,
        built: &[Disc],
        plate_thickness: f64,
        track: &SegmentalTrack,
    ) -> Self {
        let of_path = path.ends(path.pitch);
        let ends = [of_path[0], of_path[1]].map(|end| end.grown(-0.5 * plate_thickness));
        let [rear, front] = ends;
        let smaller = rear.radius.min(front.radius);
        let distance = (front.center - rear.center).length();
        let enough = |span: f64| (distance / (span * path.pitch)).ceil().max(1.0) as u32 - 1;
        // The upper tangent is the lower tangent of the mirrored ends.
        let upwards = |disc: Disc| Disc {
            center: Vector::new(disc.center.x, -disc.center.y),
            ..disc
        };
        let on_run = |[rear, front]: [Disc; 2], count: u32, largest: f64| -> Vec<Disc> {
            let [from, to] = lower_tangent(rear, front);
            let gap = (to - from) / f64::from(count + 1);
            let inwards = left_of(gap.normalize());
            let radius = (0.5 * FILLED * gap.length()).min(largest * smaller);
            let wheel = |i: u32| Disc {
                center: from + gap * f64::from(i) + inwards * radius,
                radius,
            };
            (1..=count).map(wheel).collect()
        };
        let road_wheels = track.road_wheel_count.unwrap_or_else(|| enough(LOWER_SPAN));
        let rollers = track
            .return_roller_count
            .unwrap_or_else(|| enough(UPPER_SPAN));
        let upper = on_run(ends.map(upwards), rollers, ROLLER);
        Self {
            ends,
            road_wheels: on_run([built[0], built[1]], road_wheels, ROAD_WHEEL),
            rollers: upper.into_iter().map(upwards).collect(),
        }
    }

    /// The sprocket, as heavy as the shoes on it, our assumption. Its teeth reach at most to `most` [m], the radius of
    /// the tips of the grousers.
    pub(super) fn sprocket(path: &ShoeLoop, shoe_mass: f64, most: f64) -> Option<Sprocket> {
        let teeth = path.teeth(most)?;
        let mass = shoe_mass * teeth.count as f64;
        Some(Sprocket {
            first_seat: path.first_seat(),
            inertia: 0.5 * mass * teeth.radius * teeth.radius,
            teeth,
        })
    }

    /// The wheels that could touch the ground between the shoes, whose tips are `beyond` [m] outside their surface.
    /// They turn without friction.
    pub(super) fn parts(&self, beyond: f64) -> impl Iterator<Item = Part> {
        let of = |kind, discs: Vec<Disc>| {
            discs.into_iter().map(move |disc| {
                let hull = Shape::Hull {
                    discs: vec![disc],
                    grouser_height: beyond,
                };
                Part {
                    friction_limit: 0.0,
                    ..Part::new(kind, hull, None)
                }
            })
        };
        let [rear, front] = self.ends;
        of(BodyKind::Sprocket, vec![rear])
            .chain(of(BodyKind::Idler, vec![front]))
            .chain(of(BodyKind::RoadWheel, self.road_wheels.clone()))
            .chain(of(BodyKind::Roller, self.rollers.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Model;
    use crate::scenario::{Track, shared};

    /// With plates 4 mm thick and grousers 12 mm high and 6 mm thick.
    #[test]
    fn a_shoe_is_a_plate_with_a_grouser_in_its_middle() {
        let robot = shared("engineer_chain_step").robot;
        let of = |shape| -> Vec<Vec<[f64; 2]>> {
            let pieces = shapes(&robot, shape, 0.05, 0.004);
            let corners =
                |(_, corners): (_, Vec<Vector>)| corners.into_iter().map(<[f64; 2]>::from);
            pieces
                .into_iter()
                .map(|piece| corners(piece).collect())
                .collect()
        };
        let plate = [
            [-0.025, -0.002],
            [0.025, -0.002],
            [0.025, 0.002],
            [-0.025, 0.002],
        ];
        let grouser = [
            [-0.003, -0.002],
            [0.003, -0.002],
            [0.003, 0.014],
            [-0.003, 0.014],
        ];
        assert_eq!(of(ShoeShape::Rectangle), [plate, grouser]);
        let [rear, front] = [grouser[3], grouser[2]];
        let whole = [plate[0], plate[1], plate[2], front, rear, plate[3]];
        assert_eq!(of(ShoeShape::Trapezoid), [whole]);
    }

    /// Its own surface lies inside where it is built, and what it carries stays beyond that.
    #[test]
    fn a_guide_ends_where_it_is_built_however_far_inside_its_surface_lies() {
        let disc = Disc {
            center: Vector::new(0.1, 0.2),
            radius: 0.05,
        };
        for inside in [0.0, 0.002, 0.01] {
            let found: Vec<_> = guide_of(&[disc], inside, 0.004).discs().collect();
            let [(tip, root)] = found[..] else {
                panic!("{found:?}");
            };
            assert!((tip.radius - 0.054).abs() < 1e-15, "{tip:?}");
            assert!((root.radius - (0.05 - inside)).abs() < 1e-15, "{root:?}");
            assert!((tip.center - disc.center).length() < 1e-15);
        }
    }

    /// The Engineer weighs 207.972 N, of which a track pulls with a fortieth, and its track 2.4 kg. Both tracks
    /// together have twice what one has.
    #[test]
    fn a_tensioner_pulls_with_a_share_of_the_weight_and_is_damped_for_the_track() {
        let mut robot = shared("engineer_chain_step").robot;
        let Track::Segmental(mut track) = robot.track.clone() else {
            panic!("it is a chain")
        };
        let found = tensioner(&robot, &track, 0.05);
        let check = |found: f64, expected: f64| {
            let off = found / expected - 1.0;
            assert!(off.abs() < 1e-12, "{found}, {expected}");
        };
        check(found.pre_tension, 2.0 * 5.1993);
        // It has no force left after a tenth of a pitch.
        check(found.stiffness, 2.0 * 1039.86);
        check(found.stop, 0.003);
        (track.pre_tension, track.tensioner_stiffness) = (Some(100.0), Some(30_000.0));
        let found = tensioner(&robot, &track, 0.05);
        check(found.pre_tension, 200.0);
        check(found.stiffness, 60_000.0);
        // The root of 2 x 30 kN/m x 2.4 kg is 379.47 N s/m.
        check(found.damping * found.damping, 4.0 * 144_000.0);
        track.tensioner_damping = Some(30.0);
        check(tensioner(&robot, &track, 0.05).damping, 60.0);
        robot.track = Track::Segmental(track);
        let chain = &Model::new(&robot).expect("it is valid").chains[0];
        // A rod of the length of a pitch.
        let rod = chain.shoe_inertia / (chain.shoe_mass * chain.path.pitch);
        check(12.0 * rod, chain.path.pitch);
    }

    /// 20 of them divide the 0.365 m between the axles into 21.
    #[test]
    fn road_wheels_fill_nearly_all_of_their_run() {
        let mut robot = shared("engineer_sprocket_step").robot;
        let Track::Segmental(track) = &mut robot.track else {
            panic!("it is a chain")
        };
        (track.road_wheel_count, track.return_roller_count) = (Some(20), Some(0));
        let model = Model::new(&robot).expect("it is valid");
        let wheels = model
            .track_parts()
            .filter(|part| part.kind == BodyKind::RoadWheel);
        let wheels: Vec<Disc> = wheels.flat_map(|part| part.discs().map(|d| d.1)).collect();
        assert_eq!(wheels.len(), 20);
        for pair in wheels.windows(2) {
            let apart = pair[1].center.x - pair[0].center.x;
            assert!((apart - 0.365 / 21.0).abs() < 1e-6, "{apart} m");
            let radius = pair[0].radius;
            assert!((2.0 * radius - 0.96 * apart).abs() < 1e-12, "{radius} m");
        }
    }

    #[test]
    #[allow(clippy::float_cmp)] // a limit of 0 is exact
    fn only_the_shoes_of_a_chain_on_wheels_rub_on_the_ground() {
        let robot = shared("engineer_sprocket_step").robot;
        let model = Model::new(&robot).expect("it is valid");
        let mut wheels = 0;
        for part in model.track_parts() {
            let is_wheel = !matches!(part.mount, Mount::Shoe(_));
            wheels += usize::from(is_wheel);
            let most = if is_wheel { 0.0 } else { f64::INFINITY };
            assert_eq!(part.friction_limit, most, "{:?}", part.kind);
        }
        assert!(wheels > 2, "{wheels} wheels");
    }
}
