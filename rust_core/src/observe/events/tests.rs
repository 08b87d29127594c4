//! Intrusions tracked from check to check.

use super::*;
use crate::contact::TrackEnvelope;
use crate::geometry::{Pose, Vector};
use crate::robot::{Model, Mount};
use crate::scenario::shared;
use crate::terrain::Ground;

/// An intrusion between bodies 1 and 2 with these edges, the deepest first.
fn intrusion(edges: &[i32], depth: f64) -> Intrusion {
    let scenario = shared("engineer_belt_step");
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
    let model = Model::new(&scenario.robot).expect("it can be built");
    let track = (0, Mount::Chassis);
    let margin = scenario.criteria.intrusion_depth;
    let envelope = TrackEnvelope::new(&model.parts, track, margin);
    // Straddling the face of the step.
    let pose = Pose::from_translation(Vector::new(0.0, 0.1));
    let mut intrusion = envelope.intrusions(&ground.lanes[0], pose).remove(0);
    (intrusion.edges, intrusion.edge) = (edges.to_vec(), edges[0]);
    (intrusion.depth, intrusion.root_depth) = (depth, 0.5 * depth);
    intrusion.bodies = [1, 2];
    intrusion
}

fn between(bodies: [usize; 2], edges: &[i32]) -> Intrusion {
    let mut intrusion = intrusion(edges, 0.01);
    intrusion.bodies = bodies;
    intrusion
}

#[test]
fn an_intrusion_is_one_event_from_its_first_look_to_the_one_that_misses_it() {
    let mut watch = IntrusionWatch::default();
    watch.look(1.0, std::iter::empty());
    for (time, force) in [(1.25, 10.0), (1.5, 20.0), (1.75, 60.0)] {
        watch.look(time, std::iter::once((intrusion(&[3], 0.01), force)));
    }
    let going_on: Vec<Event> = watch.events(1.8).collect();
    let expected = Event {
        kind: EventKind::Intrusion,
        start: 1.25,
        end: 1.8,
        side: Side::Both,
        edge: 3,
        bodies: Some([1, 2]),
        depth: 0.01,
        root_depth: 0.005,
        force: 30.0,
    };
    assert_eq!(going_on, std::slice::from_ref(&expected));

    watch.look(2.0, std::iter::empty());
    let over: Vec<Event> = watch.events(9.0).collect();
    assert_eq!(
        over,
        [Event {
            end: 2.0,
            ..expected
        }]
    );
    assert!(watch.most_loaded().is_none());
}

#[test]
fn an_intrusion_is_the_same_while_its_bodies_are_and_an_edge_is_still_inside() {
    let mut watch = IntrusionWatch::default();
    let mut look = |time: f64, inside: &Intrusion| {
        watch.look(time, std::iter::once((inside.clone(), 1.0)));
        let starts: Vec<f64> = watch.events(time).map(|event| event.start).collect();
        starts
    };
    assert_eq!(look(1.0, &between([1, 2], &[3, 4])), [1.0]);
    assert_eq!(look(2.0, &between([1, 2], &[4, 5])), [1.0]);
    assert_eq!(look(2.5, &between([1, 2], &[5])), [1.0]);
    assert_eq!(
        look(3.0, &between([1, 2], &[6])),
        [1.0, 3.0],
        "no edge left"
    );
    assert_eq!(
        look(4.0, &between([2, 3], &[6])),
        [1.0, 3.0, 4.0],
        "other bodies"
    );
}

#[test]
fn an_event_has_the_deepest_reach_and_the_edge_that_had_it_first() {
    let mut watch = IntrusionWatch::default();
    for (edges, depth) in [
        ([3, 4], 0.01),
        ([4, 3], 0.03),
        ([3, 4], 0.03),
        ([3, 4], 0.02),
    ] {
        watch.look(1.0, std::iter::once((intrusion(&edges, depth), 1.0)));
    }
    let event = watch.events(1.0).next().expect("there is one");
    assert_eq!(
        (event.edge, event.depth, event.root_depth),
        (4, 0.03, 0.015)
    );
}

#[test]
fn the_most_loaded_counts_and_of_equals_the_first() {
    let most_loaded = |forces: [f64; 3]| {
        let inside = [3, 4, 5].map(|edge| intrusion(&[edge], 0.01));
        let mut watch = IntrusionWatch::default();
        watch.look(1.0, inside.into_iter().zip(forces));
        watch.most_loaded().map(|event| event.edge)
    };
    assert_eq!(most_loaded([1.0, 3.0, 2.0]), Some(4));
    assert_eq!(most_loaded([2.0, 2.0, 2.0]), Some(3));
}

#[test]
fn a_stop_carries_what_is_inside_the_track_or_no_edge() {
    let alone = Event::stop(1.0, 4.0, None);
    let bare = Event {
        kind: EventKind::Stop,
        start: 1.0,
        end: 4.0,
        side: Side::Both,
        edge: -1,
        bodies: None,
        depth: 0.0,
        root_depth: 0.0,
        force: 0.0,
    };
    assert_eq!(alone, bare);
    let inside = Event {
        kind: EventKind::Intrusion,
        start: 2.0,
        end: 3.0,
        side: Side::Left,
        edge: 7,
        bodies: Some([0, 1]),
        depth: 0.02,
        root_depth: 0.01,
        force: 50.0,
    };
    let expected = Event {
        kind: EventKind::Stop,
        start: 1.0,
        end: 4.0,
        ..inside.clone()
    };
    assert_eq!(Event::stop(1.0, 4.0, Some(&inside)), expected);
}

