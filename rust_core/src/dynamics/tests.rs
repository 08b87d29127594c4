//! Motion without ground, and on contacts that no terrain could produce.

use approx::assert_relative_eq;

use super::*;
use crate::draw::{Draw, cases};
use crate::geometry::{Vector, direction};
use crate::scenario::{Friction, Scenario, Track, shared};
use crate::solver::Row;
use crate::terrain::GroundFriction;

pub(super) fn engineer() -> Scenario {
    shared("engineer_belt_step")
}

pub(super) fn setup(change: impl Fn(&mut Scenario)) -> (Dynamics, State) {
    let mut scenario = engineer();
    // Steps here are of a given length.
    scenario.solver.accuracy = None;
    change(&mut scenario);
    let model = Model::new(&scenario.robot).expect("the robot can be built");
    let state = State::at_rest(&model, Vector::new(0.0, 1.0), 0.0, 0.0);
    (
        Dynamics::new(
            model,
            vec![GroundFriction::everywhere(Friction::dry(0.5))],
            scenario.gravity,
            scenario.solver,
        ),
        state,
    )
}

/// A robot that whirls through the air with all that moves on it.
pub(super) fn whirling(name: &str) -> (Dynamics, State) {
    let scenario = shared(name);
    let model = Model::new(&scenario.robot).expect("the robot can be built");
    let mut state = State::at_rest(&model, Vector::new(0.3, 1.0), 0.2, 0.0);
    state.velocity = Vector::new(0.4, -0.3);
    state.angular_velocity = 1.3;
    for drive in &mut state.drives {
        drive.spin = -4.0;
    }
    for (flipper, rate) in state.flippers.iter_mut().zip([2.1, -1.7]) {
        flipper.rate = rate;
    }
    (
        Dynamics::new(model, Vec::new(), 0.0, scenario.solver),
        state,
    )
}

/// [s] Length of the steps here.
pub(super) const STEP: f64 = 1e-3;
/// [m] How far anything may move in one.
const TRAVEL: f64 = 5e-3;

impl Dynamics {
    /// Takes one step of `h` [s] with these contacts.
    pub(super) fn take(&mut self, state: &mut State, contacts: &[Contact], set_point: f64, h: f64) {
        let mut contacts = contacts.to_vec();
        self.recognise(&mut contacts, 0.0);
        self.prepare(state, &contacts, (h, TRAVEL));
        self.advance(state, SetPoint::constant(set_point), (h, false))
            .expect("no step is cut without an accuracy");
        self.keep(&contacts, h, false);
    }
}

fn advance(
    dynamics: &mut Dynamics,
    state: &mut State,
    steps: u64,
    set_point: f64,
    contacts: &[Contact],
) {
    for _ in 0..steps {
        dynamics.take(state, contacts, set_point, STEP);
    }
}

#[test]
fn free_fall_is_half_g_t_squared() {
    let (mut dynamics, mut state) = setup(|_| {});
    let start = state.center.y;
    advance(&mut dynamics, &mut state, 1000, 0.0, &[]);
    // Half of the weight's impulse comes before the motion of a step and half after: exact but for rounding.
    assert_relative_eq!(start - state.center.y, 0.5 * 9.81, max_relative = 1e-12);
    assert_relative_eq!(state.velocity.y, -9.81, max_relative = 1e-12);
}

#[test]
fn drive_in_the_air_spins_up_by_its_force_and_turns_the_chassis_back() {
    let (mut dynamics, mut state) = setup(|s| s.gravity = 0.0);
    advance(&mut dynamics, &mut state, 10, 100.0, &[]);
    let m = dynamics.model();
    let (force, radius) = (2.0 * 6.0 / 0.052, m.drive_radius);
    let expected = force * 0.01 * (1.0 / m.drive_masses[0] + radius * radius / m.moment_of_inertia);
    assert_relative_eq!(state.track_speed(m, 0), expected, max_relative = 1e-4);
    assert_relative_eq!(state.drives[0].force, force, max_relative = 1e-9);
    // There is no external moment: the chassis turns against the drive.
    let of_drive = m.drive_masses[0] * radius * radius * state.drives[0].spin;
    assert_relative_eq!(
        m.moment_of_inertia * state.angular_velocity,
        -of_drive,
        max_relative = 1e-9
    );
    assert!(state.velocity.length() < 1e-12);
}

