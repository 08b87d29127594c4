//! The search for rests: where the shoes of a chain bear on the guide, or on wheels and teeth.
//!
//! The equations: docs/physics.md, "Chains".

use super::Chain;
use super::rest::{Bearing, ChainPose, Rest};
use crate::geometry::{Disc, Pose, Vector};

/// A chain has come off if a shoe is farther from the guide than so many pitches.
const FAR_OFF: f64 = 2.0;

impl Chain {
    /// Calls `found` for every place within `reach` [m] where a shoe could rest.
    pub(in crate::dynamics) fn rests(
        &mut self,
        stand: ChainPose,
        place_of: impl Fn(usize) -> Pose,
        reach: f64,
        mut found: impl FnMut(&Self, Rest),
    ) {
        let back = stand.chassis.inverse();
        self.places.clear();
        let places = (0..self.rule.path.count).map(place_of);
        self.places
            .extend(places.map(|place| [place, back * place]));
        self.is_off = if self.rule.sprocket.is_some() {
            self.rests_on_wheels(stand, reach, &mut found);
            self.is_off_wheels(stand)
        } else {
            self.rests_on_guide(stand, reach, &mut found)
        };
    }

    /// Finds the rests on a guide; returns whether a shoe is too far off it to come back.
    fn rests_on_guide(
        &self,
        stand: ChainPose,
        reach: f64,
        found: &mut impl FnMut(&Self, Rest),
    ) -> bool {
        let rule = &self.rule;
        let (half, below) = (0.5 * rule.path.pitch, 0.5 * rule.plate_thickness);
        let discs = || rule.ends.iter().chain(&rule.between);
        let smallest = discs()
            .map(|disc| disc.radius)
            .fold(f64::INFINITY, f64::min);
        let deepest = -0.5 * smallest;
        let mut is_off = false;
        for (shoe, [_, place]) in self.places.iter().enumerate() {
            for (k, disc) in discs().enumerate() {
                let slides = if k == 1 { Vector::X } else { Vector::ZERO };
                self.rest_on_disc((shoe, k), (*disc, slides), stand, reach, found);
            }
            let corner = place.transform_point(Vector::new(half, -below));
            let gap = -rule.hull.depth(corner);
            is_off |= gap < deepest || gap > FAR_OFF * rule.path.pitch;
            if gap < reach {
                found(
                    self,
                    Rest {
                        shoe,
                        index: 2 + rule.between.len(),
                        point: stand.chassis.transform_point(corner),
                        normal: stand.chassis.rotation * rule.hull.outward_at(corner),
                        gap,
                        on: Bearing::Chassis(Vector::ZERO),
                    },
                );
            }
        }
        is_off
    }

    /// Finds the rest of a plate's inner face on a disc, which may slide with the idler.
    pub(super) fn rest_on_disc(
        &self,
        (shoe, index): (usize, usize),
        (disc, slides): (Disc, Vector),
        stand: ChainPose,
        reach: f64,
        found: &mut impl FnMut(&Self, Rest),
    ) {
        let (half, below) = (0.5 * self.rule.path.pitch, 0.5 * self.rule.plate_thickness);
        let [place_now, on_chassis] = self.places[shoe];
        let center = on_chassis.inverse_transform_point(disc.center + slides * stand.travel);
        let gap = -below - (center.y + disc.radius);
        if center.x.abs() <= half && center.y < 0.0 && gap < reach {
            found(
                self,
                Rest {
                    shoe,
                    index,
                    point: place_now.transform_point(Vector::new(center.x, -below)),
                    normal: place_now.rotation * Vector::Y,
                    gap,
                    on: Bearing::Chassis(stand.chassis.rotation * slides),
                },
            );
        }
    }
}
