//! Contacts of a gear wheel with a lane: exact, and only for grousers near the ground.
//!
//! The root circle bears between grousers, tip corners bear on faces and corners of the ground, and
//! flanks and tips bear on corners of the ground. Where a tip corner and a ground corner overlap, the
//! shortest way out that both allow is the contact.
//!
//! The equations: docs/physics.md, "Contacts".

use rapier2d_f64::parry::bounding_volume::Aabb;

use super::Contact;
use super::lane::{Lane, On, Region, Touch};
use super::redundant::{Tip, run_yields, thin_out, tip_yields};
use crate::geometry::{Disc, Gear, Pose, Rotation, Vector, direction, right_of};
use crate::units::Metres;

/// [m] Ground sinks into a flank by no more than this.
const SUNK: Metres = Metres(1e-3);

/// A gear wheel of a robot.
pub(super) struct GearContact {
    part: usize,
    /// [m] Axle in the chassis frame.
    center: Vector,
    gear: Gear,
    /// Unit vectors towards the middles of the grousers, at zero travel.
    directions: Vec<Vector>,
    /// The grouser that points along +x, about the centre of the wheel.
    grouser: Grouser,
    /// [rad] Half the angle that a grouser covers on the root circle.
    half_base: f64,
}

/// A grouser in some pose.
struct Grouser {
    /// [m] Counter-clockwise, starting at its base.
    corners: [Vector; 4],
    /// Outward normals of one flank, the tip and the other flank.
    normals: [Vector; 3],
}

impl Grouser {
    /// Whether a point lies in the grouser.
    fn contains(&self, point: Vector) -> bool {
        let mut sides = self.corners.iter().zip(&self.normals);
        sides.all(|(corner, normal)| (point - *corner).dot(*normal) <= 0.0)
    }

    /// Whether a corner of the ground inside flank 0 or 2 lies less deep in the opposite flank.
    fn is_shallower_opposite(&self, lane: &Lane, flank: usize, touch: &Touch) -> bool {
        let opposite = 2 - flank;
        let normal = self.normals[opposite];
        let gap = (touch.place - self.corners[opposite]).dot(normal);
        let is_met = || matches!(touch.on, On::Corner(i) if lane.corner(i).has_normal(-normal));
        opposite != flank && gap > touch.distance && is_met()
    }

    /// Corner 1 or 2, which belong to the tip.
    fn tip(&self, k: usize) -> Tip {
        Tip {
            place: self.corners[k],
            normals: [self.normals[k - 1], self.normals[k]],
        }
    }
}

impl GearContact {
    pub(super) fn new(part: usize, center: Vector, gear: Gear) -> Self {
        let corners = gear.corners(0.0);
        // A tip may be thinner than rounding errors; its normal still points outwards.
        let edge = |i: usize| (corners[i + 1] - corners[i]).try_normalize();
        let side = |i: usize| edge(i).map_or(Vector::X, right_of);
        Self {
            part,
            center,
            gear,
            directions: gear.directions().map(direction).collect(),
            grouser: Grouser {
                corners,
                normals: [0, 1, 2].map(side),
            },
            half_base: libm::atan2(corners[3].y, corners[3].x),
        }
    }

    /// Adds every contact with a gap below `prediction`; the chassis is at `pose` and the surface of the
    /// wheel has moved by `drive` [m].
    pub(super) fn find(
        &self,
        lane: &Lane,
        pose: Pose,
        drive: f64,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let center = pose.transform_point(self.center);
        let radius = self.gear.radius;
        if center.y - radius - prediction > lane.highest() {
            return;
        }
        let region = lane.region_of_runs([center.x - radius, center.x + radius], prediction);
        let room = center.y - lane.top(&region) - prediction;
        if room > radius {
            return;
        }
        let turned = pose.rotation * Rotation::new(-drive / radius);
        if room <= self.gear.root_radius {
            // If the centre is past a face, that face is the far side of something thin.
            let (reach, radius) = ((prediction, 0.0), self.gear.root_radius);
            let first = contacts.len();
            lane.touches_of_disc(&region, center, radius, reach, |touch| {
                if self.is_between_grousers(turned.inverse() * -touch.normal) {
                    contacts.push(touch.contact(self.part));
                }
            });
            thin_out(contacts, first, lane, &Disc { center, radius }, prediction);
        }
        let [_, _, tip, base] = self.grouser.corners;
        for along in &self.directions {
            let axis = turned * *along;
            let lower = |corner: Vector| corner.x * axis.y - corner.y * axis.x.abs();
            // The lowest point of a grouser that points up is at its base.
            if room + lower(tip).min(lower(base)) > 0.0 {
                continue;
            }
            let grouser = Grouser {
                corners: self.grouser.corners.map(|p| center + axis.rotate(p)),
                normals: self.grouser.normals.map(|n| axis.rotate(n)),
            };
            let Aabb { mins, maxs } = Aabb::from_points(grouser.corners);
            let near = lane.narrow_of_runs(&region, [mins.x, maxs.x], prediction);
            if mins.y - prediction > lane.top(&near) {
                continue;
            }
            self.find_tips((lane, &near), &grouser, prediction, contacts);
            if lane.may_be_convex(&near) {
                self.find_runs((lane, &near), &grouser, prediction, contacts);
            }
        }
    }

