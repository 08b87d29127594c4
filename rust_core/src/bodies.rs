//! Masses of the wheels that a model stands for, and what they leave to the chassis.

use rapier2d_f64::math::Vector;

use crate::robot::{Model, Mount, Shape};

/// A wheel; both sides together, unless these meet lanes of their own.
#[derive(Clone, Debug)]
pub struct WheelBody {
    /// Index of the part.
    pub part: usize,
    /// [m] Axle in the chassis frame.
    pub center: Vector,
    /// [m] Radius of the circumscribed circle.
    pub radius: f64,
    /// [m^2] Area of the outline.
    pub area: f64,
    /// [kg] Mass of a uniform wheel of this outline and moment of inertia.
    pub mass: f64,
    /// [kg m^2] Its share of the circulating track: mass times the square of the radius.
    pub moment_of_inertia: f64,
}

/// What the wheels leave of the robot.
#[derive(Clone, Copy, Debug)]
pub struct ChassisBody {
    /// [kg] Mass.
    pub mass: f64,
    /// [m] Centre of mass in the chassis frame.
    pub center_of_mass: Vector,
    /// [kg m^2] Moment of inertia about it.
    pub moment_of_inertia: f64,
}

impl Model {
    /// The robot as an engine of bodies and joints would hold it: chassis and wheels, those of flippers
    /// apart.
    ///
    /// Together they have the robot's mass, centre of mass and moment of inertia, and the wheels turn
    /// with the inertia of its track.
    pub fn bodies(&self) -> (ChassisBody, Vec<WheelBody>) {
        let round: Vec<(usize, Vector, f64, f64, f64)> = self
            .parts
            .iter()
            .enumerate()
            .filter(|(_, part)| part.mount == Mount::Chassis)
            .filter_map(|(i, part)| match &part.shape {
                Shape::Disc { center, radius } => {
                    let area = std::f64::consts::PI * radius * radius;
                    Some((i, *center, *radius, area, 0.5 * area * radius * radius))
                }
                Shape::Gear { center, gear } => {
                    Some((i, *center, gear.radius, gear.area(), gear.polar_moment()))
                }
                Shape::Hull { .. } | Shape::Grouser(_) | Shape::Polygon { .. } => None,
            })
            .collect();
        let share = self.drive_masses.iter().sum::<f64>() / round.len().max(1) as f64;
        let wheels: Vec<WheelBody> = round
            .into_iter()
            .map(|(part, center, radius, area, polar_moment)| {
                let moment_of_inertia = share * radius * radius;
                WheelBody {
                    part,
                    center,
                    radius,
                    area,
                    mass: moment_of_inertia * area / polar_moment,
                    moment_of_inertia,
                }
            })
            .collect();
        (self.chassis_beside(&wheels), wheels)
    }

    fn chassis_beside(&self, wheels: &[WheelBody]) -> ChassisBody {
        let mass = self.mass - wheels.iter().map(|w| w.mass).sum::<f64>();
        let moment: Vector = wheels.iter().map(|w| w.center * w.mass).sum();
        let center_of_mass = (self.center_of_mass * self.mass - moment) / mass;
        let about = |center: Vector| (center - self.center_of_mass).length_squared();
        let moment_of_inertia = self.locked_inertia()
            - mass * about(center_of_mass)
            - wheels
                .iter()
                .map(|w| w.moment_of_inertia + w.mass * about(w.center))
                .sum::<f64>();
        ChassisBody {
            mass,
            center_of_mass,
            moment_of_inertia,
        }
    }
}
