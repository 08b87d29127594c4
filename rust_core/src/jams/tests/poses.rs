//! Poses that contacts fix are found: a robot made to touch and to balance in a pose is found there.

use super::*;
use crate::jams::fixed::{meet, solve};
use crate::jams::setting::{TOUCHING, is_same};

fn is_near(one: &Posture, other: &Posture) -> bool {
    (one.position - other.position).length() < 1e-7 && (one.angle - other.angle).abs() < 1e-7
}

#[test]
fn three_equations_are_solved_unless_they_are_one() {
    let mut draw = Draw(1);
    for _ in 0..200 {
        let rows: [[f64; 3]; 3] =
            std::array::from_fn(|_| std::array::from_fn(|_| draw.between(-1.0, 1.0)));
        let expected: [f64; 3] = std::array::from_fn(|_| draw.between(-1.0, 1.0));
        let right = rows.map(|row| (0..3).map(|i| row[i] * expected[i]).sum());
        let found = solve(&rows, &right).expect("they are three");
        for (a, b) in found.iter().zip(expected) {
            // Determinants of drawn rows may be as small as 1e-4.
            assert!((a - b).abs() < 1e-9, "{rows:?}");
        }
    }
    assert_eq!(solve(&[[1.0, 2.0, 3.0]; 3], &[1.0; 3]), None);
}

/// Normals and kinds are drawn; a pose in which gradients of the gaps are nearly in one plane is passed over.
#[test]
fn the_pose_in_which_three_surfaces_were_made_to_touch_is_found() {
    let mut draw = Draw(2);
    let mut tried = 0;
    for case in 0..400 {
        let at = posture(&mut draw);
        let normals = [0.0; 3].map(|_| unit(&mut draw));
        let kinds = [case, case / 3, case / 9].map(|k| PAIRS[k % 3]);
        let pieces: Vec<_> = (kinds.iter().zip(normals))
            .map(|(pair, normal)| touching(&mut draw, *pair, &at, normal))
            .collect();
        let surfaces = pieces.iter().map(|p| surface(p.0, Grip::Free)).collect();
        let places = pieces.iter().map(|p| place(p.1, 0.5)).collect();
        let setting = setting(surfaces, places, Vector::ZERO);
        let three = [0, 1, 2].map(|k| setting.contacts[contact_of(&setting, k)]);
        let rows = three.map(|contact| {
            let touch = contact.touch(&at);
            assert!(touch.gap.abs() < 1e-15);
            Contact::gradient(&touch, at.position)
        });
        let [a, b, c] = rows;
        let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        if volume.abs() < 1e-2 {
            continue;
        }
        tried += 1;
        let mut found = Vec::new();
        meet(&three, std::iter::once([-1.3, 1.3]), &mut found);
        assert!(
            found.iter().any(|(_, posture)| is_near(posture, &at)),
            "case {case}: {kinds:?} {at:?}"
        );
        for (_, posture) in &found {
            let gaps = three.map(|contact| contact.touch(posture).gap.abs());
            assert!(
                gaps.iter().all(|gap| *gap < TOUCHING.value()),
                "case {case}"
            );
        }
        // And any two of them can occur together at that angle.
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let both = [i, j].map(|k| contact_of(&setting, k));
            let bins = setting.together(both[0].min(both[1]), both[0].max(both[1]));
            let mut ranges = setting.bins.ranges(bins);
            assert!(
                ranges.any(|[low, high]| (low..=high).contains(&at.angle)),
                "case {case}"
            );
        }
    }
    assert!(tried > 150, "{tried}");
}

/// Discs on two faces that are parallel: the turn follows from their distance.
#[test]
fn the_pose_between_two_parallel_faces_is_found() {
    let mut draw = Draw(3);
    for case in 0..100 {
        let at = posture(&mut draw);
        let normal = unit(&mut draw);
        let across = if case % 2 == 0 { normal } else { -normal };
        let third = Vector::from_angle(draw.between(0.5, 2.5)).rotate(normal);
        let pieces = [
            touching(&mut draw, Pair::OnFace, &at, normal),
            touching(&mut draw, Pair::OnFace, &at, across),
            touching(&mut draw, PAIRS[case % 3], &at, third),
        ];
        let surfaces = pieces.iter().map(|p| surface(p.0, Grip::Free)).collect();
        let places = pieces.iter().map(|p| place(p.1, 0.5)).collect();
        let setting = setting(surfaces, places, Vector::ZERO);
        let three = [0, 1, 2].map(|k| setting.contacts[contact_of(&setting, k)]);
        let levers = [0, 1].map(|k| {
            let touch = three[k].touch(&at);
            cross(touch.point - at.position, normal)
        });
        if (levers[0] - levers[1]).abs() < 0.02 {
            continue;
        }
        let mut found = Vec::new();
        meet(&three, std::iter::once([-1.3, 1.3]), &mut found);
        assert!(
            found.iter().any(|(_, posture)| is_near(posture, &at)),
            "case {case}"
        );
    }
}

