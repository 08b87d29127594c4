//! Where a chain rests on wheels: the sprocket's drum and teeth, idler, road wheels and return rollers.
//!
//! The equations: docs/physics.md, "Chains".

use super::Chain;
use super::rest::{Bearing, ChainPose, Rest};
use crate::geometry::{Disc, Rotation, Vector};

impl Chain {
    /// Finds the rests of plates and pins on wheels, and of pins on teeth.
    pub(super) fn rests_on_wheels(
        &self,
        stand: ChainPose,
        reach: f64,
        found: &mut impl FnMut(&Self, Rest),
    ) {
        let rule = &self.rule;
        let [rear, front] = rule.ends.map(|end| [end]);
        let idle = Disc {
            center: front[0].center + Vector::X * stand.travel,
            ..front[0]
        };
        let wheels = rear.iter().chain(&front).chain(&rule.between);
        for shoe in 0..self.places.len() {
            for (k, wheel) in wheels.clone().enumerate() {
                let slides = if k == 1 { Vector::X } else { Vector::ZERO };
                self.rest_on_disc((shoe, k), (*wheel, slides), stand, reach, found);
                let wheel = if k == 1 { idle } else { *wheel };
                self.rest_of_pin((shoe, k), (wheel, slides), stand, reach, found);
            }
            self.rest_on_teeth(shoe, stand, reach, found);
        }
    }

    /// Finds the rest of the edge between two plates on a wheel that touches neither plate's face.
    fn rest_of_pin(
        &self,
        (shoe, wheel): (usize, usize),
        (disc, slides): (Disc, Vector),
        stand: ChainPose,
        reach: f64,
        found: &mut impl FnMut(&Self, Rest),
    ) {
        let (half, below) = (0.5 * self.rule.path.pitch, 0.5 * self.rule.plate_thickness);
        let [_, place] = self.places[shoe];
        let center = place.inverse_transform_point(disc.center);
        let corner = Vector::new(half, -below);
        let away = corner - center;
        let near = disc.radius + reach;
        if center.x <= half || center.y >= 0.0 || away.length_squared() >= near * near {
            return;
        }
        let [_, next] = self.places[(shoe + 1) % self.places.len()];
        if next.inverse_transform_point(disc.center).x >= -half {
            return;
        }
        let length = away.length();
        found(
            self,
            Rest {
                shoe,
                index: 2 + self.rule.between.len() + wheel,
                point: stand.chassis.transform_point(place.transform_point(corner)),
                normal: stand.chassis.rotation * (place.rotation * (away / length)),
                gap: length - disc.radius,
                on: Bearing::Chassis(stand.chassis.rotation * slides),
            },
        );
    }

    /// Finds the rests of a shoe's front pin on the teeth behind and ahead of it.
    pub(super) fn rest_on_teeth(
        &self,
        shoe: usize,
        stand: ChainPose,
        reach: f64,
        found: &mut impl FnMut(&Self, Rest),
    ) {
        let rule = &self.rule;
        let Some(sprocket) = &rule.sprocket else {
            return;
        };
        let axle = rule.ends[0].center;
        let pin = self.pin(shoe);
        if (pin - axle).length() > sprocket.teeth.tip_radius + reach {
            return;
        }
        let turned = Rotation::new(sprocket.angle(stand.run));
        let seen = turned.inverse() * (pin - axle);
        let flanks = sprocket.teeth.flanks(seen, reach);
        for (side, flank) in flanks.into_iter().flatten().enumerate() {
            if flank.gap < reach {
                found(
                    self,
                    Rest {
                        shoe,
                        index: 2 * (2 + rule.between.len()) + side,
                        point: stand.chassis.transform_point(pin),
                        normal: stand.chassis.rotation * (turned * flank.normal),
                        gap: flank.gap,
                        on: Bearing::Tooth(stand.chassis.transform_point(axle)),
                    },
                );
            }
        }
    }

    /// [m] The front pin of a shoe in the chassis frame.
    pub(super) fn pin(&self, shoe: usize) -> Vector {
        let [_, place] = self.places[shoe];
        place.transform_point(Vector::new(0.5 * self.rule.path.pitch, 0.0))
    }

    /// Whether the chain is off: it no longer forms a loop round both sprocket and idler.
    pub(super) fn is_off_wheels(&self, stand: ChainPose) -> bool {
        let [rear, front] = self.rule.ends.map(|end| end.center);
        let goes_round = |center: Vector, outwards: f64| {
            let mut crossings = 0;
            let mut last = self.pin(self.places.len() - 1) - center;
            for shoe in 0..self.places.len() {
                let pin = self.pin(shoe) - center;
                if (last.y > 0.0) != (pin.y > 0.0) {
                    let share = last.y / (last.y - pin.y);
                    let at = last.x + share * (pin.x - last.x);
                    crossings += i32::from(at * outwards > 0.0);
                }
                last = pin;
            }
            crossings % 2 == 1
        };
        let idler = front + Vector::X * stand.travel;
        !(goes_round(rear, -1.0) && goes_round(idler, 1.0))
    }
}