#[test]
fn a_step_ends_when_a_drive_in_the_air_has_its_speed_back() {
    let (mut dynamics, mut state) = setup(|s| {
        s.gravity = 0.0;
        s.solver.accuracy = Some(3e-7);
    });
    let m = dynamics.model();
    let (force, radius) = (2.0 * 6.0 / 0.052, m.drive_radius);
    let lag = 0.05;
    state.drives[0].spin = lag / radius;
    let gain = force * (1.0 / m.drive_masses[0] + radius * radius / m.moment_of_inertia);
    let expected = lag / gain;
    // It is at its limit in the middle of the shorter step, and has long been at its speed in that of the longer one.
    for h in [1.3 * expected, 5.0 * expected] {
        dynamics.prepare(&state, &[], (h, TRAVEL));
        let advanced = dynamics.advance(&mut state.clone(), SetPoint::constant(0.0), (h, false));
        let time = advanced.expect_err("the force jumps");
        assert_relative_eq!(time, expected, max_relative = 1e-9);
    }
    dynamics.prepare(&state, &[], (expected, TRAVEL));
    let advanced = dynamics.advance(&mut state, SetPoint::constant(0.0), (expected, false));
    assert_eq!(advanced, Ok(()));
    assert_relative_eq!(state.track_speed(dynamics.model(), 0), 0.0, epsilon = 1e-9);
}

#[test]
fn a_step_ends_when_a_robot_that_slides_comes_to_rest() {
    let (mut dynamics, mut state) = setup(|s| {
        s.robot.drivetrain.max_torque = 1e3;
        s.robot.center_of_mass = [0.0, 0.0];
        s.solver.accuracy = Some(3e-7);
    });
    state.velocity.x = 0.05;
    let at = |x: f64| {
        let point = state.center + Vector::new(x, -0.064);
        Contact::new(0, (0, -1), (point, Vector::Y), 0.0)
    };
    let mut contacts = [-0.18, 0.18].map(at);
    // The contacts slide until friction, of 0.5, has braked it.
    let expected = 0.05 / (0.5 * 9.81);
    let h = 1.3 * expected;
    dynamics.recognise(&mut contacts, 0.0);
    dynamics.prepare(&state, &contacts, (h, TRAVEL));
    let advanced = dynamics.advance(&mut state, SetPoint::constant(0.0), (h, false));
    let time = advanced.expect_err("friction jumps");
    // Contacts bear a little less than the weight while they give way.
    assert_relative_eq!(time, expected, max_relative = 1e-3);
}

#[test]
fn the_traction_of_a_tooth_is_what_slows_its_drive() {
    let (mut dynamics, mut state) = setup(|s| {
        *s = shared("engineer_gear3_step");
        s.solver.accuracy = None;
        s.robot.drivetrain.max_torque = 0.0;
        s.robot.drivetrain.rotor_inertia = 0.0;
    });
    state.velocity = Vector::new(0.1, -0.3);
    state.drives[0].spin = -6.0;
    // Neither normal nor tangent leads past the axle.
    let point = state.center + Vector::new(0.03, -0.05);
    let contact = Contact::new(0, (0, -1), (point, direction(1.8)), 0.0);
    let before = state.drives[0].spin;
    dynamics.take(&mut state, &[contact], 0.0, STEP);
    let m = dynamics.model();
    let drive = state.drives[0];
    assert_relative_eq!(
        m.drive_inertia(0) * (drive.spin - before),
        drive.traction * m.drive_radius * STEP,
        max_relative = 1e-9
    );
    assert!(drive.traction.abs() > 10.0);
}

#[test]
fn a_soft_contact_closes_its_gap_or_pushes_out_of_the_ground() {
    let (h, most) = (2e-3, 0.5);
    let soft = Softness::new(1000.0, 5.0, h);
    for (gap, bias) in [
        (1e-4, 1e-4 / h),
        (0.0, 0.0),
        (-1e-4, -1e-4 * soft.push_rate),
        (-0.1, -most),
    ] {
        let touch = Touch {
            gap,
            ..Touch::default()
        };
        let [mut softly, mut solved] = [crate::solver::Contact::new([Row::default(); 2]); 2];
        touch.close_softly(&mut softly, (h, h), soft, most);
        touch.close(&mut solved, (h, 0.5 * h), soft, most);
        assert_relative_eq!(softly.bias, bias);
        assert_relative_eq!(solved.bias, bias);
        // Shoes press the ground on springs of 0.3 of the compliance.
        let compliance = soft.compliance;
        assert_relative_eq!(softly.compliance, 0.3 * compliance);
        assert_relative_eq!(solved.compliance, 2.0 * compliance);
    }
}