/// Whether a robot whose two surfaces touch two places in a pose is found to stand in it.
fn is_found(
    pieces: &[(Outline, Facing, Vector)],
    (grips, frictions): ([Grip; 2], [f64; 2]),
    center_of_mass: Vector,
    at: &Posture,
) -> bool {
    let surfaces = pieces.iter().zip(grips).map(|(p, grip)| surface(p.0, grip));
    let places = pieces.iter().zip(frictions).map(|(p, mu)| place(p.1, mu));
    let setting = setting(surfaces.collect(), places.collect(), center_of_mass);
    let found = setting.leaning(&Cancel::default());
    let found = found.expect("nobody asks it to end");
    found.iter().any(|posture| is_near(posture, at))
}

#[test]
fn the_pose_in_which_two_forces_were_made_to_carry_the_weight_is_found() {
    let mut draw = Draw(4);
    let mut tried = 0;
    for case in 0..300 {
        let Some(Standing { at, kinds, setting }) = on_two(&mut draw, case) else {
            continue;
        };
        tried += 1;
        let found = setting.leaning(&Cancel::default());
        let found = found.expect("nobody asks it to end");
        assert!(
            found.iter().any(|posture| is_near(posture, &at)),
            "case {case}: {kinds:?} {at:?}"
        );
    }
    assert!(tried > 80, "{tried}");
}

/// Friction leans the force by its angle from the normal. It is vertical, and the centre of mass is put on its line.
#[test]
fn the_pose_in_which_one_force_was_made_to_carry_the_weight_is_found() {
    let mut draw = Draw(5);
    let cancel = Cancel::default();
    for case in 0..100 {
        let at = posture(&mut draw);
        let friction = draw.between(0.2, 0.9);
        let (grip, slope) = [
            (Grip::Driven(1.0), friction),
            (Grip::Driven(-1.0), -friction),
            (Grip::Still, friction),
            (Grip::Still, -friction),
        ][case / 2 % 4];
        let normal = Vector::new(-slope, 1.0).normalize();
        let pair = [Pair::OnCorner, Pair::Across][case % 2];
        let (shape, facing, point) = touching(&mut draw, pair, &at, normal);
        let over = Vector::new(point.x, at.position.y + draw.between(0.0, 0.2));
        let center_of_mass = Turn::by(-at.angle).apply(over - at.position);
        let setting = setting(
            vec![surface(shape, grip)],
            vec![place(facing, friction)],
            center_of_mass,
        );
        let found = setting.leaning(&cancel).expect("nobody asks it to end");
        assert!(
            found.iter().any(|posture| is_near(posture, &at)),
            "case {case}: {at:?}"
        );
        // Nothing is found at other angles.
        for off in [-0.3, 0.3] {
            let angles = [at.angle + off - 0.2, at.angle + off + 0.2];
            let (layout, places) = (setting.layout.clone(), setting.places.clone());
            let aside =
                Setting::new(layout, places, angles, &cancel).expect("there are few contacts");
            let found = aside.leaning(&cancel).expect("nobody asks it to end");
            assert!(
                found
                    .iter()
                    .all(|found| (angles[0]..=angles[1]).contains(&found.angle))
            );
        }
    }
}

