//! rapier's own dynamics as a second backend: the robot in its bodies, colliders, joints and motors.
//!
//! It shares the robot, the ground and the outlines with our own dynamics, and nothing of the equations of motion: its
//! wheels are bodies on revolute joints, its contacts and forces are the engine's. A step moves the same state and
//! gives the same contacts with forces, so that everything that watches a run works on both.
//!
//! docs/decisions/0016 explains why and how.

mod build;
mod limits;
mod reading;
mod world;

pub use limits::OWN_SETTINGS;
pub(crate) use limits::check;
pub(crate) use world::{Command, EngineWorld};
