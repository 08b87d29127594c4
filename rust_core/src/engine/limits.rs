//! What the engine cannot hold: refused by field and reason before anything runs.

use crate::robot::{Model, Part};
use crate::scenario::{
    ContactMethod, Engine, ForceSupport, Scenario, ScenarioError, TorqueSharing, Track,
};

/// Defaults of the settings of our own contacts, in the order in which they are checked.
const OF_OUR_OWN: [f64; 4] = [1000.0, 5.0, 0.5, 2e-4];
/// [-] Least share of the robot's mass that each wheel has as a body, and that its surface has of `track_mass`. The engine's
/// contacts are as stiff as what is pressed together is heavy, and settle in one round of its solver a substep: 21 wheels of
/// 0.1 % each sink in by 5 to 20 mm; three that spin at 10 m/s do not push at all with 0.002 %.
const LIGHTEST_WHEEL: f64 = 0.0;
/// [-] Radii closer than this share are equal.
const SAME_RADIUS: f64 = 1e-9;

/// Checks that the engine of a scenario can hold its robot and its settings; our own can hold all.
///
/// The model is that of its robot, both tracks lumped.
///
/// # Errors
/// The first field that it cannot hold.
pub(crate) fn check(scenario: &Scenario, model: &Model) -> Result<(), ScenarioError> {
    if scenario.solver.engine == Engine::Own {
        return Ok(());
    }
    check_settings(scenario)?;
    let (robot, parts) = (&scenario.robot, &model.parts);
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
    let is_driven = !matches!(robot.track, Track::Force(_));
    let wheels = parts.iter().filter(|part| part.drive.is_some()).count();
    let least = LIGHTEST_WHEEL * wheels as f64 * robot.mass;
    if is_driven && robot.track_mass < least {
        let rule = format!(
            "must be at least {least:.3} kg where solver.engine is rapier, 0.3 % of the mass for each of {wheels} wheels: \
             its contacts do not turn lighter ones"
        );
        let value = robot.track_mass.to_string();
        return Err(ScenarioError::new("robot.track_mass", value, rule));
    }
    let sharing = robot.drivetrain.torque_sharing;
    if is_driven && sharing == TorqueSharing::Track && !is_one_radius(parts) {
        let rule = "must be wheel where solver.engine is rapier and wheels differ in radius: the engine can make wheels \
                    turn alike, but has no gears";
        let path = "robot.drivetrain.torque_sharing";
        return Err(ScenarioError::new(path, "track", rule));
    }
    Ok(())
}

fn check_settings(scenario: &Scenario) -> Result<(), ScenarioError> {
    let solver = &scenario.solver;
    let refused = |name: &str, value: &dyn ToString, rule: &str| {
        let rule = format!("must be {rule}, where solver.engine is rapier");
        Err(ScenarioError::new(
            format!("solver.{name}"),
            value.to_string(),
            rule,
        ))
    };
    if let Some(accuracy) = solver.accuracy {
        return refused("accuracy", &accuracy, "null, with a time_step,");
    }
    if solver.contact == ContactMethod::Reference {
        return refused(
            "contact",
            &"reference",
            "own, for it has contacts of its own",
        );
    }
    if let Some(iterations) = solver.iterations {
        return refused(
            "iterations",
            &iterations,
            "null, for it has a number of its own",
        );
    }
    let own = [
        ("contact_frequency", solver.contact_frequency),
        ("contact_damping_ratio", solver.contact_damping_ratio),
        ("max_push_speed", solver.max_push_speed),
        ("prediction_distance", solver.prediction_distance),
    ];
    for ((name, value), default) in own.iter().zip(OF_OUR_OWN) {
        if value.to_bits() != default.to_bits() {
            let rule = format!("its default, {default}, for it has a value of its own");
            return refused(name, value, &rule);
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

/// Whether all wheels have one radius.
fn is_one_radius(parts: &[Part]) -> bool {
    let wheels = parts.iter().filter(|part| part.drive.is_some());
    let radii = wheels.flat_map(Part::discs).map(|(tip, _)| tip.radius);
    let [least, most] = radii.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], radius| {
        [least.min(radius), most.max(radius)]
    });
    most - least <= SAME_RADIUS * most
}
