//! All jams of robots of scenarios, their ranges of friction, and scenarios that are refused.

use super::*;
use crate::error::Error;
use crate::jams::{Jam, JamRange, jam_ranges, jams};
use crate::robot::Model;
use crate::scenario::{
    BeltTrack, ClosedSurface, ClosedTrack, LineOfWheels, Scenario, Surface as Roughness, Terrain,
    Track, Wheel, shared,
};
use crate::terrain::Ground;

/// The Engineer on round wheels, without a belly, before a step of 80 mm.
fn on_wheels(count: u32, friction: f64) -> Scenario {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.belly = None;
    scenario.robot.track = Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.terrain = Terrain::Step {
        height: 0.08,
        surface: Roughness::sharp(friction),
    };
    scenario
}

fn built(scenario: &Scenario) -> (Model, Ground) {
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("it is ground");
    let model = Model::on(&scenario.robot, &ground).expect("it can be built");
    (model, ground)
}

fn found(scenario: &Scenario) -> Result<Vec<Jam>, Error> {
    let (model, ground) = built(scenario);
    jams(scenario, (&model, &ground), &Cancel::default())
}

#[test]
fn jams_come_from_the_rear_and_each_once_and_none_has_tipped_over() {
    let mut scenario = on_wheels(4, 0.9);
    scenario.criteria.tip_over_angle = 0.6;
    let all = found(&scenario).expect("its jams are known");
    assert!(all.len() > 3, "{}", all.len());
    for pair in all.windows(2) {
        assert!(pair[0].position.x <= pair[1].position.x);
    }
    for (i, jam) in all.iter().enumerate() {
        assert!(jam.angle.abs() <= 0.6, "{jam:?}");
        let is_same = |other: &Jam| {
            let off = (other.position - jam.position).length();
            off.max((other.angle - jam.angle).abs()) < 1e-7
        };
        assert!(!all[i + 1..].iter().any(is_same), "{jam:?}");
    }
    // The ground pushes it forwards, along the normal turned by -90 degrees.
    let contacts = || all.iter().flat_map(|jam| &jam.contacts);
    assert!(contacts().all(|contact| contact.friction >= -1e-8));
    assert!(contacts().any(|contact| contact.friction > 0.1));
    // With more room there are more.
    scenario.criteria.tip_over_angle = 1.3;
    assert!(found(&scenario).expect("its jams are known").len() > all.len());
}

/// Beyond each end by a hundredth, unless no more friction was asked for.
#[test]
fn a_pose_on_three_contacts_is_a_jam_just_where_its_range_of_friction_says() {
    let most = 1.2;
    let scenario = on_wheels(4, 0.9);
    let (model, ground) = built(&scenario);
    let ranges = jam_ranges(&scenario, (&model, &ground), most, &Cancel::default());
    let ranges = ranges.expect("its jams are known");
    assert!(ranges.len() > 1, "{ranges:?}");
    let is_jam = |friction: f64, range: &JamRange| {
        let all = found(&on_wheels(4, friction)).expect("its jams are known");
        all.iter().any(|jam| {
            let off = (jam.position - range.position).length();
            off.max((jam.angle - range.angle).abs()) < 1e-6
        })
    };
    for range in ranges.iter().take(3) {
        let [low, high] = range.friction;
        assert!(low < high && high <= most, "{range:?}");
        assert!(is_jam(0.5 * (low + high), range), "{range:?}");
        for friction in [low - 0.01, high + 0.01] {
            let is_within = friction > 0.0 && friction < most;
            assert!(
                !is_within || !is_jam(friction, range),
                "{friction} {range:?}"
            );
        }
    }
}

