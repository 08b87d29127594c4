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

/// [m] Largest depth of ground in a flank.
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

/// A grouser in a certain pose.
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

    /// Whether a corner of the ground inside flank 0 or 2 is less deep in the opposite flank.
    fn is_shallower_opposite(&self, lane: &Lane, flank: usize, touch: &Touch) -> bool {
        let opposite = 2 - flank;
        let normal = self.normals[opposite];
        let gap = (touch.place - self.corners[opposite]).dot(normal);
        let is_met = || matches!(touch.on, On::Corner(i) if lane.corner(i).has_normal(-normal));
        opposite != flank && gap > touch.distance && is_met()
    }

    /// [m] Height of its lowest corner above the centre of the wheel when it points along `axis`; it is symmetric.
    fn lowest(&self, axis: Vector) -> f64 {
        let [_, _, tip, base] = self.corners;
        let lower = |corner: Vector| corner.x * axis.y - corner.y * axis.x.abs();
        lower(tip).min(lower(base))
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
            // If the centre is behind a face, that face is the far side of something thin.
            let (reach, radius) = ((prediction, 0.0), self.gear.root_radius);
            let first = contacts.len();
            lane.touches_of_disc(&region, center, radius, reach, |touch| {
                if self.is_between_grousers(turned.inverse() * -touch.normal) {
                    contacts.push(touch.contact(self.part));
                }
            });
            thin_out(contacts, first, lane, &Disc { center, radius }, prediction);
        }
        for along in &self.directions {
            let axis = turned * *along;
            if room + self.grouser.lowest(axis) > 0.0 {
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
                // There is ground behind a face, but behind thin ground there is air again.
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
        // Deeper ground has entered through another side.
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
        // Ground inside the foot of a flank also bears on the root circle.
        off.abs() >= self.half_base - SUNK.value() / self.gear.root_radius
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::scenario::Surface;
    use crate::terrain::Profile;

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

    /// It points down, is 0.5 m high and tapers from 0.25 m to 0.125 m.
    fn grouser(x: f64) -> Grouser {
        let corners = [
            (-0.125, 0.25),
            (-0.0625, -0.25),
            (0.0625, -0.25),
            (0.125, 0.25),
        ];
        let corners = corners.map(|(off, y)| Vector::new(x + off, y));
        let side = |i: usize| right_of((corners[i + 1] - corners[i]).normalize());
        Grouser {
            corners,
            normals: [0, 1, 2].map(side),
        }
    }

    #[test]
    fn a_grouser_holds_what_lies_between_its_flanks_and_above_its_tip() {
        for (x, y, is_inside) in [
            (1.0, 0.0, true),
            (1.09, 0.0, true),
            (0.91, 0.0, true),
            (1.1, 0.0, false),
            (0.9, 0.0, false),
            (1.0, -0.24, true),
            (1.0, -0.26, false),
            (1.07, -0.24, false),
        ] {
            let found = grouser(1.0).contains(Vector::new(x, y));
            assert_eq!(found, is_inside, "{x} {y}");
        }
        let tip = grouser(1.0).tip(1);
        assert_eq!(tip.place, Vector::new(0.9375, -0.25));
        assert!(tip.normals[0].x < -0.9 && tip.normals[1] == Vector::NEG_Y);
    }

    #[test]
    fn the_lowest_corner_of_a_grouser_is_at_its_tip_or_at_its_base() {
        let gear = Gear {
            radius: 0.06,
            root_radius: 0.05,
            grousers: 7,
            tip_thickness: 0.006,
            base_thickness: 0.02,
            phase: 0.0,
        };
        let wheel = GearContact::new(0, Vector::ZERO, gear);
        for i in 0..100 {
            let axis = direction(TAU * f64::from(i) / 100.0);
            let heights = wheel.grouser.corners.map(|corner| axis.rotate(corner).y);
            let expected = heights.into_iter().fold(f64::INFINITY, f64::min);
            let found = wheel.grouser.lowest(axis);
            assert!((found - expected).abs() < 1e-15, "{axis}: {found}");
        }
    }

    /// The tip of a needle in a grouser, 1 cm to the right or left of its middle, or in the middle.
    #[test]
    fn a_corner_in_a_grouser_is_shallower_in_the_flank_that_is_nearer() {
        let points = [
            [-1.0, -1.0],
            [-0.01, -1.0],
            [0.0, 0.0],
            [0.01, -1.0],
            [1.0, -1.0],
        ];
        let lane = lane(&points);
        let corner = lane.corner(2);
        assert!(corner.is_convex);
        for (off, shallower) in [
            (0.01, [true, false]),
            (-0.01, [false, true]),
            (0.0, [false; 2]),
        ] {
            let grouser = grouser(-off);
            let distance = |flank: usize| {
                let spoke = corner.center - grouser.corners[flank];
                spoke.dot(grouser.normals[flank])
            };
            for (flank, opposite_is) in [0, 2].into_iter().zip(shallower) {
                let by_own = if off.abs() < 1e-12 {
                    distance(2 - flank)
                } else {
                    distance(flank)
                };
                let touch = corner.touch(2, -grouser.normals[flank], by_own);
                let found = grouser.is_shallower_opposite(&lane, flank, &touch);
                assert_eq!(found, opposite_is, "{off} m, flank {flank}");
            }
            let touch = corner.touch(2, Vector::Y, -0.4);
            assert!(!grouser.is_shallower_opposite(&lane, 1, &touch));
            // A corner that does not face the opposite flank cannot leave through it.
            let face = Touch {
                on: On::Face(1),
                ..touch
            };
            assert!(!grouser.is_shallower_opposite(&lane, 0, &face));
        }
    }

    fn lane(points: &[[f64; 2]]) -> Lane {
        let profile = Profile::new("terrain", points, Surface::sharp(0.9), true);
        Lane::new(&profile.expect("it is ground"))
    }
}
