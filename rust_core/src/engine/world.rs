//! The robot in rapier's world: its bodies, joints and motors.
//!
//! Wheels turn on the chassis in the engine's reduced coordinates: their axles hold exactly, and what strikes a wheel
//! meets the mass of the whole robot. The velocities that the engine keeps with the bodies of a robot on wheels are those
//! of the beginning of a step.

use rapier2d_f64::dynamics::MultibodyDofCoupling;
use rapier2d_f64::prelude::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis,
    MassProperties, MotorModel, MultibodyJointHandle, MultibodyJointSet, PhysicsWorld,
    RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle,
};

use crate::contact::Contact;
use crate::dynamics::State;
use crate::geometry::{Pose, Vector, left_of};
use crate::robot::Model;
use crate::terrain::Ground;

/// A robot on its ground in rapier.
pub(crate) struct EngineWorld {
    pub(super) world: PhysicsWorld,
    pub(super) robot: Robot,
}

/// Where the parts of a robot are in the engine's world.
#[derive(Clone, Debug)]
pub(super) struct Robot {
    pub(super) chassis: RigidBodyHandle,
    /// The wheels, drive by drive.
    pub(super) wheels: Vec<Wheel>,
    /// The joints with a motor that holds the speed of wheels, and their radius [m].
    pub(super) motors: Vec<(MultibodyJointHandle, f64)>,
    /// The joint that pushes the chassis along its axis.
    pub(super) push: Option<ImpulseJointHandle>,
}

/// A wheel in the engine.
#[derive(Clone, Debug)]
pub(super) struct Wheel {
    pub(super) body: RigidBodyHandle,
    /// Index of the part, and its drive.
    pub(super) part: usize,
    pub(super) drive: usize,
    /// [m] Radius of the circumscribed circle.
    pub(super) radius: f64,
    /// [kg m^2] Moment of inertia.
    pub(super) inertia: f64,
    /// [m] Its centre and [rad/s] its rotation before the last step.
    pub(super) center_before: Vector,
    pub(super) spin_before: f64,
}

/// Loads on the robot in a step, in addition to weight and contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Command {
    /// [m/s] Surface speed that the motors hold.
    pub set_point: f64,
    /// [N] Force at the centre of mass, along x.
    pub push: f64,
}

impl EngineWorld {
    /// Advances the state by a step of `h` [s], and gives the contacts of the step; they have no numbers yet.
    pub(crate) fn step(
        &mut self,
        (model, ground): (&Model, &Ground),
        state: &mut State,
        command: Command,
        h: f64,
    ) -> Vec<Contact> {
        self.give(model, state, command);
        self.remember();
        self.world.integration_parameters.dt = h;
        self.world.step();
        let contacts = self.contacts(model, ground, h);
        self.read(model, &contacts, state, h);
        contacts
    }

    /// Whether the engine has taken something out because it had become non-finite.
    pub(crate) fn has_lost_something(&self) -> bool {
        !self.world.quarantine().is_empty()
    }

    fn give(&mut self, model: &Model, state: &State, command: Command) {
        for (joint, radius) in &self.robot.motors {
            let speed = -command.set_point / radius;
            if let Some(joint) = turning(&mut self.world.multibody_joints, *joint) {
                hold(joint, JointAxis::AngX, speed);
            }
        }
        let joints = &mut self.world.impulse_joints;
        let push = self.robot.push.and_then(|push| joints.get_mut(push, false));
        if let Some(push) = push {
            // The line of action goes through the origin of the chassis frame.
            let origin = state.pose(model).translation;
            push.data.set_local_anchor2(origin);
            hold(&mut push.data, JointAxis::LinX, -command.set_point);
        }
        let chassis = &mut self.world.bodies[self.robot.chassis];
        chassis.reset_forces(false);
        chassis.add_force_at_point(Vector::new(command.push, 0.0), state.center, false);
    }

    /// Keeps where the wheels are before a step.
    fn remember(&mut self) {
        for wheel in &mut self.robot.wheels {
            let motion = Motion::of(&self.world, wheel.body);
            (wheel.center_before, wheel.spin_before) = (motion.center, motion.spin);
        }
    }
}

impl Clone for EngineWorld {
    /// The same world; the engine has no other copy than by its bytes.
    fn clone(&self) -> Self {
        let bytes = postcard::to_stdvec(&self.world)
            .unwrap_or_else(|e| unreachable!("plain data serialises: {e}"));
        let world = postcard::from_bytes(&bytes)
            .unwrap_or_else(|e| unreachable!("it was just written: {e}"));
        Self {
            world,
            robot: self.robot.clone(),
        }
    }
}

/// [N m s] By how much a motor's torque rises with the error of its speed, or [N s/m] a force: so steep that only its limit
/// limits it.
const MOTOR_GAIN: f64 = 1e5;

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
    joint.set_motor_velocity(axis, speed, MOTOR_GAIN);
}

/// The joint of a wheel or a shaft.
pub(super) fn turning(
    joints: &mut MultibodyJointSet,
    handle: MultibodyJointHandle,
) -> Option<&mut GenericJoint> {
    let (robot, link) = joints.get_mut(handle)?;
    Some(&mut robot.link_mut(link)?.joint.data)
}

/// The velocity of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// [m] Where its centre of mass is.
    pub center: Vector,
    /// [m/s] Velocity of that point.
    pub velocity: Vector,
    /// [rad/s]
    pub spin: f64,
}

impl Motion {
    /// The velocity of a body after the last step.
    pub(super) fn of(world: &PhysicsWorld, handle: RigidBodyHandle) -> Self {
        let body = &world.bodies[handle];
        let center = body.center_of_mass();
        let link = world.multibody_joints.rigid_body_link(handle);
        let robot = link.and_then(|link| {
            let robot = world.multibody_joints.get_multibody(link.multibody)?;
            Some(robot.body_jacobian(link.id) * robot.generalized_velocity())
        });
        let (velocity, spin) = match robot {
            Some(moved) => (Vector::new(moved[0], moved[1]), moved[2]),
            None => (body.linvel(), body.angvel()),
        };
        Self {
            center,
            velocity,
            spin,
        }
    }

    /// [m/s] Velocity of a point of the body.
    pub(super) fn at(&self, point: Vector) -> Vector {
        self.velocity + self.spin * left_of(point - self.center)
    }
}
