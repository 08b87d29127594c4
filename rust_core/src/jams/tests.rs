//! A robot with a few surfaces over a few pieces of ground, drawn so that they touch in a known pose.
#![allow(clippy::float_cmp)] // what is not changed is equal

mod loads;
mod overlap;
mod poses;
mod wall;
mod whole;

use std::f64::consts::TAU;

use super::contact::{Contact, Kind, Posture, Turn};
use super::layout::{Grip, Layout, Outline, Solid, Surface};
use super::places::{Facing, Place};
use super::setting::Setting;
use crate::draw::Draw;
use crate::geometry::{Disc, Vector, cross, left_of, right_of};
use crate::limits::Cancel;
use crate::robot::BodyKind;

pub(super) fn vector(draw: &mut Draw, most: f64) -> Vector {
    let [x, y] = [0.0; 2].map(|_| draw.between(-most, most));
    Vector::new(x, y)
}

pub(super) fn unit(draw: &mut Draw) -> Vector {
    Vector::from_angle(draw.between(-0.5 * TAU, 0.5 * TAU))
}

pub(super) fn posture(draw: &mut Draw) -> Posture {
    Posture {
        position: vector(draw, 0.5),
        angle: draw.between(-1.2, 1.2),
    }
}

/// Kinds of contacts: a disc on a face, a disc on a corner, or a straight run on a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pair {
    OnFace,
    OnCorner,
    Across,
}

pub(super) const PAIRS: [Pair; 3] = [Pair::OnFace, Pair::OnCorner, Pair::Across];

/// A surface of a robot and a piece of ground that touch in a pose, with this unit vector from the ground to the robot.
pub(super) fn touching(
    draw: &mut Draw,
    pair: Pair,
    at: &Posture,
    normal: Vector,
) -> (Outline, Facing, Vector) {
    let turn = Turn::by(at.angle);
    let back = Turn::by(-at.angle);
    let [radius, round] = [draw.between(0.02, 0.1), draw.between(0.0, 0.02)];
    let cone = [-0.8, 0.8].map(|angle| Vector::from_angle(angle).rotate(normal));
    match pair {
        Pair::OnFace | Pair::OnCorner => {
            let disc = Disc {
                center: vector(draw, 0.3),
                radius,
            };
            let point = at.position + turn.apply(disc.center) - normal * radius;
            let along = right_of(normal);
            let facing = if pair == Pair::OnFace {
                Facing::Face {
                    ends: [point - along * 0.2, point + along * 0.3],
                    normal,
                }
            } else {
                Facing::Corner {
                    center: point - normal * round,
                    radius: round,
                    cone,
                }
            };
            (Outline::Round(disc), facing, point)
        }
        Pair::Across => {
            let outward = back.apply(-normal);
            let middle =
                outward * draw.between(0.02, 0.1) + left_of(outward) * draw.between(-0.2, 0.2);
            let ends = [-0.1, 0.2].map(|along| middle + left_of(outward) * along);
            let point = at.position + turn.apply(middle);
            let facing = Facing::Corner {
                center: point - normal * round,
                radius: round,
                cone,
            };
            (Outline::Flat { ends, outward }, facing, point)
        }
    }
}

pub(super) fn surface(shape: Outline, grip: Grip) -> Surface {
    Surface {
        part: 0,
        kind: BodyKind::Wheel,
        lane: 0,
        shape,
        grip,
        friction_limit: f64::INFINITY,
    }
}

pub(super) fn place(shape: Facing, friction: f64) -> Place {
    Place {
        lane: 0,
        edge: None,
        shape,
        friction,
    }
}

/// A robot with these surfaces and centre of mass, over these pieces of ground.
pub(super) fn setting(
    surfaces: Vec<Surface>,
    places: Vec<Place>,
    center_of_mass: Vector,
) -> Setting {
    let layout = Layout {
        center_of_mass,
        reach: 1.0,
        surfaces,
        solids: Vec::new(),
    };
    let all = [-0.5 * TAU, 0.5 * TAU];
    Setting::new(layout, places, all, &Cancel::default()).expect("there are few contacts")
}

/// The contact of a surface with a place, both of the same number.
pub(super) fn contact_of(setting: &Setting, number: usize) -> usize {
    let is_it = |c: &Contact| c.surface == number && c.place == number;
    let found = setting.contacts.iter().position(is_it);
    found.expect("both can touch")
}

/// A robot that stands on two surfaces in a pose.
pub(super) struct Standing {
    pub at: Posture,
    pub kinds: [Pair; 2],
    pub setting: Setting,
}

/// One whose centre of mass is put over the point in which the lines of two forces meet; `None` if they hardly do, or
/// far away.
pub(super) fn on_two(draw: &mut Draw, case: usize) -> Option<Standing> {
    let at = posture(draw);
    let frictions = [0.0; 2].map(|_| draw.between(0.2, 0.9));
    let grips = [
        [Grip::Driven(1.0), Grip::Driven(-1.0), Grip::Free][case / 9 % 3],
        [Grip::Driven(1.0), Grip::Still][case / 27 % 2],
    ];
    let normals = [draw.between(0.2, 1.4), draw.between(1.8, 3.0)].map(Vector::from_angle);
    let kinds = [case, case / 3].map(|k| PAIRS[k % 3]);
    let pieces = [0, 1].map(|k| touching(draw, kinds[k], &at, normals[k]));
    let forces = [0, 1].map(|k| {
        let slope = match grips[k] {
            Grip::Driven(sign) => sign * frictions[k],
            Grip::Free => 0.0,
            Grip::Still => frictions[k],
        };
        normals[k] + right_of(normals[k]) * slope
    });
    // One line is p + s f; the other is q + t g.
    let (p, q) = (pieces[0].2, pieces[1].2);
    let s = cross(q - p, forces[1]) / cross(forces[0], forces[1]);
    let crossing = p + forces[0] * s;
    let over = Vector::new(crossing.x, at.position.y + draw.between(-0.1, 0.1));
    let center_of_mass = Turn::by(-at.angle).apply(over - at.position);
    let sine = cross(forces[0].normalize(), forces[1].normalize());
    if sine.abs() < 0.2 || center_of_mass.length() > 0.6 {
        return None;
    }
    let surfaces = [0, 1].map(|k| surface(pieces[k].0, grips[k])).to_vec();
    let places = [0, 1].map(|k| place(pieces[k].1, frictions[k])).to_vec();
    Some(Standing {
        at,
        kinds,
        setting: setting(surfaces, places, center_of_mass),
    })
}
