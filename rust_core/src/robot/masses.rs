//! Masses of chains, flippers and wheels, and what remains for the chassis.

use super::{ChainOfShoes, Flipper, Model, Mount, Running, Shape};
use crate::geometry::{Pose, Vector};
use crate::scenario::End;

impl Model {
    /// Subtracts the mass of the arms from the chassis.
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

    /// Subtracts the mass of the chains from the chassis.
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

    /// The same, with all moving parts fixed at their positions.
    pub(crate) fn as_one_body(&self, running: &Running) -> Self {
        let (mass, center_of_mass) = self.mass_center(running);
        Self {
            mass,
            center_of_mass,
            ..self.clone()
        }
    }

    /// [kg] Mass of chassis, chains and flippers, and [m] its centre in the chassis frame.
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

/// A wheel, both sides together unless each side has its own lane.
#[derive(Clone, Debug)]
pub struct WheelBody {
    /// Index of the part.
    pub part: usize,
    /// The body that it turns on.
    pub mount: Mount,
    /// [m] Axle in the chassis frame, with the arms as at time 0.
    pub center: Vector,
    /// [m] Radius of the circumscribed circle.
    pub radius: f64,
    /// [m^2] Area of the outline.
    pub area: f64,
    /// [kg] Mass of a uniform wheel of this outline and moment of inertia.
    pub mass: f64,
    /// [kg m^2] Its share of the inertia of the moving track: moving mass times radius squared.
    pub moment_of_inertia: f64,
}

impl WheelBody {
    /// The wheel of one side, from both sides together.
    #[must_use]
    pub fn of_one_side(self) -> Self {
        Self {
            mass: 0.5 * self.mass,
            moment_of_inertia: 0.5 * self.moment_of_inertia,
            ..self
        }
    }
}

/// The robot without its wheels.
#[derive(Clone, Copy, Debug)]
pub struct ChassisBody {
    /// [kg] Mass.
    pub mass: f64,
    /// [m] Centre of mass in the chassis frame.
    pub center_of_mass: Vector,
    /// [kg m^2] Moment of inertia about it.
    pub moment_of_inertia: f64,
}

impl Model {
    /// The wheels of chassis and arms, in the order of the parts.
    ///
    /// The wheels of the chassis together have the inertia of its track, those of an arm that of the arm's track.
    pub fn wheels(&self) -> Vec<WheelBody> {
        let start = self.running_at_start(0.0);
        let round = self.parts.iter().enumerate();
        let mut wheels: Vec<WheelBody> = round
            .filter_map(|(i, part)| {
                let (center, radius, area, polar_moment) = match &part.shape {
                    Shape::Disc { center, radius } => {
                        let area = std::f64::consts::PI * radius * radius;
                        (*center, *radius, area, 0.5 * area * radius * radius)
                    }
                    Shape::Gear { center, gear } => {
                        (*center, gear.radius, gear.area(), gear.polar_moment())
                    }
                    Shape::Hull { .. } | Shape::Grouser(_) | Shape::Polygon { .. } => return None,
                };
                let mount = start.mounted(part.mount, Pose::IDENTITY);
                Some(WheelBody {
                    part: i,
                    mount: part.mount,
                    center: mount.transform_point(center),
                    radius,
                    area,
                    mass: radius * radius * area / polar_moment,
                    moment_of_inertia: radius * radius,
                })
            })
            .collect();
        for mount in self.mounts() {
            let circulating = match mount {
                Mount::Flipper(k) => self.flippers[k].mass_of_track(),
                Mount::Chassis | Mount::Shoe(_) => self.drive_masses.iter().sum::<f64>(),
            };
            let on_it = || wheels.iter().filter(|wheel| wheel.mount == mount);
            let share = circulating / on_it().count() as f64;
            for wheel in wheels.iter_mut().filter(|wheel| wheel.mount == mount) {
                wheel.mass *= share;
                wheel.moment_of_inertia *= share;
            }
        }
        wheels
    }

    /// Name of the body that a wheel turns on.
    pub fn carrier(&self, mount: Mount) -> &'static str {
        match mount {
            Mount::Flipper(k) => match self.flippers[k].end {
                End::Front => "front flipper",
                End::Rear => "rear flipper",
            },
            Mount::Chassis | Mount::Shoe(_) => "chassis",
        }
    }

    /// The robot as bodies and joints of other engines: chassis and wheels, without the wheels of flippers.
    ///
    /// Together they have the robot's mass, centre of mass and moment of inertia, and the wheels have the inertia of
    /// its track.
    pub fn bodies(&self) -> (ChassisBody, Vec<WheelBody>) {
        let mut wheels = self.wheels();
        wheels.retain(|wheel| wheel.mount == Mount::Chassis);
        (self.chassis_beside(&wheels), wheels)
    }

    pub(crate) fn chassis_beside(&self, wheels: &[WheelBody]) -> ChassisBody {
        let mass = self.mass - wheels.iter().map(|w| w.mass).sum::<f64>();
        let moment: Vector = wheels.iter().map(|w| w.center * w.mass).sum();
        let center_of_mass = (self.center_of_mass * self.mass - moment) / mass;
        let about = |center: Vector| (center - self.center_of_mass).length_squared();
        let moment_of_inertia = self.locked_inertia()
            - mass * about(center_of_mass)
            - wheels
                .iter()
                .map(|w| w.moment_of_inertia + w.mass * about(w.center))
                .sum::<f64>();
        ChassisBody {
            mass,
            center_of_mass,
            moment_of_inertia,
        }
    }
}
