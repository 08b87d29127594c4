//! The exact outline of a gear wheel: a root circle and grousers with straight flanks.

use super::{Vector, cross, direction};
use crate::scenario::{GearWheel, ScenarioError, TrackOutline};

/// A wheel with grousers, with all sizes resolved for its position on a robot.
///
/// A grouser stands on a chord of the root circle; the two corners of its tip lie on the
/// circumscribed circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// [m] Radius of the circumscribed circle.
    pub radius: f64,
    /// [m] Radius of the root circle.
    pub root_radius: f64,
    /// Number of grousers.
    pub grousers: u32,
    /// [m] Thickness of a grouser at its tip.
    pub tip_thickness: f64,
    /// [m] Thickness of a grouser at the root circle.
    pub base_thickness: f64,
    /// [rad] Direction of the first grouser at the start, relative to the chassis axis.
    pub phase: f64,
}

impl Gear {
    /// Builds wheel number `index` (0 is the rearmost); missing sizes follow from the outline.
    ///
    /// The paper gives the size of grousers for large wheels only. Our rules for small wheels: the height is at most
    /// a quarter of the radius, the thickness shrinks with the height, and a wheel has 8 grousers if the robot's
    /// own pitch would leave fewer than 6.
    ///
    /// # Errors
    /// An impossible wheel: no root circle, no grousers, or overlapping grousers.
    pub(crate) fn new(
        wheel: &GearWheel,
        outline: &TrackOutline,
        radius: f64,
        index: usize,
    ) -> Result<Self, ScenarioError> {
        let error = |field: &str, value: f64, rule: String| {
            Err(ScenarioError::new(
                format!("robot.track.wheel.{field}"),
                value,
                rule,
            ))
        };
        let height = wheel
            .grouser_height
            .unwrap_or(outline.grouser_height.min(0.25 * radius));
        if height <= 0.0 {
            let rule = "must be given and > 0 m, because the outline has no grousers";
            return error("grouser_height", height, rule.to_owned());
        }
        if height >= radius {
            let rule = format!(
                "must be less than the radius of wheel {index}, {radius} m, to leave a root circle"
            );
            return error("grouser_height", height, rule);
        }
        let root_radius = radius - height;
        let grousers = wheel
            .grouser_count
            .unwrap_or_else(|| default_count(root_radius, outline.grouser_pitch));
        let shrunk = if outline.grouser_height > 0.0 {
            height / outline.grouser_height
        } else {
            1.0
        };
        let tip_thickness = wheel
            .tip_thickness
            .unwrap_or(outline.grouser_thickness * shrunk.min(1.0));
        if tip_thickness <= 0.0 {
            let rule = "must be given and > 0 m, because the outline's grousers have no thickness";
            return error("tip_thickness", tip_thickness, rule.to_owned());
        }
        let base_thickness = wheel.base_thickness.unwrap_or(tip_thickness);
        if base_thickness < tip_thickness {
            let rule = format!("must be at least the thickness at the tip, {tip_thickness} m");
            return error("base_thickness", base_thickness, rule);
        }
        let angle = std::f64::consts::TAU / f64::from(grousers);
        let room = 2.0 * root_radius * libm::sin(0.5 * angle);
        if base_thickness >= room {
            let given = wheel
                .base_thickness
                .map_or("tip_thickness", |_| "base_thickness");
            let rule = format!(
                "must be less than {room} m, the space for each of {grousers} grousers on the root circle of wheel {index}, or they would overlap"
            );
            return error(given, base_thickness, rule);
        }
        // Flanks that meet the root circle from inside would leave a corner between flank and arc.
        let leaning = libm::asin(0.5 * tip_thickness / radius) + libm::acos(root_radius / radius);
        let most = 2.0 * root_radius * libm::sin(leaning.min(std::f64::consts::FRAC_PI_2));
        if base_thickness > tip_thickness.max(most) {
            let rule = format!(
                "must be at most {most} m on wheel {index}, or the flanks of grousers of this height would run inside the root circle"
            );
            return error("base_thickness", base_thickness, rule);
        }
        let ahead = wheel.phase_fraction * (index + 1) as f64;
        Ok(Self {
            radius,
            root_radius,
            grousers,
            tip_thickness,
            base_thickness,
            phase: ahead * angle,
        })
    }