/// Contacts of a disc on a face and on the corner at its end coincide there; two discs are two contacts of one face.
#[test]
fn contacts_that_come_together_are_one_and_others_are_not() {
    let radius = 0.05;
    let disc = |x: f64| {
        Outline::Round(Disc {
            center: Vector::new(x, 0.0),
            radius,
        })
    };
    let ends = [Vector::ZERO, Vector::X];
    let face = Facing::Face {
        ends,
        normal: Vector::Y,
    };
    let corner = |x: f64| Facing::Corner {
        center: Vector::new(x, 0.0),
        radius: 0.0,
        cone: [Vector::X, Vector::Y],
    };
    let surfaces = vec![
        surface(disc(0.0), Grip::Free),
        surface(disc(0.3), Grip::Free),
    ];
    let places = vec![
        place(face, 0.5),
        place(corner(1.0), 0.5),
        place(corner(0.6), 0.5),
    ];
    let setting = setting(surfaces, places, Vector::ZERO);
    let of = |surface: usize, place: usize| {
        let is_it = |c: &&Contact| (c.surface, c.place) == (surface, place);
        *setting.contacts.iter().find(is_it).expect("both can touch")
    };
    let is_one = |a: Contact, b: Contact| {
        assert_eq!(a.is_one_with(&b, 1e-9), b.is_one_with(&a, 1e-9));
        a.is_one_with(&b, 1e-9)
    };
    assert!(is_one(of(0, 0), of(0, 1)));
    assert!(!is_one(of(0, 0), of(1, 0)) && !is_one(of(0, 0), of(1, 1)));
    assert!(!is_one(of(0, 1), of(1, 1)) && !is_one(of(0, 1), of(0, 2)));
    assert!(matches!(of(0, 0).kind, Kind::OnFace(..)));
}

/// Two parallel straight runs cannot turn on two corners, only slide. Corners with different friction have forces that
/// meet.
#[test]
fn the_pose_of_two_parallel_runs_that_carry_the_weight_is_found() {
    let mut draw = Draw(6);
    let mut tried = 0;
    for case in 0..200 {
        let at = posture(&mut draw);
        let normal = Vector::from_angle(draw.between(1.0, 2.1));
        let normals = [normal, if case % 2 == 0 { normal } else { -normal }];
        let frictions = [draw.between(0.1, 0.4), draw.between(0.7, 1.0)];
        let pieces = normals.map(|normal| touching(&mut draw, Pair::Across, &at, normal));
        let forces = [0, 1].map(|k| normals[k] + right_of(normals[k]) * frictions[k]);
        let (p, q) = (pieces[0].2, pieces[1].2);
        let s = cross(q - p, forces[1]) / cross(forces[0], forces[1]);
        let over = Vector::new((p + forces[0] * s).x, at.position.y + 0.05);
        let center_of_mass = Turn::by(-at.angle).apply(over - at.position);
        // Where both corners are on one normal, a turn changes nothing at first.
        let levers = [p, q].map(|point| cross(point - at.position, normal));
        if center_of_mass.length() > 0.6 || (levers[0] - levers[1]).abs() < 0.05 {
            continue;
        }
        tried += 1;
        let grips = [Grip::Driven(1.0); 2];
        assert!(
            is_found(&pieces, (grips, frictions), center_of_mass, &at),
            "case {case}: {at:?}"
        );
    }
    assert!(tried > 50, "{tried}");
}

/// The same balance on a corner whose faces hide the point, on a face that ends before it, and at an angle that is not
/// searched.
#[test]
fn a_balance_on_what_is_not_there_is_none() {
    let cancel = Cancel::default();
    let disc = Disc {
        center: Vector::new(0.1, 0.0),
        radius: 0.05,
    };
    let center_of_mass = Vector::new(0.0, 0.1);
    let friction: f64 = 0.5;
    let up = Vector::new(-friction, 1.0).normalize();
    let turned = |angle: f64| Vector::from_angle(angle).rotate(up);
    let found = |cone: [f64; 2], angles: [f64; 2]| {
        let corner = Facing::Corner {
            center: Vector::ZERO,
            radius: 0.0,
            cone: cone.map(turned),
        };
        let layout = Layout {
            center_of_mass,
            reach: 1.0,
            surfaces: vec![surface(Outline::Round(disc), Grip::Driven(1.0))],
            solids: Vec::new(),
        };
        let places = vec![place(corner, friction)];
        let setting =
            Setting::new(layout, places, angles, &cancel).expect("there are few contacts");
        setting.leaning(&cancel).expect("nobody asks it to end")
    };
    let all = [-3.1, 3.1];
    let both = found([-0.5, 0.5], all);
    // Upright and hanging.
    assert_eq!(both.len(), 2);
    assert!(found([0.1, 0.5], all).is_empty() && found([-0.5, -0.1], all).is_empty());
    for posture in &both {
        let near = [posture.angle - 0.1, posture.angle + 0.1];
        assert_eq!(found([-0.5, 0.5], near), [*posture]);
        let beside = [posture.angle + 0.1, posture.angle + 0.2];
        assert!(found([-0.5, 0.5], beside).is_empty());
    }
}

