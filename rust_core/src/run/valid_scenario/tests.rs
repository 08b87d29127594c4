//! The robot and ground that a checked scenario keeps, and which are rebuilt for another.

use super::*;
use crate::run::Simulation;
use crate::run::trials::tests::engineer;
use crate::scenario::{Surface, Terrain};

mod rules;
mod warnings;

fn varied<'a>(
    first: &ValidScenario,
    fields: &[(String, bool)],
    rows: impl IntoIterator<Item = &'a [f64]>,
) -> Vec<Result<ValidScenario, Error>> {
    let found = first.varied(fields, rows, &Cancel::default());
    found.expect("there is room")
}

fn opened(scenario: &Scenario, like: Option<&ValidScenario>) -> ValidScenario {
    ValidScenario::from_json_like(&scenario.to_json(), like).expect("it is valid")
}

#[test]
fn a_simulation_takes_over_what_was_built_to_check_it() {
    let checked = opened(&engineer(), None);
    let simulation = Simulation::new(&checked);
    assert!(std::ptr::eq(
        simulation.ground(),
        &raw const **checked.ground()
    ));
    assert_eq!(simulation.reading().position, checked.position);
}

#[test]
fn what_is_equal_in_another_scenario_is_not_built_again() {
    let first = opened(&engineer(), None);
    let mut variant = engineer();
    variant.start.approach = 0.2;
    let second = opened(&variant, Some(&first));
    assert!(Arc::ptr_eq(&first.ground, &second.ground));
    assert!(Arc::ptr_eq(&first.model, &second.model));
    assert!((first.position.x - second.position.x - 0.1).abs() < 1e-12);
}

#[test]
fn a_varied_scenario_is_the_one_that_is_read_with_these_numbers() {
    let first = opened(&engineer(), None);
    let field = |pointer: &str| (pointer.to_owned(), false);
    let fields = [field("/robot/center_of_mass/1"), field("/terrain/friction")];
    let rows: [&[f64]; 3] = [&[0.03, 0.7], &[0.02, f64::NAN], &[0.02, 0.9]];
    let found = varied(&first, &fields, rows);
    let mut variant = engineer();
    variant.robot.center_of_mass[1] = 0.03;
    if let Terrain::Step { surface, .. } = &mut variant.terrain {
        surface.friction.coefficient = 0.7;
    }
    let moved = found[0].as_ref().expect("it is valid");
    assert_eq!(moved.scenario, variant);
    assert_eq!(moved.position, opened(&variant, None).position);
    let refused = found[1].as_ref().expect_err("NaN is no friction");
    assert!(
        refused.to_string().contains("terrain.friction"),
        "{refused}"
    );
    let own = found[2].as_ref().expect("it is valid");
    assert_eq!(own.scenario.terrain, engineer().terrain);
}

#[test]
fn a_field_that_texts_leave_out_can_be_varied() {
    let first = opened(&engineer(), None);
    let pointer = "/robot/drivetrain/rotor_inertia".to_owned();
    let rows: [&[f64]; 2] = [&[0.02], &[0.0]];
    let found = varied(&first, &[(pointer, false)], rows);
    let inertias = found.into_iter().map(|each| {
        let varied = each.expect("it is valid");
        varied.scenario.robot.drivetrain.rotor_inertia
    });
    assert_eq!(inertias.collect::<Vec<_>>(), [0.02, 0.0]);
    for unknown in ["/robot/drivetrain/rotor", "/robot/rotors/inertia"] {
        let found = varied(&first, &[(unknown.to_owned(), false)], rows);
        let error = found[0].as_ref().expect_err("there is no such field");
        assert!(
            error.to_string().contains("must be a known field"),
            "{error}"
        );
    }
}

#[test]
fn what_differs_is_built_for_itself_and_as_it_would_be_alone() {
    let first = opened(&engineer(), None);
    let (mut heavier, mut apart) = (engineer(), engineer());
    heavier.robot.mass += 1.0;
    let flat = |height| Terrain::Step {
        height,
        surface: Surface::sharp(0.9),
    };
    apart.terrain = Terrain::Lanes {
        left: Box::new(flat(0.05)),
        right: Box::new(flat(0.1)),
        middle: None,
    };
    for variant in [heavier, apart] {
        let (alone, beside) = (opened(&variant, None), opened(&variant, Some(&first)));
        assert!(!Arc::ptr_eq(&first.model, &beside.model));
        assert_eq!(beside.position, alone.position);
        assert_eq!(beside.model.mass.to_bits(), alone.model.mass.to_bits());
        assert_eq!(beside.model.parts.len(), alone.model.parts.len());
        assert_eq!(beside.ground.lanes.len(), alone.ground.lanes.len());
    }
}

