//! Whether a run has sunk deeper into the ground than the softness of its contacts explains.
//!
//! The equations: docs/physics.md, "Softness".

use super::Simulation;
use crate::contact::depth;
use crate::scenario::{Doubt, Engine};
use crate::units::{Metres, Seconds};

/// [s] Time between two looks at how deep the robot is: what has sunk in does not come out at once.
const LOOK: Seconds = Seconds(0.05);
/// [m] How deep something may get in a step that the search for contacts did not see: 0.5 mm by its middle.
const UNSEEN: Metres = Metres(1e-3);
/// Effective mass at the end of a rod, in units of its mass.
const AT_END: f64 = 0.25;

/// What was seen of a run.
pub(super) struct Sinkage {
    /// Whether the robot was set down on the ground: a track that is closed in the middle of a run has ground inside.
    is_anew: bool,
    /// [m] How deep it has been.
    pub deepest: f64,
    /// [m/s] The highest speed at which anything may have met the ground.
    fastest: f64,
    /// [m] No point of the robot is farther from its centre of mass.
    reach: f64,
    looks: u64,
}

impl Sinkage {
    /// Begins with the present state.
    pub(super) fn from(simulation: &Simulation) -> Self {
        Self {
            is_anew: simulation.time() <= 0.0,
            deepest: 0.0,
            fastest: 0.0,
            reach: simulation.model().reach(),
            looks: (simulation.time() / LOOK.value()) as u64,
        }
    }

    /// Takes the state after a step.
    pub(super) fn step(&mut self, simulation: &Simulation) {
        self.fastest = self.fastest.max(speed(simulation, self.reach));
        if simulation.time() >= self.looks as f64 * LOOK.value() {
            self.looks += 1;
            self.deepest = self.deepest.max(deepest(simulation));
        }
    }

    /// A doubt about a run that sank deeper than its softness explains; an engine in place of ours has its own.
    pub(super) fn doubt(&self, simulation: &Simulation) -> Option<Doubt> {
        let most = explained(simulation, self.fastest);
        let is_own = simulation.scenario().solver.engine == Engine::Own;
        (is_own && self.is_anew && self.deepest > most).then(|| Doubt {
            path: "max_penetration".to_owned(),
            value: self.deepest,
            reason: format!(
                "is usually at most {most:.4} m, what softness and blows explain: contacts were not found, or \
                 solver.max_push_speed is too low for the load"
            ),
        })
    }
}

/// [m] How deep the robot is in the ground now.
fn deepest(simulation: &Simulation) -> f64 {
    let (model, running, pose) = simulation.placed();
    let depths = model.parts.iter().map(|part| {
        let place = running.mounted(part.mount, pose) * part.place(&running);
        depth(part, place, &simulation.ground().lanes[part.lane])
    });
    depths.fold(0.0, f64::max)
}

/// [m/s] No point of the robot is faster now.
fn speed(simulation: &Simulation, reach: f64) -> f64 {
    let reading = simulation.reading();
    let drives = (0..simulation.drives()).map(|k| simulation.drive_speed(k));
    let arms = simulation.flipper_rates().map(|rate| rate * reach);
    let own = drives.chain(arms).map(f64::abs).fold(0.0, f64::max);
    reading.velocity.length() + reading.angular_velocity.abs() * reach + own
}

/// [m] The depth that soft contacts explain: all of the load on one of them, and a blow of the whole robot.
fn explained(simulation: &Simulation, speed: f64) -> f64 {
    let model = simulation.model();
    let omega = std::f64::consts::TAU * simulation.scenario().solver.contact_frequency;
    let mass = model.total_mass();
    // The mass that a contact is as stiff as.
    let of_shoes = model.chains.iter().map(|chain| AT_END * chain.shoe_mass);
    let own = of_shoes.fold(mass, f64::min);
    let load = simulation.weight() + model.motors as f64 * model.motor.force;
    load / (own * omega * omega) + speed / omega * (mass / own).sqrt() + UNSEEN.value()
}
