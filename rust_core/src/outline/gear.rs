//! The exact outline of a gear wheel: a root circle and rectangular grousers.

use rapier2d_f64::math::Vector;

use crate::error::ScenarioError;
use crate::scenario::{GearWheel, TrackOutline};

/// A wheel with grousers, resolved for one place on a robot.
///
/// The grousers reach from the centre to the circumscribed circle, on which the two corners of each
/// tip lie; what stands out of the root circle is the grouser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// [m] Radius of the circumscribed circle, through the corners of the tips.
    pub radius: f64,
    /// [m] Radius of the root circle.
    pub root_radius: f64,
    /// Grousers round the wheel.
    pub grousers: u32,
    /// [m] Thickness of a grouser.
    pub thickness: f64,
    /// [rad] Direction of the first grouser at the start, from the chassis axis.
    pub phase: f64,
}

impl Gear {
    /// The wheel number `index` (0 is the rearmost) with what is not given taken from the outline.
    ///
    /// The paper gives the size of the large wheels' grousers only. Ours for small wheels: the height
    /// is at most a quarter of the radius, the thickness shrinks with the height, and a wheel has at
    /// least 8 grousers where the robot's own pitch would leave fewer than 6.
    ///
    /// # Errors
    /// A wheel that cannot be: no root circle, no or overlapping grousers.
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
            let rule = "must be given and > 0 m: the outline has no grousers";
            return error("grouser_height", height, rule.to_owned());
        }
        if height >= radius {
            let rule = format!(
                "must be below the radius {radius} m of wheel {index}: no root circle is left"
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
        let thickness = wheel
            .tip_thickness
            .unwrap_or(outline.grouser_thickness * shrunk.min(1.0));
        if thickness <= 0.0 {
            let rule = "must be given and > 0 m: the outline's grousers have no thickness";
            return error("tip_thickness", thickness, rule.to_owned());
        }
        let angle = std::f64::consts::TAU / f64::from(grousers);
        let room = 2.0 * root_radius * libm::sin(0.5 * angle);
        if thickness >= room {
            let rule = format!(
                "must be below {room} m, the room of {grousers} grousers on the root circle of wheel {index}: they would overlap"
            );
            return error("tip_thickness", thickness, rule);
        }
        let ahead = wheel.phase_fraction * (index + 1) as f64;
        Ok(Self {
            radius,
            root_radius,
            grousers,
            thickness,
            phase: ahead * angle,
        })
    }

    /// [m] Distance of a tip's face from the centre.
    pub fn reach(&self) -> f64 {
        (self.radius * self.radius - 0.25 * self.thickness * self.thickness).sqrt()
    }

    /// [rad] Directions of the grousers at the start.
    pub fn directions(&self) -> impl Iterator<Item = f64> {
        let (phase, step) = (self.phase, std::f64::consts::TAU / f64::from(self.grousers));
        (0..self.grousers).map(move |i| phase + f64::from(i) * step)
    }

    /// [m] Corners of one grouser in the wheel's frame, counter-clockwise: its base first.
    pub fn corners(&self, direction: f64) -> [Vector; 4] {
        let (sine, cosine) = libm::sincos(direction);
        let (along, across) = (Vector::new(cosine, sine), Vector::new(-sine, cosine));
        let (tip, half) = (along * self.reach(), across * (0.5 * self.thickness));
        // The base is the centre: the root circle hides it.
        [-half, tip - half, tip + half, half]
    }

    /// [m] The outline at the start, about the centre: each root arc in `points` points, then a grouser.
    pub fn outline(&self, points: usize) -> Vec<Vector> {
        let half = libm::asin(0.5 * self.thickness / self.root_radius);
        let step = std::f64::consts::TAU / f64::from(self.grousers);
        let of_grouser = |direction: f64| {
            let corners = self.corners(direction);
            let arc = (0..points).map(move |i| {
                let share = i as f64 / points.saturating_sub(1).max(1) as f64;
                let angle = direction - step + half + share * (step - 2.0 * half);
                let (sine, cosine) = libm::sincos(angle);
                Vector::new(cosine, sine) * self.root_radius
            });
            arc.chain([corners[1], corners[2]])
        };
        self.directions().flat_map(of_grouser).collect()
    }

    /// [m^2] Area of the outline.
    pub fn area(&self) -> f64 {
        let (h, x, root) = (0.5 * self.thickness, self.reach(), self.root_radius);
        let beta = libm::asin(h / root);
        let hidden = root * root * beta + root * libm::cos(beta) * h;
        std::f64::consts::PI * root * root + f64::from(self.grousers) * (2.0 * h * x - hidden)
    }

    /// [m^4] Polar moment of the area about the centre.
    pub fn polar_moment(&self) -> f64 {
        let (h, x, root) = (0.5 * self.thickness, self.reach(), self.root_radius);
        let beta = libm::asin(h / root);
        let b = root * libm::cos(beta);
        // A grouser's half-strip out of the centre: a rectangle; what the root circle hides of it:
        // a sector and two triangles.
        let strip = 2.0 / 3.0 * (h * x.powi(3) + h.powi(3) * x);
        let hidden = 0.5 * root.powi(4) * beta + h * b.powi(3) / 6.0 + 0.5 * b * h.powi(3);
        0.5 * std::f64::consts::PI * root.powi(4) + f64::from(self.grousers) * (strip - hidden)
    }
}

/// Grousers at the robot's own pitch where that makes at least 6, else at least 8.
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

    /// The outline as a fine polygon, from the distance of its points alone.
    fn polygon(gear: &Gear, points: usize) -> Vec<Vector> {
        (0..points)
            .map(|i| {
                let angle = std::f64::consts::TAU * i as f64 / points as f64;
                let (s, c) = libm::sincos(angle);
                let in_grouser = |direction: f64| {
                    let (sine, cosine) = libm::sincos(angle - direction);
                    let across = 0.5 * gear.thickness / sine.abs();
                    let along = gear.reach() / cosine;
                    if cosine > 0.0 { along.min(across) } else { 0.0 }
                };
                let distance = gear
                    .directions()
                    .map(in_grouser)
                    .fold(gear.root_radius, f64::max);
                Vector::new(c, s) * distance
            })
            .collect()
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
        for (radius, height, grousers, thickness) in [
            (0.064, 0.012, 7, 0.006),
            (0.02, 0.005, 8, 0.0025),
            (0.1, 0.015, 12, 0.02),
            (0.05, 0.02, 3, 0.03),
        ] {
            let gear = Gear {
                radius,
                root_radius: radius - height,
                grousers,
                thickness,
                phase: 0.1,
            };
            let (area, polar) = moments(&polygon(&gear, 4_000_000));
            // A flank is 1e-6 of the circumference away from a point of this polygon.
            assert!((gear.area() / area - 1.0).abs() < 1e-6, "{gear:?}");
            assert!((gear.polar_moment() / polar - 1.0).abs() < 1e-6, "{gear:?}");
        }
    }

    #[test]
    fn corners_of_the_tips_lie_on_the_circumscribed_circle() {
        let gear = Gear {
            radius: 0.064,
            root_radius: 0.052,
            grousers: 7,
            thickness: 0.006,
            phase: 0.3,
        };
        for direction in gear.directions() {
            for corner in &gear.corners(direction)[1..3] {
                assert!((corner.length() - gear.radius).abs() < 1e-16);
            }
        }
    }
}
