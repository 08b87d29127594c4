//! The escape force of a stop: the largest push that can be balanced.
//!
//! A pushed robot may slip a little and catch again. So what holds it is the largest push that can be balanced
//! within the next millimetres. On the way, the robot settles on the ground under its weight, surfaces keep
//! sliding and motors keep pushing.

use super::forces::Push;
use super::linear_program::Rows;
use super::scene::Scene;
use super::statics::{Role, Statics, Support};
use crate::contact::{Contact, ContactFinder};
use crate::geometry::{Pose, Rotation, Vector, cross, right_of};
use crate::observe::Stance;

/// [m] Distances ahead at which the balance is examined.
const WAY: [f64; 6] = [2e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3];
/// [m] Surfaces closer than this bear.
const BEARS: f64 = 1e-5;
/// [m] Contacts farther away than this play no part in one round of settling.
const REACH: f64 = 5e-3;
/// Largest number of rounds of settling; gaps are linear in the pose to first order.
const ROUNDS: usize = 8;

/// The largest push along the command that can be balanced on the way, in weights; `None` if the robot cannot be
/// balanced at all.
pub(super) fn force(scene: &Scene, stance: &Stance, here: &Statics, tolerance: f64) -> Option<f64> {
    let direction = scene.direction();
    let first = here.escape(direction, tolerance)?;
    let mut largest = first.force;
    if largest.is_infinite() {
        return Some(largest);
    }
    let parts = |push: &Push, part: &dyn Fn(usize) -> usize| {
        let mut parts: Vec<usize> = push.bearing.iter().map(|i| part(*i)).collect();
        parts.sort_unstable();
        parts
    };
    let bearing = parts(&first, &|i| stance.bearings[i].contact.part);
    let mut finder = ContactFinder::new(scene.contact, &scene.model.parts, scene.lanes);
    let mut pose = Pose::new(stance.position, stance.angle);
    for way in WAY {
        if largest.is_infinite() {
            break;
        }
        pose.translation.x = stance.position.x + direction * way;
        let Some(contacts) = settle(scene, &mut finder, &mut pose) else {
            break;
        };
        let supports = contacts
            .iter()
            .map(|contact| moving(scene, stance, pose, contact))
            .collect();
        let there = scene.balance(pose, stance, supports, Vec::new());
        match there.escape(direction, tolerance) {
            Some(push) if parts(&push, &|i| contacts[i].part) == bearing => {
                largest = largest.max(push.force);
            }
            // Without a balance there, or with other bodies bearing, slipping does not lead there.
            _ => break,
        }
    }
    Some(largest)
}

/// A contact of the robot while it moves in the commanded direction.
fn moving(scene: &Scene, stance: &Stance, pose: Pose, contact: &Contact) -> Support {
    let drive = scene.model.parts[contact.part].drive;
    let mut support = scene.support(pose, contact, 0.0, Role::Track);
    support.slides = match drive {
        Some(k) if scene.is_moving(stance.drives[k].speed) => {
            support.slip_at(stance.drives[k].speed)
        }
        // A surface that does not slide rolls, and its motor keeps pushing.
        Some(_) => 0.0,
        None => right_of(contact.normal).x * scene.direction(),
    };
    support
}

/// Lowers the robot onto the ground, keeping its x; returns its contacts there, or `None` if it does not come to
/// rest.
fn settle(scene: &Scene, finder: &mut ContactFinder, pose: &mut Pose) -> Option<Vec<Contact>> {
    /// [m], [rad] Largest motion per round.
    const FARTHEST: [f64; 2] = [2e-3, 0.02];

    let mut contacts = Vec::new();
    for _ in 0..ROUNDS {
        finder.find(*pose, &scene.running, REACH, &mut contacts);
        let center = pose.transform_point(scene.model.center_of_mass);
        // Variables: rise of the centre of mass [m], turn about it [rad].
        let mut rows = Rows::default();
        for contact in &contacts {
            let lever = cross(contact.point - center, contact.normal);
            rows.push(vec![-contact.normal.y, -lever], contact.distance);
        }
        for (i, most) in FARTHEST.into_iter().enumerate() {
            for sign in [-1.0, 1.0] {
                let mut row = vec![0.0; 2];
                row[i] = sign;
                rows.push(row, most);
            }
        }
        let [rise, turn] = rows.minimise(&[1.0, 0.0])?[..] else {
            return None;
        };
        let turned = Rotation::new(turn);
        let moved = center + Vector::new(0.0, rise) + turned * (pose.translation - center);
        // The chassis frame keeps its x; the centre of mass moves a little.
        *pose = Pose::from_parts(
            Vector::new(pose.translation.x, moved.y),
            turned * pose.rotation,
        );
        if rise.abs() + turn.abs() * scene.half_length < 0.1 * BEARS {
            contacts.retain(|c| c.distance < BEARS);
            return Some(contacts);
        }
    }
    None
}
