//! Axles, shafts and motors of a robot in the engine.
//!
//! Wheels turn on the chassis in the engine's reduced coordinates: their axles hold exactly, and what strikes a wheel
//! meets the mass of the whole robot.

use rapier2d_f64::dynamics::MultibodyDofCoupling;
use rapier2d_f64::prelude::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis,
    MassProperties, MotorModel, MultibodyJointHandle, MultibodyJointSet, PhysicsWorld,
    RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle,
};

use crate::geometry::{Pose, Vector};

/// [N m s] By how much a motor's torque rises with the error of its speed, or [N s/m] a force: so steep that only its limit
/// limits it.
const GAIN: f64 = 1e5;

/// A wheel turns on the chassis; `place` is its pose in the frame of that body at the beginning.
pub(super) fn axle(
    world: &mut PhysicsWorld,
    [chassis, body]: [RigidBodyHandle; 2],
    place: Pose,
) -> MultibodyJointHandle {
    let joint = RevoluteJointBuilder::new().contacts_enabled(false);
    let mut joint = GenericJoint::from(joint);
    joint.local_frame1 = place;
    world
        .insert_multibody_joint(chassis, body, joint)
        .unwrap_or_else(|| unreachable!("a wheel has one axle"))
}

/// What wheels on one motor have in common: a body without weight that turns on the chassis, with a moment of inertia
/// [kg m^2]. Each wheel turns so many times as fast as it.
pub(super) fn shaft(
    world: &mut PhysicsWorld,
    chassis: RigidBodyHandle,
    wheels: &[(MultibodyJointHandle, f64)],
    inertia: f64,
) -> MultibodyJointHandle {
    let body = RigidBodyBuilder::dynamic()
        .pose(*world.bodies[chassis].position())
        .can_sleep(false)
        .additional_mass_properties(MassProperties::new(Vector::ZERO, 0.0, inertia));
    let body = world.insert_body(body);
    let shaft = axle(world, [chassis, body], Pose::IDENTITY);
    let joints = &mut world.multibody_joints;
    let link_of = |(wheel, ratio): &(_, f64)| Some((joints.get(*wheel)?.1, *ratio));
    let links: Vec<(usize, f64)> = wheels.iter().filter_map(link_of).collect();
    if let Some((robot, shaft)) = joints.get_mut(shaft) {
        for (wheel, ratio) in links {
            let turning = JointAxis::AngX as usize;
            robot.add_dof_coupling(MultibodyDofCoupling {
                link1: shaft,
                dof1: 0,
                axis1: turning,
                link2: wheel,
                dof2: 0,
                axis2: turning,
                coeff: ratio,
                offset: 0.0,
            });
        }
    }
    shaft
}

/// A joint between the chassis, along its axis through a point of it, and the ground, with a motor of at most a force [N].
pub(super) fn push(
    world: &mut PhysicsWorld,
    chassis: RigidBodyHandle,
    point: Vector,
    force: f64,
) -> ImpulseJointHandle {
    let ground = world.insert_body(RigidBodyBuilder::fixed());
    let joint = GenericJointBuilder::new(JointAxesMask::empty())
        .local_anchor1(point)
        .contacts_enabled(false);
    let mut joint = GenericJoint::from(joint);
    limit(&mut joint, JointAxis::LinX, force);
    world.insert_impulse_joint(chassis, ground, joint)
}

/// Gives a joint a motor with a limit, a torque [N m] or a force [N].
pub(super) fn limit(joint: &mut GenericJoint, axis: JointAxis, most: f64) {
    joint
        .set_motor_model(axis, MotorModel::ForceBased)
        .set_motor_max_force(axis, most);
    hold(joint, axis, 0.0);
}

/// Lets the motor of a joint hold a speed, [rad/s] or [m/s].
pub(super) fn hold(joint: &mut GenericJoint, axis: JointAxis, speed: f64) {
    joint.set_motor_velocity(axis, speed, GAIN);
}

/// The joint of a wheel or a shaft.
pub(super) fn turning(
    joints: &mut MultibodyJointSet,
    handle: MultibodyJointHandle,
) -> Option<&mut GenericJoint> {
    let (robot, link) = joints.get_mut(handle)?;
    Some(&mut robot.link_mut(link)?.joint.data)
}
