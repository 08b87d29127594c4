//! Weight, balance, equal robots, energy: what holds for every model.

use approx::assert_relative_eq;
use crawler2d_core::{Model, Scenario, TorqueSharing, Track, Vector, Wheel};

use crate::common::*;

/// Models that are one body with its wheels or its belt, which need no more than a track.
fn one_body() -> Vec<(&'static str, Track)> {
    vec![
        ("belt", belt()),
        ("force", force()),
        ("line of 3", line(3)),
        ("line of 5", line(5)),
        ("line of 9", line(9)),
        ("line of 3 gear", line_of(3, paper_gear())),
        ("24 round the outline", circumferential(24, Wheel::Round)),
        (
            "24 gear round the outline",
            circumferential(24, paper_gear()),
        ),
        ("hybrid", hybrid(Wheel::Round)),
        ("hybrid gear", hybrid(paper_gear())),
        ("force on wheels", force_on_wheels()),
    ]
}

/// Every model, those of which more moves over the chassis, too.
pub(crate) fn models() -> impl Iterator<Item = (&'static str, Scenario)> {
    let one_body = one_body().into_iter();
    one_body
        .map(|(name, track)| (name, engineer_on(track)))
        .chain(articulated())
}

#[test]
fn robot_at_rest_carries_its_weight() {
    for (name, mut scenario) in models() {
        scenario.drive.speed = 0.0;
        let mut simulation = after(&scenario, 2.0);
        let mut lift = 0.0;
        while simulation.time() < 2.5 {
            simulation.step().expect("finite");
            lift += contact_sums(&simulation, 0.0, 0.0).1 * simulation.last_step();
        }
        lift /= simulation.time() - 2.0;
        println!("{name}: {:+.1e} of the weight", lift / (21.2 * G) - 1.0);
        // Shoes settle on their guide for seconds.
        let limit = if is_on_chain(&scenario) { 1e-3 } else { 1e-4 };
        assert_relative_eq!(lift, 21.2 * G, max_relative = limit);
    }
}

#[test]
fn two_axles_share_the_weight_by_their_levers() {
    let mut scenario = engineer();
    scenario.robot.track = line(2);
    scenario.robot.center_of_mass = [0.05, 0.02];
    scenario.drive.speed = 0.0;
    let contacts = after(&scenario, 2.0).contact_table();
    let front = 21.2 * G * (0.1825 + 0.05) / 0.365;
    let found = contacts.normal_force[contacts.body.iter().position(|b| *b == 1).unwrap()];
    println!("front axle {found:.4} N, closed form {front:.4} N");
    assert_relative_eq!(found, front, max_relative = 1e-3);
}

#[test]
fn resting_penetration_is_below_a_fifth_of_a_millimetre() {
    for (name, mut scenario) in models() {
        scenario.drive.speed = 0.0;
        let deepest = after(&scenario, 2.0)
            .contact_table()
            .penetration
            .iter()
            .copied()
            .fold(0.0, f64::max);
        println!("{name}: {:.4} mm", 1e3 * deepest);
        assert!(deepest < 2e-4);
    }
}

#[test]
fn every_model_is_the_same_robot() {
    let reference = Model::new(&engineer().robot).expect("it can be built");
    let turning = |m: &Model| m.drive_masses.iter().sum::<f64>() * m.drive_radius * m.drive_radius;
    for (name, track) in one_body() {
        for sharing in [TorqueSharing::Track, TorqueSharing::Wheel] {
            let mut robot = engineer().robot;
            let driven = !matches!(track, Track::Belt(_) | Track::Force(_));
            if sharing == TorqueSharing::Wheel && !driven {
                continue;
            }
            robot.track = track.clone();
            robot.drivetrain.torque_sharing = sharing;
            let model = Model::new(&robot).expect("it can be built");
            assert_relative_eq!(model.mass, reference.mass, max_relative = 1e-9);
            assert!(
                (model.center_of_mass - reference.center_of_mass).length() < 1e-9,
                "{name}"
            );
            let total = model.moment_of_inertia + turning(&model);
            assert_relative_eq!(total, robot.moment_of_inertia, max_relative = 1e-9);
            assert_relative_eq!(turning(&model), turning(&reference), max_relative = 1e-9);
            assert_relative_eq!(
                model.drive_masses.iter().sum::<f64>(),
                robot.track_mass,
                max_relative = 1e-9
            );
            let force = model.motors as f64 * model.motor.force;
            assert_relative_eq!(force, 2.0 * 6.0 / 0.052, max_relative = 1e-9);
        }
    }
}