#[test]
fn rotor_in_the_air_resists_only_what_turns_over_the_chassis() {
    let rotor = 0.05;
    let (mut dynamics, mut state) = setup(|s| {
        s.gravity = 0.0;
        s.robot.drivetrain.rotor_inertia = rotor;
    });
    advance(&mut dynamics, &mut state, 10, 100.0, &[]);
    let m = dynamics.model();
    let (drive, chassis, radius) = (m.drive_inertia(0), m.moment_of_inertia, m.drive_radius);
    let torque = 2.0 * 6.0 / 0.052 * radius;
    // Drive and chassis turn against each other, and the rotor with their difference.
    let reduced = drive * chassis / (drive + chassis);
    let seen = 2.0 * rotor * (radius / 0.052).powi(2);
    let expected = torque / (reduced + seen) * 0.01 * radius;
    assert_relative_eq!(state.track_speed(m, 0), expected, max_relative = 1e-9);
    assert_relative_eq!(
        chassis * state.angular_velocity,
        -drive * state.drives[0].spin,
        max_relative = 1e-9
    );
    assert_relative_eq!(state.drives[0].force * radius, torque, max_relative = 1e-9);
}

/// A belt clamped between a floor and a ceiling that follow the robot.
fn clamped(state: &State) -> [Contact; 2] {
    let at = |y: f64, up: f64| {
        let point = state.center + Vector::new(0.0, y);
        Contact::new(0, (0, -1), (point, Vector::new(0.0, up)), -3e-7)
    };
    [at(-0.064, 1.0), at(0.064, -1.0)]
}

#[test]
fn force_limit_acts_on_the_signed_sum_of_the_tractions() {
    // A belt without torque slides between floor and ceiling, which drag it in opposite directions.
    let (mut dynamics, mut state) = setup(|s| {
        s.robot.drivetrain.max_torque = 0.0;
        s.robot.center_of_mass = [0.0, 0.0];
        s.gravity = 0.0;
    });
    state.velocity.x = 1.0;
    let mass = dynamics.model().mass;
    for step in 0..20 {
        let before = state.velocity.x;
        let contacts = clamped(&state);
        advance(&mut dynamics, &mut state, 1, 0.0, &contacts);
        let load: f64 = dynamics.loaded().iter().map(|l| l.normal_force).sum();
        let net: f64 = dynamics.loaded().iter().map(|l| l.friction_force).sum();
        let gross: f64 = dynamics
            .loaded()
            .iter()
            .map(|l| l.friction_force.abs())
            .sum();
        if step > 0 {
            assert!(load > 50.0);
            assert_relative_eq!(gross, 0.5 * load, max_relative = 5e-3);
            assert!(net.abs() < 5e-3 * gross, "net {net}, gross {gross}");
            assert_relative_eq!(
                (before - state.velocity.x) / 1e-3,
                gross / mass,
                max_relative = 5e-3
            );
        }
    }
    let speed = state.track_speed(dynamics.model(), 0);
    assert!(
        speed.abs() < 5e-3,
        "the belt stays where it is, not {speed} m/s"
    );
}

/// Kinetic energy [J] of the chassis and the drives.
fn energy(m: &Model, state: &State) -> f64 {
    let spins = state.drives.iter().enumerate();
    let of_drives = spins.map(|(k, d)| {
        let over_chassis = d.spin - state.angular_velocity;
        m.drive_inertia(k) * d.spin * d.spin + m.rotor_inertia(k) * over_chassis * over_chassis
    });
    0.5 * (m.mass * state.velocity.length_squared()
        + m.moment_of_inertia * state.angular_velocity * state.angular_velocity
        + of_drives.sum::<f64>())
}

/// Random contacts from all sides: they hold, slide, part or jam.
#[test]
fn contacts_from_all_sides_take_energy_within_coulombs_law() {
    let cases = cases(4_000, 20_000) as u32;
    for seed in [1, 8] {
        let mut drawn = Draw(seed);
        let mut draw = |low, high| drawn.between(low, high);
        for iterations in [1, 8] {
            let (mut jams, mut unresolved) = (0, 0);
            for case in 0..cases {
                let (mut dynamics, mut state) = setup(|s| {
                    s.robot.drivetrain.max_torque = 0.0;
                    s.robot.drivetrain.rotor_inertia = if case % 2 == 0 { 0.0 } else { 0.05 };
                    s.gravity = 0.0;
                    s.solver.iterations = Some(iterations);
                });
                state.velocity = Vector::new(draw(-1.0, 1.0), draw(-1.0, 1.0));
                state.angular_velocity = draw(-3.0, 3.0);
                state.drives[0].spin = draw(-3.0, 3.0);
                let count = draw(1.0, 9.0) as usize;
                let mut contact = || {
                    let (place, normal) = (draw(0.0, 6.3), draw(0.0, 6.3));
                    let point = state.center + 0.2 * direction(place);
                    Contact::new(0, (0, -1), (point, direction(normal)), 0.0)
                };
                let mut contacts: Vec<Contact> = (0..count).map(|_| contact()).collect();
                contacts.sort_by(|a, b| a.point.x.total_cmp(&b.point.x));
                let before = energy(dynamics.model(), &state);
                advance(&mut dynamics, &mut state, 1, 0.0, &contacts);
                unresolved += dynamics.effort().unresolved;
                let left = energy(dynamics.model(), &state) / before;
                jams += u32::from(left < 1e-6);
                assert!(left < 1.0 + 1e-9, "case {case}: {left} of the energy");
                for l in dynamics.loaded() {
                    let most = 0.5 * l.normal_force;
                    assert!(l.normal_force >= 0.0 && l.friction_force.abs() <= most * (1.0 + 1e-9));
                }
            }
            // Rounding leaves some of the jams open.
            assert!(
                iterations == 1 || unresolved <= 4,
                "{unresolved} of {cases}"
            );
            assert!(jams > cases / 10, "{jams} of {cases} jam");
        }
    }
}

