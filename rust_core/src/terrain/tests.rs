//! The ground of both tracks and the belly.

use approx::assert_relative_eq;

use super::*;
use crate::scenario::{FieldPattern, Stepfield};

fn profile(points: &[[f64; 2]]) -> Profile {
    Profile::new("terrain", points, Surface::sharp(0.5), true).expect("a profile")
}

fn points(profile: &Profile) -> Vec<[f64; 2]> {
    profile.points.iter().map(|p| [p.x, p.y]).collect()
}

#[test]
fn between_two_lanes_each_place_has_the_larger_friction_there() {
    let with = |points: &[[f64; 2]], frictions: &[f64]| {
        let mut profile = profile(points);
        profile.friction = GroundFriction::of_segments(points, frictions, 0.0);
        profile
    };
    let step = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [0.2, 0.1], [2.0, 0.1]];
    let ditch = [
        [-1.0, -0.1],
        [0.0, -0.1],
        [0.0, -0.4],
        [1.0, -0.4],
        [2.0, -0.4],
    ];
    let a = with(&step, &[0.2, 0.05, 0.3, 0.9]);
    let b = with(&ditch, &[0.25, 0.8, 0.1, 0.0]);
    let found = upper_envelope("terrain", &a, &b).expect("they overlap");
    // The face of the step is 0.1 m above that of the ditch, and 0.4 m above its floor.
    let places = [(-0.5, 0.0), (0.0, 0.05), (0.1, 0.1), (0.6, 0.1), (1.5, 0.1)];
    let found = places.map(|(x, y)| found.friction.at(Vector::new(x, y)).coefficient);
    assert_relative_eq!(found.as_slice(), [0.25, 0.8, 0.3, 0.9, 0.9].as_slice());
}

#[test]
fn a_face_between_two_lanes_has_its_own_friction() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
    let [a, b] = [0.05, 0.04].map(|of_face| {
        let mut profile = profile(&points);
        let frictions = [0.9, of_face, 0.8];
        profile.friction = GroundFriction::of_segments(&points, &frictions, 0.0);
        profile
    });
    let found = upper_envelope("terrain", &a, &b).expect("they overlap");
    let on_face = found.friction.at(Vector::new(0.0, 0.05)).coefficient;
    assert_relative_eq!(on_face, 0.05);
}

