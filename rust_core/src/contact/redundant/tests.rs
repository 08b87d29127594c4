//! Which of several contacts remains.

use super::*;
use crate::geometry::direction;
use crate::scenario::Surface;
use crate::terrain::Profile;

#[test]
fn a_contact_between_two_others_is_redundant_if_it_is_no_deeper_than_their_chord() {
    let at = |x: f64, distance: f64| {
        Contact::new(0, (0, -1), (Vector::new(x, 0.3), Vector::Y), distance)
    };
    let (first, last) = (at(1.0, -2e-4), at(5.0, 6e-4));
    for (x, chord) in [(2.0, 0.0), (4.0, 4e-4)] {
        for (off, lies) in [(1e-8, true), (0.0, true), (-1e-8, false)] {
            assert_eq!(lies_above(&first, &at(x, chord + off), &last), lies);
        }
    }
    assert!(!lies_above(&first, &at(0.5, 1.0), &last));
    assert!(!lies_above(&first, &at(5.5, 1.0), &last));
}

#[test]
fn of_contacts_in_a_row_those_at_its_ends_and_the_deepest_are_left() {
    let at = |x: f64, distance: f64| {
        Contact::new(0, (0, -1), (Vector::new(x, 0.0), Vector::Y), distance)
    };
    let mut contacts = vec![
        at(3.0, 0.0),
        at(1.0, 0.0),
        at(2.0, 0.0),
        at(4.0, -1e-3),
        at(5.0, 0.0),
    ];
    contacts.push(at(1.0 + 1e-10, 0.0));
    contacts.push(Contact::new(
        1,
        (0, -1),
        (Vector::new(2.5, 0.0), Vector::Y),
        0.0,
    ));
    without_redundant(&mut contacts);
    let left: Vec<(usize, f64)> = contacts.iter().map(|c| (c.part, c.point.x)).collect();
    assert_eq!(left, [(0, 1.0), (0, 4.0), (0, 5.0), (1, 2.5)]);
}

#[test]
fn one_of_two_contacts_in_one_place_is_left_and_both_of_two_apart() {
    let at = |x: f64, y: f64| Contact::new(0, (0, -1), (Vector::new(x, y), Vector::Y), -1e-4);
    let left = |a: Contact, b: Contact| {
        let mut contacts = vec![a, b];
        without_redundant(&mut contacts);
        contacts.len()
    };
    for (x, y) in [(1.0, 0.3), (-2.0, 0.0), (0.0, 0.0), (0.4, -5.0)] {
        assert_eq!(left(at(x, y), at(x + 1e-10, y)), 1, "at {x} {y} m");
        assert_eq!(left(at(x, y), at(x + 1e-6, y)), 2, "at {x} {y} m");
        assert_eq!(left(at(x, y), at(-x - 1.0, -y)), 2, "at {x} {y} m");
    }
    assert_eq!(left(at(-1.0, 0.0), at(1.0, 0.0)), 2);
}

/// It is turned so that the corner of the step faces neither of its sides, only its tip.
#[test]
fn a_needle_in_a_step_leaves_it_through_the_nearer_face() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
    let profile = Profile::new("terrain", &points, Surface::sharp(0.9), true).expect("a profile");
    let lane = Lane::new(&profile);
    for (behind, below) in [(1e-4, 5e-4), (5e-4, 1e-4)] {
        let place = Vector::new(behind, 0.1 - below);
        // Of 20 degrees, down to the right at 45 degrees.
        let normals = [-125.0_f64, 35.0].map(|angle| direction(angle.to_radians()));
        let tip = Tip { place, normals };
        let mut stays = Vec::new();
        let reach = (1e-3, 1e-3);
        lane.touches_of_disc(&lane.region(-0.1, 0.1), place, 0.0, reach, |touch| {
            if !tip_yields(&lane, &tip, &touch) {
                stays.push((touch.normal, -touch.distance));
            }
        });
        let nearer = if behind < below {
            Vector::NEG_X
        } else {
            Vector::Y
        };
        assert_eq!(stays.len(), 1, "{stays:?}");
        assert!((stays[0].0 - nearer).length() < 1e-12, "{stays:?}");
        assert!((stays[0].1 - 1e-4).abs() < 1e-12, "{stays:?}");
    }
}

/// [m] The corner of a block.
const CORNER: Vector = Vector::new(0.5, 0.25);

/// A block whose top is to the left of its corner, or mirrored to its right.
fn block(side: f64) -> Lane {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [1.0, -1.0]];
    let points = points.map(|[x, y]| [CORNER.x + side * x, CORNER.y + y]);
    // The points of a profile are from left to right or from right to left.
    let profile = Profile::new("terrain", &points, Surface::sharp(0.9), true);
    Lane::new(&profile.expect("it is ground"))
}

