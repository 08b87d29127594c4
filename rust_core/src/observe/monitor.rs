//! Monitors a run for goal, tip-over and stops. It only reads, and ends a run once its outcome is certain.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::observations::{Anchor, LOOK, Observations};
use super::{Event, Outcome, Reading, Signals, Stance};
use crate::contact::{Contact, TrackEnvelope};
use crate::dynamics::{ChainReading, DriveState};
use crate::geometry::{Envelope, Pose, Vector, end_discs, outline_discs, turned_by};
use crate::robot::{Model, Part, Running};
use crate::scenario::{Scenario, SeizureCriteria};
use crate::solver::Effort;
use crate::terrain::Ground;

/// The monitor of one run.
pub(crate) struct Monitor {
    criteria: SeizureCriteria,
    ground: Arc<Ground>,
    goal: f64,
    /// [m] Height one metre below the lowest ground.
    floor: f64,
    half_length: f64,
    /// End axles in the chassis frame, the rear one first.
    axles: [Vector; 2],
    rear_radius: f64,
    /// [rad] Chassis angle of its track standing on level ground.
    standing_angle: f64,
    grouser_pitch: f64,
    /// The parts of the robot.
    parts: Vec<Part>,
    /// Envelopes of the tracks, each with its lane.
    envelopes: Vec<TrackEnvelope>,
    /// Whether a driver, or a controller that integrates errors, may still change everything.
    may_change: bool,
    /// Whether a turning grouser may change the contacts while the pose stays the same.
    has_grousers: bool,
    /// Its observations.
    pub observed: Observations,
}

impl Monitor {
    pub(crate) fn new(scenario: &Scenario, ground: &Arc<Ground>, model: &Model) -> Self {
        let outline = &scenario.robot.outline;
        Self {
            criteria: scenario.criteria.clone(),
            ground: Arc::clone(ground),
            goal: ground.goal_of(scenario),
            floor: ground.lowest() - 1.0,
            half_length: 0.5 * outline.axle_distance(),
            axles: end_discs(outline).map(|disc| disc.center),
            rear_radius: outline.rear_radius(),
            standing_angle: Envelope::new(&outline_discs(outline))
                .standing_angle(Vector::from(scenario.robot.center_of_mass)),
            grouser_pitch: outline.grouser_pitch,
            envelopes: (0..ground.tracks)
                .flat_map(|lane| model.mounts_of_tracks().map(move |mount| (lane, mount)))
                .map(|track| {
                    TrackEnvelope::new(&model.parts, track, scenario.criteria.intrusion_depth)
                })
                .collect(),
            may_change: scenario.drive.schedule.is_some()
                || (scenario.robot.drivetrain.controller).is_some_and(|pi| pi.integral > 0.0)
                || (scenario.drive.gait.is_some() && !model.flippers.is_empty()),
            parts: model.parts.clone(),
            has_grousers: model.parts.iter().any(Part::is_carried),
            observed: Observations::from(0.0),
        }
    }

    /// [s] Time of the next check of progress; steps are processed in parts that end there.
    pub(crate) fn next_look(&self) -> f64 {
        self.observed.looks as f64 * LOOK.value()
    }