/// A level run from 0.1 m to 0.5 m, on a tip under it.
#[test]
fn a_run_touches_a_tip_as_far_as_its_ends_and_a_tolerance_beyond() {
    let run = Outline::Flat {
        ends: [Vector::new(0.1, 0.0), Vector::new(0.5, 0.0)],
        outward: Vector::NEG_Y,
    };
    let tip = Facing::Corner {
        center: Vector::new(1.0, 2.0),
        radius: 0.0,
        cone: [Vector::new(0.6, 0.8), Vector::new(-0.6, 0.8)],
    };
    let places = vec![place(tip, 0.5)];
    let setting = setting(vec![surface(run, Grip::Free)], places, Vector::ZERO);
    let tolerance = 0.125;
    for (along, touches) in [
        (-0.13, false),
        (-0.12, true),
        (0.0, true),
        (0.4, true),
        (0.52, true),
        (0.53, false),
    ] {
        let at = Posture {
            position: Vector::new(1.0 - 0.1 - along, 2.0),
            angle: 0.0,
        };
        let contact = setting.contacts[0];
        let found = contact.is_real(&setting.layout, &setting.places, &at, tolerance);
        assert_eq!(found, touches, "{along} m");
    }
}

#[test]
fn poses_a_tenth_of_a_micrometre_apart_are_the_same() {
    let at = Posture {
        position: Vector::new(0.3, -0.2),
        angle: 0.4,
    };
    for (off, same) in [(0.5e-7, true), (2e-7, false)] {
        for way in [Vector::X, Vector::NEG_Y] {
            let moved = Posture {
                position: at.position + way * off,
                ..at
            };
            assert_eq!(is_same(&at, &moved), same);
        }
        for turn in [off, -off] {
            let turned = Posture {
                angle: at.angle + turn,
                ..at
            };
            assert_eq!(is_same(&at, &turned), same);
        }
    }
}

/// Wheels of one size on points as far apart as their axles: at one angle both circles are one, and both forces are vertical.
#[test]
fn the_pose_of_two_wheels_whose_circles_are_one_is_found() {
    let mut draw = Draw(7);
    for case in 0..40 {
        let at = posture(&mut draw);
        let friction = draw.between(0.1, 0.9);
        let up = Vector::new(-friction, 1.0).normalize();
        let radius = draw.between(0.02, 0.1);
        let axles = [Vector::new(-0.2, 0.01), Vector::new(0.15, -0.03)];
        let pieces = axles.map(|center| {
            let disc = Disc { center, radius };
            let point = at.position + Turn::by(at.angle).apply(center) - up * radius;
            let cone = [-0.8, 0.8].map(|angle| Vector::from_angle(angle).rotate(up));
            let facing = Facing::Corner {
                center: point,
                radius: 0.0,
                cone,
            };
            (Outline::Round(disc), facing, point)
        });
        let grips = ([Grip::Driven(1.0); 2], [friction; 2]);
        assert!(
            is_found(&pieces, grips, Vector::new(0.0, 0.05), &at),
            "case {case}: {at:?}"
        );
    }
}

/// Between wheels that touch, a sharp corner could only be a needle. With a gap between them it can touch both.
#[test]
fn a_corner_between_two_wheels_that_touch_is_one_contact() {
    let corner = Facing::Corner {
        center: Vector::new(0.6, 0.0),
        radius: 0.0,
        cone: [Vector::X, Vector::Y],
    };
    let is_one = |radii: [f64; 2], apart: f64| {
        let disc = |x: f64, radius: f64| {
            let center = Vector::new(x, 0.0);
            surface(Outline::Round(Disc { center, radius }), Grip::Free)
        };
        let surfaces = vec![disc(0.0, radii[0]), disc(apart, radii[1])];
        let setting = setting(surfaces, vec![place(corner, 0.5)], Vector::ZERO);
        let [one, other] = setting.contacts[..] else {
            panic!("each can touch it");
        };
        one.is_one_with(&other, 1e-9)
    };
    for radii in [[0.05, 0.05], [0.03, 0.08], [0.08, 0.03]] {
        let sum = radii[0] + radii[1];
        assert!(is_one(radii, sum) && !is_one(radii, sum + 1e-6));
        // Side by side they overlap, and a corner may touch both; one that lies within the other has it to itself.
        let difference = (radii[0] - radii[1]).abs();
        assert!(!is_one(radii, sum - 1e-6) && !is_one(radii, difference + 1e-6));
        assert!(is_one(radii, 0.5 * difference));
    }
}
