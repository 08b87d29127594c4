//! Energy, and the bodies that have it.

use super::*;

/// Half of the stiffness times the square of the travel, minus the pre-tension times the travel, for both tracks.
#[test]
fn a_tensioner_gives_its_pre_tension_and_takes_its_stiffness() {
    let mut scenario = shared("engineer_chain_step");
    let Track::Segmental(chain) = &mut scenario.robot.track else {
        panic!("it is a chain")
    };
    chain.pre_tension = Some(100.0);
    chain.tensioner_stiffness = Some(50_000.0);
    let mut simulation = started(&scenario);
    let energy = |simulation: &mut Simulation, travel: f64| {
        simulation.state.idlers[0].travel = travel;
        simulation.energy()
    };
    let before = energy(&mut simulation, 0.0);
    for (travel, stored) in [(1e-3, -0.15), (-1e-3, 0.25)] {
        let gained = energy(&mut simulation, travel) - before;
        // Rounding of an energy of some joules.
        assert!((gained - stored).abs() < 1e-12, "{gained} J");
    }
}

/// With its arms at an angle of 0, at which the scenario has its mass and moment of inertia.
#[test]
fn bodies_of_a_simulation_add_up_to_the_robot() {
    let names = ["engineer_sprocket_step", "engineer_flippers_step"];
    for name in names {
        let mut scenario = shared(name);
        if let Some(flippers) = &mut scenario.robot.flippers {
            flippers.angle = 0.0;
        }
        let robot = scenario.robot.clone();
        let simulation = started(&scenario);
        let center = simulation.center_of_mass() - simulation.reading().position;
        assert!((center - Vector::from(robot.center_of_mass)).length() < 1e-12);
        let share = simulation.moment_of_inertia() / robot.moment_of_inertia;
        assert!((share - 1.0).abs() < 1e-12, "{share}");
        assert!((simulation.weight() / robot.mass - 9.81).abs() < 1e-12);
        assert!((simulation.half_length() - 0.1825).abs() < 1e-15);
    }
}

/// Pins of both tracks with 2 x 4 N m/rad: a shoe of a straight run that turns by 0.01 rad bends two of them.
#[test]
fn a_bent_pin_stores_half_of_its_stiffness_times_the_square_of_its_angle() {
    let mut scenario = shared("engineer_chain_step");
    if let Track::Segmental(chain) = &mut scenario.robot.track {
        chain.pin_stiffness = 4.0;
    }
    let mut simulation = started(&scenario);
    let before = simulation.energy();
    let is_straight = |pair: &[Shoe]| pair[0].bend(&pair[1]).abs() < 1e-9;
    let mut runs = simulation.state.shoes.windows(3);
    let straight = runs.position(|run| run.windows(2).all(is_straight));
    let middle = straight.expect("it has a straight run") + 1;
    simulation.state.shoes[middle].angle += 0.01;
    let gained = simulation.energy() - before;
    assert!((gained - 8e-4).abs() < 1e-10, "{gained} J");
}

/// 21.2 kg of the robot move, its track and two rotors turn; the rotors turn over the chassis.
#[test]
fn energy_is_that_of_motion_of_turning_parts_and_of_height() {
    let mut scenario = engineer();
    scenario.robot.drivetrain.rotor_inertia = 0.02;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let gained = |change: fn(&mut State)| {
        let mut simulation = Simulation::new(&checked);
        let before = simulation.energy();
        change(&mut simulation.state);
        simulation.energy() - before
    };
    let robot = &scenario.robot;
    let model = checked.model();
    let (track, rotors) = (model.drive_inertia(0), model.rotor_inertia(0));
    assert!(track > 1e-3 && rotors > 1e-3);
    let mass = robot.mass;
    let chassis = robot.moment_of_inertia - track;
    for (found, expected) in [
        (gained(|s| s.velocity = Vector::new(3.0, 4.0)), 12.5 * mass),
        (gained(|s| s.center.y += 2.0), 2.0 * 9.81 * mass),
        (gained(|s| s.drives[0].spin = 3.0), 4.5 * (track + rotors)),
        (
            gained(|s| s.angular_velocity = 2.0),
            2.0 * (chassis + rotors),
        ),
        // All of it turns, except the rotors.
        (
            gained(|s| (s.angular_velocity, s.drives[0].spin) = (2.0, 2.0)),
            2.0 * robot.moment_of_inertia,
        ),
    ] {
        // Rounding of some hundreds of joules.
        assert!((found - expected).abs() < 1e-11, "{found} J, {expected} J");
    }
}