/// A tip there from the corner [mm] whose normals have these angles, or mirrored.
fn tip(side: f64, [x, y]: [f64; 2], angles: [f64; 2]) -> Tip {
    let mut normals = angles.map(|angle| direction(angle.to_radians()));
    for normal in &mut normals {
        normal.x *= side;
    }
    if side < 0.0 {
        normals.reverse();
    }
    Tip {
        place: CORNER + Vector::new(side * x, y) * 1e-3,
        normals,
    }
}

#[test]
fn a_tip_in_a_face_yields_to_a_shorter_way_out_beside_it_if_it_can_take_that() {
    for (place, angles, yields) in [
        // Down to the right at 45 degrees, the corner leaves through the left side, or is farther from it.
        ([-0.2, -1.0], [-135.0, -45.0], true),
        ([-2.0, -1.0], [-135.0, -45.0], false),
        // The tip leaves the block through its side, or is too far from that.
        ([-0.5, -1.0], [-185.0, -60.0], true),
        ([-1.5, -1.0], [-185.0, -60.0], false),
        // The corner is beside the tip, not in it.
        ([-0.6, -1.0], [-125.0, -5.0], false),
    ] {
        for side in [1.0, -1.0] {
            let (lane, tip) = (block(side), tip(side, place, angles));
            let mut found = Vec::new();
            let reach = (1e-3, 2e-3);
            lane.touches_of_disc(&lane.region(0.4, 0.6), tip.place, 0.0, reach, |touch| {
                if touch.normal == Vector::Y {
                    found.push(tip_yields(&lane, &tip, &touch));
                }
            });
            assert_eq!(found, [yields], "{place:?} {angles:?} {side}");
        }
    }
}

#[test]
fn a_corner_in_a_run_yields_to_a_shorter_way_out_that_the_tip_can_take() {
    for (place, angles, yields) in [
        ([-0.2, -1.0], [-135.0, -45.0], false),
        // Up through the top of the block, which is 0.3 mm above the tip.
        ([-1.5, -0.3], [-178.0, -60.0], true),
        // The other side of the tip has not come down to the block.
        ([-1.5, 0.3], [-178.0, -95.0], true),
        ([-1.5, 0.1], [-178.0, -60.0], false),
        // Left through the other side of the tip, of which the corner is 0.3 mm inside.
        ([-0.3, -1.0], [-100.0, -30.0], false),
        ([-0.3, -1.0], [-178.0, -100.0], false),
    ] {
        for side in [1.0, -1.0] {
            let (lane, tip) = (block(side), tip(side, place, angles));
            let i = if side > 0.0 { 1 } else { 2 };
            let corner = lane.corner(i);
            let outward = tip.normals[i - 1];
            let depth = (tip.place - corner.center).dot(outward);
            let touch = corner.touch(i, -outward, -depth);
            let found = run_yields(&lane, outward, &tip, &touch);
            assert_eq!(found, yields, "{place:?} {angles:?} {side}");
            let above = Touch {
                distance: depth.abs(),
                ..touch
            };
            let on_face = Touch {
                on: On::Face(i),
                ..touch
            };
            assert!(!run_yields(&lane, outward, &tip, &above));
            assert!(!run_yields(&lane, outward, &tip, &on_face));
        }
    }
}

fn lane_of(points: &[[f64; 2]]) -> Lane {
    let profile = Profile::new("terrain", points, Surface::sharp(0.9), false);
    Lane::new(&profile.expect("it is ground"))
}

/// A disc of 0.1 m that touches the ground at a number of places, a hundredth of a radian apart.
fn touching(count: i32, gap: impl Fn(i32) -> f64) -> (Disc, Vec<Contact>) {
    let disc = Disc {
        center: Vector::new(1.0, 0.1),
        radius: 0.1,
    };
    let contacts = (0..count).map(|i| {
        let normal = direction(0.25 * std::f64::consts::TAU + 0.01 * f64::from(i));
        let point = disc.center - normal * (disc.radius + 0.5 * gap(i));
        Contact::new(0, (0, -1), (point, normal), gap(i))
    });
    (disc, contacts.collect())
}

/// If contacts have equal gaps, the disc closes those at both ends first.
#[test]
fn contacts_of_a_disc_are_thinned_out_where_they_are_many_and_the_ground_is_fine() {
    let zigzag = |i: i32| [0.9 + 5e-4 * f64::from(i), 1e-4 * f64::from(i % 2)];
    let fine = lane_of(&(0..400).map(zigzag).collect::<Vec<_>>());
    let coarse = lane_of(&[[-1.0, 0.0], [3.0, 0.0]]);
    for (lane, count, kept) in [(&fine, 20, 2), (&fine, 3, 3), (&coarse, 20, 20)] {
        let (disc, own) = touching(count, |_| 1e-5);
        // Those before the first, and those of other discs, stay.
        let (_, before) = touching(3, |_| 0.0);
        let other = Contact::new(0, (0, -1), (Vector::new(1.3, 0.0), Vector::Y), 0.0);
        let mut contacts = [before.clone(), own, vec![other]].concat();
        thin_out(&mut contacts, before.len(), lane, &disc, 1e-4);
        let others = before.len() + usize::from(count > 0);
        let left = contacts.len() - others;
        if kept == count as usize {
            assert_eq!(left, kept, "of {count}");
        } else {
            assert!((kept..=6).contains(&left), "{left} of {count}");
        }
        assert!(contacts.iter().any(|c| (c.point.x - 1.3).abs() < 1e-12));
    }
}

