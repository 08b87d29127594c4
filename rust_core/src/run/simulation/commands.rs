//! Commands of the robot: by the schedule, by a driver who watches the flippers, or by hand; and a push.

use serde::{Deserialize, Serialize};

use crate::dynamics::FlipperCommand;
use crate::run::step_length::SAME_TIME;
use crate::scenario::{Climb, Drive, Drivetrain, Gait, Hold};
use crate::units::Seconds;

/// [s] A driver who climbs looks at multiples of this time. Steps end at those looks that may change its commands, so that
/// these do not depend on the length of steps.
const LOOK: Seconds = Seconds(0.01);
/// [s] No step lasts as long: looks that are longer overdue are not made up for.
const LONGER_THAN_A_STEP: Seconds = Seconds(1.0);
/// [s] A climbing robot is past the edge once its nose has been down for longer, with its rear flippers on the ground.
const ON_ITS_NOSE: Seconds = Seconds(1.0);

/// The commands of the robot.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Commands {
    /// [m/s] Speed of the drives.
    pub speed: f64,
    pub driver: Driver,
    /// Commands of the front and rear flippers.
    pub flippers: [FlipperCommand; 2],
    /// The push at the centre of mass, along x.
    pub push: Push,
    /// Whether all commands have been the scenario's from time 0 on: no branch, no command by hand, no push.
    pub follow_scenario: bool,
}

impl Commands {
    /// The commands of a scenario at time 0.
    pub(super) fn of(drive: &Drive) -> Self {
        Self {
            speed: drive.speed,
            driver: Driver::default(),
            flippers: Default::default(),
            push: Push::default(),
            follow_scenario: true,
        }
    }
}

/// What a driver knows about the robot: its pose, and whether flippers bear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DriverView {
    /// [s] Time.
    pub time: f64,
    /// [rad], [rad/s] Chassis angle, nose up > 0, and its rate.
    pub chassis_angle: f64,
    pub chassis_rate: f64,
    /// Whether the front and the rear flippers bear on something beyond their roots.
    pub touches: [bool; 2],
}

