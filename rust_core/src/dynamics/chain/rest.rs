//! A rest: a place where a shoe of a chain bears on the guide, a wheel or a tooth.
//!
//! The equations: docs/physics.md, "Chains".

use crate::geometry::{Pose, Vector};
use crate::robot::ChainOfShoes;

/// A place where a shoe bears on the guide, on a wheel or on a tooth, or nearly does.
#[derive(Clone, Copy, Debug)]
pub(in crate::dynamics) struct Rest {
    /// Index of the shoe in the chain, and of the rest on the shoe.
    pub shoe: usize,
    pub index: usize,
    pub point: Vector,
    /// Unit normal towards the shoe.
    pub normal: Vector,
    /// [m] Gap.
    pub gap: f64,
    pub on: Bearing,
}

/// What a shoe bears on.
#[derive(Clone, Copy, Debug)]
pub(in crate::dynamics) enum Bearing {
    /// The guide or a wheel, with its motion relative to the chassis per metre of idler travel.
    Chassis(Vector),
    /// A tooth of the sprocket, with the position of the sprocket's axle.
    Tooth(Vector),
}

/// The pose of chassis, idler and sprocket in which rests are searched for.
#[derive(Clone, Copy)]
pub(in crate::dynamics) struct ChainPose {
    pub chassis: Pose,
    /// [m] Travel of the idler.
    pub travel: f64,
    /// [m] Travel of the chain by the sprocket.
    pub run: f64,
}

/// Number of possible rests of a shoe: on a guide, one on each of its discs, and one of the front pin on its outline; on
/// wheels, one on each, one of the front pin on each, and two of the pin on teeth.
pub(super) fn of_a_shoe(rule: &ChainOfShoes) -> usize {
    let discs = 2 + rule.between.len();
    match rule.sprocket {
        None => discs + 1,
        Some(_) => 2 * discs + 2,
    }
}
