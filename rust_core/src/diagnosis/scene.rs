//! A stop in its surroundings: ground inside the track, contacts that bear, motion of the surfaces there, and forces
//! that could hold it.
//!
//! Belts with grousers and chains keep running while a robot is stopped, so the part that bore at a place may be
//! elsewhere when the stop is examined. Then the motion is that of the part at this place now.

use super::findings::{Facts, LoadedIntrusion, StopContact};
use super::statics::{Hinge, Statics, Support};
use crate::contact::{Contact, Intrusion, TrackEnvelope};
use crate::dynamics::{Carrier, Direction, Levers};
use crate::geometry::{Motion, Pose, Vector, cross, right_of};
use crate::observe::{Bearing, DriveMean, Stance};
use crate::robot::{BodyKind, Model, Mount, Running, Shape};
use crate::scenario::SeizureCriteria;
use crate::terrain::Profile;

/// Input of a diagnosis in addition to the stop itself.
pub(crate) struct Scene<'a> {
    pub model: &'a Model,
    pub lanes: &'a [Profile],
    /// Envelope of each track, with its lane.
    pub envelopes: &'a [TrackEnvelope],
    pub criteria: &'a SeizureCriteria,
    pub gravity: f64,
    /// 1 or -1 as commanded.
    pub direction: f64,
    /// [m/s] Current set-point, within the acceleration limits.
    pub set_point: f64,
    /// [m] Half the distance between the end axles.
    pub half_length: f64,
    /// Positions of the moving parts.
    pub running: Running,
}

