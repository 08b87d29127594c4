//! However a robot is divided, its mass, centre of mass and moment of inertia are those of the scenario.

mod arms_and_lanes;
mod chains;

use approx::assert_relative_eq;

use super::outline::Body;
use super::{BodyKind, ChainOfShoes, Model, MotorRule, Mount, Part, Shape, start_position};
use crate::geometry::{Pose, Rotation, Vector};
use crate::scenario::{
    ClosedSurface, ClosedTrack, Ends, HybridWheels, LineOfWheels, Pi, Robot, Surface, Terrain,
    Track, Wheel, shared,
};
use crate::terrain::Ground;

/// A sum of bodies.
#[derive(Default)]
struct Sum {
    mass: f64,
    moment: Vector,
    about_origin: f64,
}

impl Sum {
    fn add(&mut self, mass: f64, place: Vector, inertia: f64) {
        self.mass += mass;
        self.moment += place * mass;
        self.about_origin += inertia + mass * place.length_squared();
    }

    fn center(&self) -> Vector {
        self.moment / self.mass
    }

    fn inertia(&self) -> f64 {
        self.about_origin - self.mass * self.center().length_squared()
    }

    fn check(&self, robot: &Robot) {
        assert_relative_eq!(self.mass, robot.mass, max_relative = 1e-13);
        let off = self.center() - Vector::from(robot.center_of_mass);
        assert!(off.length() < 1e-14, "{off} m");
        assert_relative_eq!(
            self.inertia(),
            robot.moment_of_inertia,
            max_relative = 1e-12
        );
    }
}

/// All bodies of a model, with its arms at an angle of 0.
fn whole(model: &Model) -> Sum {
    let mut sum = Sum::default();
    let turning: f64 = (0..model.drives).map(|k| model.drive_inertia(k)).sum();
    let of_chassis = model.moment_of_inertia + turning;
    sum.add(model.mass, model.center_of_mass, of_chassis);
    for arm in &model.flippers {
        sum.add(arm.mass, arm.pivot + arm.arm, arm.moment_of_inertia);
    }
    for chain in &model.chains {
        for place in chain.path.places(0.0) {
            sum.add(chain.shoe_mass, place.translation, chain.shoe_inertia);
        }
        let of_sprocket = chain.sprocket.as_ref().map_or(0.0, |s| s.inertia);
        sum.add(0.0, Vector::ZERO, of_sprocket);
    }
    sum
}

/// The Engineer on every track model.
fn on_all_tracks() -> Vec<Robot> {
    let names = [
        "engineer_belt_step",
        "engineer_chain_step",
        "engineer_force_step",
        "engineer_gear3_step",
        "engineer_grouser_belt_step",
        "engineer_hybrid_step",
        "engineer_sprocket_step",
    ];
    names.map(|name| shared(name).robot).to_vec()
}

/// The same with arms at both ends, at an angle [rad].
fn on_arms(angle: f64) -> Vec<Robot> {
    let mut flippers = shared("engineer_flippers_step")
        .robot
        .flippers
        .expect("it has some");
    (flippers.ends, flippers.angle) = (Ends::Both, angle);
    let mut robots = on_all_tracks();
    for robot in &mut robots {
        robot.flippers = Some(flippers.clone());
        robot.moment_of_inertia = 1.0;
    }
    robots
}

/// With each track on its own ground.
fn on_two_lanes(robot: &Robot) -> Model {
    let mut ground =
        Ground::new(&shared("engineer_belt_step").terrain, robot.gauge).expect("it is ground");
    let lane = ground.lanes.remove(0);
    let ground = Ground::apart([lane.clone(), lane], None, ground.goal).expect("they overlap");
    Model::on(robot, &ground).expect("it is valid")
}

/// With its track closed.
fn closed(robot: &Robot, surface: ClosedSurface) -> Robot {
    let of = Box::new(robot.track.clone());
    Robot {
        track: Track::Closed(ClosedTrack { of, surface }),
        ..robot.clone()
    }
}

fn model(robot: &Robot) -> Model {
    Model::new(robot).expect("it is valid")
}

/// [N] Largest force of all motors of its tracks.
fn force(model: &Model) -> f64 {
    model.motor.force * model.motors as f64
}

