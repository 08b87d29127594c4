//! Chains of shoes of a robot, and what they leave of it to the chassis.

use std::ops::Range;

use rapier2d_f64::math::Vector;

use crate::contact::Running;
use crate::error::ScenarioError;
use crate::outline::{Disc, Envelope, ShoeLoop, Teeth};
use crate::robot::Model;

/// A closed chain of shoes round a guide, or round sprocket and idler.
#[derive(Clone, Debug)]
pub struct ChainOfShoes {
    /// Its own number.
    pub number: usize,
    /// Numbers of its shoes.
    pub shoes: Range<usize>,
    /// Its path along the pins, and how far these are from each other.
    pub path: ShoeLoop,
    /// The ends of the guide that the plates slide on, or the drum of the sprocket and the idler: rear first.
    pub ends: [Disc; 2],
    /// Road wheels and return rollers between them.
    pub wheels: Vec<Disc>,
    /// What drives it; none pulls on the shoes at the rear end of a guide.
    pub sprocket: Option<Sprocket>,
    /// [m] Thickness of the plates; the pins lie in their middle.
    pub plate_thickness: f64,
    /// [kg] Mass of a shoe.
    pub shoe_mass: f64,
    /// [kg m^2] Its moment of inertia about the middle of its pins.
    pub shoe_inertia: f64,
    /// What holds the front end out.
    pub tensioner: Tensioner,
    /// The hull of its ends.
    pub(crate) hull: Envelope,
}

/// The wheel that drives a chain with its teeth.
#[derive(Clone, Debug)]
pub struct Sprocket {
    /// Its teeth; they turn about the centre of the rear end.
    pub teeth: Teeth,
    /// [rad] Angle over the chassis of one of its seats when it has not turned.
    pub first_seat: f64,
    /// [kg m^2] Moment of inertia about its axle.
    pub inertia: f64,
}

impl Sprocket {
    /// [rad] Angle over the chassis when it has moved the chain so far [m]; it drives forwards clockwise.
    pub fn angle(&self, run: f64) -> f64 {
        self.first_seat - run / self.teeth.drive_radius()
    }
}

/// A spring and a damper that push the front end of a guide along the chassis; it weighs nothing.
#[derive(Clone, Copy, Debug)]
pub struct Tensioner {
    /// [N] Force in the middle of its travel.
    pub pre_tension: f64,
    /// [N/m] Stiffness.
    pub stiffness: f64,
    /// [N s/m] Damping.
    pub damping: f64,
    /// [m] How far it can be pressed in before it meets a stop.
    pub stop: f64,
}

impl ChainOfShoes {
    /// [m] Radius at which the drive pulls: a turn moves the chain by as many pitches as it takes shoes to go
    /// round.
    pub(crate) fn drive_radius(&self) -> f64 {
        if let Some(sprocket) = &self.sprocket {
            return sprocket.teeth.drive_radius();
        }
        let half = 0.5 * self.path.pitch;
        half / libm::atan(half / (self.ends[0].radius + 0.5 * self.plate_thickness))
    }

    /// [kg m^2] Moment of inertia of its sprocket, if there is one.
    fn sprocket_inertia(&self) -> f64 {
        self.sprocket.as_ref().map_or(0.0, |s| s.inertia)
    }
}

