//! A robot on two wheels that drives against a wall: its loads follow from levers.

use super::*;

/// [m] Radius of the wheels, and their distances from the centre of mass, which is 0.07 m over the axles.
const RADIUS: f64 = 0.05;
const REAR: f64 = 0.2;
const FRONT: f64 = 0.3;
/// [m] Where the wall is if the chassis frame is at x = 0.
const WALL: f64 = FRONT + RADIUS;

const AT: Posture = Posture {
    position: Vector::new(0.0, RADIUS),
    angle: 0.0,
};

fn wheels() -> [Disc; 2] {
    [-REAR, FRONT].map(|x| Disc {
        center: Vector::new(x, 0.0),
        radius: RADIUS,
    })
}

/// The floor from `begin` [m] on and a wall of a height [m].
fn ground(begin: f64, height: f64, friction: f64) -> Vec<Place> {
    let face = |ends: [[f64; 2]; 2], normal| {
        let ends = ends.map(Vector::from);
        place(Facing::Face { ends, normal }, friction)
    };
    vec![
        face([[begin, 0.0], [WALL, 0.0]], Vector::Y),
        face([[WALL, 0.0], [WALL, height]], Vector::NEG_X),
    ]
}

fn robot(grip: Grip, limit: f64) -> Layout {
    let of = |(part, disc): (usize, Disc)| Surface {
        part,
        friction_limit: limit,
        ..surface(Outline::Round(disc), grip)
    };
    Layout {
        center_of_mass: Vector::new(0.0, 0.07),
        reach: WALL,
        surfaces: wheels().into_iter().enumerate().map(of).collect(),
        solids: wheels().map(|disc| Solid::new(0, vec![disc])).to_vec(),
    }
}

fn standing(layout: Layout, places: Vec<Place>, angles: [f64; 2]) -> Setting {
    Setting::new(layout, places, angles, &Cancel::default()).expect("there are few contacts")
}

/// Of the wheels and the faces, in the order of the contacts.
fn pairs(setting: &Setting, contacts: &[usize]) -> Vec<(usize, usize)> {
    let of = |i: &usize| (setting.contacts[*i].surface, setting.contacts[*i].place);
    contacts.iter().map(of).collect()
}

/// The floor pushes it forwards with the friction f of 1 / (1 + f^2) of its weight, and the wall bears as much and
/// pushes the front wheel up. About the rear wheel's contact, the front one bears nothing from f^2 (FRONT + RADIUS) +
/// f RADIUS = REAR on: from 0.68787 on.
#[test]
fn a_robot_stands_at_a_wall_until_its_friction_lifts_its_nose() {
    let most = (-RADIUS + (RADIUS * RADIUS + 4.0 * WALL * REAR).sqrt()) / (2.0 * WALL);
    for (grip, limit, up_to, expected) in [
        (Grip::Driven(1.0), 2.0, 2.0, vec![[0.0, most]]),
        // Neither its own friction nor that of the ground matters.
        (Grip::Driven(1.0), 0.1, 0.6, vec![[0.0, 0.6]]),
        // Backwards, it drives away from the wall, which cannot pull.
        (Grip::Driven(-1.0), 2.0, 2.0, vec![]),
    ] {
        let places = ground(-1.0, 1.0, 0.3);
        let setting = standing(robot(grip, limit), places, [-1.2, 1.2]).with_unit_friction();
        let contacts = setting.touching(&AT).expect("it overlaps with nothing");
        assert_eq!(pairs(&setting, &contacts), [(0, 0), (1, 0), (1, 1)]);
        let found = setting.carried_at(&contacts, &AT, up_to);
        assert_eq!(found.len(), expected.len(), "{grip:?}: {found:?}");
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            // Zeros are known to 1e-14 of the range.
            assert!((found - expected).abs() < 1e-12, "{grip:?}: {found}");
        }
    }
}