#[test]
fn all_bodies_together_are_the_robot() {
    for robot in on_all_tracks().iter().chain(&on_arms(0.0)) {
        for model in [model(robot), on_two_lanes(robot)] {
            whole(&model).check(robot);
            whole(&model.with_circulating_mass()).check(robot);
            assert_relative_eq!(model.total_mass(), robot.mass, max_relative = 1e-14);
        }
    }
}

#[test]
fn a_closed_track_has_mass_and_force_of_the_one_that_it_closes() {
    for robot in on_all_tracks() {
        let open = model(&robot);
        let closed = closed(&robot, ClosedSurface::Own);
        for model in [model(&closed), on_two_lanes(&closed)] {
            whole(&model).check(&robot);
            assert_relative_eq!(force(&model), force(&open), max_relative = 1e-14);
            assert!(model.chains.is_empty() && !model.pushes_chassis);
        }
    }
}

#[test]
fn two_sides_have_all_of_what_is_shared() {
    for robot in on_all_tracks().iter().chain(&on_arms(0.0)) {
        let (whole, sides) = (model(robot), on_two_lanes(robot));
        assert_relative_eq!(force(&sides), force(&whole), max_relative = 1e-14);
        let pre_tension = |model: &Model| -> f64 {
            let of_chains = model.chains.iter().map(|chain| chain.tensioner.pre_tension);
            of_chains.sum()
        };
        assert_relative_eq!(pre_tension(&sides), pre_tension(&whole));
        let numbers: Vec<usize> = sides.chains.iter().map(|chain| chain.number).collect();
        assert_eq!(numbers, (0..2 * whole.chains.len()).collect::<Vec<_>>());
        // Each surface turns with one drive, each drive has a surface.
        let mut drives: Vec<usize> = sides.parts.iter().filter_map(|part| part.drive).collect();
        drives.sort_unstable();
        drives.dedup();
        assert_eq!(
            drives.len(),
            sides.drives - usize::from(sides.pushes_chassis)
        );
    }
}

#[test]
fn chassis_and_wheels_are_the_robot() {
    for robot in on_all_tracks() {
        let model = model(&robot);
        if !model.is_one_body() {
            continue;
        }
        let (chassis, wheels) = model.bodies();
        let turns = |part: &&Part| matches!(part.shape, Shape::Disc { .. } | Shape::Gear { .. });
        assert_eq!(wheels.len(), model.parts.iter().filter(turns).count());
        let mut sum = Sum::default();
        sum.add(
            chassis.mass,
            chassis.center_of_mass,
            chassis.moment_of_inertia,
        );
        for wheel in &wheels {
            sum.add(wheel.mass, wheel.center, wheel.moment_of_inertia);
        }
        sum.check(&robot);
        let turning: f64 = wheels
            .iter()
            .map(|wheel| wheel.moment_of_inertia / (wheel.radius * wheel.radius))
            .sum();
        if !wheels.is_empty() {
            assert_relative_eq!(turning, robot.track_mass, max_relative = 1e-13);
        }
        for wheel in wheels {
            if let Shape::Disc { .. } = model.parts[wheel.part].shape {
                // A uniform disc.
                let of_disc = 0.5 * wheel.mass * wheel.radius * wheel.radius;
                assert_relative_eq!(wheel.moment_of_inertia, of_disc, max_relative = 1e-13);
                let area = std::f64::consts::PI * wheel.radius.powi(2);
                assert_relative_eq!(wheel.area, area, max_relative = 1e-15);
            }
            let side = wheel.clone().of_one_side();
            assert_relative_eq!(2.0 * side.mass, wheel.mass);
            assert_relative_eq!(2.0 * side.moment_of_inertia, wheel.moment_of_inertia);
        }
    }
}

#[test]
fn raised_arms_carry_the_centre_of_mass_along() {
    let angle = 0.8;
    for robot in on_arms(angle) {
        let model = model(&robot);
        let (mass, center) = model.mass_center(&model.running_at_start(0.0));
        let mut sum = whole(&model);
        for arm in &model.flippers {
            let raised = Rotation::new(arm.sign() * angle) * arm.arm;
            sum.moment += (raised - arm.arm) * arm.mass;
        }
        assert_relative_eq!(mass, robot.mass, max_relative = 1e-14);
        assert!((center - sum.center()).length() < 1e-14);
        let fixed = model.as_one_body(&model.running_at_start(0.0));
        assert!((fixed.center_of_mass - center).length() < 1e-14);
    }
}

