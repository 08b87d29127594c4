//! Figures of a whole run, and a warning if it penetrated the ground deeper than softness explains.
//!
//! The equations: docs/physics.md, "Softness".

use super::Simulation;
use crate::contact::depth;
use crate::observe::{Event, EventKind};
use crate::scenario::{Engine, Warning};
use crate::units::{Metres, Seconds};

/// Description of one metric.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name in tables and files.
    pub name: &'static str,
    /// Its unit; "1" if it has none.
    pub unit: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    value: fn(&Metrics) -> f64,
}

/// Makes the fields of [`Metrics`] and their descriptions from one table.
macro_rules! metrics {
    ($($name:ident [$unit:literal] $meaning:literal)*) => {
        /// Metrics of a whole run; counts, too, are `f64`, as in the tables of sweeps.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Metrics {
            $(#[doc = concat!("[", $unit, "] ", $meaning)] pub $name: f64,)*
        }

        impl Metrics {
            /// All metrics, in the order of the tables.
            pub const ALL: &[Metric] = &[$(Metric {
                name: stringify!($name),
                unit: $unit,
                meaning: $meaning,
                value: |metrics| metrics.$name,
            }),*];
        }
    };
}

metrics! {
    time ["s"] "simulated time"
    time_to_clear ["s"] "when the robot reached the goal for good; inf if it did not"
    final_x ["m"] "final position of the chassis frame, forward"
    final_y ["m"] "the same, upward"
    final_angle ["rad"] "final angle of the chassis, nose up > 0"
    distance ["m"] "final x minus initial x"
    track_distance ["m"] "distance that the track surface has run: for wheels the odometry with their circumscribed radius, for belts and chains their travel"
    path_length ["m"] "distance that the chassis frame has actually moved along its own axis"
    max_angle ["rad"] "largest angle of the chassis, nose up > 0"
    min_angle ["rad"] "smallest angle of the chassis"
    max_penetration ["m"] "deepest overlap of any part with the ground; more than softness explains gets a warning"
    drive_work ["J"] "work of the motors of the tracks, without those of the flippers"
    stopped_time ["s"] "time spent in stops"
    time_to_free ["s"] "longest stop from which the robot freed itself; 0 if there was none"
    progress ["1"] "share of the commanded distance covered in the last stop window; 1 until the first window in its direction is over"
    vertical_acceleration ["m/s^2"] "of the chassis frame, averaged over 10 ms; root mean square, 0 in a run that is shorter"
    angular_velocity ["rad/s"] "rate of change of the chassis angle, root mean square of its values every 10 ms, 0 in a run that is shorter"
    intrusion_depth ["m"] "greatest depth, below the circumscribed circles, of the most loaded intrusion that lasts to the end; 0 if there is none"
    intrusion_root_depth ["m"] "the same, measured from the root circles"
    intrusion_force ["N"] "its mean normal force"
    max_track_tension ["N"] "largest force in a pin of a chain of shoes; 0 without one"
    max_pin_gap ["m"] "largest gap between the two halves of a pin"
    max_guide_penetration ["m"] "deepest overlap of a shoe with guide, wheels or teeth"
    max_sprocket_slip ["m"] "largest distance by which a chain ran ahead of its sprocket or lagged behind it; some hundredths of a pitch are the play of the teeth"
    steps ["1"] "steps of the solver"
    repeated_steps ["1"] "attempts at a step whose local error exceeded `solver.accuracy`, or within which a force jumped; each was taken again with a shorter one"
    solves ["1"] "searches for forces that satisfy all contacts, motors and pins"
    solve_rounds ["1"] "linear systems solved in these searches: one each if the first guess of what sticks and what slides is right"
    solver_fallbacks ["1"] "how often corrections of what sticks and slides found no solution, so that a path of pivots was followed"
    unresolved_solves ["1"] "searches that found no solution: contacts close a little faster in them than they should"
}

impl Metrics {
    /// Former names of metrics, with the current ones.
    pub const RENAMED: [(&str, &str); 1] = [("lowerings", "solver_fallbacks")];

    /// Names and values, in the order of the tables.
    pub fn entries(&self) -> Vec<(&'static str, f64)> {
        let entry = |metric: &Metric| (metric.name, (metric.value)(self));
        Self::ALL.iter().map(entry).collect()
    }