/// With a friction of 0.5, 1 / 1.25 of the weight is on the floor and half of that on the wall.
#[test]
fn the_loads_of_a_robot_at_a_wall_are_those_of_its_levers() {
    let at = |friction: f64| {
        let setting = standing(
            robot(Grip::Driven(1.0), 2.0),
            ground(-1.0, 1.0, friction),
            [-1.2, 1.2],
        );
        let contacts = setting.touching(&AT).expect("it overlaps with nothing");
        let loads = setting.loads(&contacts, &AT)?;
        Some(setting.jam(&AT, &contacts, &loads))
    };
    let jam = at(0.5).expect("it stands");
    let expected = [
        (0, Vector::new(-REAR, 0.0), Vector::Y, 0.66),
        (1, Vector::new(FRONT, 0.0), Vector::Y, 0.14),
        (1, Vector::new(WALL, RADIUS), Vector::NEG_X, 0.4),
    ];
    assert_eq!((jam.position, jam.angle), (AT.position, AT.angle));
    assert_eq!(jam.contacts.len(), expected.len());
    for (found, (part, point, normal, load)) in jam.contacts.iter().zip(expected) {
        assert_eq!((found.part, found.edge), (part, None));
        assert_eq!(found.kind, BodyKind::Wheel);
        assert!((found.point - point).length() < 1e-15 && found.normal == normal);
        assert!((found.load - load).abs() < 1e-12, "{found:?}");
        assert!((found.friction - 0.5 * load).abs() < 1e-12, "{found:?}");
    }
    assert!(at(0.687).is_some() && at(0.689).is_none());
}

#[test]
fn a_pose_on_three_contacts_is_found_where_all_of_them_are() {
    let found = |layout: Layout, places: Vec<Place>, angles: [f64; 2]| {
        let setting = standing(layout, places, angles);
        setting
            .fixed(&Cancel::default())
            .expect("nobody asks it to end")
    };
    let free = || robot(Grip::Free, 1.0);
    let near = [-1.2, 1.2];
    let one = found(free(), ground(-1.0, 1.0, 0.5), near);
    let [posture] = one[..] else {
        panic!("{one:?}");
    };
    assert!((posture.position - AT.position).length() < 1e-9 && posture.angle.abs() < 1e-9);
    // The floor begins ahead of the rear wheel, the wall ends under the front axle, or it is too steep.
    assert!(found(free(), ground(-0.1, 1.0, 0.5), near).is_empty());
    assert!(found(free(), ground(-1.0, 0.04, 0.5), near).is_empty());
    assert!(found(free(), ground(-1.0, 1.0, 0.5), [0.1, 1.2]).is_empty());
    // Something on it is in the floor.
    let mut low = free();
    low.solids.push(Solid::new(
        0,
        vec![Disc {
            center: Vector::new(0.0, -0.02),
            radius: RADIUS,
        }],
    ));
    assert!(found(low, ground(-1.0, 1.0, 0.5), near).is_empty());
}

#[test]
fn a_robot_touches_nothing_in_the_air_and_in_the_ground_there_is_no_answer() {
    let setting = standing(robot(Grip::Free, 1.0), ground(-1.0, 1.0, 0.5), [-1.2, 1.2]);
    let touching = |x: f64, y: f64| {
        let position = AT.position + Vector::new(x, y);
        let found = setting.touching(&Posture { position, ..AT });
        found.map(|contacts| pairs(&setting, &contacts))
    };
    let on = |pairs: &[(usize, usize)]| Some(pairs.to_vec());
    assert_eq!(touching(-0.1, 0.1), on(&[]));
    assert_eq!(touching(-0.1, 0.0), on(&[(0, 0), (1, 0)]));
    assert_eq!(touching(0.0, 0.1), on(&[(1, 1)]));
    assert_eq!(touching(-0.1, -1e-6), None);
    assert_eq!(touching(1e-6, 0.0), None);
    // A tenth of a nanometre is no gap, and 2 nm are one.
    assert_eq!(touching(-0.1, 1e-10), on(&[(0, 0), (1, 0)]));
    assert_eq!(touching(-0.1, 2e-9), on(&[]));
}

#[test]
fn ground_of_too_many_pieces_is_refused_with_their_number() {
    let places = ground(-1.0, 1.0, 0.5).repeat(5_001);
    let refused = Setting::new(
        robot(Grip::Free, 1.0),
        places,
        [-1.2, 1.2],
        &Cancel::default(),
    );
    let error = refused.expect_err("they make 20,004 contacts").to_string();
    let expected = "terrain must have fewer faces and corners: with those of the robot they make 20004 contacts, and \
                    at most 20000 are searched, got 10002 faces and corners";
    assert_eq!(error, expected);
}

#[test]
fn a_search_that_is_asked_to_end_finds_nothing() {
    let cancel = Cancel::default();
    let setting = standing(robot(Grip::Free, 1.0), ground(-1.0, 1.0, 0.5), [-1.2, 1.2]);
    cancel.ask();
    assert!(setting.fixed(&cancel).is_err() && setting.leaning(&cancel).is_err());
}