#[test]
fn nothing_reaches_farther_than_the_tip_of_an_arm() {
    for robot in on_arms(0.0) {
        let model = model(&robot);
        let flippers = robot.flippers.as_ref().expect("it has some");
        let reach = model.flippers.iter().map(|arm| {
            let to_pivot = (arm.pivot - model.center_of_mass).length();
            to_pivot + flippers.length + flippers.tip_radius
        });
        assert_relative_eq!(model.reach(), reach.fold(0.0, f64::max));
        let mut large = robot.clone();
        let arms = large.flippers.as_mut().expect("it has some");
        arms.track = Some(Track::Line(LineOfWheels {
            count: 2,
            wheel_radius: Some(2.0 * arms.tip_radius),
            wheel: Wheel::Round,
            as_track: true,
        }));
        let more = self::model(&large).reach() - model.reach();
        assert_relative_eq!(more, flippers.tip_radius, max_relative = 1e-12);
        let arms = large.flippers.as_mut().expect("it has some");
        large.track = arms.track.take().expect("it was given");
        let open = self::model(&large).reach();
        large.track = Track::Closed(ClosedTrack {
            of: Box::new(large.track),
            surface: ClosedSurface::Own,
        });
        assert_relative_eq!(self::model(&large).reach(), open);
    }
    for robot in on_all_tracks() {
        let model = model(&robot);
        let far = model
            .track_parts()
            .flat_map(|part| part.discs().collect::<Vec<_>>());
        let far = far.map(|(tip, _)| (tip.center - model.center_of_mass).length() + tip.radius);
        let far = far.fold(0.0, f64::max);
        assert!(model.reach() >= far, "{} m, {far} m", model.reach());
        assert!(model.reach() < far + 0.05, "{} m, {far} m", model.reach());
    }
}

/// Arms count from their pivots, whatever their frames, whose origins are in their middles.
#[test]
fn rear_arms_far_ahead_of_the_centre_of_mass_reach_no_farther_than_the_front_wheel() {
    let mut robot = on_arms(0.0).remove(0);
    let arms = robot.flippers.as_mut().expect("it has some");
    (arms.ends, arms.length) = (Ends::Rear, 0.38);
    let mut model = model(&robot);
    model.center_of_mass = Vector::new(-1.0, 0.0);
    let of_chassis = model
        .parts
        .iter()
        .filter(|part| part.mount == Mount::Chassis);
    let discs = of_chassis.flat_map(|part| part.discs().collect::<Vec<_>>());
    let far = discs.map(|(tip, _)| tip.center.x + 1.0 + tip.radius);
    assert_relative_eq!(model.reach(), far.fold(0.0, f64::max), max_relative = 1e-12);
}

#[test]
fn a_track_runs_round_wheels_that_stand_for_one() {
    let mut robot = on_arms(0.0).remove(3);
    for as_track in [true, false] {
        let Track::Line(line) = &mut robot.track else {
            panic!("it is a line")
        };
        line.as_track = as_track;
        let model = model(&robot);
        assert!(
            model
                .mounts()
                .all(|mount| model.has_track(mount) == as_track)
        );
    }
}

