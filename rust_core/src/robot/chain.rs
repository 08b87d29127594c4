//! Chains of shoes of a robot.

use std::ops::Range;

use crate::geometry::{Disc, Envelope, ShoeLoop, Teeth};

/// A closed chain of shoes round a guide, or round sprocket and idler.
#[derive(Clone, Debug)]
pub struct ChainOfShoes {
    /// Its own number.
    pub number: usize,
    /// Numbers of its shoes.
    pub shoes: Range<usize>,
    /// The path of its pins, and their pitch.
    pub path: ShoeLoop,
    /// The ends of the guide that the plates slide on, or sprocket drum and idler; rear first.
    pub ends: [Disc; 2],
    /// The other discs of the guide, or road wheels and return rollers.
    pub between: Vec<Disc>,
    /// What drives it; `None`: the drive pulls on the shoes at the rear end of a guide.
    pub sprocket: Option<Sprocket>,
    /// [m] Thickness of the plates; the pins lie in their middle.
    pub plate_thickness: f64,
    /// [kg] Mass of a shoe.
    pub shoe_mass: f64,
    /// [kg m^2] Its moment of inertia about the middle of its pins.
    pub shoe_inertia: f64,
    /// What holds the front end out.
    pub tensioner: Tensioner,
    /// The guide, or the hull of sprocket and idler.
    pub(crate) hull: Envelope,
}

/// The wheel that drives a chain with its teeth.
#[derive(Clone, Debug)]
pub struct Sprocket {
    /// Its teeth; they turn about the centre of the rear end.
    pub teeth: Teeth,
    /// [rad] Angle of one of its seats relative to the chassis at the start.
    pub first_seat: f64,
    /// [kg m^2] Moment of inertia about its axle.
    pub inertia: f64,
}

impl Sprocket {
    /// [rad] Angle relative to the chassis when it has moved the chain so far [m]; forwards is clockwise.
    pub fn angle(&self, run: f64) -> f64 {
        self.first_seat - run / self.teeth.drive_radius()
    }
}

/// A massless spring and damper that push the front end of a guide along the chassis.
#[derive(Clone, Copy, Debug)]
pub struct Tensioner {
    /// [N] Force in the middle of its travel.
    pub pre_tension: f64,
    /// [N/m] Stiffness.
    pub stiffness: f64,
    /// [N s/m] Damping.
    pub damping: f64,
    /// [m] How far it can be pressed in before it meets its stop.
    pub stop: f64,
}

impl ChainOfShoes {
    /// [kg m^2] Moment of inertia of its sprocket, if there is one.
    pub(crate) fn sprocket_inertia(&self) -> f64 {
        self.sprocket.as_ref().map_or(0.0, |s| s.inertia)
    }
}
