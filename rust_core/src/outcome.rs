//! Watches a run: goal, tip-over, stops. It only reads, and ends a run when its outcome is certain.

use std::collections::VecDeque;
use std::fmt;

use rapier2d_f64::math::Pose;

use crate::contact::{LoadedContact, TrackEnvelope};
use crate::events::{Event, IntrusionWatch};
use crate::reading::Reading;
use crate::robot::{Model, Shape};
use crate::scenario::{Scenario, SeizureCriteria};
use crate::shaking::Shaking;
use crate::terrain::{Ground, Profile};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The chassis turned past its balance point.
    TippedOver,
    /// An end axle left the terrain.
    LeftTerrain,
    /// The goal lies behind the robot.
    Cleared,
    /// No progress at the end, though commanded.
    Stopped,
    /// The time ran out on the way.
    TimedOut,
}

impl Outcome {
    /// Name as in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::TippedOver => "tipped_over",
            Self::LeftTerrain => "left_terrain",
            Self::Cleared => "cleared",
            Self::Stopped => "stopped",
            Self::TimedOut => "timed_out",
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// [s] Time between two looks at the progress; far below any stop window.
const LOOK: f64 = 0.01;

/// Watches one run.
pub(crate) struct Monitor {
    criteria: SeizureCriteria,
    profile: Profile,
    goal: f64,
    /// [m] A metre below the whole ground.
    floor: f64,
    half_length: f64,
    rear_radius: f64,
    grouser_pitch: f64,
    looks: u64,
    history: VecDeque<Look>,
    best_advance: f64,
    best_angle: f64,
    commanded: f64,
    last_time: f64,
    stop_since: Option<f64>,
    stops: Vec<Event>,
    envelope: TrackEnvelope,
    intrusions: IntrusionWatch,
    /// A turning grouser changes what is there although the pose does not.
    has_grousers: bool,
    anchor: Option<Anchor>,
    goal_since: Option<f64>,
    certain: Option<Outcome>,
    /// [s] When the goal was first held, if it was.
    pub time_to_clear: f64,
    /// [m] Deepest penetration so far.
    pub max_penetration: f64,
    /// [rad] Largest chassis angle so far.
    pub max_angle: f64,
    /// [rad] Smallest chassis angle so far.
    pub min_angle: f64,
    /// [J] Work of the motors so far.
    pub drive_work: f64,
    /// [m] How far the chassis frame has moved along its own axis so far.
    pub path_length: f64,
    /// How much the chassis shook so far.
    pub shaking: Shaking,
}

/// Progress at one instant.
#[derive(Clone, Copy)]
struct Look {
    advance: f64,
    angle: f64,
    commanded: f64,
}

/// A pose that the robot has not left since.
#[derive(Clone, Copy)]
struct Anchor {
    since: f64,
    x: f64,
    y: f64,
    angle: f64,
    contacts: u64,
}

impl Monitor {
    pub(crate) fn new(scenario: &Scenario, ground: &Ground, model: &Model) -> Self {
        let outline = &scenario.robot.outline;
        Self {
            criteria: scenario.criteria.clone(),
            profile: ground.profile.clone(),
            goal: ground.goal_of(scenario),
            floor: ground.profile.lowest() - 1.0,
            half_length: 0.5 * outline.axle_distance,
            rear_radius: outline.rear_radius,
            grouser_pitch: outline.grouser_pitch,
            looks: 0,
            history: VecDeque::new(),
            best_advance: f64::NEG_INFINITY,
            best_angle: f64::NEG_INFINITY,
            commanded: 0.0,
            last_time: 0.0,
            stop_since: None,
            stops: Vec::new(),
            envelope: TrackEnvelope::new(&model.parts, scenario.criteria.intrusion_depth),
            intrusions: IntrusionWatch::default(),
            has_grousers: model
                .parts
                .iter()
                .any(|part| matches!(part.shape, Shape::Gear { .. })),
            anchor: None,
            goal_since: None,
            certain: None,
            time_to_clear: f64::INFINITY,
            max_penetration: 0.0,
            max_angle: f64::NEG_INFINITY,
            min_angle: f64::INFINITY,
            drive_work: 0.0,
            path_length: 0.0,
            shaking: Shaking::default(),
        }
    }

    /// Takes in one step.
    pub(crate) fn observe(
        &mut self,
        now: &Reading,
        command: f64,
        loaded: &[LoadedContact],
        work_rate: f64,
    ) {
        let dt = now.time - self.last_time;
        self.last_time = now.time;
        self.drive_work += work_rate * dt;
        self.path_length += now.forward_speed() * dt;
        self.max_angle = self.max_angle.max(now.chassis_angle);
        self.min_angle = self.min_angle.min(now.chassis_angle);
        for l in loaded {
            self.max_penetration = self.max_penetration.max(-l.contact.distance);
        }
        let direction = if command < 0.0 { -1.0 } else { 1.0 };
        self.best_advance = self.best_advance.max(direction * now.position.x);
        self.best_angle = self.best_angle.max(direction * now.chassis_angle);
        self.commanded += now.commanded_speed.abs() * dt;
        if self.certain.is_none() {
            self.certain = self.ended(now);
        }
        if now.time >= self.looks as f64 * LOOK {
            self.looks += 1;
            self.shaking.look(now);
            self.look_inside(now, loaded);
            self.look(now, command, loaded);
        }
    }

