//! The nearest clear pose against a search on a grid.

mod restarts;

use super::*;
use crate::run::Checked;
use crate::scenario::{Scenario, Surface, Terrain};

/// A belt in front of a post whose top is at a height [m], moved onto it by `way` from its start.
fn on_a_post(height: f64, way: Way) -> Simulation {
    let text = include_str!("../../../../../tests/scenarios/engineer_belt_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    scenario.robot.belly = None;
    scenario.terrain = Terrain::Barrier {
        height,
        thickness: 0.01,
        surface: Surface::sharp(0.9),
    };
    let checked = Checked::new(&scenario).expect("the scenario is valid");
    let mut simulation = Simulation::new(&checked);
    let onto = -simulation.reading().position.x + way[0];
    simulation.displace([onto, way[1], way[2]]);
    simulation
}

/// [m] Deepest overlap after a displacement.
fn overlap(simulation: &mut Simulation, way: Way) -> f64 {
    let found = simulation.contacts_at(way);
    found
        .iter()
        .map(|contact| -contact.distance)
        .fold(0.0, f64::max)
}

#[test]
fn no_pose_of_a_grid_is_nearer_and_clear() {
    let poses = [
        (0.03, [0.0, 0.01, 0.0]),
        (0.05, [0.05, 0.03, 0.0]),
        (0.08, [-0.1, 0.05, 0.02]),
        (0.06, [0.17, 0.03, 0.03]),
        (0.05, [-0.2, 0.01, 0.0]),
    ];
    for (height, way) in poses {
        let mut buried = on_a_post(height, way);
        assert!(overlap(&mut buried, [0.0; 3]) > 5e-3, "{height} {way:?}");
        let before = buried.state.clone();
        let clear = on_a_post(height, way).clear_of_the_ground();
        let mut clear = clear.expect("there is one");
        assert!(overlap(&mut clear, [0.0; 3]) < INSIDE.value());
        let moved = clear.state.center - before.center;
        let turned = (clear.state.angle - before.angle) * clear.half_length();
        let found = length([moved.x, moved.y, turned]);
        // Every pose of a grid that is nearer by a step of the grid has ground inside.
        let n = 12_i32;
        let step = found / f64::from(n);
        let mut nearer = 0;
        for i in -n..=n {
            for j in -n..=n {
                for k in -n..=n {
                    let there = [i, j, k].map(|cells| step * f64::from(cells));
                    if length(there) < found - step {
                        nearer += 1;
                        let inside = overlap(&mut buried, there);
                        assert!(
                            inside > INSIDE.value(),
                            "{height} {way:?}: {there:?}, {found} m"
                        );
                    }
                }
            }
        }
        assert!(nearer > 1000);
    }
}

#[test]
fn a_robot_that_is_clear_stays_where_it_is_and_rests() {
    let text = include_str!("../../../../../tests/scenarios/engineer_belt_step.json");
    let scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let mut moving = Simulation::new(&Checked::new(&scenario).expect("the scenario is valid"));
    moving.advance(0.3).expect("the state stays finite");
    let (before, phase) = (moving.state.center, moving.reading().track_position);
    let clear = moving.clear_of_the_ground().expect("it is clear");
    let now = clear.reading();
    // Belts stand some micrometres in the ground.
    assert!((clear.state.center - before).length() < 2e-5);
    assert!(now.velocity.length() == 0.0 && now.track_speed == 0.0);
    assert!(now.track_position.to_bits() == phase.to_bits());
}
