//! How a driver moves the flippers: by the clock, or by what it sees of its own robot.

use serde::{Deserialize, Serialize};

use crate::scenario::{Climb, Drive, Gait, Hold};

/// What a driver knows of its robot: pose and touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// [s]
    pub time: f64,
    /// [rad] Nose up > 0.
    pub chassis_angle: f64,
    /// [rad] The same at the end of the step that is commanded, if it goes on turning as it does.
    pub angle_ahead: f64,
    /// The flippers at the front and at the rear bear on something beyond their roots.
    pub touches: [bool; 2],
}

/// What a driver remembers.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Driver {
    /// Entries of the schedule of speeds that are past.
    entries: usize,
    phase: Phase,
    /// [rad] Angles given by hand in place of the gait's, front and rear.
    by_hand: [Option<f64>; 2],
}

/// Phases of a climb.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// The front flippers reach up and forwards.
    #[default]
    Reach,
    /// They have met something and sweep down on it.
    Sweep,
    /// The chassis has risen: those at the rear lift it from behind.
    Lift,
}

impl Driver {
    /// [m/s] The next speed of the schedule, if its time has come.
    pub(crate) fn speed(&mut self, drive: &Drive, time: f64) -> Option<f64> {
        let entries = drive.schedule.as_deref().unwrap_or_default();
        let past = entries.partition_point(|[from, _]| *from <= time);
        let speed = (past > self.entries).then(|| entries[past - 1][1]);
        self.entries = past;
        speed
    }

    /// Whether commands can have brought it there.
    pub(crate) fn fits(&self, drive: &Drive) -> bool {
        let entries = drive.schedule.as_ref().map_or(0, Vec::len);
        let known = |angle: &Option<f64>| angle.is_none_or(f64::is_finite);
        self.entries <= entries && self.by_hand.iter().all(known)
    }

    /// Takes the flippers out of the gait's hands.
    pub(crate) fn hold(&mut self, end: usize, angle: f64) {
        self.by_hand[end] = Some(angle);
    }

    /// [rad] Where the flippers at the front and at the rear are to be, upwards > 0; `start` is where they
    /// were at time 0.
    pub(crate) fn angles(&mut self, drive: &Drive, start: f64, sight: Sight) -> [f64; 2] {
        let of_gait = match &drive.gait {
            None => [start; 2],
            Some(Gait::Hold(hold)) => [hold.angle_at(sight.time); 2],
            Some(Gait::Climb(climb)) => self.climb(climb, start, sight),
        };
        std::array::from_fn(|end| self.by_hand[end].unwrap_or(of_gait[end]))
    }

    /// [rad] Where a climb has the flippers.
    fn climb(&mut self, climb: &Climb, start: f64, sight: Sight) -> [f64; 2] {
        let [front, rear] = sight.touches;
        let raised = sight.chassis_angle > climb.level_angle;
        self.phase = match self.phase {
            Phase::Reach | Phase::Sweep if raised => Phase::Lift,
            Phase::Reach if front => Phase::Sweep,
            Phase::Sweep if !front => Phase::Reach,
            // What they stand on would drop the robot.
            Phase::Lift if !raised && !rear => Phase::Reach,
            same => same,
        };
        // Aimed at where the chassis was, arms would lag behind by what it turns in a step.
        let swept = climb.sweep_angle - sight.angle_ahead;
        let pushed = climb.push_angle + sight.angle_ahead;
        match self.phase {
            Phase::Reach => [climb.reach_angle, start],
            Phase::Sweep => [swept, start],
            Phase::Lift => [swept, pushed],
        }
    }
}

impl Hold {
    fn angle_at(&self, time: f64) -> f64 {
        let entries = self.schedule.as_deref().unwrap_or_default();
        let past = entries.partition_point(|[from, _]| *from <= time);
        past.checked_sub(1)
            .map_or(self.angle, |last| entries[last][1])
    }
}
