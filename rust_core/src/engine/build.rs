//! Builds a robot in a given state on its ground. The shapes of parts are convex pieces whose union is the part.

use rapier2d_f64::prelude::{
    CoefficientCombineRule, Collider, ColliderBuilder, Group, InteractionGroups,
    InteractionTestMode, JointAxis, MassProperties, PhysicsWorld, RigidBodyBuilder,
    RigidBodyHandle, SharedShape, SpringCoefficients,
};

use super::world::{EngineWorld, Robot, Wheel, axle, limit, push, shaft, turning};
use crate::contact::solids_of;
use crate::dynamics::State;
use crate::geometry::{Disc, Envelope, Pose, Rotation, Vector};
use crate::robot::{Model, Part, Running, Shape, WheelBody};
use crate::scenario::{Friction, Scenario};
use crate::terrain::{Ground, Profile};

/// Substeps of a step: in more than one, contacts are those of its beginning.
const SUBSTEPS: usize = 1;
/// Rounds of the solver over all contacts, motors and shafts, in either of its two passes. With four, 24 wheels on one motor
/// exceed its limit by a quarter.
const ROUNDS: usize = 20;
/// [Hz] Natural frequency and damping ratio of its contacts. With a quarter of the frequency a path was farther from that of
/// shorter steps: docs/decisions/0016.
const CONTACT: (f64, f64) = (1000.0, 5.0);
/// [m/s] Largest speed at which a penetration is pushed out.
const PUSH_OUT: f64 = 0.5;
/// Share of the inertia of wheels on one motor that is on their shaft, which has no other.
const ON_SHAFT: f64 = 0.9;
/// [m] Depth up to which the engine lets bodies sink in.
const SLOP: f64 = 1e-5;
/// [m/s^2] How fast parts may gain speed within a step, as far as the search for contacts looks ahead.
const SPEED_GAIN: f64 = 100.0;

impl EngineWorld {
    /// A robot at rest in a state.
    pub(crate) fn new(scenario: &Scenario, model: &Model, ground: &Ground, state: &State) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -scenario.gravity);
        set_up(&mut world, scenario);
        for (k, lane) in ground.lanes.iter().enumerate() {
            world.insert_collider(profile(lane, k), None);
        }
        let robot = build(&mut world, model, ground, state);
        Self { world, robot }
    }
}

/// Gives the engine the settings of a scenario.
fn set_up(world: &mut PhysicsWorld, scenario: &Scenario) {
    let step = scenario.solver.time_step.unwrap_or_default();
    let fastest = scenario.robot.drivetrain.max_speed;
    let p = &mut world.integration_parameters;
    p.dt = step;
    p.num_solver_iterations = SUBSTEPS;
    p.num_internal_pgs_iterations = ROUNDS;
    p.num_internal_stabilization_iterations = ROUNDS;
    p.friction_in_bias_pass = true;
    p.contact_recycling = false;
    p.max_ccd_substeps = 0;
    p.normalized_max_corrective_velocity = PUSH_OUT;
    // A surface that runs at its fastest over a corner must be seen before it arrives.
    p.normalized_prediction_distance = 2.0 * (fastest + SPEED_GAIN * step) * step;
    p.normalized_allowed_linear_error = SLOP;
    let (natural_frequency, damping_ratio) = CONTACT;
    p.contact_softness = SpringCoefficients {
        natural_frequency,
        damping_ratio,
    };
    p.static_contact_softness = p.contact_softness;
}

fn build(world: &mut PhysicsWorld, model: &Model, ground: &Ground, state: &State) -> Robot {
    let mut running = Running::default();
    state.running_after(0.0, model, &mut running);
    let pose = state.pose(model);
    // Wheels have no mass of their own: their axles hold exactly, and mechanics sees no difference.
    let (_, mut wheels) = model.bodies();
    for wheel in &mut wheels {
        wheel.mass = 0.0;
    }
    let body = model.chassis_beside(&wheels);
    let frame = Pose::from_translation(-body.center_of_mass);
    let chassis = insert(
        world,
        pose * frame.inverse(),
        [body.mass, body.moment_of_inertia],
    );
    for (i, part) in model.parts.iter().enumerate() {
        if wheels.iter().all(|wheel| wheel.part != i) {
            let collider = collider(part, i, ground).position(frame);
            world.insert_collider(collider, Some(chassis));
        }
    }
    let mut built = Vec::new();
    let mut motors = Vec::new();
    for drive in 0..model.drives {
        let is_of_drive = |wheel: &&WheelBody| model.parts[wheel.part].drive == Some(drive);
        let of_drive: Vec<&WheelBody> = wheels.iter().filter(is_of_drive).collect();
        let Some(first) = of_drive.first() else {
            continue; // a force along the chassis
        };
        // All on one motor have one surface speed.
        let ratios = of_drive.iter().map(|wheel| first.radius / wheel.radius);
        let shared = if of_drive.len() > 1 { ON_SHAFT } else { 0.0 };
        let mut axles = Vec::new();
        for wheel in &of_drive {
            let part = &model.parts[wheel.part];
            let turn = Rotation::new(part.turn(part.run(&running)));
            let place = Pose::from_parts(wheel.center, turn);
            let inertia = (1.0 - shared) * wheel.moment_of_inertia;
            let body = insert(world, pose * place, [0.0, inertia]);
            world.insert_collider(collider(part, wheel.part, ground), Some(body));
            axles.push(axle(world, [chassis, body], frame * place));
            built.push(Wheel {
                body,
                part: wheel.part,
                drive,
                radius: wheel.radius,
                inertia: wheel.moment_of_inertia,
                center_before: Vector::ZERO,
                spin_before: 0.0,
            });
        }
        let joint = if let [axle] = axles[..] {
            axle
        } else {
            let spins = of_drive.iter().zip(ratios.clone());
            let inertia: f64 = spins
                .map(|(w, ratio)| w.moment_of_inertia * ratio * ratio)
                .sum();
            let wheels: Vec<_> = axles.into_iter().zip(ratios).collect();
            shaft(world, chassis, &wheels, shared * inertia)
        };
        if model.has_motor(drive) && model.motor.force > 0.0 {
            let torque = model.motor.force * first.radius;
            if let Some(joint) = turning(&mut world.multibody_joints, joint) {
                limit(joint, JointAxis::AngX, torque);
            }
            motors.push((joint, first.radius));
        }
    }
    free(world, chassis, pose.rotation.angle());
    let pushes = model.pushes_chassis && model.motor.force > 0.0;
    let push = pushes.then(|| push(world, chassis, frame.translation, model.motor.force));
    Robot {
        chassis,
        wheels: built,
        motors,
        push,
    }
}

