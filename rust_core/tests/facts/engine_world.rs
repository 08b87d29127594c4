//! The same robot built of bodies, joints and motors in the engine's own dynamics.
//!
//! The engine shares nothing with this project's equations of motion but the contact geometry: its
//! wheels are bodies on revolute joints, each with its own velocity motor.

use crawler2d_core::Scenario;
use rapier2d_f64::prelude::*;

/// A line of wheels with motors of their own before a step, in the engine.
pub struct EngineWorld {
    world: PhysicsWorld,
    chassis: RigidBodyHandle,
    motors: Vec<ImpulseJointHandle>,
    set_point: f64,
    command: f64,
    acceleration: f64,
    radius: f64,
}

/// How finely the engine steps.
#[derive(Clone, Copy)]
pub struct EngineSettings {
    /// [s] Time of a step.
    pub time_step: f64,
    /// Substeps of a step.
    pub substeps: usize,
}

impl EngineWorld {
    /// The scenario's robot on `count` wheels before a step of `height` [m].
    pub fn new(scenario: &Scenario, count: u32, height: f64, settings: EngineSettings) -> Self {
        let robot = &scenario.robot;
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -scenario.gravity);
        let p = &mut world.integration_parameters;
        p.dt = settings.time_step;
        p.num_solver_iterations = settings.substeps;
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
                ball.collision_groups(
                    groups.with_filter(Group::ALL ^ Group::GROUP_2 ^ Group::GROUP_1),
                ),
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
        let motors = world.impulse_joints().map(|(handle, _)| handle).collect();
        Self {
            world,
            chassis,
            motors,
            set_point: 0.0,
            command: scenario.drive.speed,
            acceleration: robot.drivetrain.max_acceleration,
            radius,
        }
    }

    /// Advances by one step of the bare engine.
    pub fn step(&mut self) {
        let dt = self.world.integration_parameters.dt;
        self.set_point = (self.set_point + self.acceleration * dt).min(self.command);
        for handle in &self.motors {
            if let Some(joint) = self.world.impulse_joints.get_mut(*handle, false) {
                joint
                    .data
                    .set_motor_velocity(JointAxis::AngX, -self.set_point / self.radius, 1e4);
            }
        }
        self.world.step();
    }

    /// Position x, y [m] and angle [rad] of the chassis.
    pub fn pose(&self) -> [f64; 3] {
        let body = &self.world.bodies[self.chassis];
        [
            body.translation().x,
            body.translation().y,
            body.rotation().angle(),
        ]
    }
}
