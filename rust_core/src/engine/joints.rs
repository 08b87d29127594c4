//! Axles, shafts and motors of a robot in the engine.

use rapier2d_f64::prelude::{
    GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis, MassProperties, MotorModel,
    PhysicsWorld, RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle,
};

use super::Wheel;
use crate::geometry::Vector;

/// [N m s] By how much a motor's torque rises with the error of its speed, or [N s/m] a force: so steep that only its limit
/// limits it.
const GAIN: f64 = 1e5;
/// [kg] Mass of a shaft, which bears nothing and weighs nothing.
const SHAFT: f64 = 1.0;

/// A wheel turns on the chassis, at a place in its frame [m].
pub(super) fn axle(
    world: &mut PhysicsWorld,
    [chassis, body]: [RigidBodyHandle; 2],
    center: Vector,
) -> ImpulseJointHandle {
    let joint = RevoluteJointBuilder::new().local_anchor1(center);
    world.insert_impulse_joint(chassis, body, joint.contacts_enabled(false))
}

/// What wheels on one motor have in common: a body without weight that turns, and they with it, with its moment of inertia
/// [kg m^2]. Its joint turns it on the chassis, wherever it is.
pub(super) fn shaft(
    world: &mut PhysicsWorld,
    chassis: RigidBodyHandle,
    wheels: &[Wheel],
    inertia: f64,
) -> ImpulseJointHandle {
    let mass = MassProperties::new(Vector::ZERO, SHAFT, inertia);
    let place = *world.bodies[wheels[0].body].position();
    let body = RigidBodyBuilder::dynamic()
        .pose(place)
        .can_sleep(false)
        .gravity_scale(0.0)
        .additional_mass_properties(mass);
    let shaft = world.insert_body(body);
    for wheel in wheels {
        // Nothing but their rotations is coupled.
        let joint = GenericJointBuilder::new(JointAxesMask::ANG_X).contacts_enabled(false);
        world.insert_impulse_joint(shaft, wheel.body, joint);
    }
    let joint = GenericJointBuilder::new(JointAxesMask::empty()).contacts_enabled(false);
    world.insert_impulse_joint(chassis, shaft, joint)
}

/// A joint between the chassis, along its axis, and the ground at a point of that axis, with a motor of at most a force
/// [N].
pub(super) fn push(
    world: &mut PhysicsWorld,
    chassis: RigidBodyHandle,
    point: Vector,
    force: f64,
) -> ImpulseJointHandle {
    let ground = world.insert_body(RigidBodyBuilder::fixed());
    let joint = GenericJointBuilder::new(JointAxesMask::empty())
        .local_anchor2(point)
        .contacts_enabled(false);
    let joint = world.insert_impulse_joint(chassis, ground, joint);
    limit(world, (joint, JointAxis::LinX), force);
    joint
}

/// Gives a joint a motor with a limit, a torque [N m] or a force [N].
pub(super) fn limit(
    world: &mut PhysicsWorld,
    (joint, axis): (ImpulseJointHandle, JointAxis),
    most: f64,
) {
    if let Some(joint) = world.impulse_joints.get_mut(joint, false) {
        joint
            .data
            .set_motor_model(axis, MotorModel::ForceBased)
            .set_motor_max_force(axis, most);
    }
    hold(world, (joint, axis), 0.0);
}

/// Lets the motor of a joint hold a speed, [rad/s] or [m/s].
pub(super) fn hold(
    world: &mut PhysicsWorld,
    (joint, axis): (ImpulseJointHandle, JointAxis),
    speed: f64,
) {
    if let Some(joint) = world.impulse_joints.get_mut(joint, false) {
        joint.data.set_motor_velocity(axis, speed, GAIN);
    }
}
