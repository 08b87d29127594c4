//! Possible contacts in a cell, compared with contacts in its poses.

use super::*;

fn pairs(setting: &Setting, contacts: &[usize]) -> Vec<(usize, usize)> {
    let of = |i: &usize| (setting.contacts[*i].surface, setting.contacts[*i].place);
    contacts.iter().map(of).collect()
}

/// A cell of one pose contains exactly the contacts there, with their normals, arms and friction.
#[test]
fn in_a_cell_of_one_pose_just_that_is_possible_which_touches_there() {
    let family = family_on_a_step();
    let shares = [0.3, 0.6, 0.0, 0.0];
    let (setting, all) = stands(&family, &shares);
    assert!(all.len() > 4, "{}", all.len());
    for (posture, contacts) in &all {
        let Possible::Touches(touches) = family.possible(&cell_at(posture, &shares)) else {
            panic!("it overlaps nowhere");
        };
        let found: Vec<(usize, usize)> = touches.iter().map(|t| (t.surface, t.place)).collect();
        for pair in pairs(&setting, contacts) {
            assert!(found.contains(&pair), "{pair:?} of {found:?}");
        }
        for touch in &touches {
            let is_it = |contact: &&Contact| {
                (contact.surface, contact.place) == (touch.surface, touch.place)
            };
            let Some(contact) = setting.contacts.iter().find(is_it) else {
                continue;
            };
            let there = contact.touch(posture);
            // Up to the margin, and ends of what runs and faces can do.
            assert!(there.gap.abs() < 3.0 * MARGIN, "{contact:?} {there:?}");
            let normals = touch.normals.all();
            assert!((normals.middle - there.normal).length() < 1e-6);
            assert!(normals.half.length() < 1e-6);
            let arm = there.point + there.normal * touch.radius
                - posture.position
                - Vector::from_angle(posture.angle).rotate(setting.layout.center_of_mass);
            assert!((touch.arm.middle - arm).length() < 1e-7, "{touch:?} {arm}");
        }
    }
}

/// Every contact in a pose of a cell is among the possible ones, with its normal.
#[test]
fn a_cell_has_all_that_touches_in_poses_of_it() {
    let family = family_on_a_step();
    let mut draw = Draw(31);
    let mut tried = 0;
    for shares in [[0.2, 0.9, 0.0, 0.0], [0.8, 0.1, 0.0, 0.0]] {
        let (setting, all) = stands(&family, &shares);
        for (posture, contacts) in &all {
            for half in [1e-4, 1e-2, 0.2] {
                let cell = cell_round(&mut draw, &cell_at(posture, &shares), half);
                let Possible::Touches(touches) = family.possible(&cell) else {
                    panic!("there is a pose in it without overlap");
                };
                for i in contacts {
                    let contact = &setting.contacts[*i];
                    let is_it = |t: &&crate::jams::certify::touch::Touch| {
                        (t.surface, t.place) == (contact.surface, contact.place)
                    };
                    let touch = touches.iter().find(is_it).expect("it touches");
                    let there = contact.touch(posture);
                    let off = (there.normal - touch.normals.all().middle).abs();
                    let room = touch.normals.all().half + Vector::ONE * 1e-8;
                    assert!(off.cmple(room).all(), "{touch:?} {there:?}");
                    let friction = setting.places[contact.place].friction;
                    let friction =
                        friction.min(setting.layout.surfaces[contact.surface].friction_limit);
                    let [low, high] = touch.slopes;
                    assert!(low <= high && (touch.slides || low + high == 0.0));
                    assert!(high >= friction - 1e-12 || high == 0.0 && touch.slides);
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 100, "{tried}");
}

/// A cell in which a part overlaps with the ground everywhere has no pose in which it does not; of wheels, one of one
/// pose tells all that overlap.
#[test]
fn where_all_of_a_cell_overlaps_no_pose_of_it_is_clear() {
    let wheels = members().map(|mut scenario| {
        scenario.robot.belly = None;
        scenario
    });
    let family = family(&wheels).expect("height and friction are in proportion");
    let cancel = Cancel::default();
    let mut draw = Draw(32);
    let (mut overlaps, mut clear) = (0, 0);
    let root = family.root();
    for case in 0..2_000 {
        let mut point = anywhere(&mut draw, &root);
        // Near the step, where it matters.
        point.low[0] = draw.between(-0.4, 0.4);
        point.low[1] = draw.between(-0.05, 0.3);
        point.high = point.low;
        let half = if case % 2 == 0 { 0.0 } else { 0.02 };
        let cell = cell_round(&mut draw, &point, half);
        let shares = point.shares();
        let setting = family
            .setting(&shares, &cancel)
            .expect("there are few contacts");
        let is_clear = setting.is_clear(&posture(&point));
        let is_overlap = matches!(family.possible(&cell), Possible::Overlap);
        assert!(!(is_overlap && is_clear), "{point:?}");
        assert!(half > 0.0 || is_overlap != is_clear, "{point:?}");
        overlaps += u32::from(is_overlap);
        clear += u32::from(is_clear);
    }
    assert!(overlaps > 500 && clear > 200);
}

/// A wheel whose axle is over the middle of a face, and one that may be over its end.
#[test]
fn a_wheel_is_wholly_on_a_face_if_it_is_over_it_all_over_a_cell() {
    let family = family_on_a_step();
    let radius = family
        .discs
        .iter()
        .map(|disc| disc.radius)
        .fold(0.0, f64::max);
    let of = |x: f64, half: f64| {
        let mut cell = Cell::ZERO;
        cell.low[..2].copy_from_slice(&[x - half, radius]);
        cell.high[..2].copy_from_slice(&[x + half, radius]);
        let Possible::Touches(touches) = family.possible(&cell) else {
            panic!("it stands there");
        };
        let on_faces = touches.iter().map(|touch| touch.normals.is_on_face);
        on_faces.collect::<Vec<bool>>()
    };
    assert_eq!(of(-1.0, 0.0), [true; 4]);
    assert_eq!(of(-1.0, 0.1), [true; 4]);
    // The ground ends under the axle of the rear wheel.
    let end = family.root().low[0] - family.reach;
    let rear = family
        .discs
        .iter()
        .map(|disc| disc.center.x)
        .fold(0.0, f64::min);
    let mut beyond = of(end - rear, 0.01);
    beyond.sort_unstable();
    assert_eq!(beyond, [false, true, true, true]);
}
