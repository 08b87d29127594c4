//! The same robot built of bodies, joints and motors in the engine's own dynamics.
//!
//! The engine shares nothing with this project's equations of motion but the contact geometry: its
//! wheels are bodies on revolute joints, each with its own velocity motor.

use crawler2d_core::{Outcome, Scenario, TorqueSharing};
use rapier2d_f64::prelude::*;

use crate::common::*;

/// Wheels of their own motors before a step; the engine's world and the chassis in it.
fn world(scenario: &Scenario, count: u32, height: f64) -> (PhysicsWorld, RigidBodyHandle) {
    let robot = &scenario.robot;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -G);
    let p = &mut world.integration_parameters;
    p.dt = 5e-4;
    p.num_solver_iterations = 8;
    p.contact_recycling = false;
    p.normalized_prediction_distance = 0.005;
    p.normalized_allowed_linear_error = 1e-4;
    p.contact_softness = SpringCoefficients {
        natural_frequency: 240.0,
        damping_ratio: 5.0,
    };
    p.static_contact_softness = p.contact_softness;

    let ground = vec![
        Vector::new(10.0, height),
        Vector::new(0.0, height),
        Vector::new(0.0, 0.0),
        Vector::new(-10.0, 0.0),
    ];
    let friction = |c: ColliderBuilder| {
        c.friction(0.9)
            .friction_combine_rule(CoefficientCombineRule::Min)
    };
    world.insert_collider(
        friction(ColliderBuilder::oriented_polyline(ground, None)),
        None,
    );

    // The chassis takes what the wheels leave of mass, centre of mass and inertia.
    let (radius, half) = (robot.outline.rear_radius, 0.5 * robot.outline.axle_distance);
    let wheel_mass = robot.track_mass / f64::from(count);
    let wheel_inertia = wheel_mass * radius * radius;
    let axle = |i: u32| -half + f64::from(i) * 2.0 * half / f64::from(count - 1);
    let mass = robot.mass - robot.track_mass;
    let com = Vector::from(robot.center_of_mass) * (robot.mass / mass);
    let mut inertia = robot.moment_of_inertia - robot.track_mass * radius * radius;
    let total = Vector::from(robot.center_of_mass);
    inertia -= mass * (com - total).length_squared();
    for i in 0..count {
        inertia -= wheel_mass * (Vector::new(axle(i), 0.0) - total).length_squared();
    }
    let x = -scenario.start.approach - half - radius;
    let chassis = world.insert_body(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, radius))
            .can_sleep(false)
            .additional_mass_properties(MassProperties::new(com, mass, inertia)),
    );
    let belly: Vec<Vector> = robot
        .belly
        .iter()
        .flatten()
        .map(|c| Vector::new(c[0], c[1]))
        .collect();
    if let Some(collider) = ColliderBuilder::convex_polyline(belly) {
        let groups =
            InteractionGroups::new(Group::GROUP_1, Group::GROUP_2, InteractionTestMode::And);
        let belly =
            friction(collider.density(0.0)).collision_groups(groups.with_filter(Group::ALL));
        world.insert_collider(belly, Some(chassis));
    }
    let force = robot.drivetrain.max_force(&robot.outline) / f64::from(count);
    for i in 0..count {
        let center = Vector::new(axle(i), 0.0);
        let wheel = world.insert_body(
            RigidBodyBuilder::dynamic()
                .translation(Vector::new(x, radius) + center)
                .can_sleep(false)
                .additional_mass_properties(MassProperties::new(
                    Vector::ZERO,
                    wheel_mass,
                    wheel_inertia,
                )),
        );
        let groups =
            InteractionGroups::new(Group::GROUP_2, Group::GROUP_3, InteractionTestMode::And);
        let ball = friction(ColliderBuilder::ball(radius).density(0.0));
        world.insert_collider(
            ball.collision_groups(groups.with_filter(Group::ALL ^ Group::GROUP_2 ^ Group::GROUP_1)),
            Some(wheel),
        );
        let joint = RevoluteJointBuilder::new()
            .local_anchor1(center)
            .contacts_enabled(false)
            .motor_model(MotorModel::ForceBased)
            .motor_velocity(0.0, 1e4)
            .motor_max_force(force * radius);
        world.insert_impulse_joint(chassis, wheel, joint);
    }
    (world, chassis)
}

/// Final x, y [m] and angle [rad] of the chassis in the engine after so many seconds.
fn run_engine(scenario: &Scenario, count: u32, height: f64, duration: f64) -> [f64; 3] {
    let (mut world, chassis) = world(scenario, count, height);
    let mut speed: f64 = 0.0;
    let dt = world.integration_parameters.dt;
    let joints: Vec<_> = world.impulse_joints().map(|(handle, _)| handle).collect();
    for _ in 0..(duration / dt).round() as u64 {
        speed = (speed + scenario.robot.drivetrain.max_acceleration * dt).min(scenario.drive.speed);
        for handle in &joints {
            if let Some(joint) = world.impulse_joints.get_mut(*handle, false) {
                joint.data.set_motor_velocity(
                    JointAxis::AngX,
                    -speed / scenario.robot.outline.rear_radius,
                    1e4,
                );
            }
        }
        world.step();
        assert!(world.quarantine().is_empty());
    }
    let body = &world.bodies[chassis];
    [
        body.translation().x,
        body.translation().y,
        body.rotation().angle(),
    ]
}

#[test]
fn engine_s_own_dynamics_agree_on_who_climbs_and_where_it_stops() {
    for (count, height) in [
        (3, 0.05),
        (3, 0.125),
        (4, 0.05),
        (5, 0.05),
        (5, 0.1),
        (9, 0.05),
        (9, 0.1),
    ] {
        let mut scenario = engineer();
        scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
        scenario.robot.drivetrain.max_torque = 20.0;
        scenario.robot.track = line(count);
        scenario.terrain = step(height, 0.9);
        scenario.duration = 6.0;
        scenario.criteria.clear_time = 100.0; // run on to the same instant
        let ours = summary(&scenario);
        let theirs = run_engine(&scenario, count, height, ours.metrics.time);
        let own = [
            ours.metrics.final_x,
            ours.metrics.final_y,
            ours.metrics.final_angle,
        ];
        println!(
            "{count} wheels, {height} m: {} {own:.4?}, the engine's bodies {theirs:.4?}",
            ours.outcome
        );
        let _ = Outcome::Cleared;
    }
}