/// If the disc moves in any direction as far as the remaining contacts allow, no other gap is smaller.
#[test]
fn the_contacts_that_are_left_keep_a_disc_out_of_all_the_others() {
    let far = 1e-4;
    for seed in 0..50 {
        let mut draw = crate::draw::Draw(20_270_401 + seed);
        let gaps: Vec<f64> = (0..30).map(|_| draw.between(-1e-5, 5e-5)).collect();
        let (_, all) = touching(30, |i| gaps[i as usize]);
        let left = reachable(all.clone(), far);
        assert!(left.len() < all.len());
        let least = |contacts: &[Contact], at: Vector| {
            let gaps = contacts.iter().map(|contact| gap_after(contact, at));
            gaps.fold(f64::INFINITY, f64::min)
        };
        for _ in 0..300 {
            let at = Vector::new(draw.between(-far, far), draw.between(-far, far));
            let found = deepest(&all, at).map(|contact| gap_after(&contact, at));
            assert_eq!(found, Some(least(&all, at)));
            if least(&left, at) >= 0.0 {
                assert!(least(&all, at) > -STRAIGHT.value() - 1e-15, "{at}");
            }
        }
    }
}

/// A square of 2 m, cut half a metre to the left of its middle and then below its middle.
#[test]
fn a_contact_cuts_the_displacements_that_would_close_it() {
    let mut range = Displacements::around(1.0);
    let contact = |normal: Vector, gap: f64| Contact::new(0, (0, -1), (Vector::ZERO, normal), gap);
    range.cut(&contact(Vector::X, 0.5));
    let corners = |range: &Displacements| -> Vec<[f64; 2]> {
        range.corners.iter().map(|c| [c.at.x, c.at.y]).collect()
    };
    assert_eq!(
        corners(&range),
        [[1.0, 1.0], [-0.5, 1.0], [-0.5, -1.0], [1.0, -1.0]]
    );
    range.corners[0].is_checked = true;
    range.cut(&contact(Vector::Y, 0.0));
    assert_eq!(
        corners(&range),
        [[1.0, 1.0], [-0.5, 1.0], [-0.5, 0.0], [1.0, 0.0]]
    );
    let checked: Vec<bool> = range.corners.iter().map(|c| c.is_checked).collect();
    assert_eq!(checked, [true, false, false, false]);
    range.cut(&contact(Vector::Y, 0.5));
    assert_eq!(range.corners.len(), 4);
    range.cut(&contact(Vector::NEG_Y, -0.5));
    assert!(range.corners.is_empty());
}

/// In numbers without rounding; otherwise two equally long ways out would yield to each other.
#[test]
fn a_way_out_yields_to_a_shorter_one_and_not_to_one_as_long() {
    let lane = block(1.0);
    let touch = lane.corner(1).touch(1, Vector::Y, -0.25);
    for (normal, depth, is_open, yields) in [
        (Vector::X, 0.125, true, true),
        (Vector::X, 0.25, true, false),
        (Vector::X, 0.5, true, false),
        (Vector::X, 0.0, true, false),
        (Vector::X, -0.125, true, false),
        (Vector::X, 0.125, false, false),
        // 15 degrees from its own normal, and 25 degrees.
        (direction(75.0_f64.to_radians()), 0.125, true, false),
        (direction(65.0_f64.to_radians()), 0.125, true, true),
    ] {
        let found = shorter(&touch, normal, depth, || is_open);
        assert_eq!(found, yields, "{normal} {depth} m");
    }
    for (depth, apart, is_it) in [
        (-2e-9, 1.0, true),
        (-0.5e-9, 1.0, false),
        (-2e-9, 4.0, false),
    ] {
        assert_eq!(is_gap(depth, apart), is_it, "{depth} m of {apart} m");
    }
}

/// Within the disc its pieces are as long as a centimetre, and beyond it by as much as it may move half a millimetre.
#[test]
fn contacts_are_thinned_out_where_ground_is_fine_that_the_disc_may_come_to() {
    let mut points = vec![];
    let mut x = 0.85;
    while x < 1.15 {
        points.push([x, 1e-4 * f64::from(points.len() as u32 % 2)]);
        let is_far = (x - 1.0_f64).abs() > 0.05;
        x += if is_far { 5e-4 } else { 0.01 };
    }
    let lane = lane_of(&points);
    let (disc, mut contacts) = touching(20, |_| 1e-5);
    assert!(!lane.is_fine(disc.center, 0.05));
    thin_out(&mut contacts, 0, &lane, &disc, 0.05);
    assert!(contacts.len() < 20);
}
