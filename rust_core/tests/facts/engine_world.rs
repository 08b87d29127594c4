//! The same robot built of bodies, joints and motors in the engine's own dynamics.
//!
//! The engine shares nothing with this project's equations of motion but the contact geometry: its
//! wheels are bodies on revolute joints, each with its own velocity motor.

use crawler2d_core::{Checked, Ground, Model, Scenario, Shape, Simulation};
use rapier2d_f64::prelude::*;

/// A robot on wheels with motors of their own, in the engine.
pub struct EngineWorld {
    world: PhysicsWorld,
    chassis: RigidBodyHandle,
    motors: Vec<(ImpulseJointHandle, f64)>,
    set_point: f64,
    command: f64,
    acceleration: f64,
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
    /// The scenario in bodies; its robot must have wheels with motors of their own.
    ///
    /// # Panics
    /// If the scenario is not valid.
    pub fn new(scenario: &Scenario, settings: EngineSettings) -> Self {
        let robot = &scenario.robot;
        let model = Model::new(robot).expect("the scenario is valid");
        let ground =
            Ground::new(&scenario.terrain, scenario.robot.gauge).expect("the scenario is valid");
        let start = Simulation::new(&Checked::new(scenario).expect("the scenario is valid"));
        let start = start.reading().position;
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

        let friction = |c: ColliderBuilder| {
            c.friction(ground.lanes[0].friction)
                .friction_combine_rule(CoefficientCombineRule::Min)
        };
        let groups =
            |own: Group, other: Group| InteractionGroups::new(own, other, InteractionTestMode::And);
        let (of_ground, of_robot) = (Group::GROUP_1, Group::GROUP_2);
        let points: Vec<Vector> = ground.lanes[0].points.iter().rev().copied().collect();
        let profile = friction(ColliderBuilder::oriented_polyline(points, None));
        world.insert_collider(profile.collision_groups(groups(of_ground, of_robot)), None);
        let on_robot = |c: ColliderBuilder| {
            friction(c.density(0.0)).collision_groups(groups(of_robot, of_ground))
        };

        // The chassis takes what the wheels leave of mass, centre of mass and inertia.
        let (body, wheels) = model.bodies();
        let chassis = world.insert_body(
            RigidBodyBuilder::dynamic()
                .translation(start)
                .can_sleep(false)
                .additional_mass_properties(MassProperties::new(
                    body.center_of_mass,
                    body.mass,
                    body.moment_of_inertia,
                )),
        );
        for part in &model.parts {
            if let Shape::Polygon { corners } = &part.shape {
                let belly = ColliderBuilder::convex_polyline(corners.clone());
                world.insert_collider(on_robot(belly.expect("convex")), Some(chassis));
            }
        }
        let mut motors = Vec::new();
        for wheel in &wheels {
            let handle = world.insert_body(
                RigidBodyBuilder::dynamic()
                    .translation(start + wheel.center)
                    .can_sleep(false)
                    .additional_mass_properties(MassProperties::new(
                        Vector::ZERO,
                        wheel.mass,
                        wheel.moment_of_inertia,
                    )),
            );
            let collider = match &model.parts[wheel.part].shape {
                Shape::Gear { gear, .. } => {
                    let ball = (Pose::IDENTITY, SharedShape::ball(gear.root_radius));
                    let grousers = gear.directions().map(|direction| {
                        let corners = gear.corners(direction).to_vec();
                        let grouser = SharedShape::convex_polyline(corners);
                        (Pose::IDENTITY, grouser.expect("convex"))
                    });
                    ColliderBuilder::compound(std::iter::once(ball).chain(grousers).collect())
                }
                _ => ColliderBuilder::ball(wheel.radius),
            };
            world.insert_collider(on_robot(collider), Some(handle));
            let joint = RevoluteJointBuilder::new()
                .local_anchor1(wheel.center)
                .contacts_enabled(false)
                .motor_model(MotorModel::ForceBased)
                .motor_velocity(0.0, 1e4)
                .motor_max_force(model.drive_force * wheel.radius);
            let joint = world.insert_impulse_joint(chassis, handle, joint);
            motors.push((joint, wheel.radius));
        }
        Self {
            world,
            chassis,
            motors,
            set_point: 0.0,
            command: scenario.drive.speed,
            acceleration: robot.drivetrain.max_acceleration,
        }
    }

    /// Advances by one step of the bare engine.
    pub fn step(&mut self) {
        let dt = self.world.integration_parameters.dt;
        self.set_point = (self.set_point + self.acceleration * dt).min(self.command);
        for (handle, radius) in &self.motors {
            if let Some(joint) = self.world.impulse_joints.get_mut(*handle, false) {
                joint
                    .data
                    .set_motor_velocity(JointAxis::AngX, -self.set_point / radius, 1e4);
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
