//! A robot with a few surfaces over a few pieces of ground, drawn so that they touch in a known pose.
#![allow(clippy::float_cmp)] // what is not changed is equal

mod loads;
mod overlap;
mod poses;

use std::f64::consts::TAU;

use super::contact::{Contact, Kind, Posture, Turn};
use super::layout::{Grip, Layout, Outline, Solid, Surface};
use super::places::{Facing, Place};
use super::setting::Setting;
use crate::draw::Draw;
use crate::geometry::{Disc, Vector, left_of, right_of};
use crate::limits::Cancel;
use crate::robot::BodyKind;

fn vector(draw: &mut Draw, most: f64) -> Vector {
    let [x, y] = [0.0; 2].map(|_| draw.between(-most, most));
    Vector::new(x, y)
}

fn unit(draw: &mut Draw) -> Vector {
    Vector::from_angle(draw.between(-0.5 * TAU, 0.5 * TAU))
}

fn posture(draw: &mut Draw) -> Posture {
    Posture {
        position: vector(draw, 0.5),
        angle: draw.between(-1.2, 1.2),
    }
}

/// Kinds of contacts: a disc on a face, a disc on a corner, or a straight run on a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pair {
    OnFace,
    OnCorner,
    Across,
}

const PAIRS: [Pair; 3] = [Pair::OnFace, Pair::OnCorner, Pair::Across];

/// A surface of a robot and a piece of ground that touch in a pose, with this unit vector from the ground to the robot.
fn touching(
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

fn surface(shape: Outline, grip: Grip) -> Surface {
    Surface {
        part: 0,
        kind: BodyKind::Wheel,
        lane: 0,
        shape,
        grip,
        friction_limit: f64::INFINITY,
    }
}

fn place(shape: Facing, friction: f64) -> Place {
    Place {
        lane: 0,
        edge: None,
        shape,
        friction,
    }
}

/// A robot with these surfaces and centre of mass, over these pieces of ground.
fn setting(surfaces: Vec<Surface>, places: Vec<Place>, center_of_mass: Vector) -> Setting {
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
fn contact_of(setting: &Setting, number: usize) -> usize {
    let is_it = |c: &Contact| c.surface == number && c.place == number;
    let found = setting.contacts.iter().position(is_it);
    found.expect("both can touch")
}
