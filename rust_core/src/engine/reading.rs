//! The engine's bodies and contacts in the terms of our own: a state, and contacts with their forces.

use std::f64::consts::{PI, TAU};

use rapier2d_f64::prelude::{ContactPair, JointAxis, RigidBodyHandle};

use super::world::EngineWorld;
use super::world::Motion;
use crate::contact::Contact;
use crate::dynamics::State;
use crate::geometry::{Vector, cross, right_of};
use crate::robot::Model;
use crate::solver::Grip;
use crate::terrain::{Ground, Profile};

/// Normals closer than this are equal, and points closer than this [m].
const SAME_DIRECTION: f64 = 1e-12;
const SAME_POINT: f64 = 1e-9;

impl EngineWorld {
    /// Reads where everything is after a step of `h` [s], and what the drives did in it against these contacts.
    pub(super) fn read(&self, model: &Model, contacts: &[Contact], state: &mut State, h: f64) {
        let rotation = *self.world.bodies[self.robot.chassis].rotation();
        let chassis = Motion::of(&self.world, self.robot.chassis);
        state.angle += to_half_turn(rotation.angle() - state.angle);
        (state.center, state.velocity) = (chassis.center, chassis.velocity);
        state.angular_velocity = chassis.spin;
        for drive in 0..state.drives.len() {
            self.read_drive(model, contacts, (state, drive), h);
        }
        if model.pushes_chassis {
            let origin = state.pose(model).translation;
            let speed = chassis.at(origin).dot(rotation * Vector::X);
            let drive = &mut state.drives[0];
            drive.position += speed * h;
            drive.spin = state.angular_velocity - speed / model.drive_radius;
            drive.force = self.push_force(h);
            drive.traction = drive.force;
        }
    }

    /// Reads a drive from its wheels: how far they have turned since they were read last, and what turned them.
    fn read_drive(
        &self,
        model: &Model,
        contacts: &[Contact],
        (state, drive): (&mut State, usize),
        h: f64,
    ) {
        let wheels = || self.robot.wheels.iter().filter(|w| w.drive == drive);
        let count = wheels().count() as f64;
        if count == 0.0 {
            return;
        }
        let run = state.drives[drive].position;
        let (mut way, mut speed, mut gained, mut traction) = (0.0, 0.0, 0.0, 0.0);
        for wheel in wheels() {
            let body = &self.world.bodies[wheel.body];
            let spin = Motion::of(&self.world, wheel.body).spin;
            let known = state.angle + model.parts[wheel.part].turn(run);
            way -= to_half_turn(body.rotation().angle() - known) * wheel.radius;
            speed += (state.angular_velocity - spin) * wheel.radius;
            gained += wheel.inertia * (spin - wheel.spin_before) / wheel.radius;
            let on_it = contacts.iter().filter(|l| l.part == wheel.part);
            let moments = on_it.map(|l| cross(l.point - wheel.center_before, l.force()));
            traction += moments.sum::<f64>() / wheel.radius;
        }
        let drive = &mut state.drives[drive];
        drive.position += way / count;
        drive.spin = state.angular_velocity - speed / count / model.drive_radius;
        drive.traction = traction;
        drive.force = traction - gained / h;
    }

    /// [N] Force of the push along the chassis in the last substep.
    fn push_force(&self, h: f64) -> f64 {
        let joints = &self.world.impulse_joints;
        let joint = self.robot.push.and_then(|push| joints.get(push));
        let substeps = self.world.integration_parameters.num_solver_iterations as f64;
        joint.map_or(0.0, |joint| {
            joint.data.motors[JointAxis::LinX as usize].impulse * substeps / h
        })
    }

    /// The contacts of a step of `h` [s], sorted by part and x, where they were at its beginning.
    pub(super) fn contacts(&self, model: &Model, ground: &Ground, h: f64) -> Vec<Contact> {
        let pairs = self.world.narrow_phase.contact_pairs();
        let mut found: Vec<Contact> = pairs
            .flat_map(|pair| self.contacts_of(pair, model, ground, h))
            .collect();
        let place = |l: &Contact| (l.part, l.point.x, l.normal.x);
        found.sort_by(|a, b| {
            let (a, b) = (place(a), place(b));
            a.0.cmp(&b.0)
                .then(a.1.total_cmp(&b.1))
                .then(a.2.total_cmp(&b.2))
        });
        merged(found)
    }