    /// Ends that need no window.
    fn ended(&mut self, now: &Reading) -> Option<Outcome> {
        if now.chassis_angle.abs() > self.criteria.tip_over_angle {
            return Some(Outcome::TippedOver);
        }
        let (sine, cosine) = libm::sincos(now.chassis_angle);
        let rear = now.position.x - cosine * self.half_length;
        let front = now.position.x + cosine * self.half_length;
        let lower_axle = now.position.y - (sine * self.half_length).abs();
        let (low, high) = self.profile.extent();
        if rear.min(front) < low || rear.max(front) > high || lower_axle < self.floor {
            return Some(Outcome::LeftTerrain);
        }
        let level = (now.chassis_angle - self.profile.angle_at(now.position.x)).abs()
            < self.criteria.clear_angle;
        if rear > self.goal + self.rear_radius && level {
            let since = *self.goal_since.get_or_insert(now.time);
            if now.time - since >= self.criteria.clear_time {
                self.time_to_clear = since;
                return Some(Outcome::Cleared);
            }
        } else {
            self.goal_since = None;
        }
        None
    }

    /// Follows what is inside the track.
    fn look_inside(&mut self, now: &Reading, loaded: &[LoadedContact]) {
        let pose = Pose::new(now.position, now.chassis_angle);
        let profile = &self.profile;
        let inside = if self.envelope.holds_edge(profile, pose) {
            self.envelope.intrusions(profile, pose)
        } else {
            Vec::new()
        };
        let with_force = inside.into_iter().filter(|i| i.edge >= 0).map(|i| {
            let force = i.force(profile, loaded);
            (i, force)
        });
        self.intrusions.look(now.time, with_force);
    }

    /// Compares the progress with that of one window ago.
    fn look(&mut self, now: &Reading, command: f64, loaded: &[LoadedContact]) {
        let angle = self.best_angle * 2.0 * self.half_length;
        self.history.push_back(Look {
            advance: self.best_advance,
            angle,
            commanded: self.commanded,
        });
        let window = self.window(command);
        let span = (window / LOOK).ceil() as usize;
        while self.history.len() > span + 1 {
            self.history.pop_front();
        }
        let then = self.history[0];
        let commanded = self.commanded - then.commanded;
        let progress = (self.best_advance - then.advance).max(angle - then.angle);
        let stopped = command != 0.0
            && self.history.len() == span + 1
            && progress < self.criteria.stop_progress * commanded;
        match (stopped, self.stop_since) {
            (true, None) => self.stop_since = Some(now.time - window),
            (false, Some(start)) => {
                let inside = self.intrusions.most_loaded();
                self.stops.push(Event::stop(start, now.time, inside));
                self.stop_since = None;
            }
            _ => {}
        }
        if !self.has_grousers {
            self.watch_stationary(now, window, loaded);
        }
    }

    /// [s] Time without progress that is a stop.
    fn window(&self, command: f64) -> f64 {
        let pitches = self.criteria.stop_pitches * self.grouser_pitch / command.abs();
        if pitches.is_finite() {
            self.criteria.stop_window.max(pitches)
        } else {
            self.criteria.stop_window
        }
    }

    /// A state that does not change at all will not change later: the run may end.
    fn watch_stationary(&mut self, now: &Reading, window: f64, loaded: &[LoadedContact]) {
        let contacts = loaded
            .iter()
            .filter(|l| l.normal_force > 0.0)
            .fold(0_u64, |sum, l| {
                // Order does not matter, and neither does on which side of a vertex an edge was found.
                let place = if l.contact.edge >= 0 {
                    l.contact.edge as u64 + (1 << 32)
                } else {
                    l.contact.facet as u64
                };
                sum.wrapping_add(
                    (place << 8 | l.contact.part as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15),
                )
            });
        let here = Anchor {
            since: now.time,
            x: now.position.x,
            y: now.position.y,
            angle: now.chassis_angle,
            contacts,
        };
        let tolerance = self.criteria.stationary_distance;
        let anchor = *self.anchor.get_or_insert(here);
        let moved = (here.x - anchor.x).abs().max((here.y - anchor.y).abs());
        let turned = (here.angle - anchor.angle).abs() * self.half_length;
        if moved > tolerance || turned > tolerance || here.contacts != anchor.contacts {
            self.anchor = Some(here);
            return;
        }
        let still = now.time - anchor.since;
        let enough = f64::from(self.criteria.stationary_windows) * window;
        if self.certain.is_none() && self.stop_since.is_some() && still >= enough {
            self.certain = Some(Outcome::Stopped);
        }
    }

    /// The outcome, as soon as it is certain.
    pub(crate) fn certain(&self) -> Option<Outcome> {
        self.certain
    }

    /// The outcome if the run ended now.
    pub(crate) fn now(&self) -> Outcome {
        self.certain.unwrap_or(if self.stop_since.is_some() {
            Outcome::Stopped
        } else {
            Outcome::TimedOut
        })
    }

    /// Stops and intrusions so far, in order of their beginning; those that last end at `now`.
    pub(crate) fn events(&self, now: f64) -> Vec<Event> {
        let inside = self.intrusions.most_loaded();
        let open = self.stop_since.map(|start| Event::stop(start, now, inside));
        let stops = self.stops.iter().cloned().chain(open);
        let mut events: Vec<Event> = stops.chain(self.intrusions.events(now)).collect();
        events.sort_by(|a, b| a.start.total_cmp(&b.start));
        events
    }

    /// The most loaded of what is inside the track.
    pub(crate) fn intrusion(&self) -> Option<&Event> {
        self.intrusions.most_loaded()
    }

    pub(crate) fn envelope(&self) -> &TrackEnvelope {
        &self.envelope
    }
}
