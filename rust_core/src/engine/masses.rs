//! How the robot's mass is divided between the chassis and wheels that are bodies of their own.

use crate::geometry::Vector;
use crate::robot::{ChassisBody, Model, WheelBody};

/// Largest share of the robot's mass, and of its moment of inertia, that its wheels have together.
pub(super) const ON_WHEELS: f64 = 0.5;

/// The chassis, and its wheels with masses that suit the engine.
///
/// The axle of a wheel is fixed to the chassis, so mechanics sees no difference between two divisions of the robot's mass:
/// what counts is mass, centre of mass and inertia of the whole, and each wheel's inertia about its axle. The engine does see
/// one: its contacts hold a wheel the better the more of the mass it has.
pub(super) fn divided(model: &Model) -> (ChassisBody, Vec<WheelBody>) {
    let (_, mut wheels) = model.bodies();
    let mass = wheel_mass(model, &wheels);
    for wheel in &mut wheels {
        wheel.mass = mass;
    }
    (model.chassis_beside(&wheels), wheels)
}

/// [kg] The mass of each of these wheels, as large as leaves the chassis its share of mass and of moment of inertia.
pub(super) fn wheel_mass(model: &Model, wheels: &[WheelBody]) -> f64 {
    let count = wheels.len() as f64;
    let [squares, of_sum] = offsets(model, wheels);
    // The root of a quadratic equation: what wheels of this mass take is what there is.
    let there_is = ON_WHEELS * model.moment_of_inertia;
    let a = count * squares - of_sum;
    let b = model.mass * squares + there_is * count;
    let c = there_is * model.mass;
    let by_inertia = 2.0 * c / (b + (b * b - 4.0 * a * c).max(0.0).sqrt());
    by_inertia.min(ON_WHEELS * model.mass / count)
}

/// [kg m^2] What wheels of a mass [kg] each take of the chassis' moment of inertia.
pub(super) fn inertia_taken(model: &Model, wheels: &[WheelBody], mass: f64) -> f64 {
    let [squares, of_sum] = offsets(model, wheels);
    mass * squares + mass * mass * of_sum / (model.mass - wheels.len() as f64 * mass)
}

/// [m^2] Sum of the squares of the wheels' distances from the centre of mass, and the square of the sum of these ways.
fn offsets(model: &Model, wheels: &[WheelBody]) -> [f64; 2] {
    let ways = || wheels.iter().map(|w| w.center - model.center_of_mass);
    let sum: Vector = ways().sum();
    [
        ways().map(Vector::length_squared).sum(),
        sum.length_squared(),
    ]
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::scenario::{CircumferentialWheels, LineOfWheels, Scenario, Track, Wheel};

    fn model(track: Track) -> Model {
        let text = include_str!("../../../tests/scenarios/judge_gear3_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        scenario.robot.track = track;
        Model::new(&scenario.robot).expect("it can be built")
    }

    fn line(count: u32) -> Track {
        Track::Line(LineOfWheels {
            count,
            wheel_radius: None,
            wheel: Wheel::Round,
            as_track: true,
        })
    }

    fn small_wheels() -> Track {
        Track::Circumferential(CircumferentialWheels {
            count: 24,
            wheel_radius: None,
            wheel: Wheel::Round,
        })
    }

    #[test]
    fn the_chassis_keeps_half_of_the_mass_or_of_the_inertia() {
        for track in [line(9), small_wheels()] {
            for share in [0.02, 0.3, 1.0, 4.0] {
                let mut model = model(track.clone());
                model.moment_of_inertia *= share;
                let (chassis, wheels) = divided(&model);
                let on_wheels: f64 = wheels.iter().map(|w| w.mass).sum();
                let taken = inertia_taken(&model, &wheels, wheels[0].mass);
                let full = [on_wheels / model.mass, taken / model.moment_of_inertia];
                assert_relative_eq!(full[0].max(full[1]), ON_WHEELS, max_relative = 1e-9);
                let spinning: f64 = wheels.iter().map(|w| w.moment_of_inertia).sum();
                let left = model.locked_inertia() - spinning - taken;
                assert_relative_eq!(chassis.moment_of_inertia, left, max_relative = 1e-9);
                assert!(chassis.mass >= (1.0 - ON_WHEELS - 1e-9) * model.mass);
            }
        }
    }

    #[test]
    fn the_whole_has_its_mass_and_its_centre() {
        let model = model(line(4));
        let (chassis, wheels) = divided(&model);
        let all: f64 = wheels.iter().map(|w| w.mass).sum::<f64>() + chassis.mass;
        let moments = wheels.iter().map(|w| w.center * w.mass);
        let center = (moments.sum::<Vector>() + chassis.center_of_mass * chassis.mass) / all;
        assert_relative_eq!(all, model.mass, max_relative = 1e-12);
        assert!((center - model.center_of_mass).length() < 1e-12);
    }
}
