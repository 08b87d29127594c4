//! What the judge takes of a robot: its masses, its shapes, its motors.

use crawler2d_core::{Model, Scenario, Shape, Vector};

use super::wheel::Toothed;

/// What a part looks like, in the chassis frame about the centre of mass.
pub(super) enum Form {
    Disc { center: Vector, radius: f64 },
    Toothed { center: Vector, wheel: Toothed },
    Belly { corners: Vec<Vector> },
}

/// One part, and how its surface is moved.
pub(super) struct Part {
    pub form: Form,
    /// Its drive, and the radius [m] at which its surface has the drive's speed.
    pub drive: Option<(usize, f64)>,
    pub friction: f64,
    /// [m] Radius of a disc about the part's place that holds all of it.
    pub reach: f64,
}

/// One rigid body with drives.
pub(super) struct Robot {
    pub mass: f64,
    pub center_of_mass: Vector,
    /// [kg m^2] Without what turns with the drives.
    pub inertia: f64,
    pub parts: Vec<Part>,
    pub drives: usize,
    /// [kg] Mass that moves at the surface speed of each drive.
    pub drive_mass: f64,
    /// [m] Radius at which it turns.
    pub drive_radius: f64,
    /// [N] Largest force of each motor at the surface.
    pub drive_force: f64,
}

impl Robot {
    pub(super) fn new(scenario: &Scenario, ground_friction: f64) -> Self {
        let model = Model::new(&scenario.robot).expect("the robot can be built");
        assert!(!model.pushes_chassis && model.motors == model.drives);
        let parts = model.parts.iter().map(|part| {
            let about = |p: Vector| p - model.center_of_mass;
            let (form, radius) = match &part.shape {
                Shape::Disc { center, radius } => {
                    let (center, radius) = (about(*center), *radius);
                    (Form::Disc { center, radius }, radius)
                }
                Shape::Gear { center, gear } => {
                    let (center, wheel) = (about(*center), Toothed::new(gear));
                    (Form::Toothed { center, wheel }, gear.radius)
                }
                Shape::Polygon { corners } => {
                    let corners: Vec<Vector> = corners.iter().map(|p| about(*p)).collect();
                    let reach = corners.iter().map(|p| p.length()).fold(0.0, f64::max);
                    (Form::Belly { corners }, reach)
                }
                Shape::Hull { .. } | Shape::Grouser(_) => panic!("the judge knows no belts"),
            };
            Part {
                form,
                drive: part.drive.map(|drive| (drive, radius)),
                friction: part.friction_limit.min(ground_friction),
                reach: radius,
            }
        });
        Self {
            mass: model.mass,
            center_of_mass: model.center_of_mass,
            inertia: model.moment_of_inertia,
            parts: parts.collect(),
            drives: model.drives,
            drive_mass: model.drive_masses[0],
            drive_radius: model.drive_radius,
            drive_force: model.motor.force,
        }
    }
}

impl Part {
    /// Centre of the disc that holds the part, about the centre of mass.
    pub(super) fn place(&self) -> Vector {
        match &self.form {
            Form::Disc { center, .. } | Form::Toothed { center, .. } => *center,
            Form::Belly { .. } => Vector::ZERO,
        }
    }
}
