//! A place where a shoe of a chain bears on what it runs on.

use crate::geometry::{Pose, Vector};
use crate::robot::ChainOfShoes;

/// A place where a shoe bears on the guide, on a wheel or on a tooth, or nearly.
#[derive(Clone, Copy, Debug)]
pub(in crate::dynamics) struct Rest {
    /// Index in the chain, and which of its rests.
    pub shoe: usize,
    pub place: usize,
    pub point: Vector,
    /// From there to the shoe.
    pub normal: Vector,
    /// [m]
    pub gap: f64,
    pub on: Bearing,
}

/// What a shoe bears on.
#[derive(Clone, Copy, Debug)]
pub(in crate::dynamics) enum Bearing {
    /// The guide or a wheel, and how it moves over the chassis with the idler, for each metre of its slide.
    Chassis(Vector),
    /// A tooth of the sprocket, and where the axle of that is.
    Tooth(Vector),
}

/// Where chassis, idler and sprocket are when rests are looked for.
#[derive(Clone, Copy)]
pub(in crate::dynamics) struct Stand {
    pub chassis: Pose,
    /// [m] How far the idler is out, ...
    pub travel: f64,
    /// ... and what the sprocket has moved the chain by.
    pub run: f64,
}

/// Places at which a shoe can rest: on either end of a guide and with its front pin on it; or on each wheel,
/// with its front pin on each wheel, and between two teeth.
pub(super) fn of_a_shoe(rule: &ChainOfShoes) -> usize {
    match rule.sprocket {
        None => 3,
        Some(_) => 2 * (2 + rule.wheels.len()) + 2,
    }
}
