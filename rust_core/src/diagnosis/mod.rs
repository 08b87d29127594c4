//! Why did it stop? Outcome, mechanism and cause of a stop, from what was seen of it alone.
//!
//! Nothing here knows a track model: contacts, forces, surface speeds, torques and the geometry of
//! the envelope decide. docs/decisions/0005 says how, docs/conventions.md what the words mean.

mod linear_program;
mod mechanism;
mod signals;
mod statics;

use rapier2d_f64::math::{Pose, Vector};

pub use mechanism::Mechanism;
pub(crate) use signals::{Signals, Stance};
pub use statics::Condition;

use crate::contact::{Contact, Intrusion, TrackEnvelope};
use crate::dynamics::{Direction, Levers};
use crate::outcome::Outcome;
use crate::plane::{left_of, right_of};
use crate::robot::{BodyKind, Model};
use crate::scenario::SeizureCriteria;
use crate::simulation::Counterfactual;
use crate::terrain::Profile;
use mechanism::Facts;
use signals::Bearing;
use statics::{Role, Statics, Support};

/// Why a robot that was commanded to move did not.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// What the stop is.
    pub outcome: Outcome,
    /// How the most loaded ground inside the track is held, if there is any.
    pub mechanism: Option<Mechanism>,
    /// The smallest sets of conditions without which there is no equilibrium; more than one is a tie.
    pub cause: Vec<Vec<Condition>>,
    /// Whether closing the pockets would end the equilibrium if the track were taken to reach to the
    /// circumscribed circles: ground between the grousers of one wheel is then a pocket, too.
    pub seized_at_tips: bool,
    /// [s] When it was looked at.
    pub time: f64,
    /// [s] Since when it has lasted.
    pub since: f64,
    /// [m] Mean position of the chassis frame.
    pub position: [f64; 2],
    /// [rad] Mean chassis angle.
    pub chassis_angle: f64,
    /// The most loaded ground inside the track.
    pub intrusion: Option<LoadedIntrusion>,
    /// What bears, in the mean over the last one to two stop windows.
    pub contacts: Vec<StopContact>,
    /// Share of the normal forces' lift that the belly has, 0 to 1.
    pub belly_share: f64,
    /// Share of the normal forces at contacts that slide.
    pub sliding_share: f64,
    /// Share of the motors that stand at their limit.
    pub stalled_share: f64,
    /// Share of the commanded distance made in the last stop window.
    pub progress: f64,
    /// The pose did not change at all.
    pub stationary: bool,
    /// Share of the weight by which the best choice of forces misses balance; None without an answer.
    pub imbalance: Option<f64>,
    /// The imbalance is within the criteria: the pose may be an equilibrium.
    pub certified: bool,
    /// [N] Largest push at the centre of mass along the command that can be balanced while sliding
    /// contacts go on sliding as they do; infinite if any can. None without a certificate.
    pub escape_force: Option<f64>,
    /// [N] The same if every contact could hold within its friction cone.
    pub free_escape_force: Option<f64>,
    /// How a closed belt fares from here, if that was asked for.
    pub counterfactual: Option<Counterfactual>,
}

/// A connected piece of ground inside the track, with what bears on it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedIntrusion {
    /// Where it is.
    pub place: Intrusion,
    /// [N] Normal force on it, in the mean.
    pub force: f64,
}

/// A contact of a stop, in the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopContact {
    /// Index of the part.
    pub body: usize,
    /// What the part is.
    pub kind: BodyKind,
    /// Facet of the ground, from the left.
    pub segment: usize,
    /// Edge, or -1.
    pub edge: i32,
    /// [m] Where.
    pub point: Vector,
    /// From the ground to the robot.
    pub normal: Vector,
    /// [N] Normal force.
    pub normal_force: f64,
    /// [N] Friction on the robot, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the robot's surface over the ground in that direction.
    pub surface_speed: f64,
    /// It slides at its friction limit.
    pub slides: bool,
    /// It bears on the most loaded ground inside the track.
    pub in_pocket: bool,
}