    /// [rad] Directions of the grousers at the start.
    pub fn directions(&self) -> impl Iterator<Item = f64> {
        let (phase, step) = (self.phase, self.angle());
        (0..self.grousers).map(move |i| phase + f64::from(i) * step)
    }

    /// [rad] Angle between two grousers: theta in eq. (1).
    pub fn angle(&self) -> f64 {
        std::f64::consts::TAU / f64::from(self.grousers)
    }

    /// [rad] Half the angle of a grouser on the circumscribed circle and on the root circle.
    fn half_angles(&self) -> (f64, f64) {
        (
            libm::asin(0.5 * self.tip_thickness / self.radius),
            libm::asin(0.5 * self.base_thickness / self.root_radius),
        )
    }

    /// [m] Corners of the grouser at an angle [rad] about the wheel's centre, counter-clockwise from the base.
    pub fn corners(&self, angle: f64) -> [Vector; 4] {
        let (tip, base) = self.half_angles();
        [
            direction(angle - base) * self.root_radius,
            direction(angle - tip) * self.radius,
            direction(angle + tip) * self.radius,
            direction(angle + base) * self.root_radius,
        ]
    }

    /// [m] The outline at the start, about the centre: `points` points on each root arc, then a tip.
    pub fn outline(&self, points: usize) -> Vec<Vector> {
        let (_, base) = self.half_angles();
        let room = self.angle() - 2.0 * base;
        let of_grouser = |angle: f64| {
            let arc = (0..points).map(move |i| {
                let fraction = i as f64 / points.saturating_sub(1).max(1) as f64;
                direction(angle - base - (1.0 - fraction) * room) * self.root_radius
            });
            let [_, tip, other, _] = self.corners(angle);
            arc.chain([tip, other])
        };
        self.directions().flat_map(of_grouser).collect()
    }

    /// [m^2] Area of the outline, with exact root arcs; parry has only areas and moments of polygons.
    pub fn area(&self) -> f64 {
        let root = self.root_radius;
        let arc = 0.5 * root * root * self.arc();
        let sides: f64 = self.sides().map(|[a, b]| 0.5 * cross(a, b)).sum();
        f64::from(self.grousers) * (arc + sides)
    }

    /// [m^4] Polar moment of the area about the centre.
    pub fn polar_moment(&self) -> f64 {
        let square = self.root_radius * self.root_radius;
        let arc = 0.25 * square * square * self.arc();
        let sides: f64 = self
            .sides()
            .map(|[a, b]| cross(a, b) * (a.dot(a) + a.dot(b) + b.dot(b)) / 12.0)
            .sum();
        f64::from(self.grousers) * (arc + sides)
    }

    /// [rad] Angle of a root arc between two grousers.
    fn arc(&self) -> f64 {
        self.angle() - 2.0 * self.half_angles().1
    }

    /// Flank, tip and flank of one grouser.
    fn sides(&self) -> impl Iterator<Item = [Vector; 2]> {
        let [a, b, c, d] = self.corners(0.0);
        [[a, b], [b, c], [c, d]].into_iter()
    }
}

