//! rapier's own dynamics behind the same door: the robot in its bodies, colliders, joints and motors.
//!
//! It shares the robot, the ground and the outlines with our own dynamics, and nothing of the equations of motion: its
//! wheels are bodies on revolute joints, its contacts and forces are the engine's. A step moves the same [`State`] and
//! gives the same contacts with forces, so that everything that watches a run works on both.
//!
//! docs/decisions/0016 explains why and how.

mod build;
mod joints;
mod limits;
mod motion;
mod reading;
mod surface;

use rapier2d_f64::prelude::{
    ImpulseJointHandle, JointAxis, MultibodyJointHandle, PhysicsWorld, RigidBodyHandle,
};

use crate::contact::Contact;
use crate::dynamics::State;
use crate::geometry::Vector;
use crate::robot::Model;
use crate::terrain::Ground;

use motion::Motion;

pub use limits::OWN_SETTINGS;
pub(crate) use limits::check;

/// A robot on its ground in rapier.
pub(crate) struct EngineWorld {
    world: PhysicsWorld,
    robot: Robot,
}

/// Where the parts of a robot are in the engine's world.
#[derive(Clone, Debug)]
struct Robot {
    chassis: RigidBodyHandle,
    /// The wheels, drive by drive.
    wheels: Vec<Wheel>,
    /// The joints with a motor that holds the speed of wheels, and their radius [m].
    motors: Vec<(MultibodyJointHandle, f64)>,
    /// The joint that pushes the chassis along its axis.
    push: Option<ImpulseJointHandle>,
}

/// A wheel in the engine.
#[derive(Clone, Debug)]
struct Wheel {
    body: RigidBodyHandle,
    /// Index of the part, and its drive.
    part: usize,
    drive: usize,
    /// [m] Radius of the circumscribed circle.
    radius: f64,
    /// [kg m^2] Moment of inertia.
    inertia: f64,
    /// [m] Its centre and [rad/s] its rotation before the last step.
    center_before: Vector,
    spin_before: f64,
}

/// What acts on the robot in a step besides weight and contacts.
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
            if let Some(joint) = joints::turning(&mut self.world.multibody_joints, *joint) {
                joints::hold(joint, JointAxis::AngX, speed);
            }
        }
        let joints = &mut self.world.impulse_joints;
        let push = self.robot.push.and_then(|push| joints.get_mut(push, false));
        if let Some(push) = push {
            // The line of action goes through the origin of the chassis frame.
            let origin = state.pose(model).translation;
            push.data.set_local_anchor2(origin);
            joints::hold(&mut push.data, JointAxis::LinX, -command.set_point);
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