    /// Metrics of a run that had these events.
    pub(super) fn of(simulation: &Simulation, events: &[Event]) -> Self {
        let end = simulation.reading();
        let monitor = simulation.monitor();
        let observed = &monitor.observed;
        let inside = monitor.intrusion();
        Self {
            time: end.time,
            time_to_clear: observed.time_to_clear,
            final_x: end.position.x,
            final_y: end.position.y,
            final_angle: end.chassis_angle,
            distance: end.position.x - observed.start[0],
            track_distance: end.track_position - observed.start[1],
            path_length: observed.path_length,
            max_angle: observed.max_angle,
            min_angle: observed.min_angle,
            max_penetration: observed.max_penetration,
            drive_work: observed.drive_work,
            stopped_time: events
                .iter()
                .filter(|e| e.kind == EventKind::Stop)
                .fold(0.0, |sum, e| sum + e.end - e.start),
            time_to_free: monitor.time_to_free(),
            progress: monitor.progress(),
            vertical_acceleration: observed.shaking.vertical_acceleration(),
            angular_velocity: observed.shaking.angular_velocity(),
            intrusion_depth: inside.map_or(0.0, |e| e.depth),
            intrusion_root_depth: inside.map_or(0.0, |e| e.root_depth),
            intrusion_force: inside.map_or(0.0, |e| e.force),
            max_track_tension: observed.max_track_tension,
            max_pin_gap: observed.max_pin_gap,
            max_guide_penetration: observed.max_guide_penetration,
            max_sprocket_slip: observed.max_sprocket_slip,
            steps: observed.effort.steps as f64,
            repeated_steps: observed.effort.repeated_steps as f64,
            solves: observed.effort.solves as f64,
            solve_rounds: observed.effort.rounds as f64,
            solver_fallbacks: observed.effort.paths as f64,
            unresolved_solves: observed.effort.unresolved as f64,
        }
    }
}

/// [s] Time between two checks of the depth: penetration does not disappear at once.
const BETWEEN_LOOKS: Seconds = Seconds(0.05);
/// [m] Depth that something outside the search for contacts may reach in a step: 0.5 mm by its middle.
const UNSEEN_DEPTH: Metres = Metres(1e-3);
/// Effective mass at the end of a rod, in units of its mass.
const ROD_END: f64 = 0.25;

/// Observations of a run.
pub(super) struct Sinkage {
    /// Whether the robot started on the ground; a track that is closed in the middle of a run may have ground inside.
    is_anew: bool,
    /// [m] Largest depth so far.
    pub deepest: f64,
    /// [m/s] Upper bound for the speed at which anything met the ground.
    fastest: f64,
    /// [m] Largest distance of a point of the robot from its centre of mass.
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
            looks: (simulation.time() / BETWEEN_LOOKS.value()) as u64,
        }
    }

    /// Processes the state after a step.
    pub(super) fn step(&mut self, simulation: &Simulation) {
        self.fastest = self.fastest.max(speed(simulation, self.reach));
        if simulation.time() >= self.looks as f64 * BETWEEN_LOOKS.value() {
            self.looks += 1;
            self.deepest = self.deepest.max(deepest(simulation));
        }
    }

    /// A warning about a run that penetrated deeper than its softness explains; another engine has its own warning.
    pub(super) fn warning(&self, simulation: &Simulation) -> Option<Warning> {
        let most = explained(simulation, self.fastest);
        let is_own = simulation.scenario().solver.engine == Engine::Own;
        (is_own && self.is_anew && self.deepest > most).then(|| Warning {
            path: "max_penetration".to_owned(),
            value: self.deepest,
            reason: format!(
                "is usually at most {most:.4} m, what softness and impacts explain: contacts were not found, or \
                 solver.max_push_speed is too low for the load"
            ),
        })
    }
}

/// [m] Present depth of the robot in the ground.
fn deepest(simulation: &Simulation) -> f64 {
    let (model, running, pose) = simulation.placed();
    let depths = model.parts.iter().map(|part| {
        let place = running.mounted(part.mount, pose) * part.place(&running);
        depth(part, place, &simulation.ground().lanes[part.lane])
    });
    depths.fold(0.0, f64::max)
}

/// [m/s] Upper bound for the present speed of points of the robot.
fn speed(simulation: &Simulation, reach: f64) -> f64 {
    let reading = simulation.reading();
    let drives = (0..simulation.drives()).map(|k| simulation.drive_speed(k));
    let arms = simulation.flipper_rates().map(|rate| rate * reach);
    let own = drives.chain(arms).map(f64::abs).fold(0.0, f64::max);
    reading.velocity.length() + reading.angular_velocity.abs() * reach + own
}

