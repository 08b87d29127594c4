//! Figures of a whole run.

use super::Simulation;
use crate::observe::{Event, EventKind, Reading};

/// Metrics of a whole run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// [s] Simulated time.
    pub time: f64,
    /// [s] Time at which the goal was reached and then held; infinite if it was not.
    pub time_to_clear: f64,
    /// [m] Final position of the chassis frame.
    pub final_x: f64,
    /// [m] Final position of the chassis frame.
    pub final_y: f64,
    /// [rad] Final chassis angle.
    pub final_angle: f64,
    /// [m] Final x minus initial x.
    pub distance: f64,
    /// [m] How far the track surface has run: what odometry with the circumscribed radius reads.
    pub track_distance: f64,
    /// [m] How far the chassis frame has moved along its own axis.
    pub path_length: f64,
    /// [rad] Largest chassis angle.
    pub max_angle: f64,
    /// [rad] Smallest chassis angle.
    pub min_angle: f64,
    /// [m] Deepest penetration of the ground by any part.
    pub max_penetration: f64,
    /// [J] Work of the motors.
    pub drive_work: f64,
    /// [s] Time spent in stops.
    pub stopped_time: f64,
    /// [s] Longest stop that the robot got out of by itself; 0 if there was none.
    pub time_to_free: f64,
    /// Share of the commanded distance made in the last stop window.
    pub progress: f64,
    /// [m/s^2] Root mean square of the vertical acceleration, averaged over 10 ms.
    pub vertical_acceleration: f64,
    /// [rad/s] Root mean square of the rate of change of the chassis angle.
    pub angular_velocity: f64,
    /// [m] Depth of the most loaded intrusion at the end of the run, below the circumscribed circles;
    /// 0 if there is none.
    pub intrusion_depth: f64,
    /// [m] The same, below the root circles.
    pub intrusion_root_depth: f64,
    /// [N] Its mean normal force.
    pub intrusion_force: f64,
    /// [N] Largest force in a pin of a chain; 0 without chains.
    pub max_track_tension: f64,
    /// [m] Largest gap of a pin.
    pub max_pin_gap: f64,
    /// [m] Deepest penetration of a chain's guide, wheels or teeth by a shoe.
    pub max_guide_penetration: f64,
    /// [m] Largest slip between a chain and its sprocket, ahead or behind; 0 without a sprocket.
    pub max_sprocket_slip: f64,
    /// Steps taken.
    pub steps: f64,
    /// Steps taken again with a shorter one, because their error was too large.
    pub repeated_steps: f64,
    /// Searches for forces that satisfy all contacts, motors and pins.
    pub solves: f64,
    /// Linear systems solved in them; one per solve if every first guess is right.
    pub solve_rounds: f64,
    /// How often no guess was right, so that the robot was lowered onto its contacts.
    pub lowerings: f64,
    /// Solves that found no consistent forces: they let contacts sink in a little faster than they should.
    pub unresolved_solves: f64,
}

impl Metrics {
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

    /// Names and values, in the order of the tables.
    pub fn entries(&self) -> [(&'static str, f64); 30] {
        [
            ("time", self.time),
            ("time_to_clear", self.time_to_clear),
            ("final_x", self.final_x),
            ("final_y", self.final_y),
            ("final_angle", self.final_angle),
            ("distance", self.distance),
            ("track_distance", self.track_distance),
            ("path_length", self.path_length),
            ("max_angle", self.max_angle),
            ("min_angle", self.min_angle),
            ("max_penetration", self.max_penetration),
            ("drive_work", self.drive_work),
            ("stopped_time", self.stopped_time),
            ("time_to_free", self.time_to_free),
            ("progress", self.progress),
            ("vertical_acceleration", self.vertical_acceleration),
            ("angular_velocity", self.angular_velocity),
            ("intrusion_depth", self.intrusion_depth),
            ("intrusion_root_depth", self.intrusion_root_depth),
            ("intrusion_force", self.intrusion_force),
            ("max_track_tension", self.max_track_tension),
            ("max_pin_gap", self.max_pin_gap),
            ("max_guide_penetration", self.max_guide_penetration),
            ("max_sprocket_slip", self.max_sprocket_slip),
            ("steps", self.steps),
            ("repeated_steps", self.repeated_steps),
            ("solves", self.solves),
            ("solve_rounds", self.solve_rounds),
            ("lowerings", self.lowerings),
            ("unresolved_solves", self.unresolved_solves),
        ]
    }
}