impl Model {
    /// Leaves to the chassis what the chains do not weigh.
    ///
    /// # Errors
    /// Chains that leave no chassis, as they may beside flippers.
    pub(crate) fn with_chains(mut self, chains: Vec<ChainOfShoes>) -> Result<Self, ScenarioError> {
        if chains.is_empty() {
            return Ok(self);
        }
        let places = chains.iter().flat_map(|chain| {
            let body = (chain.shoe_mass, chain.shoe_inertia);
            let places = chain.path.places(0.0).into_iter();
            places.map(move |place| (body, place.translation))
        });
        let locked = self.locked_inertia();
        let (total, center) = (self.mass, self.center_of_mass);
        let (mut mass, mut moment) = (total, center * total);
        for ((shoe, _), place) in places.clone() {
            mass -= shoe;
            moment -= place * shoe;
        }
        self.center_of_mass = moment / mass;
        let about = |point: Vector| (point - center).length_squared();
        let of_shoes: f64 = places
            .map(|((shoe, inertia), place)| inertia + shoe * about(place))
            .sum();
        let of_sprockets: f64 = chains.iter().map(ChainOfShoes::sprocket_inertia).sum();
        let of_chassis = mass * about(self.center_of_mass);
        self.moment_of_inertia = locked - of_shoes - of_chassis - of_sprockets;
        self.mass = mass;
        // The first drives are those of the chains; the others keep what turns with them.
        self.drive_masses[..chains.len()].fill(0.0);
        if let Some(sprocket) = chains.first().and_then(|chain| chain.sprocket.as_ref()) {
            self.drive_radius = sprocket.teeth.drive_radius();
        }
        let of_drives: f64 = (0..self.drives).map(|k| self.drive_inertia(k)).sum();
        self.moment_of_inertia -= of_drives;
        if self.moment_of_inertia <= 0.0 {
            let left = self.moment_of_inertia;
            let rule =
                format!("must exceed that of shoes and arms: the chassis would have {left} kg m^2");
            let path = "robot.moment_of_inertia";
            return Err(ScenarioError::new(path, locked - left, rule));
        }
        self.chains = chains;
        Ok(self)
    }

    /// [kg] Mass of chassis, chains and flippers.
    pub fn total_mass(&self) -> f64 {
        let of_chain = |chain: &ChainOfShoes| chain.shoe_mass * chain.path.count as f64;
        let of_chains: f64 = self.chains.iter().map(of_chain).sum();
        let of_flippers: f64 = self.flippers.iter().map(|flipper| flipper.mass).sum();
        self.mass + of_chains + of_flippers
    }

    /// Whether nothing but drives moves over the chassis.
    pub(crate) fn is_one_body(&self) -> bool {
        self.chains.is_empty() && self.flippers.is_empty()
    }

    /// The same with all that moves over the chassis fixed to it where it is.
    pub(crate) fn as_one_body(&self, running: &Running) -> Self {
        let (mut mass, mut moment) = (self.mass, self.center_of_mass * self.mass);
        for chain in &self.chains {
            for place in &running.shoes[chain.shoes.clone()] {
                mass += chain.shoe_mass;
                moment += place.translation * chain.shoe_mass;
            }
        }
        for (flipper, mounted) in self.flippers.iter().zip(&running.flippers) {
            mass += flipper.mass;
            moment += mounted.pose.translation * flipper.mass;
        }
        Self {
            mass,
            center_of_mass: if self.is_one_body() {
                self.center_of_mass
            } else {
                moment / mass
            },
            ..self.clone()
        }
    }

    /// The same robot with the mass of its chains at the drives, as where no shoes are simulated.
    pub(crate) fn with_circulating_mass(&self) -> Self {
        let start = |chain: &ChainOfShoes| chain.path.places(0.0);
        let running = Running {
            shoes: self.chains.iter().flat_map(start).collect(),
            ..Running::default()
        };
        let mut whole = self.as_one_body(&running);
        let about = |point: Vector| (point - whole.center_of_mass).length_squared();
        let mut inertia = self.locked_inertia() + self.mass * about(self.center_of_mass);
        for (k, chain) in self.chains.iter().enumerate() {
            inertia += chain.sprocket_inertia();
            for place in &running.shoes[chain.shoes.clone()] {
                inertia += chain.shoe_inertia + chain.shoe_mass * about(place.translation);
            }
            whole.drive_masses[k] = chain.shoe_mass * chain.path.count as f64;
        }
        whole.moment_of_inertia = inertia - (whole.locked_inertia() - whole.moment_of_inertia);
        whole.chains.clear();
        whole
    }
}