/// [m] The depth that soft contacts explain, with the whole load on one of them, and an impact of the whole robot.
fn explained(simulation: &Simulation, speed: f64) -> f64 {
    let model = simulation.model();
    let omega = std::f64::consts::TAU * simulation.scenario().solver.contact_frequency;
    let mass = model.total_mass();
    // The mass from which the stiffness of a contact follows.
    let of_shoes = model.chains.iter().map(|chain| ROD_END * chain.shoe_mass);
    let own = of_shoes.fold(mass, f64::min);
    let load = simulation.weight() + model.motors as f64 * model.motor.force;
    load / (own * omega * omega) + speed / omega * (mass / own).sqrt() + UNSEEN_DEPTH.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::FlipperCommand;
    use crate::run::ValidScenario;
    use crate::scenario::{End, Track, shared};

    /// The Engineer on a belt, or on a chain of 40 shoes of 60 g.
    fn simulation(on_chain: bool) -> Simulation {
        let name = if on_chain {
            "engineer_chain_step"
        } else {
            "engineer_belt_step"
        };
        let mut scenario = shared(name);
        if let Track::Segmental(chain) = &mut scenario.robot.track {
            chain.shoe_count = Some(40);
        }
        Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"))
    }

    #[test]
    fn the_stopped_time_is_that_of_all_stops_and_of_nothing_else() {
        let intrusion = Event {
            kind: EventKind::Intrusion,
            ..Event::stop(0.0, 100.0, None)
        };
        let events = [
            Event::stop(1.0, 3.0, None),
            intrusion,
            Event::stop(5.0, 9.5, None),
        ];
        let found = Metrics::of(&simulation(false), &events).stopped_time;
        assert!((found - 6.5).abs() < 1e-12, "{found} s");
    }

    /// On the belt 1.0005 mm are explained at rest.
    #[test]
    fn a_depth_has_a_warning_if_it_exceeds_what_is_explained_in_a_run_from_its_start() {
        let simulation = simulation(false);
        let warning = |is_anew, deepest| {
            let seen = Sinkage {
                is_anew,
                deepest,
                ..Sinkage::from(&simulation)
            };
            seen.warning(&simulation)
        };
        assert!(Sinkage::from(&simulation).is_anew, "it is at its start");
        assert_eq!(warning(true, 1.0004e-3), None);
        assert_eq!(warning(false, 2e-3), None);
        let found = warning(true, 1.0006e-3).expect("it is deeper");
        let reason = "is usually at most 0.0010 m, what softness and impacts explain:";
        assert!(found.reason.starts_with(reason), "{}", found.reason);
        assert!((found.value - 1.0006e-3).abs() < 1e-15);
    }

    #[test]
    fn the_fastest_point_moves_as_the_robot_turns_and_its_track_runs() {
        let simulation = simulation(false);
        let place = ValidScenario::new(simulation.scenario()).expect("it is valid");
        let running = Simulation::driven_at(&place, simulation.reading().position, 0.0);
        // At rest, with a track that runs at the command.
        let found = speed(&running, 0.3);
        assert!((found - 0.4).abs() < 1e-12, "{found} m/s");
    }

    /// Its arms turn by 1 rad/s.
    #[test]
    fn tips_of_arms_are_as_fast_as_they_turn_and_as_far_as_the_robot_reaches() {
        let mut scenario = shared("engineer_flippers_step");
        (scenario.drive.gait, scenario.drive.speed) = (None, 0.0);
        let mut simulation = Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"));
        let up = FlipperCommand::Rate(1.0);
        simulation
            .command_flippers(End::Front, up)
            .expect("it has arms");
        simulation.advance(0.3).expect("the state stays finite");
        let [near, far] = [0.5, 2.0].map(|reach| speed(&simulation, reach));
        // The chassis hardly moves.
        assert!(
            (near - 0.5).abs() < 0.02 && (far - 2.0).abs() < 0.08,
            "{near} {far} m/s"
        );
    }

    /// All of its weight presses a contact in by 0.25 um, and it accelerates at 0.2 m/s^2.
    #[test]
    fn a_belt_on_the_ground_is_not_deep_and_no_faster_than_it_drives() {
        let mut simulation = simulation(false);
        let mut seen = Sinkage::from(&simulation);
        while simulation.time() < 0.3 {
            simulation.step_until(0.3).expect("the state stays finite");
            seen.step(&simulation);
        }
        assert!(
            seen.deepest > 1e-8 && seen.deepest < 1e-6,
            "{} m",
            seen.deepest
        );
        // The robot and its track, each at up to 0.06 m/s.
        assert!((seen.fastest - 0.12).abs() < 0.01, "{} m/s", seen.fastest);
        // At the start and every 0.05 s; the last may miss the end by rounding.
        assert!((6..=7).contains(&seen.looks));
        let later = Sinkage::from(&simulation);
        assert!(!later.is_anew && (5..=6).contains(&later.looks));
    }

    /// The contacts have 1000 Hz: 6283.2 /s. On a belt, a contact has the stiffness for 21.2 kg, and bears 207.97 N of
    /// weight and 2 x 6 N m / 0.052 m = 230.77 N of force: 0.52 um. On a chain it has the stiffness for 15 g, and an
    /// impact of 1 m/s is deeper by the square root of 21.2 / 0.015 = 37.59: 5.98 mm instead of 0.16 mm.
    #[test]
    fn what_softness_and_impacts_explain_depends_on_the_mass_that_a_contact_is_as_stiff_as() {
        let depths = |on_chain| [0.0, 1.0].map(|speed| explained(&simulation(on_chain), speed));
        let [rest, impact] = depths(false);
        assert!((rest - 1.000_524e-3).abs() < 1e-9, "{rest} m");
        assert!((impact - rest - 1.591_55e-4).abs() < 1e-9, "{impact} m");
        let [rest, impact] = depths(true);
        assert!((rest - 1.0e-3 - 0.74e-3).abs() < 1e-5, "{rest} m");
        assert!((impact - rest - 5.983e-3).abs() < 1e-6, "{impact} m");
    }
}