/// Takes from a robot on wheels the damping that the engine gives to all that turns, and tells it the angle [rad] of its
/// chassis, which it does not read from the body.
fn free(world: &mut PhysicsWorld, chassis: RigidBodyHandle, angle: f64) {
    let joints = &mut world.multibody_joints;
    let link = joints.rigid_body_link(chassis).map(|link| link.multibody);
    if let Some(robot) = link.and_then(|robot| joints.get_multibody_mut(robot)) {
        robot.damping_mut().fill(0.0);
        let mut turned = vec![0.0; robot.ndofs()];
        turned[JointAxis::AngX as usize] = angle;
        robot.apply_displacements(&turned);
        robot.forward_kinematics(&world.bodies, false);
    }
}

fn insert(
    world: &mut PhysicsWorld,
    pose: Pose,
    [mass, moment_of_inertia]: [f64; 2],
) -> RigidBodyHandle {
    let mass = MassProperties::new(Vector::ZERO, mass, moment_of_inertia);
    let body = RigidBodyBuilder::dynamic().pose(pose).can_sleep(false);
    world.insert_body(body.additional_mass_properties(mass))
}

/// A lane: one-sided, with its outside on the right of each segment, so from +x to -x.
fn profile(lane: &Profile, number: usize) -> Collider {
    let points: Vec<Vector> = lane.points.iter().rev().copied().collect();
    let builder = ColliderBuilder::oriented_polyline(points, None);
    on_lane(
        builder,
        lane.friction.most(),
        number,
        [Group::GROUP_1, Group::GROUP_2],
    )
    .build()
}

/// A part; mass and inertia are those of its body.
fn collider(part: &Part, number: usize, ground: &Ground) -> ColliderBuilder {
    let friction = ground.lanes[part.lane]
        .friction
        .most()
        .at_most(part.friction_limit);
    let builder = ColliderBuilder::compound(pieces(part)).density(0.0);
    let sides = [Group::GROUP_2, Group::GROUP_1];
    on_lane(builder, friction, part.lane, sides).user_data(number as u128)
}

/// What collides with the ground of one lane alone; `sides` are its own group of each lane and that of the others.
fn on_lane(
    builder: ColliderBuilder,
    friction: Friction,
    lane: usize,
    sides: [Group; 2],
) -> ColliderBuilder {
    let [own, other] = sides.map(|side| Group::from(side.bits() << (2 * lane)));
    builder
        .friction(friction.coefficient)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(InteractionGroups::new(own, other, InteractionTestMode::And))
}

/// [rad] How an arc is divided in a polygon; the discs fill what it leaves out.
const TURN: f64 = 0.5;

/// The convex pieces of a part, in its own frame; together they are exactly the part.
pub(super) fn pieces(part: &Part) -> Vec<(Pose, SharedShape)> {
    match &part.shape {
        Shape::Disc { .. } | Shape::Gear { .. } => solids_of(part)
            .into_iter()
            .map(|solid| (Pose::IDENTITY, solid))
            .collect(),
        Shape::Hull { discs, .. } => hull(discs),
        Shape::Polygon { corners } => polygon(corners.clone()),
        Shape::Grouser(grouser) => polygon(grouser.corners().to_vec()),
    }
}

/// The hull of discs: the discs, and the polygon of the points where its straight runs touch them.
fn hull(discs: &[Disc]) -> Vec<(Pose, SharedShape)> {
    let mut corners = Envelope::new(discs).polyline(TURN);
    corners.reverse(); // counter-clockwise
    corners.dedup();
    if corners.first() == corners.last() {
        corners.pop();
    }
    let round = discs.iter().map(|disc| {
        let place = Pose::from_translation(disc.center);
        (place, SharedShape::ball(disc.radius))
    });
    round.chain(polygon(corners)).collect()
}

fn polygon(corners: Vec<Vector>) -> Vec<(Pose, SharedShape)> {
    SharedShape::convex_polyline(corners)
        .map(|shape| (Pose::IDENTITY, shape))
        .into_iter()
        .collect()
}