    fn contacts_of<'a>(
        &'a self,
        pair: &'a ContactPair,
        model: &'a Model,
        ground: &'a Ground,
        h: f64,
    ) -> impl Iterator<Item = Contact> + 'a {
        let colliders = &self.world.colliders;
        // The ground has no body.
        let ground_first = colliders[pair.collider1].parent().is_none();
        let own = if ground_first {
            pair.collider2
        } else {
            pair.collider1
        };
        let part = colliders[own].user_data as usize;
        let body = colliders[own]
            .parent()
            .unwrap_or_else(|| unreachable!("a part has a body"));
        let lane = &ground.lanes[model.parts[part].lane];
        let friction = lane
            .friction
            .most()
            .at_most(model.parts[part].friction_limit);
        pair.manifolds().iter().flat_map(move |manifold| {
            let (segment, normal) = if ground_first {
                (manifold.subshape1, manifold.data.normal)
            } else {
                (manifold.subshape2, -manifold.data.normal)
            };
            let facet = lane.points.len() - 2 - segment as usize;
            // The engine measures friction along the normal from the first collider turned to the left, on the first.
            let points = manifold.points.iter();
            points.map(move |point| {
                let on_ground = if ground_first {
                    point.local_p1
                } else {
                    point.local_p2
                };
                let contact = contact_at((lane, facet), (part, on_ground), normal, point.dist);
                let (pressed, rubbed) = (point.data.impulse / h, -point.data.tangent_impulse.x / h);
                self.loaded(contact, body, (pressed, rubbed), friction.coefficient)
            })
        })
    }

    fn loaded(
        &self,
        contact: Contact,
        body: RigidBodyHandle,
        (normal_force, friction_force): (f64, f64),
        friction: f64,
    ) -> Contact {
        let velocity = Motion::of(&self.world, body).at(contact.point);
        Contact {
            normal_force,
            friction_force,
            surface_speed: velocity.dot(right_of(contact.normal)),
            normal_guess: normal_force,
            friction_guess: friction_force,
            grip: grip(normal_force, friction_force, friction),
            ..contact
        }
    }
}

/// How a contact with these forces grips.
fn grip(normal: f64, friction: f64, coefficient: f64) -> Grip {
    /// Share of the limit from which it slides: all of it, but for what the engine's rounds leave.
    const SLIDES_FROM: f64 = 1.0 - 1e-6;

    if normal <= 0.0 {
        Grip::Open
    } else if friction.abs() < SLIDES_FROM * coefficient * normal {
        Grip::Sticks
    } else if friction > 0.0 {
        Grip::Forwards
    } else {
        Grip::Backwards
    }
}

fn contact_at(
    (lane, facet): (&Profile, usize),
    (part, on_ground): (usize, Vector),
    normal: Vector,
    distance: f64,
) -> Contact {
    let middle = on_ground + 0.5 * distance * normal;
    let edge = lane.edge_at(facet, on_ground);
    Contact::new(part, (facet, edge), (middle, normal), distance)
}

/// The same contacts, with one in place of several on the same part at the same point: at a corner of the ground the
/// engine has one for each facet, whose forces add up.
fn merged(contacts: Vec<Contact>) -> Vec<Contact> {
    let mut kept: Vec<Contact> = Vec::with_capacity(contacts.len());
    for next in contacts {
        let same = kept.iter_mut().rev().find(|last| {
            let (a, b) = (&**last, &next);
            a.part == b.part
                && (a.point - b.point).length() < SAME_POINT
                && 1.0 - a.normal.dot(b.normal) < SAME_DIRECTION
        });
        match same {
            Some(last) => {
                last.normal_force += next.normal_force;
                last.friction_force += next.friction_force;
                last.normal_guess = last.normal_force;
                last.friction_guess = last.friction_force;
            }
            None => kept.push(next),
        }
    }
    kept
}

/// [rad] The same angle between half a turn backwards and forwards.
fn to_half_turn(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}