/// Number of grousers at the robot's own pitch if that is at least 6, else 8.
fn default_count(root_radius: f64, pitch: f64) -> u32 {
    let fitting = (std::f64::consts::TAU * root_radius / pitch).round();
    if fitting >= 6.0 {
        fitting.min(f64::from(crate::scenario::MAX_GROUSERS)) as u32
    } else {
        8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gear(radius: f64, height: f64, grousers: u32, tip: f64, base: f64) -> Gear {
        Gear {
            radius,
            root_radius: radius - height,
            grousers,
            tip_thickness: tip,
            base_thickness: base,
            phase: 0.1,
        }
    }

    /// The outline as a fine polygon, computed only from the distance of its points.
    fn polygon(gear: &Gear, points: usize) -> Vec<Vector> {
        // A flank runs from (x0, y0) on the root circle to (x1, y1) on the circumscribed one.
        let (y0, y1) = (0.5 * gear.base_thickness, 0.5 * gear.tip_thickness);
        let x0 = (gear.root_radius * gear.root_radius - y0 * y0).sqrt();
        let x1 = (gear.radius * gear.radius - y1 * y1).sqrt();
        (0..points)
            .map(|i| {
                let angle = std::f64::consts::TAU * i as f64 / points as f64;
                let in_grouser = |direction: f64| {
                    let (sine, cosine) = libm::sincos(angle - direction);
                    let flank = (x1 * y0 - x0 * y1) / ((x1 - x0) * sine.abs() + (y0 - y1) * cosine);
                    if cosine > 0.5 {
                        (x1 / cosine).min(flank)
                    } else {
                        0.0
                    }
                };
                let distance = gear
                    .directions()
                    .map(in_grouser)
                    .fold(gear.root_radius, f64::max);
                direction(angle) * distance
            })
            .collect()
    }

    #[test]
    fn the_outline_of_a_picture_has_the_area_of_the_wheel() {
        let gear = gear(0.1, 0.02, 9, 0.006, 0.012);
        let whole = gear.area();
        let [coarse, fine] = [8, 80].map(|points| whole - moments(&gear.outline(points)).0);
        // The area that chords cut off is inversely proportional to the square of their number.
        assert!(
            0.0 < fine && fine < 1e-5 * whole,
            "{fine} m^2 of {whole} m^2"
        );
        assert!((coarse / fine - (79.0_f64 / 7.0).powi(2)).abs() < 1.0);
        assert_eq!(gear.outline(8).len(), 9 * 10);
    }

    fn moments(polygon: &[Vector]) -> (f64, f64) {
        let n = polygon.len();
        (0..n).fold((0.0, 0.0), |(area, polar), i| {
            let (a, b) = (polygon[i], polygon[(i + 1) % n]);
            let cross = a.x * b.y - a.y * b.x;
            (
                area + 0.5 * cross,
                polar + cross * (a.dot(a) + a.dot(b) + b.dot(b)) / 12.0,
            )
        })
    }

    #[test]
    fn area_and_polar_moment_are_those_of_the_outline() {
        for gear in [
            gear(0.064, 0.012, 7, 0.006, 0.006),
            gear(0.02, 0.005, 8, 0.0025, 0.0025),
            gear(0.1, 0.015, 12, 0.016, 0.024),
            gear(0.05, 0.02, 3, 0.02, 0.03),
        ] {
            let (area, polar) = moments(&polygon(&gear, 100_000));
            // A corner is at most 2e-5 of the circumference away from a point of this polygon.
            assert!((gear.area() / area - 1.0).abs() < 2e-5, "{gear:?}");
            assert!((gear.polar_moment() / polar - 1.0).abs() < 2e-5, "{gear:?}");
        }
    }

    #[test]
    fn corners_of_the_tips_lie_on_the_circumscribed_circle() {
        let gear = gear(0.064, 0.012, 7, 0.006, 0.009);
        for direction in gear.directions() {
            let [base, tip, other, _] = gear.corners(direction);
            assert!((tip.length() - gear.radius).abs() < 1e-16);
            assert!(((tip - other).length() - gear.tip_thickness).abs() < 1e-16);
            assert!((base.length() - gear.root_radius).abs() < 1e-16);
        }
    }

    const OUTLINE: TrackOutline = TrackOutline {
        discs: Vec::new(),
        grouser_height: 0.02,
        grouser_pitch: 0.05,
        grouser_thickness: 0.008,
    };

    fn wheel() -> GearWheel {
        GearWheel {
            grouser_count: None,
            grouser_height: None,
            tip_thickness: None,
            base_thickness: None,
            phase_fraction: 0.25,
        }
    }

    #[test]
    fn a_wheel_has_as_many_grousers_as_its_pitch_leaves_but_8_instead_of_fewer_than_6() {
        for (root_radius, pitch, count) in [
            (0.1, 0.05, 13),
            (0.05, 0.05, 6),
            (0.05, 0.0572, 8),
            (0.05, 0.2, 8),
            (1.0, 1e-6, crate::scenario::MAX_GROUSERS),
        ] {
            assert_eq!(
                default_count(root_radius, pitch),
                count,
                "{root_radius} {pitch}"
            );
        }
    }

    /// Grousers of a small wheel are lower than the outline's, and thinner by the same factor.
    #[test]
    fn sizes_that_are_not_given_follow_from_the_outline() {
        for (radius, index, height, thickness) in [
            (0.1, 0, 0.02, 0.008),
            (0.1, 2, 0.02, 0.008),
            (0.04, 1, 0.01, 0.004),
        ] {
            let found = Gear::new(&wheel(), &OUTLINE, radius, index).expect("it is possible");
            assert!((found.radius - found.root_radius - height).abs() < 1e-15);
            let thicknesses = [found.tip_thickness, found.base_thickness];
            assert!(thicknesses.iter().all(|t| (t - thickness).abs() < 1e-15));
            assert_eq!(found.grousers, default_count(radius - height, 0.05));
            // A quarter of the angle between two grousers ahead of the wheel before.
            let ahead = 0.25 * (index + 1) as f64 * found.angle();
            assert!((found.phase - ahead).abs() < 1e-15);
        }
        let plain = TrackOutline {
            grouser_height: 0.0,
            ..OUTLINE
        };
        let given = GearWheel {
            grouser_height: Some(0.02),
            ..wheel()
        };
        let found = Gear::new(&given, &plain, 0.1, 0).expect("it is possible");
        assert!((found.tip_thickness - 0.008).abs() < 1e-15);
    }

    /// Of 8 grousers on a root circle of 0.08 m, 0.02 m high: each has 61 mm, and flanks to the root circle are 79 mm
    /// apart.
    #[test]
    fn a_wheel_whose_grousers_have_no_room_or_no_size_is_refused() {
        let with = |height: f64, tip: f64, base: f64, count: u32| GearWheel {
            grouser_count: Some(count),
            grouser_height: Some(height),
            tip_thickness: Some(tip),
            base_thickness: Some(base),
            ..wheel()
        };
        let room = 0.16 * libm::sin(std::f64::consts::PI / 8.0);
        let leaning = libm::asin(0.03) + libm::acos(0.8);
        let most = 0.16 * libm::sin(leaning);
        for (wheel, field) in [
            (with(0.0, 0.006, 0.006, 8), Some("grouser_height")),
            (with(0.1, 0.006, 0.006, 8), Some("grouser_height")),
            (with(0.099, 1e-4, 1e-4, 8), None),
            (with(0.02, 0.0, 0.006, 8), Some("tip_thickness")),
            (with(0.02, 0.006, 0.0059, 8), Some("base_thickness")),
            (with(0.02, 0.006, 0.006, 8), None),
            (with(0.02, 0.006, 1.001 * room, 8), Some("base_thickness")),
            (with(0.02, 0.006, 0.999 * room, 8), None),
            (with(0.02, 0.006, 1.001 * most, 3), Some("base_thickness")),
            (with(0.02, 0.006, 0.999 * most, 3), None),
        ] {
            let found = Gear::new(&wheel, &OUTLINE, 0.1, 0);
            let path = field.map(|field| format!("robot.track.wheel.{field}"));
            assert_eq!(found.err().map(|error| error.path), path, "{wheel:?}");
        }
        // Parallel flanks of thick grousers meet the root circle from outside.
        let thick = GearWheel {
            base_thickness: None,
            ..with(0.02, 0.0613, 0.0, 8)
        };
        let error = Gear::new(&thick, &OUTLINE, 0.1, 0).expect_err("they overlap");
        assert_eq!(error.path, "robot.track.wheel.tip_thickness");
        let found = Gear::new(
            &GearWheel {
                tip_thickness: Some(0.06),
                ..thick
            },
            &OUTLINE,
            0.1,
            0,
        );
        assert!(found.is_ok());
    }
}