/// What a diagnosis looks at besides the stop.
pub(crate) struct Scene<'a> {
    pub model: &'a Model,
    pub profile: &'a Profile,
    pub envelope: &'a TrackEnvelope,
    pub criteria: &'a SeizureCriteria,
    pub gravity: f64,
    /// [m/s] What the drivetrain is to do.
    pub command: f64,
    /// [m/s] What it is to do now, within its acceleration.
    pub set_point: f64,
    /// [m] Half the distance of the end axles.
    pub half_length: f64,
}

/// When a stop was seen.
pub(crate) struct Seen {
    pub time: f64,
    pub since: f64,
    pub progress: f64,
}

/// Judges a stop.
pub(crate) fn diagnose(scene: &Scene, stance: &Stance, seen: &Seen) -> Diagnosis {
    let pose = Pose::new(stance.position, stance.angle);
    let weight = scene.model.mass * scene.gravity;
    let criteria = scene.criteria;
    let bearings = &stance.bearings;
    let mut pockets = scene.pockets(pose, bearings);
    pockets.retain(|p| p.force > criteria.intrusion_load * weight);
    let most_loaded = pockets
        .iter()
        .reduce(|most, p| if p.force > most.force { p } else { most });

    let range = stance.range[0].max(stance.range[1]);
    let range = range.max(stance.range[2] * scene.half_length);
    let stationary = range <= criteria.stationary_distance;
    let tolerance = if stationary {
        criteria.imbalance
    } else {
        criteria.mean_imbalance
    };
    let statics = scene.statics(pose, stance, &pockets, false);
    let imbalance = statics.as_ref().and_then(Statics::imbalance);
    let certified = imbalance.is_some_and(|i| i <= tolerance);
    let certificate = statics.as_ref().filter(|_| certified);
    let escape = |free| {
        let push = certificate.and_then(|s| s.escape(scene.direction(), free));
        push.map(|push| push * weight)
    };

    let facts = scene.facts(stance, most_loaded);
    let is_pocket = pockets
        .iter()
        .any(|p| p.place.root_depth > criteria.intrusion_depth);
    let given = scene.conditions(stance, &facts, is_pocket);
    let cause = certificate.map_or(Vec::new(), |s| s.cause(tolerance, &given));
    let alone = |s: &Statics| s.ends(&[Condition::Pocket], tolerance);
    let seized = cause.contains(&vec![Condition::Pocket]);
    let at_tips = || scene.statics(pose, stance, &pockets, true);
    let seized_at_tips = certified
        && !pockets.is_empty()
        && (seized || at_tips().is_some_and(|statics| alone(&statics)));
    let outcome = if range > criteria.cycling_distance {
        Outcome::Cycling
    } else if seized {
        Outcome::Seized
    } else if facts.belly_share >= criteria.belly_load {
        Outcome::HungUp
    } else if facts.stalled_share >= 0.5 {
        Outcome::Stalled
    } else {
        Outcome::Slipping
    };
    Diagnosis {
        outcome,
        mechanism: most_loaded.and_then(|_| Mechanism::of(&facts, criteria, weight)),
        cause,
        seized_at_tips,
        time: seen.time,
        since: seen.since,
        position: [stance.position.x, stance.position.y],
        chassis_angle: stance.angle,
        intrusion: most_loaded.cloned(),
        belly_share: facts.belly_share,
        sliding_share: facts.sliding_share,
        stalled_share: facts.stalled_share,
        contacts: facts.contacts,
        progress: seen.progress,
        stationary,
        imbalance,
        certified,
        escape_force: escape(false),
        free_escape_force: escape(true),
        counterfactual: None,
    }
}

