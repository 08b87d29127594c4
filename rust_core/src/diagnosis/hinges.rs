//! Arms in the statics of a stop: each is held at its pivot by a motor with a torque limit, or by a gear that locks itself.

use super::scene::Scene;
use super::statics::Hinge;
use crate::geometry::{Pose, Vector, cross};
use crate::robot::Mount;
use crate::solver::Direction;

impl Scene<'_> {
    /// The hinges of the robot in a pose.
    pub(super) fn hinges(&self, pose: Pose) -> Vec<Hinge> {
        let arms = self.model.flippers.iter().zip(&self.running.flippers);
        arms.map(|(arm, mounted)| {
            let spoke = pose.rotation * (mounted.pose.translation - arm.pivot);
            Hinge {
                weight: spoke.x * arm.mass / self.model.mass,
                torque: if arm.self_locking {
                    f64::INFINITY
                } else {
                    arm.torque_limit / (self.model.mass * self.gravity)
                },
            }
        })
        .collect()
    }

    /// The hinge of a mount, and a direction with its lever about that hinge. A turning arm runs its belt along
    /// itself, because the sprocket stands still.
    pub(super) fn hung(
        &self,
        mount: Mount,
        pose: Pose,
        point: Vector,
        directions: [Direction; 2],
    ) -> (Option<usize>, [Direction; 2]) {
        let Mount::Flipper(k) = mount else {
            return (None, directions);
        };
        let arm = point - pose.transform_point(self.model.flippers[k].pivot);
        let hung = directions.map(|direction| Direction {
            joint_lever: cross(arm, direction.unit) - direction.spin_lever,
            ..direction
        });
        (Some(k), hung)
    }
}
