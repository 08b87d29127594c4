//! Commands of the robot: by the schedule, by a driver who watches the flippers, or by hand; and a push.

use serde::{Deserialize, Serialize};

use crate::dynamics::FlipperCommand;
use crate::run::step_length::SAME_TIME;
use crate::scenario::{Climb, Drive, Drivetrain, Gait, Hold};
use crate::units::Seconds;

/// [s] A driver who climbs looks at intervals, so that what it decides does not depend on the length of steps.
const LOOK: Seconds = Seconds(0.01);
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
    /// [rad] Chassis angle, nose up > 0.
    pub chassis_angle: f64,
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
    /// [s] When it looks again, and what the front and the rear flippers have touched since it last did.
    next_look: f64,
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
            && (0.0..=time + LOOK.value()).contains(&self.next_look)
            && self.by_hand.iter().all(known)
            && since.is_none_or(f64::is_finite)
    }

    /// [s] When it looks next, if it looks at all.
    pub(crate) fn next_look(&self) -> f64 {
        self.next_look
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
        for (touched, touches) in self.touched.iter_mut().zip(sight.touches) {
            *touched |= touches;
        }
        if sight.time > self.next_look - SAME_TIME.value() {
            self.look(climb, sight);
            self.next_look = sight.time + LOOK.value();
            self.touched = [false; 2];
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

    /// Chooses the phase of a climb. A contact that opens for an instant, as rigid ones do, is no loss of contact.
    fn look(&mut self, climb: &Climb, sight: DriverView) {
        let [front, rear] = self.touched;
        let raised = sight.chassis_angle > climb.level_angle;
        let is_nose_down = sight.chassis_angle < -climb.level_angle;
        self.nose_down_since = (self.nose_down_since.or(Some(sight.time))).filter(|_| is_nose_down);
        let since = self.nose_down_since.unwrap_or(f64::INFINITY);
        let is_on_its_nose = sight.time - since > ON_ITS_NOSE.value();
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
mod drive_tests {
    use super::*;
    use crate::scenario::TorqueSharing;

    const LIMITS: Drivetrain = Drivetrain {
        max_speed: 1.0,
        max_acceleration: 0.2,
        max_deceleration: 4.0,
        max_torque: 6.0,
        torque_sharing: TorqueSharing::Track,
        rotor_inertia: 0.0,
        no_load_speed: None,
        torque_curve: None,
        controller: None,
        self_locking: false,
    };

    #[test]
    fn speeds_up_slowly_and_brakes_fast() {
        assert!((set_point(0.1, 0.4, &LIMITS, 0.1) - 0.12).abs() < 1e-15);
        assert!((set_point(0.4, 0.0, &LIMITS, 0.05) - 0.2).abs() < 1e-15);
        assert!((set_point(-0.1, -0.4, &LIMITS, 0.1) + 0.12).abs() < 1e-15);
    }

    #[test]
    fn a_ramp_lasts_until_the_command_or_a_stand() {
        assert!((ramp_time(0.1, 0.4, &LIMITS) - 1.5).abs() < 1e-12);
        assert!((ramp_time(0.1, -0.4, &LIMITS) - 0.025).abs() < 1e-12);
        assert!(ramp_time(0.4, 0.4, &LIMITS).is_infinite());
    }

    #[test]
    fn reversing_brakes_to_a_stand_first() {
        assert!((set_point(0.1, -0.4, &LIMITS, 0.1) - 0.0).abs() < 1e-15);
        assert!((set_point(0.0, -0.4, &LIMITS, 0.1) + 0.02).abs() < 1e-15);
    }

    #[test]
    #[allow(clippy::float_cmp)] // a stand is exact
    fn no_rounding_is_left_of_a_speed_that_is_reversed() {
        for k in 1..1000 {
            let (now, time) = (1e-3 * f64::from(k), 0.37 * f64::from(k));
            // A step ends at an instant, so that its length is rounded.
            let dt = time + ramp_time(now, -0.4, &LIMITS) - time;
            assert_eq!(set_point(now, -0.4, &LIMITS, dt), 0.0, "from {now} m/s");
        }
    }

    #[test]
    fn reaches_the_command_and_stays() {
        assert!((set_point(0.399, 0.4, &LIMITS, 0.1) - 0.4).abs() < 1e-15);
    }
}

#[cfg(test)]
mod driver_tests {
    use super::*;

    const CLIMB: Climb = Climb {
        reach_angle: 0.7,
        sweep_angle: -0.2,
        push_angle: -0.5,
        level_angle: 0.1,
    };

    /// Commands of a driver in this situation for front and rear arms, which start at 0.3 rad.
    fn after(views: &[(f64, [bool; 2])]) -> [FlipperCommand; 2] {
        let mut driver = Driver::default();
        let drive = Drive {
            gait: Some(Gait::Climb(CLIMB)),
            speed: 0.4,
            schedule: None,
        };
        let mut commands = [FlipperCommand::default(); 2];
        for (time, (chassis_angle, touches)) in (0_u32..).zip(views) {
            let sight = DriverView {
                time: f64::from(time),
                chassis_angle: *chassis_angle,
                touches: *touches,
            };
            commands = driver.flippers(&drive, 0.3, sight);
        }
        commands
    }

    #[test]
    fn front_arms_reach_until_they_touch_and_then_press_down() {
        let (nothing, front) = ([false; 2], [true, false]);
        let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
        assert_eq!(after(&[(0.0, nothing)]), reach);
        let sweep = [
            FlipperCommand::Level(-0.2 - 0.05),
            FlipperCommand::Angle(0.3),
        ];
        assert_eq!(after(&[(0.0, nothing), (0.05, front)]), sweep);
        assert_eq!(after(&[(0.0, front), (0.05, front)]), sweep);
        assert_eq!(after(&[(0.05, front), (0.0, nothing)]), reach);
    }

    #[test]
    fn rear_arms_push_a_raised_chassis_until_it_is_level_and_they_bear_nothing() {
        let (nothing, rear) = ([false; 2], [false, true]);
        let push = |angle: f64| {
            [
                FlipperCommand::Level(-0.2 - angle),
                FlipperCommand::Level(-0.5 + angle),
            ]
        };
        assert_eq!(after(&[(0.2, nothing)]), push(0.2));
        assert_eq!(after(&[(0.2, rear), (0.05, rear)]), push(0.05));
        let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
        assert_eq!(after(&[(0.2, rear), (0.05, nothing)]), reach);
    }

    /// Contacts open for an instant where bodies rock on them, the more often the finer the steps are.
    #[test]
    fn what_arms_have_touched_since_the_last_look_counts() {
        let drive = Drive {
            gait: Some(Gait::Climb(CLIMB)),
            speed: 0.4,
            schedule: None,
        };
        let mut driver = Driver::default();
        let mut front_at = |time: f64, touches: bool| {
            let sight = DriverView {
                time,
                chassis_angle: 0.0,
                touches: [touches, false],
            };
            driver.flippers(&drive, 0.3, sight)[0]
        };
        let (reach, sweep) = (FlipperCommand::Angle(0.7), FlipperCommand::Level(-0.2));
        for (time, touches, command) in [
            (0.0, true, sweep),
            (0.004, true, sweep),
            (0.006, false, sweep),
            (0.01, false, sweep),
            (0.015, false, sweep),
            (0.02, false, reach),
            (0.024, true, reach),
            (0.028, false, reach),
            (0.03, false, sweep),
        ] {
            assert_eq!(front_at(time, touches), command, "{time} s");
        }
    }

    /// On level ground they would keep its tail raised for ever. The times are whole seconds.
    #[test]
    fn rear_arms_that_have_stood_a_robot_on_its_nose_for_a_while_let_it_down() {
        let rear = [false, true];
        let [raised, down, level] = [0.2, -0.3, -0.05].map(|angle| (angle, rear));
        let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
        assert_eq!(after(&[raised, down, down, down]), reach);
        assert_ne!(after(&[raised, down]), reach);
        assert_ne!(after(&[raised, down, down, level, down]), reach);
    }
}

#[cfg(test)]
mod push_tests {
    #![allow(clippy::float_cmp)] // halves of whole numbers

    use super::*;

    #[test]
    fn a_push_rises_evenly_and_stays() {
        let push = Push::default().raised(8.0, 1.0, 2.0);
        assert_eq!(
            [1.0, 1.5, 3.0, 9.0].map(|time| push.at(time)),
            [0.0, 2.0, 8.0, 8.0]
        );
        let more = push.raised(16.0, 2.0, 1.0);
        assert_eq!([2.0, 2.5, 3.0].map(|time| more.at(time)), [4.0, 10.0, 16.0]);
    }

    #[test]
    fn only_a_push_that_can_be_commanded_is_taken_from_a_snapshot() {
        let fits = |from: f64, to: f64, since: f64, rise: f64| {
            let push = Push {
                from,
                to,
                since,
                rise,
            };
            push.fits()
        };
        assert!(Push::default().fits() && fits(1e15, -1e15, -3.0, 1e9));
        for force in [1.1e15, -1.1e15, f64::INFINITY, f64::NAN] {
            assert!(!fits(force, 0.0, 0.0, 0.0) && !fits(0.0, force, 0.0, 0.0));
            assert!(!Push::may_be(force));
        }
        assert!(!fits(0.0, 0.0, f64::NAN, 0.0) && !fits(0.0, 0.0, f64::INFINITY, 0.0));
        for rise in [-1e-9, f64::INFINITY, f64::NAN] {
            assert!(!fits(0.0, 0.0, 0.0, rise), "{rise} s");
        }
    }

    #[test]
    fn a_push_without_a_rise_is_there_at_once() {
        let push = Push::default().raised(5.0, 1.0, 0.0);
        assert_eq!([0.5, 1.0].map(|time| push.at(time)), [0.0, 5.0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(speeds: &[[f64; 2]], angles: &[[f64; 2]]) -> Drive {
        Drive {
            speed: 0.1,
            schedule: Some(speeds.to_vec()),
            gait: Some(Gait::Hold(Hold {
                angle: 0.5,
                schedule: Some(angles.to_vec()),
                front: None,
                rear: None,
            })),
        }
    }

    /// Entries at exactly this time are due from then on, and so are not followed.
    #[test]
    fn a_driver_who_ignores_schedules_keeps_the_angle_before() {
        let drive = drive(&[[1.0, 0.2], [9.0, 0.3]], &[[1.0, 0.6], [2.0, 0.7]]);
        for (now, past) in [(0.5, 0), (1.0, 0), (1.5, 1), (2.0, 1), (2.5, 2)] {
            let mut driver = Driver::default();
            driver.ignore_schedules(&drive, now);
            assert_eq!(driver.angles, Some(past), "{now} s");
            assert_eq!(driver.speed(&drive, 10.0), None, "{now} s");
        }
    }

    #[test]
    fn a_driver_with_another_gait_goes_on_with_the_speeds_that_are_past() {
        let before = drive(&[[1.0, 0.2], [9.0, 0.3]], &[]);
        let mut driver = Driver::default();
        assert_eq!(driver.speed(&before, 2.0), Some(0.2));
        let gait = drive(&[[1.0, 0.2], [9.0, 0.3]], &[[1.0, 0.6]]);
        assert_eq!(driver.commanded(&before, &gait).speed(&gait, 3.0), None);
        assert_eq!(
            driver.commanded(&before, &gait).speed(&gait, 9.0),
            Some(0.3)
        );
        // Other speeds start from the beginning.
        let speeds = drive(&[[1.0, 0.4]], &[]);
        assert_eq!(
            driver.commanded(&before, &speeds).speed(&speeds, 3.0),
            Some(0.4)
        );
    }

    #[test]
    fn arms_are_held_at_the_last_angle_that_is_due() {
        let Some(Gait::Hold(hold)) = drive(&[], &[[1.0, 0.6], [2.0, 0.7]]).gait else {
            panic!("they are held");
        };
        for (time, most, angle) in [
            (0.9, None, 0.5),
            (1.0, None, 0.6),
            (1.9, None, 0.6),
            (5.0, None, 0.7),
            (5.0, Some(1), 0.6),
            (5.0, Some(0), 0.5),
            (0.9, Some(2), 0.5),
        ] {
            let found = hold.angle_at(time, most);
            assert_eq!(found.to_bits(), f64::to_bits(angle), "{time} s {most:?}");
        }
    }

    #[test]
    fn only_what_commands_lead_to_is_taken_from_a_snapshot() {
        let drive = drive(&[[1.0, 0.2], [9.0, 0.3]], &[]);
        let fits = |change: fn(&mut Driver)| {
            let mut driver = Driver::default();
            change(&mut driver);
            driver.fits(&drive, 1.0)
        };
        assert!(fits(|_| {}) && fits(|d| d.entries = 2) && fits(|d| d.nose_down_since = Some(0.3)));
        assert!(!fits(|d| d.entries = 3));
        assert!(!fits(|d| d.nose_down_since = Some(f64::NAN)));
        assert!(fits(|d| d.next_look = 1.01));
        for next_look in [1.02, -0.01, f64::NAN] {
            let driver = Driver {
                next_look,
                ..Driver::default()
            };
            assert!(!driver.fits(&drive, 1.0), "{next_look} s");
        }
        assert!(fits(|d| d.take(1, FlipperCommand::Angle(0.3))));
        for end in [0, 1] {
            let mut driver = Driver::default();
            driver.take(end, FlipperCommand::Angle(f64::INFINITY));
            assert!(!driver.fits(&drive, 1.0), "{end}");
        }
    }
}