/// Values at the belt are those of one sprocket, times two, divided by the radius once for torque and once for rate.
#[test]
fn motors_are_seen_from_the_belt() {
    let mut robot = on_all_tracks().remove(0);
    let radius = robot.outline.belt_radius();
    robot.drivetrain.rotor_inertia = 0.01;
    robot.drivetrain.controller = Some(Pi {
        gain: 3.0,
        integral: 40.0,
    });
    let rule = MotorRule::of(&robot.drivetrain, &robot.outline);
    let correction = rule.correction.expect("it corrects its speed");
    let at_belt = 2.0 / (radius * radius);
    assert_relative_eq!(rule.force, 2.0 * robot.drivetrain.max_torque / radius);
    assert_relative_eq!(rule.rotor_mass, 0.01 * at_belt);
    assert_relative_eq!(correction.gain, 3.0 * at_belt);
    assert_relative_eq!(correction.integral, 40.0 * at_belt);
    assert!(rule.depends_on_speed());
    for robot in [robot.clone(), on_all_tracks().remove(0)] {
        let model = model(&robot);
        let rotors: f64 = (0..model.drives).map(|k| model.rotor_inertia(k)).sum();
        // At a speed of the surface a rotor turns with the sprocket, at the belt's radius.
        let at_surface = rotors / (model.drive_radius * model.drive_radius);
        let rotors = robot.drivetrain.rotor_inertia * at_belt;
        assert_relative_eq!(at_surface, rotors, max_relative = 1e-12);
        assert_eq!(
            model.motor.depends_on_speed(),
            robot.drivetrain.controller.is_some()
        );
    }
    // The error at the end, and the sum of errors up to there by the rule of the trapezoid.
    let (speed, target, error, sum, time) = (0.35, 0.4, 0.08, 7.0, 1e-3);
    let force = correction.force(target, error, sum, time);
    let errors = 0.5 * time * (error + (target - speed));
    let expected = correction.gain * (target - speed) + correction.integral * errors + sum;
    assert_relative_eq!(
        force.at_rest - force.slope * speed,
        expected,
        max_relative = 1e-12
    );
}

