//! How high a slow, strong robot climbs, against plane quasi-statics.

use crate::common::*;
use crawler2d_core::{Outcome, Scenario, Surface, Terrain, TorqueSharing, TrackOutline};

/// Friction that holds a track on an edge up to 45 degrees and more. Far more friction would not be
/// ampler: from about 3 on the nose sticks to the face and the track stalls at any torque.
const AMPLE: f64 = 1.5;

/// [m] Height of a step that a rigid track just climbs: the robot lies on the edge with the rear
/// sprocket on the ground, and tips forwards over the edge if its centre of mass is beyond it.
///
/// The second figure is the chassis angle at which it lies in balance there.
pub(crate) fn highest_step(radius: f64, behind: f64, above: f64) -> (f64, f64) {
    let height = |angle: f64| {
        let (s, c) = libm::sincos(angle);
        radius * (1.0 - c) + behind * s - (radius + above) * s * s / c
    };
    // One maximum: golden-section search.
    let (mut low, mut high) = (0.0, 1.5);
    while high - low > 1e-9 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if height(a) < height(b) {
            low = a;
        } else {
            high = b;
        }
    }
    (height(low), low)
}

/// [m] The same by bisection over simulations.
fn highest_step_simulated(base: &Scenario, expected: f64) -> f64 {
    bisect(0.7 * expected, 1.3 * expected, |height| {
        let mut scenario = base.clone();
        scenario.terrain = step(height, AMPLE);
        summary(&scenario).outcome == Outcome::Cleared
    })
}

pub(crate) fn rigid_track(
    axle_distance: f64,
    radius: f64,
    behind_share: f64,
    above: f64,
) -> Scenario {
    let mut scenario = slow_and_strong();
    let outline = &mut scenario.robot.outline;
    outline.discs = TrackOutline::two_discs(axle_distance, [radius, radius]);
    outline.grouser_height = 0.0;
    scenario.robot.center_of_mass = [(behind_share - 0.5) * axle_distance, above];
    scenario.robot.moment_of_inertia = scenario.robot.mass * axle_distance * axle_distance / 8.0;
    scenario.robot.track_mass = 0.02 * scenario.robot.mass;
    scenario.robot.track = belt();
    scenario.terrain = step(0.05, AMPLE);
    scenario
}

#[test]
fn belt_climbs_as_high_as_a_rigid_track_can_on_the_engineer() {
    for (share, above) in [
        (0.5, 0.0),
        (0.5, 0.03),
        (0.5, 0.06),
        (0.4, 0.0),
        (0.6, 0.03),
    ] {
        let (expected, _) = highest_step(0.064, share * 0.365, above);
        let mut scenario = rigid_track(0.365, 0.064, share, above);
        // The closed form is the limit of no speed: momentum carries a robot over what it could not
        // climb, most where it turns far before it is on top.
        let mut off = [0.0; 2];
        for (off, speed) in off.iter_mut().zip([0.05, 0.02]) {
            scenario.drive.speed = speed;
            scenario.duration = 3.0 / speed;
            *off = highest_step_simulated(&scenario, expected) / expected - 1.0;
        }
        println!(
            "b/L {share} g {above}: closed form {expected:.5} m, {:+.2} % at 0.05 m/s, {:+.2} % at 0.02 m/s",
            100.0 * off[0],
            100.0 * off[1]
        );
        assert!(off[0].abs() < 0.02 && off[1].abs() < 0.01);
    }
}

#[test]
fn belt_climbs_as_high_as_a_rigid_track_can_on_drawn_geometries() {
    let seed = 20_261_121;
    println!("seed {seed}");
    let mut draw = Draw(seed);
    let mut cases = 0;
    while cases < few_or_many(5, 10) {
        let length = draw.between(0.25, 0.8);
        let radius = draw.between(0.1, 0.25) * length;
        let share = draw.between(0.4, 0.65);
        let above = draw.between(-0.1, 0.15) * length;
        let (expected, angle) = highest_step(radius, share * length, above);
        if angle > std::f64::consts::FRAC_PI_4 {
            continue; // steeper than its friction holds: slip decides there, not the balance
        }
        cases += 1;
        let mut scenario = rigid_track(length, radius, share, above);
        let fast = highest_step_simulated(&scenario, expected) / expected - 1.0;
        scenario.drive.speed = 0.02;
        scenario.duration = 100.0;
        let slow = highest_step_simulated(&scenario, expected) / expected - 1.0;
        println!(
            "L {length:.3} R {radius:.3} b/L {share:.3} g {above:+.3}: closed form {expected:.5} m, \
             {:+.2} % at 0.05 m/s, {:+.2} % at 0.02 m/s",
            100.0 * fast,
            100.0 * slow
        );
        assert!(fast.abs() < 0.02 && slow.abs() < 0.01);
    }
}

/// Friction from which on the nose of a track climbs a face at least as high as its radius.
pub(crate) fn friction_of_the_nose(length: f64, radius: f64, behind: f64) -> f64 {
    bisect(0.0, 10.0, |mu| {
        behind * (1.0 + mu * mu) > mu * mu * (length + radius) + mu * radius
    })
}

