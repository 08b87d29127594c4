//! Possible and impossible observations of a monitor.

use super::stops::astride;
use super::*;
use crate::terrain::Profile;

/// [s] Time of the check of a snapshot.
const TIME: f64 = 1.0;

/// The robot and the ground of [`astride`].
struct Place {
    model: Model,
    lanes: Vec<Profile>,
}

impl Place {
    fn new(robot: &Watched) -> Self {
        let lanes = robot.monitor.ground.lanes.clone();
        let model = Model::new(&scenario().robot).expect("it can be built");
        Self { model, lanes }
    }

    fn fits(&self, observed: &Observations, time: f64) -> bool {
        observed.fits(time, &self.model, &self.lanes)
    }
}

#[test]
fn what_was_seen_with_one_thing_spoilt_does_not_fit() {
    type Spoil = fn(&mut Watched);

    let mut robot = astride();
    robot.stands_until(TIME);
    let place = Place::new(&robot);
    assert!(place.fits(robot.observed(), TIME));
    assert!(place.fits(&Observations::from(TIME), TIME), "nothing yet");
    let all: [(&str, Spoil); 16] = [
        ("time to clear", |r| {
            r.monitor.observed.time_to_clear = f64::NAN;
        }),
        ("penetration", |r| {
            r.monitor.observed.max_penetration = f64::NAN;
        }),
        ("largest angle", |r| r.monitor.observed.max_angle = f64::NAN),
        ("smallest angle", |r| {
            r.monitor.observed.min_angle = f64::NAN;
        }),
        ("work", |r| r.monitor.observed.drive_work = f64::NAN),
        ("path", |r| r.monitor.observed.path_length = f64::NAN),
        ("tension", |r| {
            r.monitor.observed.max_track_tension = f64::NAN;
        }),
        ("gap", |r| r.monitor.observed.max_pin_gap = f64::NAN),
        ("guide", |r| {
            r.monitor.observed.max_guide_penetration = f64::NAN;
        }),
        ("slip", |r| r.monitor.observed.max_sprocket_slip = f64::NAN),
        ("goal", |r| r.monitor.observed.goal_since = Some(f64::NAN)),
        ("endless goal", |r| {
            r.monitor.observed.goal_since = Some(f64::INFINITY);
        }),
        ("time", |r| r.monitor.observed.last_time = f64::NAN),
        ("progress", |r| r.monitor.observed.progress.share = f64::NAN),
        ("intrusions", |r| {
            let pose = Pose::new(r.now.position, r.now.chassis_angle);
            let inside = r.monitor.envelopes[0].intrusions(&r.monitor.ground.lanes[0], pose);
            let endless = inside.into_iter().map(|i| (i, f64::INFINITY));
            r.monitor.observed.intrusions.look(TIME, endless);
        }),
        ("signals", |r| {
            // A facet that this ground does not have.
            let contact = on_facet(99, 10.0);
            let signals = &mut r.monitor.observed.signals;
            signals.add((&r.now, STEP), &[contact], std::iter::empty(), 1.0);
        }),
    ];
    for (what, spoil) in all {
        let mut robot = astride();
        robot.stands_until(TIME);
        spoil(&mut robot);
        assert!(!place.fits(robot.observed(), TIME), "{what}");
    }
}

#[test]
fn a_goal_that_is_held_since_some_time_fits() {
    let mut observed = Observations::from(TIME);
    observed.goal_since = Some(0.5);
    assert!(Place::new(&astride()).fits(&observed, TIME));
}

#[test]
fn looks_are_ahead_of_time_by_two_at_most() {
    let place = Place::new(&astride());
    let fits = |looks: u64| {
        let mut observed = Observations::from(0.0);
        observed.looks = looks;
        place.fits(&observed, 0.0)
    };
    assert_eq!([0, 1, 2, 3].map(fits), [true, true, true, false]);
    let mut behind = Observations::from(TIME);
    behind.looks = 0;
    assert!(place.fits(&behind, TIME), "they catch up");
}

#[test]
fn the_last_step_was_within_two_looks_on_either_side_of_time() {
    let place = Place::new(&astride());
    let fits = |last_time: f64| {
        let mut observed = Observations::from(0.0);
        observed.last_time = last_time;
        place.fits(&observed, 0.0)
    };
    let most = 2.0 * LOOK.value();
    for side in [1.0, -1.0] {
        assert!(fits(side * most));
        assert!(!fits(side * most.next_up()));
    }
}
