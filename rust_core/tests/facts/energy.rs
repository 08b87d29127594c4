//! Energy: what a robot has never exceeds what it started with and what its motors have given.

use crawler2d_core::{ChainMechanism, Scenario, SegmentalTrack, Simulation, Track};

use crate::basics::models;
use crate::common::*;
use crate::drawn::drawn;

/// [s] Wheels of a chain begin up to some hundredths of a pitch inside of their shoes, which are let out.
const LET_OUT: f64 = 0.2;

/// What the motors of a robot do.
struct Motors {
    /// Forces of the drives [N], then torques of the flippers [N m].
    efforts: Vec<f64>,
    /// Speeds [m/s] and rates [rad/s] of the same.
    speeds: Vec<f64>,
}

impl Motors {
    fn of(simulation: &Simulation) -> Self {
        let drives = (0..simulation.drives()).map(|k| simulation.drive_speed(k));
        Self {
            efforts: simulation
                .drive_forces()
                .chain(simulation.flipper_torques())
                .collect(),
            speeds: drives.chain(simulation.flipper_rates()).collect(),
        }
    }
}

/// The energy account of a run.
#[derive(Default)]
pub(crate) struct Account {
    /// [J] What the robot has gained beyond the work of its motors, at most.
    pub(crate) gained: f64,
    /// [J] What the motors have given and taken, ...
    pub(crate) moved: f64,
    /// [J] ... and the most that was kinetic.
    pub(crate) kinetic: f64,
}

/// Follows a run for a time [s]. The work of a step is that of its mean efforts at the mean of the speeds
/// before and after: of an impact that is all.
pub(crate) fn follow(scenario: &Scenario, duration: f64) -> Account {
    let mut simulation = Simulation::new(&checked(scenario));
    let on_wheels = matches!(
        scenario.robot.track,
        Track::Segmental(SegmentalTrack {
            mechanism: ChainMechanism::Sprocket,
            ..
        })
    );
    let opens = if on_wheels { LET_OUT } else { 0.0 };
    advance(&mut simulation, opens);
    let (start, mut work) = (simulation.energy(), 0.0);
    let mut account = Account::default();
    while simulation.time() < duration {
        let before = Motors::of(&simulation).speeds;
        simulation.step().expect("the state stays finite");
        let now = Motors::of(&simulation);
        for ((effort, a), b) in now.efforts.iter().zip(before).zip(now.speeds) {
            let done = 0.5 * effort * (a + b) * simulation.last_step();
            work += done;
            account.moved += done.abs();
        }
        let of_weight = scenario.robot.mass * scenario.gravity * simulation.center_of_mass().y;
        account.kinetic = account.kinetic.max(simulation.energy() - of_weight);
        account.gained = account.gained.max(simulation.energy() - start - work);
    }
    account
}

/// [J] What errors of energy are measured by: that of the weight over the length of the robot, on Earth, and
/// what goes round.
pub(crate) fn scale(scenario: &Scenario, account: &Account) -> f64 {
    scenario.robot.mass * G * scenario.robot.outline.axle_distance()
        + account.moved
        + account.kinetic
}

#[test]
fn unpowered_robots_never_gain_energy() {
    let mut draw = Draw(7);
    for (name, mut scenario) in models() {
        for _ in 0..few_or_many(1, 3) {
            scenario.robot.drivetrain.max_torque = 0.0;
            if let Some(flippers) = &mut scenario.robot.flippers {
                flippers.torque_limit = 0.0;
            }
            let angle = draw.between(-0.4, 0.4);
            scenario.terrain = slope(angle, draw.between(0.0, 1.2));
            scenario.start.angle = angle;
            let account = follow(&scenario, f64::from(few_or_many(1, 2)));
            assert!(
                account.gained <= 1e-3 * scale(&scenario, &account),
                "{name} gained {} J",
                account.gained
            );
        }
    }
}

/// With `CRAWLER2D_SOAK` two thousand robots of each of two seeds.
#[test]
fn drawn_robots_gain_no_more_than_their_motors_give() {
    for seed in [97, 1234] {
        drawn_robots_gain_no_more(seed, few_or_many(15, 2000));
    }
}

fn drawn_robots_gain_no_more(seed: u64, cases: u32) {
    let mut draw = Draw(seed);
    let (mut chains, mut grousers, mut arms, mut most) = (0, 0, 0, 0.0_f64);
    for case in 0..cases {
        let scenario = drawn(&mut draw);
        let account = follow(&scenario, scenario.duration);
        let share = account.gained / scale(&scenario, &account);
        chains += u32::from(is_on_chain(&scenario));
        grousers += u32::from(matches!(scenario.robot.track, Track::GrouserBelt(_)));
        arms += u32::from(scenario.robot.flippers.is_some());
        most = most.max(share);
        assert!(
            share < 1e-3,
            "seed {seed} case {case}: gained {} J, {share:.1e}\n{}",
            account.gained,
            scenario.to_json()
        );
    }
    println!(
        "seed {seed}: {cases} robots, {chains} on chains, {grousers} on belts with grousers, {arms} with arms; \
         gained {most:.1e} at most"
    );
}

/// Arms of the Engineer's form that lift it, slowly and fast, on ice and on rubber.
#[test]
fn arms_that_lift_a_robot_give_it_no_more_than_their_motors_do() {
    for (name, track) in [
        ("belt", belt()),
        ("chain", segmental(None)),
        ("force", force()),
    ] {
        for (rate_limit, friction) in [(1.0, 0.0), (1.0, 0.9), (4.0, 0.0), (4.0, 0.9)] {
            let mut scenario = on_arms(0.0, track.clone());
            flippers(&mut scenario).rate_limit = rate_limit;
            flippers(&mut scenario).torque_limit = 60.0;
            scenario.terrain = slope(0.0, friction);
            scenario.drive.speed = 0.0;
            scenario.drive.gait = Some(hold(-0.8));
            let account = follow(&scenario, 2.0);
            println!(
                "{name}, {rate_limit} rad/s, friction {friction}: {:.1e} J of {:.1} J",
                account.gained, account.moved
            );
            // A tenth of the robot's height in the work of the motors.
            assert!(account.moved > 6.0);
            assert!(account.gained < 1e-3 * account.moved, "{name}");
        }
    }
}
