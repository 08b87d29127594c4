//! Masses of chains and flippers, and what remains for the chassis.

use super::{ChainOfShoes, Flipper, Model, Running};
use crate::geometry::Vector;

impl Model {
    /// Takes the mass of the arms off the chassis.
    pub(crate) fn with_flippers(mut self, arms: Vec<Flipper>) -> Self {
        if arms.is_empty() {
            return self;
        }
        let (total, center) = (self.mass, self.center_of_mass);
        let place = |arm: &Flipper| arm.pivot + arm.arm;
        let of_arms: f64 = arms.iter().map(|arm| arm.mass).sum();
        let moment: Vector = arms.iter().map(|arm| place(arm) * arm.mass).sum();
        self.mass = total - of_arms;
        self.center_of_mass = (center * total - moment) / self.mass;
        let about = |point: Vector| (point - center).length_squared();
        let inertia: f64 = arms
            .iter()
            .map(|arm| arm.moment_of_inertia + arm.mass * about(place(arm)))
            .sum();
        self.moment_of_inertia -= inertia + self.mass * about(self.center_of_mass);
        self.flippers = arms;
        self
    }

    /// Takes the mass of the chains off the chassis.
    pub(crate) fn with_chains(mut self, chains: Vec<ChainOfShoes>) -> Self {
        if chains.is_empty() {
            return self;
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
        // Chains have their own mass; the other drives keep theirs.
        for chain in &chains {
            self.drive_masses[chain.number] = 0.0;
        }
        if let Some(sprocket) = chains.first().and_then(|chain| chain.sprocket.as_ref()) {
            self.drive_radius = sprocket.teeth.drive_radius();
        }
        let of_drives: f64 = (0..self.drives).map(|k| self.drive_inertia(k)).sum();
        self.moment_of_inertia -= of_drives;
        self.chains = chains;
        self
    }

    /// [kg] Mass of chassis, chains and flippers.
    pub fn total_mass(&self) -> f64 {
        let of_chain = |chain: &ChainOfShoes| chain.shoe_mass * chain.path.count as f64;
        let of_chains: f64 = self.chains.iter().map(of_chain).sum();
        let of_flippers: f64 = self.flippers.iter().map(|flipper| flipper.mass).sum();
        self.mass + of_chains + of_flippers
    }

    /// Whether nothing but drives moves relative to the chassis.
    pub(crate) fn is_one_body(&self) -> bool {
        self.chains.is_empty() && self.flippers.is_empty()
    }

    /// The same, with all parts that move relative to the chassis fixed where they are.
    pub(crate) fn as_one_body(&self, running: &Running) -> Self {
        let (mass, center_of_mass) = self.mass_center(running);
        Self {
            mass,
            center_of_mass,
            ..self.clone()
        }
    }

    /// [kg] Mass of chassis, chains and flippers and [m] centre of it in the chassis frame.
    pub(crate) fn mass_center(&self, running: &Running) -> (f64, Vector) {
        if self.is_one_body() {
            return (self.mass, self.center_of_mass);
        }
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
        (mass, moment / mass)
    }

    /// The same robot with the mass of its chains at the drives, as if no shoes were simulated.
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
