//! Figures of a whole run.

use super::Simulation;
use crate::observe::{Event, EventKind, Reading};

/// What one metric is.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name in tables and files.
    pub name: &'static str,
    /// Its unit; "1" if it has none.
    pub unit: &'static str,
    /// What it says.
    pub meaning: &'static str,
    value: fn(&Metrics) -> f64,
}

/// Makes the fields of [`Metrics`], and what is said of them elsewhere, of one table.
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
    track_distance ["m"] "how far the track surface has run: for wheels what odometry with the circumscribed radius reads, for belts and chains the travel of the belt"
    path_length ["m"] "how far the chassis frame has actually moved, along its own axis"
    max_angle ["rad"] "largest angle of the chassis, nose up > 0"
    min_angle ["rad"] "smallest angle of the chassis"
    max_penetration ["m"] "deepest overlap of any part with the ground; more than softness explains is doubted"
    drive_work ["J"] "work of the motors of the tracks, without those of the flippers"
    stopped_time ["s"] "time spent in stops"
    time_to_free ["s"] "longest stop from which the robot freed itself; 0 if there was none"
    progress ["1"] "share of the commanded distance covered in the last stop window; 1 until the first window is over"
    vertical_acceleration ["m/s^2"] "of the chassis frame, averaged over 10 ms; root mean square"
    angular_velocity ["rad/s"] "rate of change of the chassis angle, root mean square"
    intrusion_depth ["m"] "greatest depth, below the circumscribed circles, of the most loaded intrusion that lasts to the end; 0 if there is none"
    intrusion_root_depth ["m"] "the same, measured from the root circles"
    intrusion_force ["N"] "its mean normal force"
    max_track_tension ["N"] "largest force in a pin of a chain of shoes; 0 without one"
    max_pin_gap ["m"] "largest distance by which the two halves of a pin were apart"
    max_guide_penetration ["m"] "deepest overlap of a shoe with guide, wheels or teeth"
    max_sprocket_slip ["m"] "farthest that a chain ran ahead of its sprocket or behind it; some hundredths of a pitch are the play of the teeth"
    steps ["1"] "steps of the solver, all together"
    repeated_steps ["1"] "attempts at a step whose local error exceeded `solver.accuracy`; each was taken again with a shorter one"
    solves ["1"] "searches for the forces that all contacts, motors and pins agree on"
    solve_rounds ["1"] "linear systems solved in these: one per solve if the first guess of what sticks and what slides is right"
    lowerings ["1"] "how often correcting the guesses did not succeed, so that the robot was lifted off and lowered onto its contacts"
    unresolved_solves ["1"] "solves that ended without agreement: contacts close a little faster in them than they should"
}

impl Metrics {
    /// Names and values, in the order of the tables.
    pub fn entries(&self) -> Vec<(&'static str, f64)> {
        let entry = |metric: &Metric| (metric.name, (metric.value)(self));
        Self::ALL.iter().map(entry).collect()
    }

    /// Metrics of a run that began at `start` and had these events.
    pub(super) fn of(simulation: &Simulation, start: &Reading, events: &[Event]) -> Self {
        let end = simulation.reading();
        let monitor = simulation.monitor();
        let seen = &monitor.seen;
        let inside = monitor.intrusion();
        Self {
            time: end.time,
            time_to_clear: seen.time_to_clear,
            final_x: end.position.x,
            final_y: end.position.y,
            final_angle: end.chassis_angle,
            distance: end.position.x - start.position.x,
            track_distance: end.track_position - start.track_position,
            path_length: seen.path_length,
            max_angle: seen.max_angle.max(start.chassis_angle),
            min_angle: seen.min_angle.min(start.chassis_angle),
            max_penetration: seen.max_penetration,
            drive_work: seen.drive_work,
            stopped_time: events
                .iter()
                .filter(|e| e.kind == EventKind::Stop)
                .fold(0.0, |sum, e| sum + e.end - e.start),
            time_to_free: monitor.time_to_free(),
            progress: monitor.progress(),
            vertical_acceleration: seen.shaking.vertical_acceleration(),
            angular_velocity: seen.shaking.angular_velocity(),
            intrusion_depth: inside.map_or(0.0, |e| e.depth),
            intrusion_root_depth: inside.map_or(0.0, |e| e.root_depth),
            intrusion_force: inside.map_or(0.0, |e| e.force),
            max_track_tension: seen.max_track_tension,
            max_pin_gap: seen.max_pin_gap,
            max_guide_penetration: seen.max_guide_penetration,
            max_sprocket_slip: seen.max_sprocket_slip,
            steps: seen.effort.steps as f64,
            repeated_steps: seen.effort.repeated_steps as f64,
            solves: seen.effort.solves as f64,
            solve_rounds: seen.effort.rounds as f64,
            lowerings: seen.effort.lowerings as f64,
            unresolved_solves: seen.effort.unresolved as f64,
        }
    }
}
