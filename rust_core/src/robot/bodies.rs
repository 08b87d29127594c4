//! Masses of the wheels of a model, and what remains for the chassis.

use super::{Model, Mount, Shape};
use crate::geometry::{Pose, Vector};
use crate::scenario::End;

/// A wheel, both sides together unless each side has its own lane.
#[derive(Clone, Debug)]
pub struct WheelBody {
    /// Index of the part.
    pub part: usize,
    /// The body that it turns on.
    pub mount: Mount,
    /// [m] Axle in the chassis frame, with the arms as at time 0.
    pub center: Vector,
    /// [m] Radius of the circumscribed circle.
    pub radius: f64,
    /// [m^2] Area of the outline.
    pub area: f64,
    /// [kg] Mass of a uniform wheel of this outline and moment of inertia.
    pub mass: f64,
    /// [kg m^2] Its share of the inertia of the moving track: moving mass times radius squared.
    pub moment_of_inertia: f64,
}

impl WheelBody {
    /// The wheel of one side, from both sides together.
    #[must_use]
    pub fn of_one_side(self) -> Self {
        Self {
            mass: 0.5 * self.mass,
            moment_of_inertia: 0.5 * self.moment_of_inertia,
            ..self
        }
    }
}

/// The robot without its wheels.
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
    /// The wheels of chassis and arms, in the order of the parts.
    ///
    /// The wheels of the chassis together have the inertia of its track, those of an arm that of the arm's track.
    pub fn wheels(&self) -> Vec<WheelBody> {
        let start = self.running_at_start(0.0);
        let round = self.parts.iter().enumerate();
        let mut wheels: Vec<WheelBody> = round
            .filter_map(|(i, part)| {
                let (center, radius, area, polar_moment) = match &part.shape {
                    Shape::Disc { center, radius } => {
                        let area = std::f64::consts::PI * radius * radius;
                        (*center, *radius, area, 0.5 * area * radius * radius)
                    }
                    Shape::Gear { center, gear } => {
                        (*center, gear.radius, gear.area(), gear.polar_moment())
                    }
                    Shape::Hull { .. } | Shape::Grouser(_) | Shape::Polygon { .. } => return None,
                };
                let mount = start.mounted(part.mount, Pose::IDENTITY);
                Some(WheelBody {
                    part: i,
                    mount: part.mount,
                    center: mount.transform_point(center),
                    radius,
                    area,
                    mass: radius * radius * area / polar_moment,
                    moment_of_inertia: radius * radius,
                })
            })
            .collect();
        for mount in self.mounts() {
            let circulating = match mount {
                Mount::Flipper(k) => self.flippers[k].mass_of_track(),
                Mount::Chassis | Mount::Shoe(_) => self.drive_masses.iter().sum::<f64>(),
            };
            let on_it = || wheels.iter().filter(|wheel| wheel.mount == mount);
            let share = circulating / on_it().count() as f64;
            for wheel in wheels.iter_mut().filter(|wheel| wheel.mount == mount) {
                wheel.mass *= share;
                wheel.moment_of_inertia *= share;
            }
        }
        wheels
    }

    /// Name of the body that a wheel turns on.
    pub fn carrier(&self, mount: Mount) -> &'static str {
        match mount {
            Mount::Flipper(k) => match self.flippers[k].end {
                End::Front => "front flipper",
                End::Rear => "rear flipper",
            },
            Mount::Chassis | Mount::Shoe(_) => "chassis",
        }
    }

    /// The robot as an engine of bodies and joints would model it: chassis and wheels, without the wheels of flippers.
    ///
    /// Together they have the robot's mass, centre of mass and moment of inertia, and the wheels have the inertia of
    /// its track.
    pub fn bodies(&self) -> (ChassisBody, Vec<WheelBody>) {
        let mut wheels = self.wheels();
        wheels.retain(|wheel| wheel.mount == Mount::Chassis);
        (self.chassis_beside(&wheels), wheels)
    }

    pub(crate) fn chassis_beside(&self, wheels: &[WheelBody]) -> ChassisBody {
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