#[test]
fn the_kinds_have_the_names_of_the_tables() {
    let names = [EventKind::Stop, EventKind::Intrusion].map(EventKind::name);
    assert_eq!(names, ["stop", "intrusion"]);
}

/// The lanes of a step up.
fn lanes() -> Vec<Profile> {
    let scenario = shared("engineer_belt_step");
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge);
    ground.expect("a ground").lanes
}

/// Bodies 0 to 2.
const PARTS: usize = 3;

/// An intrusion between the last two of them.
fn genuine() -> Event {
    Event {
        kind: EventKind::Intrusion,
        start: 1.0,
        end: 2.0,
        side: Side::Both,
        edge: 0,
        bodies: Some([1, 2]),
        depth: 0.02,
        root_depth: 0.01,
        force: 50.0,
    }
}

#[test]
fn an_event_with_one_number_that_is_not_finite_does_not_fit() {
    type Number = fn(&mut Event) -> &mut f64;
    let numbers: [Number; 5] = [
        |e| &mut e.start,
        |e| &mut e.end,
        |e| &mut e.depth,
        |e| &mut e.root_depth,
        |e| &mut e.force,
    ];
    let lanes = lanes();
    assert!(genuine().fits(PARTS, &lanes));
    for (i, number) in numbers.into_iter().enumerate() {
        for spoilt in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut event = genuine();
            *number(&mut event) = spoilt;
            assert!(!event.fits(PARTS, &lanes), "number {i}: {spoilt}");
        }
    }
}

#[test]
fn an_event_fits_the_bodies_that_a_robot_has_or_none() {
    let fits = |bodies: Option<[usize; 2]>| {
        let event = Event {
            bodies,
            ..genuine()
        };
        event.fits(PARTS, &lanes())
    };
    assert!(fits(None));
    assert!(fits(Some([0, PARTS - 1])));
    assert!(fits(Some([PARTS - 1, 0])));
    assert!(!fits(Some([0, PARTS])));
    assert!(!fits(Some([PARTS, 0])));
}

#[test]
fn an_event_fits_the_edges_of_the_lane_that_has_most_or_none() {
    let fits = |edge: i32, lanes: &[Profile]| Event { edge, ..genuine() }.fits(PARTS, lanes);
    let all = lanes();
    let mut bare = all[0].clone();
    let past = bare.edges.len() as i32;
    assert!(past > 0, "a step has edges");
    bare.edges.clear();
    for lanes in [
        all.clone(),
        vec![all[0].clone(), bare.clone()],
        vec![bare, all[0].clone()],
    ] {
        assert!(!fits(-2, &lanes));
        assert!(fits(-1, &lanes));
        assert!(fits(past - 1, &lanes));
        assert!(!fits(past, &lanes));
    }
}

#[test]
fn what_is_followed_with_one_thing_spoilt_does_not_fit() {
    type Spoil = fn(&mut IntrusionWatch);

    let lanes = lanes();
    // One is over and one is going on.
    let followed = || {
        let mut watch = IntrusionWatch::default();
        for (time, edge) in [(1.0, 0), (2.0, 1)] {
            watch.look(time, std::iter::once((intrusion(&[edge], 0.01), 10.0)));
        }
        assert_eq!((watch.past.len(), watch.present.len()), (1, 1));
        watch
    };
    assert!(IntrusionWatch::default().fits(PARTS, &lanes));
    assert!(followed().fits(PARTS, &lanes));
    let all: [(&str, Spoil); 6] = [
        ("past force", |w| w.past[0].force = f64::NAN),
        ("past body", |w| w.past[0].bodies = Some([0, PARTS])),
        ("present force", |w| w.present[0].event.force = f64::NAN),
        ("present body", |w| {
            w.present[0].event.bodies = Some([0, PARTS]);
        }),
        ("no look", |w| w.present[0].looks = 0.0),
        ("looks that are no number", |w| {
            w.present[0].looks = f64::NAN;
        }),
    ];
    for (what, spoil) in all {
        let mut watch = followed();
        spoil(&mut watch);
        assert!(!watch.fits(PARTS, &lanes), "{what}");
    }
}

#[test]
fn outcomes_are_listed_in_their_order() {
    let places = Outcome::ALL.map(|outcome| outcome as usize);
    assert_eq!(places, std::array::from_fn(|place| place));
}

#[test]
fn a_stop_is_neither_an_end_of_its_own_nor_a_run_out_of_time() {
    for outcome in Outcome::ALL {
        let name = outcome.name();
        let stops = ["seized", "cycling", "hung_up", "stalled", "slipping"];
        assert_eq!(outcome.is_stop(), stops.contains(&name), "{name}");
    }
}