/// The path that is refused.
fn refused(scenario: &Scenario) -> Option<String> {
    match found(scenario) {
        Ok(_) => None,
        Err(Error::Scenario(error)) => Some(error.path),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn scenarios_without_isolated_jams_are_refused() {
    let path = |change: fn(&mut Scenario)| {
        let mut scenario = on_wheels(3, 0.9);
        change(&mut scenario);
        refused(&scenario)
    };
    let step = |height: f64, friction: f64| {
        Box::new(Terrain::Step {
            height,
            surface: Roughness::sharp(friction),
        })
    };
    assert_eq!(path(|_| {}), None);
    assert_eq!(
        path(|s| s.drive.speed = 0.0).as_deref(),
        Some("drive.speed")
    );
    assert_eq!(path(|s| s.drive.speed = -0.1), None);
    let mut smooth = on_wheels(3, 0.0);
    assert_eq!(refused(&smooth).as_deref(), Some("terrain.friction"));
    smooth.terrain = Terrain::Lanes {
        left: step(0.08, 0.9),
        right: step(0.05, 0.9),
        middle: None,
    };
    assert_eq!(refused(&smooth).as_deref(), Some("terrain"));
    smooth.terrain = Terrain::Points {
        points: vec![[-3.0, 0.0], [0.0, 0.0], [0.0, 0.08], [3.0, 0.08]],
        goal: 1.0,
        surface: Roughness::sharp(0.9),
        segment_friction: Some(vec![0.9, 0.5, 0.9]),
    };
    assert_eq!(
        refused(&smooth).as_deref(),
        Some("terrain.segment_friction")
    );
}

/// Which way a surface is pushed.
#[test]
fn wheels_are_driven_as_the_robot_drives_and_roll_without_a_motor() {
    let grips = |motors: usize, forwards: bool| {
        let mut scenario = on_wheels(3, 0.9);
        scenario.robot.belly = Some(vec![[-0.1, 0.0], [0.1, 0.0], [0.1, 0.05], [-0.1, 0.05]]);
        let (mut model, _) = built(&scenario);
        model.motors = motors;
        let layout = Layout::new(&model, forwards).expect("it has round wheels");
        let of = |kind: BodyKind| {
            let own = layout.surfaces.iter().filter(move |s| s.kind == kind);
            own.map(|surface| surface.grip).collect::<Vec<_>>()
        };
        // A belly of four corners has as many edges.
        assert_eq!(of(BodyKind::Belly), [Grip::Still; 8]);
        of(BodyKind::Wheel)
    };
    assert_eq!(grips(1, true), [Grip::Driven(1.0); 3]);
    assert_eq!(grips(1, false), [Grip::Driven(-1.0); 3]);
    assert_eq!(grips(0, true), [Grip::Free; 3]);
}

#[test]
fn a_robot_reaches_from_its_centre_of_mass_to_its_farthest_point() {
    let mut scenario = on_wheels(3, 0.9);
    scenario.robot.track = Track::Belt(BeltTrack {});
    scenario.robot.center_of_mass = [0.05, 0.02];
    let (model, _) = built(&scenario);
    let layout = Layout::new(&model, true).expect("it has a smooth belt");
    assert!((layout.center_of_mass - Vector::new(0.05, 0.02)).length() < 1e-12);
    let discs = layout.solids.iter().flat_map(|solid| &solid.discs);
    let rear = discs
        .min_by(|a, b| a.center.x.total_cmp(&b.center.x))
        .expect("it has some");
    let expected = (rear.center - Vector::new(0.05, 0.02)).length() + rear.radius;
    assert!(
        (layout.reach - expected).abs() < 1e-12 && expected > 0.28,
        "{expected}"
    );
    // Two circles and the straight runs over and under them.
    assert_eq!(layout.surfaces.len(), 4);
}

/// Where they can jam depends on how far they have turned, or they are pushed by something else.
#[test]
fn tracks_whose_shape_turns_with_their_drives_are_refused_by_their_names() {
    let names = [
        ("engineer_gear3_step", "gear wheels"),
        ("engineer_grouser_belt_step", "a belt with grousers"),
        ("engineer_chain_step", "a chain of shoes"),
        ("engineer_force_step", "force"),
    ];
    let refused = |scenario: &Scenario| {
        let (model, _) = built(scenario);
        let error = Layout::new(&model, true).expect_err("it turns");
        assert_eq!(error.path, "robot.track");
        error.value
    };
    for (shown, name) in names {
        let scenario = shared(shown);
        assert_eq!(refused(&scenario), name);
    }
    // Gear wheels in a closed track whose surface has their grousers, or none.
    let mut scenario = shared(names[0].0);
    let of = Box::new(scenario.robot.track);
    let closed = |surface| {
        Track::Closed(ClosedTrack {
            of: of.clone(),
            surface,
        })
    };
    scenario.robot.track = closed(ClosedSurface::Own);
    assert_eq!(refused(&scenario), "a belt with grousers");
    scenario.robot.track = closed(ClosedSurface::Smooth);
    assert!(Layout::new(&built(&scenario).0, true).is_ok());
}