/// What a driver remembers.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Driver {
    /// Number of past entries of the schedule of speeds.
    entries: usize,
    /// Number of entries of the schedule of angles that count, if later ones do not.
    angles: Option<usize>,
    phase: Phase,
    /// [s] When it looks again, if it has looked, and what the front and the rear flippers have touched since it last did.
    next_look: Option<f64>,
    touched: [bool; 2],
    /// [s] When the nose went below what counts as level, if it is below.
    nose_down_since: Option<f64>,
    /// Commands by hand that override the gait, front and rear.
    by_hand: [Option<FlipperCommand>; 2],
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
        self.entries = past.max(self.entries);
        speed
    }

    /// Continues with the speed and angles before a time [s], whatever the schedules have from then on.
    pub(crate) fn ignore_schedules(&mut self, drive: &Drive, now: f64) {
        self.entries = drive.schedule.as_ref().map_or(0, Vec::len);
        if let Some(Gait::Hold(hold)) = &drive.gait {
            let past = hold.entries().partition_point(|[from, _]| *from < now);
            self.angles.get_or_insert(past);
        }
    }

    /// The same driver with another command; common parts of both commands continue.
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

    /// Whether commands can have led to this state at a time [s].
    pub(crate) fn fits(&self, drive: &Drive, time: f64) -> bool {
        let entries = drive.schedule.as_ref().map_or(0, Vec::len);
        let known = |given: &Option<FlipperCommand>| given.is_none_or(|c| c.value().is_finite());
        let since = self.nose_down_since;
        self.entries <= entries
            && (self.next_look).is_none_or(|look| (0.0..=look_after(time)).contains(&look))
            && self.by_hand.iter().all(known)
            && since.is_none_or(f64::is_finite)
    }

    /// [s] The first of the next two looks that may change its commands, as far as can be seen now; infinite if neither
    /// does. Steps are shorter than two intervals, unless their length is given.
    pub(crate) fn next_change(&self, climb: &Climb, sight: DriverView) -> f64 {
        let Some(next) = self.next_look else {
            return f64::INFINITY;
        };
        let mut touched = self.touched;
        for time in [next, next + LOOK.value()] {
            let mut driver = Self { touched, ..*self };
            driver.see(sight.touches);
            let changes = |angle: f64| {
                let mut then = driver;
                then.look(climb, time, angle);
                then.phase != self.phase
                    || then.nose_down_since.is_some() != self.nose_down_since.is_some()
            };
            // Twice as far, as it may turn faster by then.
            let turned = sight.chassis_rate * (time - sight.time);
            let mut angles = [0.0, 1.0, 2.0]
                .into_iter()
                .map(|times| sight.chassis_angle + times * turned);
            if angles.any(changes) {
                return time;
            }
            touched = [false; 2];
        }
        f64::INFINITY
    }

    /// Overrides the gait at one end.
    pub(crate) fn take(&mut self, end: usize, command: FlipperCommand) {
        self.by_hand[end] = Some(command);
    }

    /// Its commands for the front and rear flippers; `start` is their angle at time 0 [rad].
    pub(crate) fn flippers(
        &mut self,
        drive: &Drive,
        start: f64,
        sight: DriverView,
    ) -> [FlipperCommand; 2] {
        let of_gait = match &drive.gait {
            None => [FlipperCommand::Angle(start); 2],
            Some(Gait::Hold(hold)) => {
                let angle = hold.angle_at(sight.time, self.angles);
                [hold.front, hold.rear].map(|end| FlipperCommand::Angle(end.unwrap_or(angle)))
            }
            Some(Gait::Climb(climb)) => self.climb(climb, start, sight),
        };
        std::array::from_fn(|end| self.by_hand[end].unwrap_or(of_gait[end]))
    }

    /// Commands of the flippers during a climb.
    fn climb(&mut self, climb: &Climb, start: f64, sight: DriverView) -> [FlipperCommand; 2] {
        self.see(sight.touches);
        let recent = |look: &f64| *look > sight.time - LONGER_THAN_A_STEP.value();
        let past = |look: &f64| *look <= sight.time + SAME_TIME.value();
        while let Some(time) = (self.next_look.filter(recent).or(Some(sight.time))).filter(past) {
            let turned = sight.chassis_rate * (time - sight.time);
            self.look(climb, time, sight.chassis_angle + turned);
            self.next_look = Some(look_after(time));
            self.touched = [false; 2];
            if time < sight.time - SAME_TIME.value() {
                self.see(sight.touches);
            }
        }
        let swept = FlipperCommand::Level(climb.sweep_angle - sight.chassis_angle);
        let pushed = FlipperCommand::Level(climb.push_angle + sight.chassis_angle);
        let [reach, start] = [climb.reach_angle, start].map(FlipperCommand::Angle);
        match self.phase {
            Phase::Reach => [reach, start],
            Phase::Sweep => [swept, start],
            Phase::Lift => [swept, pushed],
        }
    }

    /// Remembers which flippers touch something.
    fn see(&mut self, touches: [bool; 2]) {
        for (touched, touches) in self.touched.iter_mut().zip(touches) {
            *touched |= touches;
        }
    }

    /// Chooses the phase of a climb at a time [s] and an angle of the chassis [rad]. What opens and closes between two looks
    /// is no loss of contact.
    fn look(&mut self, climb: &Climb, time: f64, chassis_angle: f64) {
        let [front, rear] = self.touched;
        let raised = chassis_angle > climb.level_angle;
        let is_nose_down = chassis_angle < -climb.level_angle;
        self.nose_down_since = self.nose_down_since.or(Some(time)).filter(|_| is_nose_down);
        let since = self.nose_down_since.unwrap_or(f64::INFINITY);
        let is_on_its_nose = time - since > ON_ITS_NOSE.value();
        self.phase = match self.phase {
            Phase::Reach | Phase::Sweep if raised => Phase::Lift,
            Phase::Reach if front => Phase::Sweep,
            Phase::Sweep if !front => Phase::Reach,
            // Raising rear flippers that bear would drop the robot, unless they have put it on its nose.
            Phase::Lift if !raised && (!rear || is_on_its_nose) => Phase::Reach,
            same => same,
        };
    }
}