/// The lower run of its belt joins wheels that are not neighbours in the list, and covers a higher one.
#[test]
fn a_closed_track_starts_on_what_is_highest_below_its_hull() {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.belly = None;
    scenario.terrain = Terrain::Points {
        points: vec![
            [-3.0, 0.0],
            [-0.31, 0.0],
            [-0.30, 0.02],
            [-0.29, 0.0],
            [0.0, 0.0],
            [0.0, 0.02],
            [3.0, 0.02],
        ],
        goal: 0.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
    let placements = vec![[-0.15, 0.0, 0.06], [0.0, 0.0, 0.03], [0.15, 0.0, 0.06]];
    scenario.robot.track = Track::Closed(ClosedTrack {
        of: Box::new(Track::Hybrid(HybridWheels {
            placements,
            wheel: Wheel::Round,
        })),
        surface: ClosedSurface::Own,
    });
    let model = model(&scenario.robot);
    let start = start_position(&scenario, &model, &ground).expect("it fits");
    assert!((start.x + 0.3).abs() < 0.15, "its run is above the ridge");
    assert_relative_eq!(start.y, 0.02 + 0.06, max_relative = 1e-12);
}

#[test]
fn a_closed_track_has_grousers_as_high_as_the_track_that_it_closes() {
    for robot in on_all_tracks() {
        let heights = |surface| {
            let closed = closed(&robot, surface);
            let of_part = |part: &Part| match part.shape {
                Shape::Hull { grouser_height, .. } => grouser_height,
                _ => 0.0,
            };
            let model = model(&closed);
            model.parts.iter().map(of_part).fold(0.0, f64::max)
        };
        let own = if robot.track.has_grousers() {
            robot.outline.grouser_height
        } else {
            0.0
        };
        assert_relative_eq!(heights(ClosedSurface::Own), own, epsilon = 1e-12);
        assert!(heights(ClosedSurface::Smooth) < 1e-15);
    }
}

#[test]
fn a_closed_track_covers_a_belly_that_lies_inside_it() {
    let mut robot = on_all_tracks().remove(0);
    // The outline reaches up to 0.064 m.
    for (top, count) in [(0.06, 0), (0.07, 1)] {
        robot.belly = Some(vec![[-0.1, 0.0], [0.1, 0.0], [0.0, top]]);
        let closed = model(&closed(&robot, ClosedSurface::Own));
        assert_eq!(closed.belly().count(), count, "up to {top} m");
    }
}

#[test]
fn a_belt_on_an_arm_has_its_sprocket_at_the_pivot() {
    let model = model(&on_arms(0.3)[0]);
    let running = model.running_at_start(0.0);
    let mut sprockets = 0;
    for body in model.outlines() {
        let (BodyKind::Sprocket, Mount::Flipper(k)) = (body.kind, body.mount) else {
            continue;
        };
        sprockets += 1;
        let (origin, _) = body.place(&model, &running);
        let mount = running.mounted(body.mount, Pose::IDENTITY);
        let off = mount.transform_point(origin) - model.flippers[k].pivot;
        assert!(off.length() < 1e-15, "arm {k}: {off} m");
        assert_relative_eq!(body.radius.expect("it is round"), 0.064);
    }
    assert_eq!(sprockets, 2);
}

/// 180 chords of a circle: its area is smaller by a share of 2/3 (pi/180)^2.
#[test]
fn a_wheel_is_drawn_as_a_circle() {
    let robot = on_all_tracks().remove(5);
    let model = model(&robot);
    let mut wheels = 0;
    for body in model.outlines() {
        let Some(radius) = body.radius else { continue };
        wheels += 1;
        for corner in &body.outline {
            assert_relative_eq!(corner.length(), radius, max_relative = 1e-14);
        }
        let next = body.outline.iter().cycle().skip(1);
        let pairs = body.outline.iter().zip(next);
        let area: f64 = pairs.map(|(a, b)| 0.5 * (a.x * b.y - a.y * b.x)).sum();
        let circle = std::f64::consts::PI * radius * radius;
        assert_relative_eq!(area, circle, max_relative = 3e-4);
    }
    let Track::Hybrid(placed) = &robot.track else {
        panic!("it is hybrid")
    };
    assert_eq!(wheels, placed.placements.len());
}

#[test]
fn a_belly_may_reach_farther_than_any_track() {
    let mut robot = on_all_tracks().remove(0);
    robot.belly = Some(vec![[-0.1, 0.1], [0.1, 0.1], [0.1, 0.7], [-0.1, 0.7]]);
    let model = model(&robot);
    let far = [-0.1, 0.1].map(|x| (Vector::new(x, 0.7) - model.center_of_mass).length());
    assert_relative_eq!(model.reach(), far[0].max(far[1]));
}

#[test]
fn two_chains_have_half_of_each_spring_damper_and_wheel() {
    let mut robot = on_all_tracks().remove(6);
    let Track::Segmental(chain) = &mut robot.track else {
        panic!("it is a chain")
    };
    (chain.pin_stiffness, chain.pin_damping) = (2.0, 0.01);
    let (whole, sides) = (model(&robot), on_two_lanes(&robot));
    let whole = &whole.chains[0];
    for side in &sides.chains {
        let inertia = |chain: &ChainOfShoes| chain.sprocket.as_ref().map_or(0.0, |s| s.inertia);
        for (of_side, of_both) in [
            (side.bushing.stiffness, whole.bushing.stiffness),
            (side.bushing.damping, whole.bushing.damping),
            (side.tensioner.stiffness, whole.tensioner.stiffness),
            (side.tensioner.damping, whole.tensioner.damping),
            (inertia(side), inertia(whole)),
        ] {
            assert!(of_both > 0.0);
            assert_relative_eq!(2.0 * of_side, of_both);
        }
        assert_relative_eq!(side.tensioner.stop, whole.tensioner.stop);
    }
}

/// A track that has run by the radius of a wheel has turned it by 1 rad, clockwise.
#[test]
fn what_a_track_runs_round_turns_with_it() {
    let robots = on_all_tracks();
    for (robot, belt) in [(&robots[0], true), (&robots[6], false)] {
        let model = model(robot);
        let radius = if belt { 0.064 } else { model.drive_radius };
        let [before, after] = [0.0, radius].map(|run| model.running_at_start(run));
        let is_sprocket = |body: &&Body| body.kind == BodyKind::Sprocket;
        let bodies = model.outlines();
        let sprocket = bodies.iter().find(is_sprocket).expect("it has one");
        let turned = sprocket.place(&model, &after).1 - sprocket.place(&model, &before).1;
        assert_relative_eq!(turned, -1.0, max_relative = 1e-12);
        let farthest = sprocket
            .outline
            .iter()
            .map(|c| c.length())
            .fold(0.0, f64::max);
        assert!(farthest > 0.04 && farthest < 0.064 + 1e-9, "{farthest} m");
    }
}