    /// Processes a step or a part of one: the state of the robot at its end, the flipper positions, and during it the
    /// mean speed [m/s] along the chassis, the contact forces, and the drives with their mean speeds.
    pub(crate) fn observe(
        &mut self,
        (now, forward_speed): (&Reading, f64),
        command: f64,
        loaded: &[Contact],
        drives: impl Iterator<Item = (DriveState, f64)> + Clone,
        running: &Running,
    ) {
        let observed = &mut self.observed;
        let dt = now.time - observed.last_time;
        observed.last_time = now.time;
        observed.loads.add(loaded, dt);
        let work_rate: f64 = drives
            .clone()
            .map(|(drive, speed)| drive.force * speed)
            .sum();
        observed.drive_work += work_rate * dt;
        observed.path_length += forward_speed * dt;
        observed.max_angle = observed.max_angle.max(now.chassis_angle);
        observed.min_angle = observed.min_angle.min(now.chassis_angle);
        for l in loaded {
            observed.max_penetration = observed.max_penetration.max(-l.distance);
        }
        let length = 2.0 * self.half_length;
        observed.progress.advance(now, command, length, dt);
        let window = self.window(command);
        if self.observed.progress.falters() {
            self.observed.signals.add((now, dt), loaded, drives, window);
        }
        if self.observed.ended.is_none() {
            self.observed.ended = self.ended(now, dt);
        }
        if now.time >= self.next_look() {
            // The first step is not cut at checks: those within it are skipped.
            while now.time >= self.next_look() {
                self.observed.looks += 1;
            }
            self.observed.shaking.look(now);
            self.look_inside(now, running);
            self.look(now, command, window);
            if !self.has_grousers && !self.may_change {
                self.watch_stationary(now, window, loaded);
            }
        }
    }

    /// Adds the solver's work in the same step.
    pub(crate) fn observe_effort(&mut self, effort: Effort) {
        self.observed.effort = self.observed.effort.plus(effort);
    }

    /// Processes the state of the chains in the same step.
    pub(crate) fn observe_chains(&mut self, chains: ChainReading) {
        let observed = &mut self.observed;
        observed.max_track_tension = observed.max_track_tension.max(chains.tension);
        observed.max_pin_gap = observed.max_pin_gap.max(chains.pin_gap);
        observed.max_guide_penetration =
            observed.max_guide_penetration.max(chains.guide_penetration);
        observed.max_sprocket_slip = observed.max_sprocket_slip.max(chains.sprocket_slip);
        if chains.is_off {
            observed.ended.get_or_insert(Outcome::Detracked);
        }
    }

    /// Checks for outcomes that need no stop window.
    fn ended(&mut self, now: &Reading, dt: f64) -> Option<Outcome> {
        if now.chassis_angle.abs() > self.criteria.tip_over_angle {
            return Some(Outcome::TippedOver);
        }
        let turned = turned_by(now.chassis_angle);
        let [rear_axle, front_axle] = self.axles.map(|axle| now.position + turned(axle));
        let (rear, front) = (rear_axle.x, front_axle.x);
        let lower_axle = rear_axle.y.min(front_axle.y);
        let (low, high) = self.ground.extent();
        if rear.min(front) < low || rear.max(front) > high || lower_axle < self.floor {
            return Some(Outcome::LeftTerrain);
        }
        let is_level = || {
            let ground = self.ground.angle_at(now.position.x);
            let angle = now.chassis_angle - self.standing_angle - ground;
            angle.abs() < self.criteria.clear_angle
        };
        let beyond = self.beyond(rear);
        let before = std::mem::replace(&mut self.observed.beyond, beyond);
        if beyond > 0.0 && is_level() {
            // It has passed the goal within the step.
            let over = beyond / (beyond - before.min(0.0));
            let since = *self.observed.goal_since.get_or_insert(now.time - over * dt);
            if now.time - since >= self.criteria.clear_time {
                self.observed.time_to_clear = since;
                return Some(Outcome::Cleared);
            }
        } else {
            self.observed.goal_since = None;
        }
        None
    }

    /// [m] Distance of the robot beyond the goal, from the x of its rear axle [m].
    fn beyond(&self, rear: f64) -> f64 {
        rear - self.goal - self.rear_radius
    }

    /// [m] Distance to the goal; below 0 beyond it.
    pub(crate) fn to_goal(&self, now: &Reading) -> f64 {
        let [rear, _] = self.axles;
        -self.beyond((now.position + turned_by(now.chassis_angle)(rear)).x)
    }