#[test]
fn force_alone_drives_the_chassis_in_the_air() {
    let (mut dynamics, mut state) = setup(|s| {
        s.gravity = 0.0;
        s.robot.center_of_mass = [0.0, 0.0];
        s.robot.track = Track::Force(crate::scenario::ForceTrack {
            support: crate::scenario::ForceSupport::Skids,
            skid_friction: 0.0,
            wheel_count: 5,
        });
    });
    advance(&mut dynamics, &mut state, 10, 100.0, &[]);
    let m = dynamics.model();
    let expected = 0.01 * m.motor.force / (m.mass + m.drive_masses[0]);
    // The motor's reaction turns the chassis back a little, which adds a quarter of a per cent.
    assert_relative_eq!(state.velocity.x, expected, max_relative = 5e-3);
    assert_relative_eq!(
        state.track_speed(m, 0),
        state.velocity.x,
        max_relative = 0.05
    );
}

#[test]
fn a_state_that_is_no_number_is_seen_after_a_step_on_contacts_too() {
    for value in [f64::NAN, f64::INFINITY] {
        for has_contacts in [false, true] {
            let (mut dynamics, mut state) = setup(|_| {});
            let clamped = clamped(&state);
            let contacts = if has_contacts { &clamped[..] } else { &[] };
            state.velocity.x = value;
            dynamics.take(&mut state, contacts, 0.0, STEP);
            assert!(!state.is_finite());
        }
    }
}

#[test]
fn nothing_moves_faster_than_light() {
    let (_, mut state) = setup(|_| {});
    for (speed, is_slower) in [(2e8, true), (-2e8, true), (4e8, false), (-1e60, false)] {
        state.velocity.y = speed;
        assert_eq!(state.is_finite(), is_slower);
    }
}

#[test]
fn a_push_acts_along_the_axis_of_the_chassis_beside_the_reaction_of_its_motor() {
    let (dynamics, _) = setup(|s| s.robot.center_of_mass = [0.05, 0.02]);
    let model = dynamics.model();
    let push = push_axis(model, 0.3);
    assert_relative_eq!(push.unit, direction(0.3), epsilon = 1e-15);
    assert_relative_eq!(push.lever + push.spin_lever, 0.02, epsilon = 1e-15);
    assert_relative_eq!(push.spin_lever, model.drive_radius);
}

#[test]
fn a_controller_pushes_by_the_sum_of_its_errors_from_the_beginning_of_a_step() {
    let (gain, integral) = (2.0, 30.0);
    let (mut dynamics, mut state) = setup(|s| {
        s.gravity = 0.0;
        s.robot.drivetrain.controller = Some(crate::scenario::Pi { gain, integral });
    });
    // Nothing is wrong now, and errors have added up to 50 N.
    state.drives[0].integral = 50.0;
    dynamics.take(&mut state, &[], 0.0, 1e-5);
    assert_relative_eq!(state.drives[0].force, 50.0, max_relative = 1e-2);
}

#[test]
fn a_point_of_a_body_moves_as_it_does_in_a_short_time() {
    const TIME: f64 = 1e-7;
    let (dynamics, mut state) = setup(|_| {});
    (state.velocity, state.angular_velocity) = (Vector::new(0.4, -0.3), 1.3);
    let on_chassis = Vector::new(0.2, 0.05);
    let at = |time| {
        state
            .pose_after(time, &dynamics.model)
            .transform_point(on_chassis)
    };
    let moved = (at(TIME) - at(-TIME)) / (2.0 * TIME);
    // Differences of 1e-7 m lose nine digits of sixteen.
    assert_relative_eq!(state.velocity_at(at(0.0)), moved, max_relative = 1e-7);
}