#[test]
fn nose_climbs_a_face_from_the_friction_of_the_balance_on() {
    for share in [0.4, 0.5, 0.6] {
        let expected = friction_of_the_nose(0.365, 0.064, share * 0.365);
        let found = bisect(0.8 * expected, 1.2 * expected, |mu| {
            let mut scenario = rigid_track(0.365, 0.064, share, 0.0);
            scenario.terrain = step(0.2, mu);
            // At 0.05 m/s the impact against the face alone lifts the nose at 1 % less friction.
            scenario.drive.speed = 0.01;
            scenario.duration = 40.0;
            summary(&scenario).metrics.max_angle < 0.1
        });
        println!(
            "b/L {share}: mu {found:.4}, closed form {expected:.4}, {:+.2} %",
            100.0 * (found / expected - 1.0)
        );
        assert!((found / expected - 1.0).abs() < 0.01);
    }
}

/// One driven wheel that carries the whole weight: the other is too far away to help.
pub(crate) fn single_wheel(height: f64, friction: f64) -> Scenario {
    let mut scenario = slow_and_strong();
    let radius = scenario.robot.outline.rear_radius();
    scenario.robot.outline.discs = TrackOutline::two_discs(20.0, [radius, radius]);
    scenario.robot.outline.grouser_height = 0.0;
    scenario.robot.center_of_mass = [10.0, 0.0];
    scenario.robot.moment_of_inertia = 100.0;
    scenario.robot.track_mass = 0.1;
    scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    scenario.robot.track = line(2);
    scenario.terrain = step(height, friction);
    // The barrier is so low that at 0.005 m/s momentum still carries the wheel 3 % higher, at 0.002 m/s 1 %.
    scenario.drive.speed = 0.002;
    scenario.start.approach = 0.0;
    scenario.duration = 40.0;
    scenario
}

pub(crate) fn climbs(scenario: &Scenario) -> bool {
    summary(scenario).metrics.final_y
        > scenario.robot.outline.rear_radius() + 0.45 * height_of(scenario)
}

fn height_of(scenario: &Scenario) -> f64 {
    match scenario.terrain {
        Terrain::Step { height, .. } => height,
        _ => unreachable!("the base is a step"),
    }
}

#[test]
fn single_wheel_climbs_as_high_as_its_friction_allows() {
    let radius: f64 = 0.064;
    for mu in [0.4, 0.7, 1.0_f64] {
        let expected = radius * (1.0 - 1.0 / (1.0 + mu * mu).sqrt());
        let found = bisect(0.8 * expected, 1.2 * expected, |height| {
            climbs(&single_wheel(height, mu))
        });
        println!(
            "mu {mu}: {found:.5} m, closed form {expected:.5} m, {:+.2} %",
            100.0 * (found / expected - 1.0)
        );
        assert!((found / expected - 1.0).abs() < 0.02); // the far wheel carries the motor's reaction and pushes a little
    }
}

#[test]
fn single_wheel_needs_the_torque_of_its_lever() {
    let radius: f64 = 0.064;
    for height in [0.01, 0.02, 0.03_f64] {
        let lever = (2.0 * radius * height - height * height).sqrt();
        let expected = 21.2 * G * lever;
        let found = bisect(0.8 * expected, 1.2 * expected, |torque| {
            let mut scenario = single_wheel(height, 3.0);
            scenario.robot.drivetrain.max_torque = torque;
            !climbs(&scenario)
        });
        println!(
            "h {height}: {found:.3} N m, closed form {expected:.3} N m, {:+.2} %",
            100.0 * (found / expected - 1.0)
        );
        assert!((found / expected - 1.0).abs() < 0.02);
    }
}

/// A robot before a gap of that width [m], a metre deep.
pub(crate) fn before_a_gap(base: &Scenario, width: f64) -> Scenario {
    let mut scenario = base.clone();
    let points = vec![
        [-10.0, 0.0],
        [0.0, 0.0],
        [0.0, -1.0],
        [width, -1.0],
        [width, 0.0],
        [10.0, 0.0],
    ];
    scenario.terrain = Terrain::Points {
        points,
        goal: width,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    scenario
}

#[test]
fn gap_is_bridged_up_to_the_shorter_end_of_the_track() {
    for share in [0.4, 0.5, 0.6_f64] {
        let shorter = share.min(1.0 - share) * 0.365;
        let base = rigid_track(0.365, 0.064, share, 0.0);
        let dips = |width: f64| {
            let run = summary(&before_a_gap(&base, width));
            run.metrics.min_angle < -0.01 || run.metrics.max_angle > 0.01
        };
        let found = bisect(0.5 * shorter, 2.0 * shorter, |width| !dips(width));
        println!("b/L {share}: {found:.4} m, shorter end {shorter:.4} m");
        // Up to about one radius more, because the arc reaches further when the nose has begun to dip.
        assert!(found > 0.995 * shorter && found < shorter + 0.064);
    }
}