    /// Follows the ground inside the track.
    fn look_inside(&mut self, now: &Reading, running: &Running) {
        let pose = Pose::new(now.position, now.chassis_angle);
        let lanes = &self.ground.lanes;
        let inside = self.envelopes.iter().flat_map(|envelope| {
            let (profile, pose) = (&lanes[envelope.lane], running.mounted(envelope.mount, pose));
            if envelope.holds_edge(profile, pose) {
                envelope.intrusions(profile, pose)
            } else {
                Vec::new()
            }
        });
        let loads: Vec<Contact> = self.observed.loads.drain().collect();
        let with_force = inside.filter(|i| i.edge >= 0).map(|i| {
            let bears = |l: &&Contact| i.bears(lanes, &self.parts, l);
            let force = loads.iter().filter(bears).map(|l| l.normal_force).sum();
            (i, force)
        });
        self.observed.intrusions.look(now.time, with_force);
    }

    /// Compares the progress with that one stop window ago.
    fn look(&mut self, now: &Reading, command: f64, window: f64) {
        let least = self.criteria.stop_progress;
        let observed = &mut self.observed;
        let freed = observed
            .progress
            .look(now.time, command != 0.0, (window, LOOK.value()), least);
        if let Some(start) = freed {
            let inside = observed.intrusions.most_loaded();
            let stop = Event::stop(start, now.time, inside);
            observed.progress.stops.push(stop);
        }
        if !observed.progress.falters() {
            observed.signals = Signals::default();
        }
    }

    /// [s] Time without progress that counts as a stop.
    pub(crate) fn window(&self, command: f64) -> f64 {
        let pitches = self.criteria.stop_pitches * self.grouser_pitch / command.abs();
        if pitches.is_finite() {
            self.criteria.stop_window.max(pitches)
        } else {
            self.criteria.stop_window
        }
    }

    /// If neither pose nor contacts change, and nothing else can, the run may end.
    fn watch_stationary(&mut self, now: &Reading, window: f64, loaded: &[Contact]) {
        let here = Anchor {
            since: now.time,
            x: now.position.x,
            y: now.position.y,
            angle: now.chassis_angle,
            bearing: signature(loaded),
        };
        let tolerance = self.criteria.stationary_distance;
        let observed = &mut self.observed;
        let anchor = *observed.anchor.get_or_insert(here);
        let moved = (here.x - anchor.x).abs().max((here.y - anchor.y).abs());
        let turned = (here.angle - anchor.angle).abs() * self.half_length;
        if moved > tolerance || turned > tolerance || here.bearing != anchor.bearing {
            observed.anchor = Some(here);
            return;
        }
        let still = now.time - anchor.since;
        let enough = f64::from(self.criteria.stationary_windows) * window;
        observed.stays |= observed.progress.stop_since.is_some() && still >= enough;
    }

    /// Whether the outcome is certain.
    pub(crate) fn is_over(&self) -> bool {
        self.observed.ended.is_some() || self.observed.stays
    }

    /// The outcome of a run that did not end in a stop or by time.
    pub(crate) fn ended_as(&self) -> Option<Outcome> {
        self.observed.ended
    }

    /// +1 or -1 as commanded in the last step; 0 in a pause, and while braking from the other direction.
    pub(crate) fn direction(&self) -> f64 {
        self.observed.progress.direction
    }

    /// [s] When the robot stopped, if it is stopped.
    pub(crate) fn stop_since(&self) -> Option<f64> {
        self.observed.progress.stop_since
    }

    /// Share of the commanded distance covered in the last stop window; 1 before the first window in a direction is over.
    pub(crate) fn progress(&self) -> f64 {
        self.observed.progress.share
    }

    /// [m] Farthest position in the commanded direction.
    pub(crate) fn best_advance(&self) -> f64 {
        self.observed.progress.best_advance()
    }

    /// Means over the last one to two stop windows.
    pub(crate) fn stance(&self) -> Stance {
        self.observed.signals.stance()
    }

    /// Stops and intrusions so far, ordered by their beginning; those still going on end at `now`.
    pub(crate) fn events(&self, now: f64) -> Vec<Event> {
        let Observations {
            progress,
            intrusions,
            ..
        } = &self.observed;
        let inside = intrusions.most_loaded();
        let open = progress
            .stop_since
            .map(|start| Event::stop(start, now, inside));
        let stops = progress.stops.iter().cloned().chain(open);
        let mut events: Vec<Event> = stops.chain(intrusions.events(now)).collect();
        events.sort_by(|a, b| a.start.total_cmp(&b.start));
        events
    }

