//! How a body moves. The velocities that the engine keeps with the bodies of a robot on wheels are those of the
//! beginning of a step.

use rapier2d_f64::prelude::{PhysicsWorld, RigidBodyHandle};

use crate::geometry::{Vector, left_of};

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
        match robot {
            Some(moved) => Self {
                center,
                velocity: Vector::new(moved[0], moved[1]),
                spin: moved[2],
            },
            None => Self {
                center,
                velocity: body.linvel(),
                spin: body.angvel(),
            },
        }
    }

    /// [m/s] Velocity of a point of the body.
    pub(super) fn at(&self, point: Vector) -> Vector {
        self.velocity + self.spin * left_of(point - self.center)
    }
}