impl Scene<'_> {
    /// Ground inside the track that carries weight, with the force on it. There is none inside a single smooth body,
    /// which a moving robot only touched at different times.
    pub(super) fn loaded_intrusions(&self, stance: &Stance) -> Vec<LoadedIntrusion> {
        let least = self.criteria.intrusion_load * self.model.mass * self.gravity;
        let found = self.envelopes.iter().flat_map(|envelope| {
            let pose = self.running.mounted(envelope.mount, stance.pose());
            envelope.intrusions(&self.lanes[envelope.lane], pose)
        });
        let is_inside = |i: &Intrusion| {
            let [before, after] = i.bodies;
            i.edge >= 0 && (before != after || i.root_depth < i.depth)
        };
        let with_force = found.filter(is_inside).map(|place| {
            let on_it = stance
                .bearings
                .iter()
                .filter(|b| self.bears_on(&place, &b.contact));
            let force = on_it.map(|b| b.contact.normal_force).sum();
            let kinds = place.bodies.map(|body| self.model.parts[body].kind);
            LoadedIntrusion {
                carrier: self.model.carrier(place.mount),
                place,
                kinds,
                force,
            }
        });
        with_force.filter(|i| i.force > least).collect()
    }

    /// Whether an intrusion is in a pocket: between two bodies, and deeper than their root circles. Between two
    /// grousers of one wheel, it is grip; inside a single surface, it is a dent.
    pub(super) fn is_pocket(&self, intrusion: &LoadedIntrusion) -> bool {
        let [before, after] = intrusion.place.bodies;
        before != after && intrusion.place.root_depth > self.criteria.intrusion_depth
    }

    fn bears_on(&self, place: &Intrusion, contact: &Contact) -> bool {
        place.bears(self.lanes, &self.model.parts, contact)
    }

    /// Friction coefficient at a contact.
    fn friction(&self, contact: &Contact) -> f64 {
        let part = &self.model.parts[contact.part];
        let friction = self.lanes[part.lane].friction.at(contact.point);
        friction.at_most(part.friction_limit).coefficient
    }

    /// Whether a surface speed [m/s] is more than the creep of a sticking contact.
    pub(super) fn is_moving(&self, speed: f64) -> bool {
        speed.abs() > self.criteria.sliding_speed * self.set_point.abs()
    }

    fn slides(&self, contact: &Contact) -> bool {
        /// Fraction of the friction cone that a rattling contact must use on average.
        const WHILE_RATTLING: f64 = 0.95;

        let limit = self.friction(contact) * contact.normal_force;
        self.is_moving(contact.surface_speed)
            && contact.friction_force.abs() >= WHILE_RATTLING * limit
    }

    /// The facts that determine the mechanism.
    pub(super) fn facts(&self, stance: &Stance, inside: Option<&LoadedIntrusion>) -> Facts {
        let of_stop = |Bearing { contact, .. }: &Bearing| {
            let part = &self.model.parts[contact.part];
            StopContact {
                number: contact.number,
                body: contact.part,
                kind: part.kind,
                segment: contact.facet,
                edge: contact.edge,
                point: contact.point,
                normal: contact.normal,
                normal_force: contact.normal_force,
                friction_force: contact.friction_force,
                surface_speed: contact.surface_speed,
                slides: self.slides(contact),
                in_pocket: inside.is_some_and(|p| self.bears_on(&p.place, contact)),
                side: self.lanes[part.lane].side,
            }
        };
        let contacts: Vec<StopContact> = stance.loaded().map(of_stop).collect();
        let sum = |of: &dyn Fn(&StopContact) -> f64| contacts.iter().map(of).sum::<f64>();
        let normal = sum(&|c| c.normal_force).max(f64::MIN_POSITIVE);
        let lift = |c: &StopContact| {
            let force = c.normal * c.normal_force + right_of(c.normal) * c.friction_force;
            force.y.max(0.0)
        };
        let all_lift = sum(&lift).max(f64::MIN_POSITIVE);
        let on = |is: bool, value: f64| if is { value } else { 0.0 };
        // A wheel in the air turns, whatever holds the robot.
        let on_drive = |k: usize| {
            contacts
                .iter()
                .any(|c| self.model.parts[c.body].drive == Some(k))
        };
        let bears = |k: &usize| self.model.push_drive() == Some(*k) || on_drive(*k);
        let bearing = self.model.driven().filter(bears);
        let motors: Vec<&DriveMean> = bearing.filter_map(|k| stance.drives.get(k)).collect();
        // The load may also turn it backwards.
        let is_overcome = |d: &&&DriveMean| !self.is_moving(d.speed) || d.speed * d.force < 0.0;
        let at_limit = motors.iter().filter(|d| self.is_at_limit(d));
        let stalled = at_limit.filter(is_overcome).count();
        Facts {
            belly_share: sum(&|c| on(c.kind == BodyKind::Belly, lift(c))) / all_lift,
            sliding_share: sum(&|c| on(c.slides, c.normal_force)) / normal,
            stalled_share: stalled as f64 / motors.len().max(1) as f64,
            flank: self.bears_on_a_flank(stance, &contacts),
            pinched: self.pinches(stance, &contacts),
            contacts,
        }
    }

    /// Whether a surface in the pocket would move into the ground if its drive turned as commanded: the flank of a
    /// grouser.
    fn bears_on_a_flank(&self, stance: &Stance, contacts: &[StopContact]) -> bool {
        /// Fraction of the surface speed along the normal; zero for a round wheel, except for rounding.
        const INTO_GROUND: f64 = 0.05;

        stance.loaded().zip(contacts).any(|(bearing, contact)| {
            // A surface speed of 1 moves the surface by -spin_lever / drive_radius along the normal.
            let levers = self.levers(stance.pose(), &bearing.contact);
            let into_ground = levers.normal.spin_lever;
            contact.in_pocket
                && self.direction * into_ground > INTO_GROUND * self.model.drive_radius
        })
    }

    /// Levers of a contact of the robot, taken as one body, in a pose.
    fn levers(&self, pose: Pose, contact: &Contact) -> Levers {
        let origin = self.model.center_of_mass;
        let body = Carrier {
            center: pose.transform_point(origin),
            origin,
            angle: pose.rotation.angle(),
        };
        let motion = self.motion(contact.part, pose.inverse_transform_point(contact.point));
        Levers::new(contact, &body, motion, self.model)
    }

    /// The statics of a stop; `None` without a weight.
    pub(super) fn statics(&self, stance: &Stance) -> Option<Statics> {
        self.statics_where(stance, &|contact| self.slides(contact))
    }

    /// The same from the motion of the surfaces alone: whatever moves on the ground slides, regardless of its force.
    pub(super) fn statics_of_surfaces(&self, stance: &Stance) -> Option<Statics> {
        self.statics_where(stance, &|contact| self.is_moving(contact.surface_speed))
    }

    fn statics_where(&self, stance: &Stance, slides: &dyn Fn(&Contact) -> bool) -> Option<Statics> {
        let weight = self.model.mass * self.gravity;
        if weight <= 0.0 {
            return None;
        }
        let pose = stance.pose();
        let supports = stance.bearings.iter().map(|Bearing { contact, .. }| {
            let slip = contact.surface_speed.signum();
            let slides = if slides(contact) { slip } else { 0.0 };
            self.support(pose, contact, slides)
        });
        let of_drive = |k: usize| {
            let bounds = self.bounds(stance.drives.get(k));
            bounds.map(|bound| bound / weight)
        };
        Some(Statics::new(
            self.model,
            stance.angle,
            supports.collect(),
            self.hinges(pose),
            (0..self.model.drives).map(of_drive).collect(),
            self.half_length,
        ))
    }

    /// [N] Smallest and largest force of a motor whose drive moves like this, if known. A self-locking gear bears any
    /// load at rest, and brakes without limit.
    fn bounds(&self, drive: Option<&DriveMean>) -> [f64; 2] {
        let motor = &self.model.motor;
        if !motor.self_locking {
            return [-motor.force, motor.force];
        }
        match drive.map(|drive| drive.speed) {
            Some(speed) if self.is_moving(speed) && speed > 0.0 => [f64::NEG_INFINITY, motor.force],
            Some(speed) if self.is_moving(speed) => [-motor.force, f64::INFINITY],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// A contact as a support; `slides` is the sign of its slip, 0 while it sticks.
    fn support(&self, pose: Pose, contact: &Contact, slides: f64) -> Support {
        let levers = self.levers(pose, contact);
        let part = &self.model.parts[contact.part];
        let directions = [levers.normal, levers.tangent];
        let (hinge, [normal, tangent]) = self.hung(part.mount, pose, contact.point, directions);
        Support {
            normal,
            tangent,
            drive: part.drive,
            hinge,
            friction: self.friction(contact),
            slides,
        }
    }

    /// Whether a motor is at its torque limit, on average.
    fn is_at_limit(&self, drive: &DriveMean) -> bool {
        drive.force.abs() >= self.criteria.torque_limit * self.model.motor.force
    }
}

impl Scene<'_> {
    /// Motion relative to the chassis, per metre that the drive of a part runs; its contact is at `point` [m] in the
    /// chassis frame.
    pub(super) fn motion(&self, part: usize, point: Vector) -> Motion {
        let mount = self.model.parts[part].mount;
        match mount {
            Mount::Shoe(shoe) => self.motion_of_shoe(shoe, point),
            Mount::Chassis => self.motion_over_mount(part, point),
            Mount::Flipper(k) => {
                let pose = self.running.flippers[k].pose;
                let there = pose.inverse_transform_point(point);
                self.motion_over_mount(part, there).seen_from(pose)
            }
        }
    }

    fn motion_over_mount(&self, part: usize, point: Vector) -> Motion {
        let part = &self.model.parts[part];
        let run = part.run(&self.running);
        match &part.shape {
            Shape::Grouser(grouser) => grouser.motion_where(run, point),
            _ => part.motion(run, 0.0),
        }
    }

    /// As the chain runs, each shoe moves to the place of the next one. So the places of its neighbours give its
    /// motion, including the travel of the tensioner.
    fn motion_of_shoe(&self, shoe: usize, point: Vector) -> Motion {
        /// Distance from its middle, in pitches, within which a contact belongs to the shoe.
        const OWN: f64 = 0.75;

        let places = &self.running.shoes;
        let of_shoe = self.model.chains.iter().find(|c| c.shoes.contains(&shoe));
        let Some(chain) = of_shoe else {
            return Motion::default();
        };
        let distance = |shoe: usize| (places[shoe].translation - point).length();
        let there = if distance(shoe) < OWN * chain.path.pitch {
            shoe
        } else {
            let nearest = chain
                .shoes
                .clone()
                .min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            nearest.unwrap_or(shoe)
        };
        let (first, count) = (chain.shoes.start, chain.shoes.len());
        let beside = |steps: usize| places[first + (there - first + steps) % count];
        between(beside(count - 1), beside(1), 2.0 * chain.path.pitch)
    }
}