impl Scene<'_> {
    fn direction(&self) -> f64 {
        if self.command < 0.0 { -1.0 } else { 1.0 }
    }

    /// Ground inside the track with the forces on it.
    fn pockets(&self, pose: Pose, bearings: &[Bearing]) -> Vec<LoadedIntrusion> {
        let found = self.envelope.intrusions(self.profile, pose);
        let with_force = found.into_iter().filter(|i| i.edge >= 0).map(|place| {
            let on_it = bearings
                .iter()
                .filter(|b| place.bears(self.profile, &b.contact));
            let force = on_it.map(|b| b.normal_force).sum();
            LoadedIntrusion { place, force }
        });
        with_force.collect()
    }

    /// The coefficient of friction of a part on the ground.
    fn friction(&self, contact: &Contact) -> f64 {
        let limit = self.model.parts[contact.part].friction_limit;
        limit.min(self.profile.friction)
    }

    /// Whether a surface speed [m/s] is more than the creep of a contact that sticks.
    fn is_moving(&self, speed: f64) -> bool {
        speed.abs() > self.criteria.sliding_speed * self.set_point.abs()
    }

    fn slides(&self, bearing: &Bearing) -> bool {
        /// Share of the friction cone that a contact in rattle must have used, in the mean.
        const AT_LIMIT: f64 = 0.95;

        let limit = self.friction(&bearing.contact) * bearing.normal_force;
        self.is_moving(bearing.slip) && bearing.friction_force.abs() >= AT_LIMIT * limit
    }

    /// What the mechanism is read from.
    fn facts(&self, stance: &Stance, pocket: Option<&LoadedIntrusion>) -> Facts {
        let contacts: Vec<StopContact> = stance
            .bearings
            .iter()
            .filter(|b| b.normal_force > 0.0)
            .map(|b| StopContact {
                body: b.contact.part,
                kind: self.model.parts[b.contact.part].kind,
                segment: b.contact.facet,
                edge: b.contact.edge,
                point: b.contact.point,
                normal: b.contact.normal,
                normal_force: b.normal_force,
                friction_force: b.friction_force,
                surface_speed: b.slip,
                slides: self.slides(b),
                in_pocket: pocket.is_some_and(|p| p.place.bears(self.profile, &b.contact)),
            })
            .collect();
        let sum = |of: &dyn Fn(&StopContact) -> f64| contacts.iter().map(of).sum::<f64>();
        let normal = sum(&|c| c.normal_force).max(f64::MIN_POSITIVE);
        let lift = |c: &StopContact| {
            let force = c.normal * c.normal_force + right_of(c.normal) * c.friction_force;
            force.y.max(0.0)
        };
        let all_lift = sum(&lift).max(f64::MIN_POSITIVE);
        let on = |is: bool, value: f64| if is { value } else { 0.0 };
        let motors = &stance.drives[..self.model.motors.min(stance.drives.len())];
        let stalled = motors
            .iter()
            .filter(|d| {
                !self.is_moving(d.speed)
                    && d.force.abs() >= self.criteria.torque_limit * self.model.drive_force
            })
            .count();
        Facts {
            belly_share: sum(&|c| on(c.kind == BodyKind::Belly, lift(c))) / all_lift,
            sliding_share: sum(&|c| on(c.slides, c.normal_force)) / normal,
            stalled_share: stalled as f64 / self.model.motors.max(1) as f64,
            flank: self.bears_on_a_flank(stance, &contacts),
            contacts,
        }
    }

    /// Whether a surface in the pocket would move into the ground if its drive turned: a grouser.
    fn bears_on_a_flank(&self, stance: &Stance, contacts: &[StopContact]) -> bool {
        /// Share of the surface speed along the normal that a round wheel, but for rounding, lacks.
        const INTO_GROUND: f64 = 0.05;

        let bearing = stance.bearings.iter().filter(|b| b.normal_force > 0.0);
        bearing.zip(contacts).any(|(bearing, contact)| {
            let levers = self.levers(stance, &bearing.contact);
            contact.in_pocket
                && levers.normal.drive_lever.abs() > INTO_GROUND * self.model.drive_radius
        })
    }

    fn levers(&self, stance: &Stance, contact: &Contact) -> Levers {
        let pose = Pose::new(stance.position, stance.angle);
        let center = pose.transform_point(self.model.center_of_mass);
        Levers::new(contact, (center, stance.angle), self.model)
    }

    /// The conditions that this stop has at all.
    fn conditions(&self, stance: &Stance, facts: &Facts, is_pocket: bool) -> Vec<Condition> {
        let at_limit = |d: &signals::DriveMean| {
            d.force.abs() >= self.criteria.torque_limit * self.model.drive_force
        };
        let has = |condition: &Condition| match condition {
            Condition::Pocket => is_pocket,
            Condition::Belly => facts.belly_share > self.criteria.intrusion_load,
            Condition::Torque => stance.drives.iter().take(self.model.motors).any(at_limit),
            Condition::Friction => facts.contacts.iter().any(|c| c.slides),
        };
        Condition::ALL.into_iter().filter(has).collect()
    }

    /// The statics of a stop; None without a weight. At the tips, every loaded intrusion is a pocket;
    /// else those that reach below the root circles.
    fn statics(
        &self,
        pose: Pose,
        stance: &Stance,
        pockets: &[LoadedIntrusion],
        at_tips: bool,
    ) -> Option<Statics> {
        let weight = self.model.mass * self.gravity;
        if weight <= 0.0 {
            return None;
        }
        let deep: Vec<&LoadedIntrusion> = pockets
            .iter()
            .filter(|p| at_tips || p.place.root_depth > self.criteria.intrusion_depth)
            .collect();
        let center = pose.transform_point(self.model.center_of_mass);
        let angle = pose.rotation.angle();
        let supports = stance
            .bearings
            .iter()
            .map(|b| {
                let role = self.role(&b.contact, &deep);
                let slides = if self.slides(b) { b.slip.signum() } else { 0.0 };
                let levers = Levers::new(&b.contact, (center, angle), self.model);
                let drive = self.model.parts[b.contact.part].drive;
                Support::new(&levers, drive, (self.friction(&b.contact), slides), role)
            })
            .collect();
        let closed = deep
            .iter()
            .map(|p| self.closed(pose, stance, &p.place))
            .collect();
        let torque = self.model.drive_force / weight;
        Some(Statics::new(
            self.model,
            angle,
            (supports, closed),
            (self.direction(), torque, self.half_length),
        ))
    }

    fn role(&self, contact: &Contact, pockets: &[&LoadedIntrusion]) -> Role {
        let bears = |p: &&LoadedIntrusion| p.place.bears(self.profile, contact);
        if pockets.iter().any(bears) {
            Role::Pocket
        } else if self.model.parts[contact.part].kind == BodyKind::Belly {
            Role::Belly
        } else {
            Role::Track
        }
    }

    /// What would bear on an intrusion if a belt closed the pocket: the root belt, at its edge.
    fn closed(&self, pose: Pose, stance: &Stance, place: &Intrusion) -> Support {
        let edge = &self.profile.edges[place.edge as usize];
        let point = Vector::new(edge.x, edge.y);
        let outward = self
            .envelope
            .outward_at(pose.inverse_transform_point(point));
        let normal = -(pose.rotation * outward);
        let arm = point - pose.transform_point(self.model.center_of_mass);
        let part = &self.model.parts[place.bodies[0]];
        let motion = if part.drive.is_some() {
            left_of(normal)
        } else {
            Vector::ZERO
        };
        let speed = part.drive.map_or(0.0, |k| stance.drives[k].speed);
        let slides = if self.is_moving(speed) {
            right_of(normal).dot(motion) * speed
        } else {
            0.0
        };
        Support {
            normal: Direction::new(normal, arm, motion, self.model),
            tangent: Direction::new(right_of(normal), arm, motion, self.model),
            drive: part.drive,
            friction: part.friction_limit.min(self.profile.friction),
            slides,
            role: Role::Track,
        }
    }
}
