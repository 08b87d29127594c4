//! How a driver moves the flippers: by a schedule, or by watching the robot.

use serde::{Deserialize, Serialize};

use crate::scenario::{Climb, Drive, Gait, Hold};

/// What a driver knows about the robot: its pose, and whether flippers bear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// [s] Time.
    pub time: f64,
    /// [rad] Chassis angle, nose up > 0.
    pub chassis_angle: f64,
    /// Whether the front and the rear flippers bear on something beyond their roots.
    pub touches: [bool; 2],
}

/// Where a driver wants the flippers at one end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Target {
    /// [rad] Angle relative to the chassis, upwards > 0.
    pub angle: f64,
    /// Whether they turn against the chassis as fast as it turns, to keep their angle to the ground; otherwise they
    /// would lag behind.
    pub keeps_level: bool,
}

impl Target {
    fn fixed(angle: f64) -> Self {
        Self {
            angle,
            keeps_level: false,
        }
    }
}

/// What a driver remembers.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Driver {
    /// Number of past entries of the schedule of speeds.
    entries: usize,
    phase: Phase,
    /// [rad] Angles given by hand that override the gait, front and rear.
    by_hand: [Option<f64>; 2],
}

/// Phases of a climb.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// The front flippers reach up and forward.
    #[default]
    Reach,
    /// They have touched something and sweep down on it.
    Sweep,
    /// The chassis is raised: the rear flippers lift it from behind.
    Lift,
}

impl Driver {
    /// [m/s] The next speed of the schedule, if it is due.
    pub(crate) fn speed(&mut self, drive: &Drive, time: f64) -> Option<f64> {
        let entries = drive.schedule.as_deref().unwrap_or_default();
        let past = entries.partition_point(|[from, _]| *from <= time);
        let speed = (past > self.entries).then(|| entries[past - 1][1]);
        self.entries = past;
        speed
    }

    /// The same driver with another command; what the commands have in common goes on.
    pub(crate) fn commanded(self, before: &Drive, now: &Drive) -> Self {
        let speeds = if has_the_same_speeds(before, now) {
            self
        } else {
            Self::default()
        };
        let angles = if before.gait == now.gait {
            self
        } else {
            Self::default()
        };
        Self {
            entries: speeds.entries,
            ..angles
        }
    }

    /// Whether commands can have led to this state.
    pub(crate) fn fits(&self, drive: &Drive) -> bool {
        let entries = drive.schedule.as_ref().map_or(0, Vec::len);
        let known = |angle: &Option<f64>| angle.is_none_or(f64::is_finite);
        self.entries <= entries && self.by_hand.iter().all(known)
    }

    /// Overrides the gait at one end.
    pub(crate) fn hold(&mut self, end: usize, angle: f64) {
        self.by_hand[end] = Some(angle);
    }

    /// Where it wants the front and rear flippers; `start` is their angle at time 0 [rad].
    pub(crate) fn targets(&mut self, drive: &Drive, start: f64, sight: Sight) -> [Target; 2] {
        let of_gait = match &drive.gait {
            None => [Target::fixed(start); 2],
            Some(Gait::Hold(hold)) => [Target::fixed(hold.angle_at(sight.time)); 2],
            Some(Gait::Climb(climb)) => self.climb(climb, start, sight),
        };
        std::array::from_fn(|end| self.by_hand[end].map_or(of_gait[end], Target::fixed))
    }

    /// Where the flippers are to be during a climb.
    fn climb(&mut self, climb: &Climb, start: f64, sight: Sight) -> [Target; 2] {
        let [front, rear] = sight.touches;
        let raised = sight.chassis_angle > climb.level_angle;
        self.phase = match self.phase {
            Phase::Reach | Phase::Sweep if raised => Phase::Lift,
            Phase::Reach if front => Phase::Sweep,
            Phase::Sweep if !front => Phase::Reach,
            // Raising rear flippers that bear would drop the robot.
            Phase::Lift if !raised && !rear => Phase::Reach,
            same => same,
        };
        let level = |angle| Target {
            angle,
            keeps_level: true,
        };
        let swept = level(climb.sweep_angle - sight.chassis_angle);
        let pushed = level(climb.push_angle + sight.chassis_angle);
        let (reach, start) = (Target::fixed(climb.reach_angle), Target::fixed(start));
        match self.phase {
            Phase::Reach => [reach, start],
            Phase::Sweep => [swept, start],
            Phase::Lift => [swept, pushed],
        }
    }
}

/// Whether two commands differ in what the flippers do at most.
pub(crate) fn has_the_same_speeds(one: &Drive, other: &Drive) -> bool {
    let level = |drive: &Drive| Drive {
        gait: None,
        ..drive.clone()
    };
    level(one) == level(other)
}

impl Hold {
    fn angle_at(&self, time: f64) -> f64 {
        let entries = self.schedule.as_deref().unwrap_or_default();
        let past = entries.partition_point(|[from, _]| *from <= time);
        past.checked_sub(1)
            .map_or(self.angle, |last| entries[last][1])
    }
}
