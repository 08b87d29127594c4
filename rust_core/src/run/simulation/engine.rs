//! A step in which the engine moves the robot.

use super::Simulation;
use super::step::Taken;
use crate::dynamics::SetPoint;
use crate::engine::{Command, EngineWorld};

impl Simulation {
    /// Takes a step of `h` [s] in the engine; what it has given up is not finite.
    pub(super) fn take_in(&mut self, engine: &mut EngineWorld, h: f64) -> Taken {
        let set_point = SetPoint {
            middle: self.set_point_after(0.5 * h),
            end: self.set_point_after(h),
        };
        let command = Command {
            set_point: set_point.end,
            push: self.push.at(self.time + 0.5 * h),
        };
        let travel = self.dynamics.fastest(&self.state, self.reach) * h;
        let world = (self.dynamics.model(), &*self.ground);
        let contacts = engine.step(world, &mut self.state, command, h);
        if engine.has_lost_something() {
            self.state.angle = f64::NAN;
        }
        self.dynamics.take_contacts(contacts, travel, h);
        Taken {
            h,
            strikes: false,
            set_point,
        }
    }
}