    /// Adds the contacts of the tip corners on the ground.
    fn find_tips(
        &self,
        (lane, region): (&Lane, &Region),
        grouser: &Grouser,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        for tip in [grouser.tip(1), grouser.tip(2)] {
            let (reach, first) = ((prediction, self.height()), contacts.len());
            lane.touches_of_disc(region, tip.place, 0.0, reach, |touch| {
                // Behind a face is ground, but beyond thin ground it is open again.
                let is_real = touch.distance >= 0.0
                    || lane.contains(tip.place)
                    || grouser.contains(touch.place);
                if is_real && tip.may_bear(&touch) && !tip_yields(lane, &tip, &touch) {
                    contacts.push(touch.contact(self.part));
                }
            });
            thin_out(contacts, first, lane, &Disc::point(tip.place), prediction);
        }
    }

    /// Adds the contacts of corners of the ground on the flanks and the tip of a grouser.
    fn find_runs(
        &self,
        (lane, region): (&Lane, &Region),
        grouser: &Grouser,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let thickness = self.gear.base_thickness;
        // Ground deeper than this has come in through another side.
        for (i, depth) in [thickness, self.height(), thickness]
            .into_iter()
            .enumerate()
        {
            let ends = (grouser.corners[i], grouser.corners[i + 1]);
            let outward = grouser.normals[i];
            lane.touches_of_run(region, ends, outward, (prediction, depth), |touch| {
                // A flank has one end at the tip; the tip itself has two.
                let mut tips = (i.max(1)..=(i + 1).min(2)).map(|k| grouser.tip(k));
                let is_real = touch.distance >= 0.0
                    || (grouser.contains(touch.place)
                        && !grouser.is_shallower_opposite(lane, i, &touch));
                if is_real && !tips.any(|tip| run_yields(lane, outward, &tip, &touch)) {
                    contacts.push(touch.contact(self.part));
                }
            });
        }
    }

    /// [m] Height of a grouser.
    fn height(&self) -> f64 {
        self.gear.radius - self.gear.root_radius
    }

    /// Whether a direction in the wheel's frame meets the root circle between grousers.
    fn is_between_grousers(&self, outward: Vector) -> bool {
        let angle = libm::atan2(outward.y, outward.x) - self.gear.phase;
        let pitch = self.gear.angle();
        let off = (angle / pitch - (angle / pitch).round()) * pitch;
        // Ground sunk into the foot of a flank also bears on the root circle.
        off.abs() >= self.half_base - SUNK.value() / self.gear.root_radius
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn between_two_grousers_the_root_circle_bears_and_at_their_bases_it_does_not() {
        let gear = Gear {
            radius: 0.06,
            root_radius: 0.05,
            grousers: 7,
            tip_thickness: 0.006,
            base_thickness: 0.01,
            phase: 0.4,
        };
        let half_base = (0.5_f64 * 0.01 / 0.05).asin();
        let wheel = GearContact::new(0, Vector::ZERO, gear);
        for grouser in -4..7 {
            let middle = 0.4 + f64::from(grouser) * TAU / 7.0;
            let bears = |off: f64| wheel.is_between_grousers(direction(middle + off));
            // A millimetre of a base, 0.02 rad, still bears.
            let inside = half_base - 0.025;
            assert!(!bears(0.0) && !bears(inside) && !bears(-inside));
            let outside = half_base + 0.005;
            assert!(bears(outside) && bears(-outside) && bears(0.5 * TAU / 7.0));
        }
    }
}