/// [s] The first look after a time [s].
fn look_after(time: f64) -> f64 {
    let next = (((time + SAME_TIME.value()) / LOOK.value()).floor() + 1.0) * LOOK.value();
    // After months of simulated time it may be rounded down to that time.
    if next > time {
        next
    } else {
        time + LOOK.value()
    }
}

/// Whether two commands differ at most in the flippers.
pub(crate) fn has_the_same_speeds(one: &Drive, other: &Drive) -> bool {
    let level = |drive: &Drive| Drive {
        gait: None,
        ..drive.clone()
    };
    level(one) == level(other)
}

impl Hold {
    fn entries(&self) -> &[[f64; 2]] {
        self.schedule.as_deref().unwrap_or_default()
    }

    /// [rad] The angle at a time [s], if only these entries count.
    fn angle_at(&self, time: f64, most: Option<usize>) -> f64 {
        let entries = self.entries();
        let past = entries.partition_point(|[from, _]| *from <= time);
        let past = past.min(most.unwrap_or(entries.len()));
        past.checked_sub(1)
            .map_or(self.angle, |last| entries[last][1])
    }
}

/// [m/s] The set-point after `dt` [s]; its magnitude rises and falls at the drivetrain's rates. A value that misses 0
/// by rounding becomes 0: otherwise it would take a whole step to reach 0.
pub(crate) fn set_point(now: f64, command: f64, limits: &Drivetrain, dt: f64) -> f64 {
    let (target, rate) = ramp(now, command, limits);
    let way = target - now;
    if way.abs() <= rate * (dt + SAME_TIME.value()) {
        target
    } else {
        now + (rate * dt).copysign(way)
    }
}

/// [s] Time for which the set-point changes at the same rate; infinite if it has reached its command.
pub(crate) fn ramp_time(now: f64, command: f64, limits: &Drivetrain) -> f64 {
    let (target, rate) = ramp(now, command, limits);
    let time = (target - now).abs() / rate;
    if time > SAME_TIME.value() {
        time
    } else {
        f64::INFINITY
    }
}

/// [m/s] Value that the set-point approaches, and [m/s^2] its rate.
fn ramp(now: f64, command: f64, limits: &Drivetrain) -> (f64, f64) {
    let slowing = now * command < 0.0 || command.abs() < now.abs();
    let target = if now * command < 0.0 { 0.0 } else { command };
    let rate = if slowing {
        limits.max_deceleration
    } else {
        limits.max_acceleration
    };
    (target, rate)
}

/// A horizontal force over time: it rises linearly from one value to another, and stays there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Push {
    /// [N] Force before it rises.
    from: f64,
    /// [N] Force once it has risen.
    to: f64,
    /// [s] Beginning and duration of the rise.
    since: f64,
    rise: f64,
}

impl Push {
    /// [N] Largest allowed force: the weight of the heaviest robot.
    const MOST: f64 = 1e15;

    /// A push that rises from its present value to a force [N].
    pub(super) fn raised(self, force: f64, now: f64, rise: f64) -> Self {
        Self {
            from: self.at(now),
            to: force,
            since: now,
            rise,
        }
    }

    /// [N] The force at a time [s].
    pub(super) fn at(self, time: f64) -> f64 {
        if time >= self.end() {
            self.to
        } else if time <= self.since {
            self.from
        } else {
            self.from + (self.to - self.from) * (time - self.since) / self.rise
        }
    }

    /// [s] When it has risen.
    pub(super) fn end(self) -> f64 {
        self.since + self.rise
    }

    /// Whether it can have been commanded.
    pub(super) fn fits(self) -> bool {
        let most = -Self::MOST..=Self::MOST;
        most.contains(&self.from)
            && most.contains(&self.to)
            && self.since.is_finite()
            && (0.0..f64::INFINITY).contains(&self.rise)
    }

    /// Whether a force [N] is allowed.
    pub(super) fn may_be(force: f64) -> bool {
        (-Self::MOST..=Self::MOST).contains(&force)
    }
}

#[cfg(test)]
mod tests;