/// The motion from one place to another while a chain runs by a distance [m].
fn between(from: Pose, to: Pose, run: f64) -> Motion {
    let turn = (from.rotation.inverse() * to.rotation).angle();
    let half = 0.5 * turn;
    // Fraction of the displacement that remains as translation if the turn is about the midpoint.
    let share = if half.abs() < 1e-6 {
        1.0
    } else {
        half / libm::tan(half)
    };
    Motion {
        center: 0.5 * (from.translation + to.translation),
        turn: -turn / run,
        along: (to.translation - from.translation) * (share / run),
    }
}

impl Scene<'_> {
    /// The hinges of the robot in a pose.
    pub(super) fn hinges(&self, pose: Pose) -> Vec<Hinge> {
        let arms = self.model.flippers.iter().zip(&self.running.flippers);
        arms.map(|(arm, mounted)| {
            let spoke = pose.rotation * (mounted.pose.translation - arm.pivot);
            Hinge {
                weight: spoke.x * arm.mass / self.model.mass,
                torque: if arm.self_locking {
                    f64::INFINITY
                } else {
                    arm.torque_limit / (self.model.mass * self.gravity)
                },
            }
        })
        .collect()
    }

    /// The hinge of a mount, and a direction with its lever about that hinge. The belt of a turning arm runs along the
    /// arm, because the sprocket stands still.
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
            joint_lever: cross(arm, direction.unit) - direction.spin_lever,
            ..direction
        });
        (Some(k), hung)
    }
}

