//! Runs the bare engine on one of the scenes of `benches/peers`: reads a job as JSON, writes its results.

use std::io;
use std::time::Instant;

use rapier2d_f64::prelude::*;
use serde::{Deserialize, Serialize};

/// A job.
#[derive(Deserialize)]
struct Job {
    scene: Scene,
    settings: Settings,
    /// [s] Simulated time.
    duration: f64,
    /// Steps between two recorded poses; 0 records none.
    sample_every: usize,
}

/// Steps of the engine, and kind of ground.
#[derive(Deserialize)]
struct Settings {
    /// [s] Time of a step.
    time_step: f64,
    substeps: usize,
    /// Internal solver iterations per substep.
    iterations: usize,
    /// Whether lengths and stiffness suit parts of a few millimetres, or are the engine's defaults.
    tuned: bool,
    ground: GroundKind,
}

/// The kind of ground.
#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum GroundKind {
    /// The scene's boxes.
    Boxes,
    /// The outline of their union, one-sided.
    Profile,
}

/// The scene, as in `benches/adapters/planar.py`.
#[derive(Deserialize)]
struct Scene {
    bodies: Vec<Body>,
    joints: Vec<Pin>,
    boxes: Vec<Polygon>,
    friction: f64,
    /// [m] Upper outline of the ground, from left to right.
    profile: Polygon,
}

/// [m] Corners.
type Polygon = Vec<[f64; 2]>;

#[derive(Deserialize)]
struct Body {
    x: f64,
    y: f64,
    angle: f64,
    mass: f64,
    inertia: f64,
    /// [m] Radius of its circle, 0 without a circle.
    radius: f64,
    polygons: Vec<Polygon>,
}

/// A pin with a motor.
#[derive(Deserialize)]
struct Pin {
    a: usize,
    b: usize,
    pa: [f64; 2],
    pb: [f64; 2],
    /// [rad/s] Speed of b relative to a.
    speed: f64,
    /// [N m] Torque limit.
    torque: f64,
}

/// The results.
#[derive(Default, Serialize)]
struct Figures {
    /// [s] Wall time of the steps, without building the world.
    wall: f64,
    /// [s] Time of each recorded sample.
    time: Vec<f64>,
    /// [m], [m], [rad] Pose of each body at each sample, one after another.
    poses: Vec<f64>,
}

/// The engine's world, and its bodies in the order of the scene.
struct Bare {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let job: Job = serde_json::from_reader(io::stdin().lock())?;
    let steps = (job.duration / job.settings.time_step).round() as usize;
    let mut figures = Figures::default();
    let mut bare = Bare::new(&job)?;
    let start = Instant::now();
    for step in 0..=steps {
        if step > 0 {
            bare.world.step();
        }
        if job.sample_every > 0 && step % job.sample_every == 0 {
            figures.time.push(step as f64 * job.settings.time_step);
            bare.append_poses(&mut figures.poses);
        }
    }
    figures.wall = start.elapsed().as_secs_f64();
    serde_json::to_writer(io::stdout().lock(), &figures)?;
    Ok(())
}

impl Bare {
    fn new(job: &Job) -> Result<Self, &'static str> {
        let scene = &job.scene;
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -9.81);
        set(&mut world.integration_parameters, &job.settings);
        let finish = |collider: ColliderBuilder, own: Group, other: Group| {
            collider
                .density(0.0)
                .friction(scene.friction)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(InteractionGroups::new(own, other, InteractionTestMode::And))
        };
        for collider in ground(scene, &job.settings.ground) {
            world.insert_collider(finish(collider, Group::GROUP_1, Group::GROUP_2), None);
        }
        let mut bodies = Vec::new();
        for body in &scene.bodies {
            let properties = MassProperties::new(Vector::ZERO, body.mass, body.inertia);
            let handle = world.insert_body(
                RigidBodyBuilder::dynamic()
                    .translation(Vector::new(body.x, body.y))
                    .rotation(body.angle)
                    .can_sleep(false) // slowly driven wheels fall asleep
                    .additional_mass_properties(properties),
            );
            let collider = outline(body)?;
            world.insert_collider(
                finish(collider, Group::GROUP_2, Group::GROUP_1),
                Some(handle),
            );
            bodies.push(handle);
        }
        for pin in &scene.joints {
            let joint = RevoluteJointBuilder::new()
                .local_anchor1(vector(pin.pa))
                .local_anchor2(vector(pin.pb))
                .contacts_enabled(false)
                .motor_model(MotorModel::ForceBased)
                // A gain so high that only the torque limit matters.
                .motor_velocity(pin.speed, 1e4)
                .motor_max_force(pin.torque);
            world.insert_impulse_joint(bodies[pin.a], bodies[pin.b], joint);
        }
        Ok(Self { world, bodies })
    }

    fn append_poses(&self, poses: &mut Vec<f64>) {
        for handle in &self.bodies {
            let body = &self.world.bodies[*handle];
            let at = body.translation();
            poses.extend([at.x, at.y, body.rotation().angle()]);
        }
    }
}

/// Lengths on the scale of a grouser and stiff contacts, as this project's tests use the engine.
fn set(parameters: &mut IntegrationParameters, settings: &Settings) {
    parameters.dt = settings.time_step;
    parameters.num_solver_iterations = settings.substeps;
    parameters.num_internal_pgs_iterations = settings.iterations;
    if settings.tuned {
        parameters.contact_recycling = false;
        parameters.normalized_prediction_distance = 0.005;
        parameters.normalized_allowed_linear_error = 1e-4;
        parameters.contact_softness = SpringCoefficients {
            natural_frequency: 240.0,
            damping_ratio: 5.0,
        };
        parameters.static_contact_softness = parameters.contact_softness;
    }
}

fn ground(scene: &Scene, kind: &GroundKind) -> Vec<ColliderBuilder> {
    if *kind == GroundKind::Profile {
        // The outside is on the right of each segment, so go backwards.
        let points = scene.profile.iter().rev().copied().map(vector).collect();
        return vec![ColliderBuilder::oriented_polyline(points, None)];
    }
    let boxes = scene.boxes.iter().map(|corners| {
        let corners = corners.iter().copied().map(vector);
        let (low, high) = corners.fold((Vector::MAX, Vector::MIN), |(low, high), corner| {
            (low.min(corner), high.max(corner))
        });
        let half = (high - low) / 2.0;
        ColliderBuilder::cuboid(half.x, half.y).translation((low + high) / 2.0)
    });
    boxes.collect()
}

fn outline(body: &Body) -> Result<ColliderBuilder, &'static str> {
    let mut parts = Vec::new();
    if body.radius > 0.0 {
        parts.push((Pose::IDENTITY, SharedShape::ball(body.radius)));
    }
    for polygon in &body.polygons {
        let corners = polygon.iter().copied().map(vector).collect();
        let part = SharedShape::convex_polyline(corners).ok_or("a polygon must be convex")?;
        parts.push((Pose::IDENTITY, part));
    }
    match <[_; 1]>::try_from(parts) {
        Ok([(_, single)]) => Ok(ColliderBuilder::new(single)),
        Err(several) => Ok(ColliderBuilder::compound(several)),
    }
}

fn vector([x, y]: [f64; 2]) -> Vector {
    Vector::new(x, y)
}