#[test]
fn the_higher_of_two_steps_is_a_stair() {
    let early = profile(&[[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [2.0, 0.1]]);
    let late = profile(&[[-2.0, 0.0], [1.0, 0.0], [1.0, 0.3], [3.0, 0.3]]);
    let stair = upper_envelope("terrain", &early, &late).expect("they overlap");
    let expected = [
        [-1.0, 0.0],
        [0.0, 0.0],
        [0.0, 0.1],
        [1.0, 0.1],
        [1.0, 0.3],
        [2.0, 0.3],
    ];
    assert_eq!(points(&stair), expected);
}

#[test]
fn slopes_that_cross_make_a_valley_between_them() {
    let down = profile(&[[0.0, 1.0], [2.0, 0.0]]);
    let up = profile(&[[0.0, 0.0], [2.0, 1.0]]);
    let valley = upper_envelope("terrain", &down, &up).expect("they overlap");
    assert_eq!(points(&valley), [[0.0, 1.0], [1.0, 0.5], [2.0, 1.0]]);
}

#[test]
fn the_height_beyond_an_end_is_that_of_the_end() {
    let step = Terrain::Step {
        height: 0.1,
        surface: Surface::sharp(0.5),
    };
    let ground = Ground::new(&step, 0.4).expect("it is ground");
    let heights = [-1e4, -0.5, 0.0, 0.5, 1e4].map(|x| ground.height(x));
    assert_relative_eq!(heights.as_slice(), [0.0, 0.0, 0.1, 0.1, 0.1].as_slice());
}

#[test]
fn a_slope_has_its_height_between_its_ends() {
    let ground = profile(&[[1.0, 0.0], [3.0, 0.5], [3.0, 0.8], [7.0, 0.0]]);
    assert_relative_eq!(heights_at(&ground, 2.6).as_slice(), [0.4, 0.4].as_slice());
    assert_relative_eq!(heights_at(&ground, 3.0).as_slice(), [0.5, 0.8].as_slice());
    assert_relative_eq!(heights_at(&ground, 6.0).as_slice(), [0.2, 0.2].as_slice());
}

#[test]
fn lanes_apart_are_refused() {
    let here = profile(&[[0.0, 0.0], [1.0, 0.0]]);
    let there = profile(&[[2.0, 0.0], [3.0, 0.0]]);
    let error = upper_envelope("terrain", &here, &there).expect_err("nothing in common");
    assert!(error.to_string().contains("common stretch"));
}

/// Turned far enough, the barrier of a field is longer than that.
#[test]
fn an_obstacle_begins_with_the_barrier_of_its_field() {
    let field = Stepfield {
        seed: 1,
        pattern: FieldPattern::Flat,
        posts: 2,
        post: 0.1,
        rise: 0.02,
        levels: 4,
        barrier_height: 0.1,
        barrier_thickness: 1.0,
        barrier_yaw: 0.0,
        surface: Surface::sharp(0.9),
    };
    let ground = Ground::new(&Terrain::RandomStepfield(field), 0.2).expect("a ground");
    assert!(
        (ground.first_edge + 0.4).abs() < 1e-12,
        "{} m",
        ground.first_edge
    );
}

/// The corners of the belly's ground between two lanes are not a separate obstacle.
#[test]
fn two_lanes_of_one_shape_begin_where_that_does() {
    let lane = |friction: f64| Terrain::Points {
        points: vec![[-3.0, 0.0], [1.0, 0.0], [1.5, -0.3], [4.0, -0.3]],
        goal: 1.5,
        surface: Surface {
            edge_radius: 0.5,
            ..Surface::sharp(friction)
        },
        segment_friction: None,
    };
    let lanes = Terrain::Lanes {
        left: Box::new(lane(0.9)),
        right: Box::new(lane(0.8)),
        middle: None,
    };
    let begins = |terrain| Ground::new(&terrain, 0.2).expect("a ground").first_edge;
    assert_eq!(begins(lanes).to_bits(), begins(lane(0.9)).to_bits());
}

/// A step of 0.1 m that begins at an x [m].
fn step_at(x: f64, goal: f64) -> Terrain {
    Terrain::Points {
        points: vec![[-3.0, 0.0], [x, 0.0], [x, 0.1], [4.0, 0.1]],
        goal,
        surface: Surface::sharp(0.5),
        segment_friction: None,
    }
}

fn lanes(left: &Terrain, right: &Terrain, middle: Option<&Terrain>) -> Terrain {
    Terrain::Lanes {
        left: Box::new(left.clone()),
        right: Box::new(right.clone()),
        middle: middle.map(|lane| Box::new(lane.clone())),
    }
}

#[test]
fn tracks_that_meet_the_same_ground_are_simulated_as_one() {
    let (early, late, flat) = (step_at(0.0, 1.0), step_at(0.5, 2.0), step_at(3.0, 3.0));
    for (terrain, tracks, sides, goal) in [
        (lanes(&early, &early, None), 1, &[Side::Both][..], 1.0),
        (lanes(&early, &early, Some(&early)), 1, &[Side::Both], 1.0),
        (
            lanes(&early, &early, Some(&flat)),
            1,
            &[Side::Both, Side::Middle],
            1.0,
        ),
        (
            lanes(&early, &late, None),
            2,
            &[Side::Left, Side::Right, Side::Middle],
            2.0,
        ),
        (
            lanes(&late, &early, Some(&flat)),
            2,
            &[Side::Left, Side::Right, Side::Middle],
            2.0,
        ),
    ] {
        let ground = Ground::new(&terrain, 0.2).expect("a ground");
        assert_eq!(ground.tracks, tracks);
        let found: Vec<Side> = ground.lanes.iter().map(|lane| lane.side).collect();
        assert_eq!(found, sides);
        assert_relative_eq!(ground.goal, goal);
        assert_eq!(ground.middle(), sides.len() - 1);
        for (lane, side) in ground.lanes.iter().zip(sides) {
            assert!(lane.edges.iter().all(|edge| edge.side == *side));
        }
        let edges: usize = ground.lanes.iter().map(|lane| lane.edges.len()).sum();
        assert_eq!(ground.edges().len(), edges);
    }
}

/// A barrier that lies across both tracks is one profile, a turned one is three.
#[test]
fn a_turned_barrier_gives_each_track_its_own_ground() {
    let barrier = |yaw: f64| Terrain::DiagonalBarrier {
        yaw,
        height: 0.1,
        thickness: 0.2,
        surface: Surface::sharp(0.9),
    };
    let counts = [0.0, 0.3].map(|yaw| {
        let ground = Ground::new(&barrier(yaw), 0.4).expect("a ground");
        assert_relative_eq!(ground.first_edge, 0.0);
        assert_relative_eq!(ground.extent().0, -100.0);
        assert_relative_eq!(ground.extent().1, ground.goal + 100.0);
        (ground.tracks, ground.lanes.len())
    });
    assert_eq!(counts, [(1, 1), (2, 3)]);
}

#[test]
fn the_angle_of_the_ground_is_the_mean_of_what_both_tracks_meet() {
    let slope = |rise: f64| Terrain::Points {
        points: vec![[-1.0, 0.0], [0.0, 0.0], [1.0, rise]],
        goal: 1.0,
        surface: Surface::sharp(0.5),
        segment_friction: None,
    };
    let both = lanes(&slope(1.0), &slope(-0.5), Some(&slope(0.25)));
    let ground = Ground::new(&both, 0.2).expect("a ground");
    let expected = 0.5 * (1.0_f64.atan() - 0.5_f64.atan());
    assert_relative_eq!(ground.angle_at(0.5), expected, epsilon = 1e-12);
    assert_relative_eq!(ground.angle_at(-0.5), 0.0);
    assert_relative_eq!(ground.lowest(), -0.5);
    assert_relative_eq!(ground.highest(), 1.0);
}

#[test]
fn a_goal_beyond_a_lane_and_frictions_that_do_not_fit_are_refused() {
    let path = |terrain: &Terrain| Ground::new(terrain, 0.2).err().map(|error| error.path);
    for (goal, fits) in [(-3.0, true), (4.0, true), (-3.1, false), (4.1, false)] {
        let expected = (!fits).then(|| "terrain.goal".to_owned());
        assert_eq!(path(&step_at(0.0, goal)), expected, "{goal} m");
    }
    let short = Terrain::Points {
        points: vec![[-1.0, 0.0], [1.0, 0.0], [1.5, 0.1]],
        goal: 1.0,
        surface: Surface::sharp(0.5),
        segment_friction: None,
    };
    let ends_before = lanes(&step_at(0.0, 3.0), &short, None);
    assert_eq!(path(&ends_before).as_deref(), Some("terrain"));
    for (frictions, fits) in [(3, true), (2, false), (4, false)] {
        let mut terrain = step_at(0.0, 1.0);
        if let Terrain::Points {
            segment_friction, ..
        } = &mut terrain
        {
            *segment_friction = Some(vec![0.7; frictions]);
        }
        let expected = (!fits).then(|| "terrain.segment_friction".to_owned());
        assert_eq!(path(&terrain), expected, "{frictions} numbers");
        if fits {
            let ground = Ground::new(&terrain, 0.2).expect("a ground");
            assert_relative_eq!(ground.lanes[0].friction.most().coefficient, 0.7);
        }
    }
}

/// It begins at the first edge at or beyond 0.
#[test]
fn an_obstacle_begins_at_the_first_edge_that_is_not_behind_the_start() {
    for (x, first) in [(0.0, 0.0), (0.7, 0.7), (-1e-10, -1e-10), (-0.5, -0.5)] {
        let ground = Ground::new(&step_at(x, 1.0), 0.2).expect("a ground");
        assert_relative_eq!(ground.first_edge, first);
    }
    let two = Terrain::Points {
        points: vec![[-3.0, 0.0], [-1.0, 0.1], [2.0, 0.0], [4.0, 0.0]],
        goal: 1.0,
        surface: Surface::sharp(0.5),
        segment_friction: None,
    };
    let ground = Ground::new(&two, 0.2).expect("a ground");
    assert_relative_eq!(ground.first_edge, 2.0);
    let flat = Terrain::Flat {
        length: 2.0,
        friction: crate::scenario::Friction::dry(0.5),
    };
    let ground = Ground::new(&flat, 0.2).expect("a ground");
    assert_relative_eq!(ground.first_edge, 0.0);
}