/// A step has two corners and two ends of the ground, and 300 bytes for each.
#[test]
fn a_varied_scenario_takes_room_for_a_ground_of_its_own_only() {
    let first = opened(&engineer(), None);
    let varied = |terrain: Terrain| {
        let mut variant = engineer();
        variant.start.approach = 0.2;
        variant.terrain = terrain;
        opened(&variant, Some(&first)).bytes_beside(&first)
    };
    assert_eq!(varied(engineer().terrain), None);
    let step = Terrain::Step {
        height: 0.05,
        surface: Surface::sharp(0.9),
    };
    assert_eq!(varied(step.clone()), Some(4 * 300));
    // A lane for each track, and one for the belly.
    let lower = Terrain::Step {
        height: 0.04,
        surface: Surface::sharp(0.9),
    };
    let lanes = Terrain::Lanes {
        left: Box::new(step.clone()),
        right: Box::new(lower),
        middle: Some(Box::new(step)),
    };
    assert_eq!(varied(lanes), Some(3 * 4 * 300));
}

#[test]
fn the_corners_of_lanes_are_those_of_the_tracks_and_of_the_belly() {
    let lane = |count: u32, edge_radius| {
        Box::new(Terrain::Points {
            points: (0..count).map(|i| [f64::from(i), 0.0]).collect(),
            goal: 1.0,
            surface: Surface {
                edge_radius,
                ..Surface::sharp(0.9)
            },
            segment_friction: None,
        })
    };
    let lanes = |middle| Terrain::Lanes {
        left: lane(2, 0.0),
        right: lane(5, 0.0),
        middle,
    };
    assert_eq!(corners(&lanes(Some(lane(4, 0.0)))), 2 + 5 + 4);
    // Without its own profile, the belly has all edges of both tracks.
    assert_eq!(corners(&lanes(None)), 2 * (2 + 5));
    // 90 facets for each corner, and at most a million together.
    assert_eq!(corners(&lane(3, 0.01)), 3 + 3 * 90);
    assert_eq!(corners(&lane(20_000, 0.01)), 20_000 + 1_000_000);
}

/// So that memory is requested before the ground uses it; the ends are not corners.
#[test]
fn ground_has_no_more_corners_than_are_asked_for() {
    let surface = |edge_radius: f64| Surface::rounded(edge_radius, 0.9);
    for edge_radius in [0.0, 0.01] {
        let stairs = Terrain::Stairs {
            count: 2_000,
            rise: 0.1,
            run: 0.2,
            surface: surface(edge_radius),
        };
        let step = Terrain::Step {
            height: 0.1,
            surface: surface(edge_radius),
        };
        for terrain in [stairs, step] {
            let ground = Ground::new(&terrain, 0.2).expect("a ground");
            let there: usize = ground.lanes.iter().map(|lane| lane.points.len()).sum();
            assert!(corners(&terrain) + 2 >= there as u64, "{there}");
        }
    }
}

#[test]
fn whole_numbers_are_written_without_a_point_where_a_field_wants_them() {
    for (number, whole, text) in [
        (3.0, true, "3"),
        (0.0, true, "0"),
        (3.5, true, "3.5"),
        (-3.0, true, "-3.0"),
        (3.0, false, "3.0"),
        (f64::NAN, true, "\"NaN\""),
        (f64::INFINITY, false, "\"inf\""),
    ] {
        assert_eq!(to_number(number, whole).to_string(), text);
    }
}

/// An edge that is rounded takes 90 facets, and a lane a million at most.
#[test]
fn a_ground_has_as_many_corners_as_its_points_steps_and_posts_and_more_if_they_are_round() {
    let points = |count: u32, radius: f64| Terrain::Points {
        points: (0..count).map(|i| [f64::from(i), 0.0]).collect(),
        goal: 0.0,
        surface: Surface::rounded(radius, 0.9),
        segment_friction: None,
    };
    let lanes = |middle: Option<Terrain>| Terrain::Lanes {
        left: Box::new(points(10, 0.0)),
        right: Box::new(points(7, 0.0)),
        middle: middle.map(Box::new),
    };
    let stairs = |radius: f64| Terrain::Stairs {
        count: 5,
        rise: 0.1,
        run: 0.3,
        surface: Surface::rounded(radius, 0.9),
    };
    let field = Terrain::RandomStepfield(crate::scenario::Stepfield {
        seed: 1,
        pattern: crate::scenario::FieldPattern::Flat,
        posts: 20,
        post: 0.1,
        rise: 0.02,
        levels: 4,
        barrier_height: 0.0,
        barrier_thickness: 0.1,
        barrier_yaw: 0.0,
        surface: Surface::sharp(0.9),
    });
    for (terrain, count) in [
        (points(10, 0.0), 10),
        (points(10, 0.01), 910),
        (points(20_000, 0.01), 1_020_000),
        (lanes(None), 34),
        (lanes(Some(points(3, 0.0))), 20),
        (stairs(0.0), 10),
        (stairs(0.01), 910),
        (field, 120),
    ] {
        assert_eq!(corners(&terrain), count, "{count}");
    }
}
