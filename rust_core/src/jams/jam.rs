//! A jam, with the contacts that carry the robot.

use super::contact::{Posture, Turn};
use super::forces::Loads;
use super::setting::Setting;
use crate::geometry::Vector;
use crate::robot::BodyKind;

/// A pose in which a robot can stand still with its drives running.
#[derive(Clone, Debug)]
pub struct Jam {
    /// [m] Position of the chassis frame.
    pub position: Vector,
    /// [rad] Its angle.
    pub angle: f64,
    /// The contacts that carry it.
    pub contacts: Vec<JamContact>,
}

/// A contact that carries a jammed robot.
#[derive(Clone, Copy, Debug)]
pub struct JamContact {
    /// Index of the part.
    pub part: usize,
    /// What it represents.
    pub kind: BodyKind,
    /// Number of the ground's edge on the lane under it, if it is a corner.
    pub edge: Option<i32>,
    /// [m] The point of the ground.
    pub point: Vector,
    /// Unit vector from the ground to the robot.
    pub normal: Vector,
    /// Normal force over the weight.
    pub load: f64,
    /// Friction over the weight, along the normal turned by -90 degrees.
    pub friction: f64,
}

impl Setting {
    /// The jam of a posture with these contacts and loads.
    pub(super) fn jam(&self, posture: &Posture, contacts: &[usize], loads: &Loads) -> Jam {
        let turn = Turn::by(posture.angle);
        let of = |(i, [load, friction]): (&usize, &[f64; 2])| {
            let contact = &self.contacts[*i];
            let touch = contact.touch_turned(posture.position, turn);
            let (surface, place) = (
                &self.layout.surfaces[contact.surface],
                &self.places[contact.place],
            );
            JamContact {
                part: surface.part,
                kind: surface.kind,
                edge: place.edge,
                point: touch.point,
                normal: touch.normal,
                load: *load,
                friction: *friction,
            }
        };
        Jam {
            position: posture.position,
            angle: posture.angle,
            contacts: contacts.iter().zip(loads).map(of).collect(),
        }
    }
}
