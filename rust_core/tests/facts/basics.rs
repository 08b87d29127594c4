//! Weight, balance, equal robots, energy: what holds for every model.

use approx::assert_relative_eq;
use crawler2d_core::{Model, Scenario, Simulation, TorqueSharing, Track, Vector, Wheel};

use crate::common::*;

fn models() -> Vec<(&'static str, Track)> {
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

#[test]
fn robot_at_rest_carries_its_weight() {
    for (name, track) in models() {
        let mut scenario = engineer();
        scenario.robot.track = track;
        scenario.drive.speed = 0.0;
        let (_, fy, _) = contact_sums(&after(&scenario, 2.0), 0.0, 0.0);
        println!("{name}: {:+.1e} of the weight", fy / (21.2 * G) - 1.0);
        assert_relative_eq!(fy, 21.2 * G, max_relative = 1e-4);
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
    for (name, track) in models() {
        let mut scenario = engineer();
        scenario.robot.track = track;
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
    for (name, track) in models() {
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
            let force = model.motors as f64 * model.drive_force;
            assert_relative_eq!(force, 2.0 * 6.0 / 0.052, max_relative = 1e-9);
        }
    }
}

#[test]
fn chassis_and_wheels_together_are_the_robot() {
    for (name, track) in models() {
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

/// Contact forces against weight and inertia over a stretch of driving.
fn check_balance(scenario: &Scenario, name: &str) {
    let mut simulation = after(scenario, 0.5);
    let dt = simulation.time_step();
    let (mut worst, mut steps) = (0.0_f64, 0);
    let com = |s: &Simulation| {
        let (r, c) = (s.reading(), s.scenario().robot.center_of_mass);
        let (sine, cosine) = libm::sincos(r.chassis_angle);
        let arm = [cosine * c[0] - sine * c[1], sine * c[0] + cosine * c[1]];
        [
            r.velocity.x - r.angular_velocity * arm[1],
            r.velocity.y + r.angular_velocity * arm[0],
        ]
    };
    while simulation.time() < 1.5 {
        let before = com(&simulation);
        simulation.step().unwrap();
        let now = com(&simulation);
        let (fx, fy, _) = contact_sums(&simulation, 0.0, 0.0);
        let mass = scenario.robot.mass;
        let (ax, ay) = ((now[0] - before[0]) / dt, (now[1] - before[1]) / dt);
        worst = worst
            .max((fx - mass * ax).abs())
            .max((fy - mass * (ay + G)).abs());
        steps += 1;
    }
    println!(
        "{name}: worst residual {:.1e} of the weight over {steps} steps",
        worst / (21.2 * G)
    );
    assert!(worst < 1e-3 * 21.2 * G);
}

#[test]
fn contact_forces_sum_to_weight_and_inertia_on_flat_and_ramp() {
    for (name, track) in models() {
        if matches!(track, Track::Force(_)) {
            continue; // its push is no contact force
        }
        for angle in [0.0, 0.2] {
            let mut scenario = engineer();
            scenario.robot.track = track.clone();
            scenario.terrain = slope(angle, 0.9);
            scenario.start.angle = angle;
            scenario.drive.speed = 0.4;
            check_balance(&scenario, &format!("{name} at {angle} rad"));
        }
    }
}

#[test]
fn unpowered_robot_never_gains_energy() {
    let (mut draw, models) = (Draw(7), models());
    for case in 0..3 * models.len() {
        let mut scenario = engineer();
        scenario.robot.drivetrain.max_torque = 0.0;
        scenario.robot.track = models[case % models.len()].1.clone();
        let angle = draw.between(-0.4, 0.4);
        scenario.terrain = slope(angle, draw.between(0.0, 1.2));
        scenario.start.angle = angle;
        let mut simulation = after(&scenario, 0.0);
        let energy = |s: &Simulation| {
            let (r, robot) = (s.reading(), &s.scenario().robot);
            let model = Model::new(robot).expect("it can be built");
            let (sine, cosine) = libm::sincos(r.chassis_angle);
            let c = robot.center_of_mass;
            let arm = [cosine * c[0] - sine * c[1], sine * c[0] + cosine * c[1]];
            let v = [
                r.velocity.x - r.angular_velocity * arm[1],
                r.velocity.y + r.angular_velocity * arm[0],
            ];
            let spins: f64 = (0..s.drives())
                .map(|k| {
                    let spin = r.angular_velocity - s.drive_speed(k) / model.drive_radius;
                    0.5 * model.drive_masses[k] * (model.drive_radius * spin).powi(2)
                })
                .sum();
            0.5 * robot.mass * (v[0] * v[0] + v[1] * v[1])
                + 0.5 * model.moment_of_inertia * r.angular_velocity.powi(2)
                + spins
                + robot.mass * G * (r.position.y + arm[1])
        };
        let start = energy(&simulation);
        let mut highest = f64::NEG_INFINITY;
        while simulation.time() < 2.0 {
            simulation.step().unwrap();
            highest = highest.max(energy(&simulation));
        }
        // A tenth of a per cent of what it can fall: 21.2 kg through 1 m.
        assert!(
            highest <= start + 1e-3 * 21.2 * G,
            "case {case}: {start} J grew to {highest} J"
        );
    }
}
