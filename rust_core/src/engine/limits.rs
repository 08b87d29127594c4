//! What the engine cannot hold: refused by field and reason before anything runs.

use crate::scenario::{
    ContactMethod, Drivetrain, Engine, ForceSupport, Scenario, ScenarioError, Track,
};

/// Settings of our own contacts, which the engine does not have, with their defaults.
pub const OWN_SETTINGS: [(&str, f64); 5] = [
    ("contact_frequency", 1000.0),
    ("contact_damping_ratio", 5.0),
    ("max_push_speed", 0.5),
    ("prediction_distance", 2e-4),
    ("restitution", 0.0),
];

/// Checks that the engine of a scenario can hold its robot and its settings; our own can hold all.
///
/// # Errors
/// The first field that it cannot hold.
pub(crate) fn check(scenario: &Scenario) -> Result<(), ScenarioError> {
    if scenario.solver.engine == Engine::Own {
        return Ok(());
    }
    check_settings(scenario)?;
    if let Some(path) = scenario.terrain.path_of_segments("terrain") {
        let rule = "must be null where solver.engine is rapier, whose lanes have one friction each";
        return Err(ScenarioError::new(path, "a list", rule));
    }
    let robot = &scenario.robot;
    check_motors(&robot.drivetrain)?;
    if let Some((kind, reason)) = refused(&robot.track) {
        let rule = format!(
            "must be line, circumferential, hybrid or force where solver.engine is rapier, which {reason}"
        );
        return Err(ScenarioError::new("robot.track.kind", kind, rule));
    }
    if robot.flippers.is_some() {
        let rule =
            "must be null where solver.engine is rapier: arms and their servos are not built there";
        return Err(ScenarioError::new("robot.flippers", "flippers", rule));
    }
    Ok(())
}

fn check_motors(drivetrain: &Drivetrain) -> Result<(), ScenarioError> {
    let refused = |name: &str, value: &dyn ToString, rule: &str| {
        let rule = format!(
            "must be {rule} where solver.engine is rapier: its motors hold their speed there"
        );
        let path = format!("robot.drivetrain.{name}");
        Err(ScenarioError::new(path, value.to_string(), rule))
    };
    if drivetrain.rotor_inertia > 0.0 {
        return refused("rotor_inertia", &drivetrain.rotor_inertia, "0");
    }
    if let Some(speed) = drivetrain.no_load_speed {
        return refused("no_load_speed", &speed, "null");
    }
    if drivetrain.torque_curve.is_some() {
        return refused("torque_curve", &"a curve", "null");
    }
    if drivetrain.controller.is_some() {
        return refused("controller", &"pi", "null");
    }
    if drivetrain.self_locking {
        return refused("self_locking", &true, "false");
    }
    Ok(())
}

fn check_settings(scenario: &Scenario) -> Result<(), ScenarioError> {
    let solver = &scenario.solver;
    let refused = |name: &str, value: &dyn ToString, rule: &str, reason: &str| {
        let rule = format!("must be {rule} where solver.engine is rapier, which {reason}");
        Err(ScenarioError::new(
            format!("solver.{name}"),
            value.to_string(),
            rule,
        ))
    };
    if let Some(accuracy) = solver.accuracy {
        return refused("accuracy", &accuracy, "null", "has a time_step instead");
    }
    if solver.contact == ContactMethod::Reference {
        return refused("contact", &"reference", "own", "has contacts of its own");
    }
    if let Some(iterations) = solver.iterations {
        let reason = "has a number of its own";
        return refused("iterations", &iterations, "null", reason);
    }
    let values = [
        solver.contact_frequency,
        solver.contact_damping_ratio,
        solver.max_push_speed,
        solver.prediction_distance,
        solver.restitution,
    ];
    for ((name, default), value) in OWN_SETTINGS.iter().zip(values) {
        if value.to_bits() != default.to_bits() {
            let rule = format!("its default, {default},");
            return refused(name, &value, &rule, "has a value of its own");
        }
    }
    Ok(())
}

/// The name of a track that the engine cannot hold, and why.
fn refused(track: &Track) -> Option<(&'static str, &'static str)> {
    const SURFACE: &str = "has no surface that a motor with a limit moves";
    match track {
        Track::Line(_) | Track::Circumferential(_) | Track::Hybrid(_) => None,
        Track::Force(force) => match force.support {
            ForceSupport::Skids | ForceSupport::Wheels => None,
        },
        Track::Belt(_) => Some(("belt", SURFACE)),
        Track::GrouserBelt(_) => Some(("grouser_belt", SURFACE)),
        Track::Closed(_) => Some(("closed", SURFACE)),
        Track::Segmental(_) => Some((
            "segmental",
            "would need a tensioner and shoes in contact with each other, which are not built there",
        )),
    }
}