/// [rad] Smallest angle between two pinching shoes; on a straight run, the angle is less.
const BENT: f64 = 0.05;
/// Fraction of the time during which each shoe must bear, so that both do so at once. Shoes that slip past one after
/// another hold nothing.
const STAYS: f64 = 0.5;

impl Scene<'_> {
    /// Whether two neighbouring shoes bear on the ground inside the track where the gap between them is closing: bent
    /// apart, as round an end of the track, and about to be straightened, as at the leading end.
    pub(super) fn pinches(&self, stance: &Stance, contacts: &[StopContact]) -> bool {
        let mut durations = vec![0.0; self.running.shoes.len()];
        for (bearing, contact) in stance.loaded().zip(contacts).filter(|(_, c)| c.in_pocket) {
            if let Some(shoe) = self.model.parts[contact.body].mount.shoe() {
                durations[shoe] += bearing.duration;
            }
        }
        let closes = |one: usize, next: usize| {
            let [a, b] = [one, next].map(|shoe| self.running.shoes[shoe]);
            let bent = (a.rotation.inverse() * b.rotation).angle().abs();
            let middle_leads = self.direction * (a.translation.x + b.translation.x) > 0.0;
            durations[one].min(durations[next]) > STAYS && bent > BENT && middle_leads
        };
        self.model.chains.iter().any(|chain| {
            let next = |shoe: usize| {
                if shoe + 1 == chain.shoes.end {
                    chain.shoes.start
                } else {
                    shoe + 1
                }
            };
            chain.shoes.clone().any(|shoe| closes(shoe, next(shoe)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation, left_of};

    #[test]
    fn between_two_places_on_a_circle_it_turns_about_its_middle() {
        let (radius, turn) = (0.05, 0.7);
        let place = |angle: f64| {
            let (sine, cosine) = libm::sincos(angle);
            Pose::from_parts(Vector::new(cosine, sine) * radius, Rotation::new(angle))
        };
        // Clockwise, as when a chain drives forwards.
        let motion = between(place(turn), place(-turn), 2.0 * turn * radius);
        for point in [Vector::new(0.05, 0.0), Vector::new(0.06, 0.01)] {
            let expected = -left_of(point) / radius;
            assert!((motion.at(point) - expected).length() < 1e-12);
        }
    }

    #[test]
    fn between_two_places_on_a_line_it_goes_straight() {
        let place = |x: f64| Pose::from_translation(Vector::new(x, 0.0));
        let motion = between(place(0.1), place(0.0), 0.1);
        assert!((motion.at(Vector::new(0.3, 0.2)) - Vector::new(-1.0, 0.0)).length() < 1e-12);
    }
}