    /// [s] Duration of the longest stop from which the robot freed itself, 0 if there was none.
    pub(crate) fn time_to_free(&self) -> f64 {
        self.observed.progress.time_to_free
    }

    /// The most loaded intrusion into the track.
    pub(crate) fn intrusion(&self) -> Option<&Event> {
        self.observed.intrusions.most_loaded()
    }

    pub(crate) fn envelopes(&self) -> &[TrackEnvelope] {
        &self.envelopes
    }
}

/// The signature of the loaded contacts; their order does not matter.
pub(super) fn signature(loaded: &[Contact]) -> u64 {
    let bearing = loaded.iter().filter(|l| l.normal_force > 0.0);
    sum_mixed(bearing.map(|l| {
        // The side of a vertex on which an edge was found does not matter either.
        let place = if l.edge >= 0 {
            l.edge as u64 + (1 << 32)
        } else {
            l.facet as u64
        };
        (l.part as u64, place)
    }))
}

/// Part and place are hashed before they are summed: otherwise two parts could swap places unnoticed.
fn sum_mixed(bearing: impl Iterator<Item = (u64, u64)>) -> u64 {
    let mixed = bearing.map(|(part, place)| mix(mix(part) ^ place));
    mixed.fold(0, u64::wrapping_add)
}

/// Spreads each bit over all of them (the finaliser of splitmix64).
fn mix(bits: u64) -> u64 {
    let z = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod bearing_tests {
    use std::collections::HashSet;

    use super::*;
    use crate::contact::Contact;
    use crate::geometry::Vector;

    /// Parts that bear on facets, each with this force [N].
    fn on_facets(bearing: &[(usize, usize)], force: f64) -> Vec<Contact> {
        let loaded = |(part, facet): &(usize, usize)| Contact {
            normal_force: force,
            ..Contact::new(*part, (*facet, -1), (Vector::ZERO, Vector::Y), 0.0)
        };
        bearing.iter().map(loaded).collect()
    }

    fn of(bearing: &[(usize, usize)]) -> u64 {
        signature(&on_facets(bearing, 1.0))
    }

    #[test]
    fn wheels_that_swap_their_facets_are_seen() {
        assert_ne!(of(&[(0, 5), (1, 6)]), of(&[(0, 6), (1, 5)]));
        assert_ne!(of(&[(0, 1), (1, 0)]), of(&[(0, 0), (1, 1)]));
    }

    #[test]
    fn parts_256_apart_are_told_from_each_other() {
        assert_ne!(of(&[(1, 4)]), of(&[(257, 4)]));
        assert_ne!(of(&[(256, 4)]), of(&[(0, 5)]));
    }

    #[test]
    fn edges_are_told_from_facets_but_not_by_the_facet_they_were_found_on() {
        let on_edge = |facet| {
            let mut loaded = on_facets(&[(3, facet)], 1.0);
            loaded[0].edge = 7;
            signature(&loaded)
        };
        assert_eq!(on_edge(6), on_edge(7));
        assert_ne!(on_edge(7), of(&[(3, 7)]));
    }

    #[test]
    fn neither_order_nor_what_bears_nothing_matters() {
        let two = [(0, 5), (1, 6)];
        assert_eq!(of(&two), of(&[(1, 6), (0, 5)]));
        let mut loaded = on_facets(&two, 1.0);
        loaded.extend(on_facets(&[(2, 7)], 0.0));
        assert_eq!(signature(&loaded), of(&two));
    }

    #[test]
    fn no_two_pairs_of_parts_and_facets_are_taken_for_each_other() {
        let parts = (0..400).flat_map(|part| (0..200).map(move |facet| (part, facet)));
        let observed: HashSet<u64> = parts.map(|bears| of(&[bears])).collect();
        assert_eq!(observed.len(), 400 * 200);
    }
}
