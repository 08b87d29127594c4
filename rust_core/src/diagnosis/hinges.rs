//! Arms in the statics of a stop: each hangs on its pivot, and its motor has a limit.

use super::scene::Scene;
use super::statics::Hinge;
use crate::dynamics::Direction;
use crate::geometry::{Pose, Vector, cross};
use crate::robot::Mount;

impl Scene<'_> {
    /// Those of the robot in a pose.
    pub(super) fn hinges(&self, pose: Pose) -> Vec<Hinge> {
        let arms = self.model.flippers.iter().zip(&self.running.flippers);
        arms.map(|(arm, mounted)| {
            let spoke = pose.rotation * (mounted.pose.translation - arm.pivot);
            Hinge {
                weight: spoke.x * arm.mass / self.model.mass,
                torque: arm.torque_limit / (self.model.mass * self.gravity),
            }
        })
        .collect()
    }

    /// The hinge of what a mount carries, and a direction there with its lever about it: an arm that turns
    /// runs its belt along itself, since its sprocket stands.
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
            flipper_lever: cross(arm, direction.unit) - direction.drive_lever,
            ..direction
        });
        (Some(k), hung)
    }
}