#[test]
fn chassis_and_wheels_together_are_the_robot() {
    for (name, track) in one_body() {
        let mut robot = engineer().robot;
        robot.track = track;
        let (chassis, wheels) = Model::new(&robot).expect("it can be built").bodies();
        let mass = chassis.mass + wheels.iter().map(|w| w.mass).sum::<f64>();
        let moment = wheels
            .iter()
            .map(|w| w.center * w.mass)
            .fold(chassis.center_of_mass * chassis.mass, |sum, m| sum + m);
        let com = Vector::from(robot.center_of_mass);
        let about = |center: Vector| (center - com).length_squared();
        let inertia = chassis.moment_of_inertia
            + chassis.mass * about(chassis.center_of_mass)
            + wheels
                .iter()
                .map(|w| w.moment_of_inertia + w.mass * about(w.center))
                .sum::<f64>();
        let reflected: f64 = wheels
            .iter()
            .map(|w| w.moment_of_inertia / (w.radius * w.radius))
            .sum();
        assert_relative_eq!(mass, robot.mass, max_relative = 1e-9);
        assert!((moment / mass - com).length() < 1e-9, "{name}");
        if !wheels.is_empty() {
            assert_relative_eq!(reflected, robot.track_mass, max_relative = 1e-9);
            assert_relative_eq!(inertia, robot.moment_of_inertia, max_relative = 1e-9);
        }
    }
}

/// Arms and shoes have their masses and moments of inertia from the robot's: together with the chassis they are
/// the robot with its arms at angle 0; arms that turn move its centre of mass.
#[test]
fn every_robot_weighs_what_it_is_given_where_it_is_given() {
    for (name, mut scenario) in models() {
        let robot = scenario.robot.clone();
        let given = Vector::from(robot.center_of_mass);
        let mass = Model::new(&robot).expect("it can be built").total_mass();
        assert_relative_eq!(mass, robot.mass, max_relative = 1e-12);
        let angles = if robot.flippers.is_some() {
            vec![0.0, 0.7, -0.4]
        } else {
            vec![0.0]
        };
        for angle in angles {
            let mut moved = Vector::ZERO;
            if let Some(arms) = &mut scenario.robot.flippers {
                arms.angle = angle;
                let (s, c) = libm::sincos(angle);
                // Those in front and those at the rear move towards each other, and all upwards.
                let both = Vector::new(0.0, 2.0 * s) * 0.5 * arms.length;
                moved = both * (2.0 * arms.mass / robot.mass);
                assert!(c > 0.0);
            }
            let simulation = after(&scenario, 0.0);
            let center = simulation.center_of_mass() - simulation.reading().position;
            println!(
                "{name} at {angle} rad: centre of mass {center}, inertia {:.6}",
                simulation.moment_of_inertia()
            );
            assert!((center - given - moved).length() < 1e-9);
            if angle == 0.0 {
                let inertia = simulation.moment_of_inertia();
                assert_relative_eq!(inertia, robot.moment_of_inertia, max_relative = 1e-9);
            }
        }
    }
}

/// Contact forces against weight and inertia over a second of driving: the worst step, as a share of the weight and
/// the forces in it, and the mean, as a share of the weight.
fn imbalance(scenario: &Scenario) -> (f64, f64) {
    let mut simulation = after(scenario, 1.0);
    let weight = scenario.robot.mass * G;
    let (mut worst, mut sum) = (0.0_f64, Vector::ZERO);
    while simulation.time() < 1.5 {
        let before = simulation.momentum();
        simulation.step().expect("finite");
        let (fx, fy, _) = contact_sums(&simulation, 0.0, 0.0);
        let dt = simulation.last_step();
        let off = Vector::new(fx, fy - weight) - (simulation.momentum() - before) / dt;
        // An impact of 20 us is a large force.
        let forces = weight + fx.hypot(fy);
        worst = worst.max(off.length() / forces);
        sum += off * dt;
    }
    let mean = sum / (simulation.time() - 1.0);
    (worst, mean.x.abs().max(mean.y.abs()) / weight)
}

#[test]
fn contact_forces_sum_to_weight_and_inertia_on_flat_and_ramp() {
    for (name, mut scenario) in models() {
        if matches!(scenario.robot.track, Track::Force(_)) {
            continue; // its push is no contact force
        }
        for angle in [0.0, 0.2] {
            scenario.terrain = slope(angle, 0.9);
            scenario.start.angle = angle;
            let (worst, mean) = imbalance(&scenario);
            println!(
                "{name} at {angle} rad: {worst:.1e} of the weight at worst, {mean:.1e} in the mean"
            );
            // Velocities follow from the impulses: only rounding is left.
            assert!(worst < 1e-10 && mean < 1e-11, "{name}");
        }
    }
}
