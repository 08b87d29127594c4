//! Contacts that one part makes from step to step, and the numbers that they get.

use super::*;
use crate::draw::Draw;
use crate::dynamics::tests::{engineer, setup};
use crate::geometry::{Vector, direction};
use crate::terrain::Ground;

/// [s] Length of a step.
const STEP: f64 = 0.001;

/// A contact of a part with level ground at x [m].
fn at(part: usize, x: f64) -> Contact {
    Contact::new(part, (0, -1), (Vector::new(x, 0.0), Vector::Y), 0.0)
}

/// A robot's steps, with contacts made up by a test.
#[derive(Default)]
struct Steps {
    identity: Identity,
    last: Vec<Contact>,
}

impl Steps {
    /// Takes a step with these contacts, sorted by part and x; returns their numbers.
    fn step(&mut self, contacts: &[Contact]) -> Vec<u64> {
        let mut contacts = contacts.to_vec();
        self.identity.recognise(&self.last, &mut contacts, 0.0);
        self.identity.keep(&self.last, STEP);
        self.last.clone_from(&contacts);
        contacts.iter().map(|contact| contact.number).collect()
    }

    /// Takes steps without contacts for a time [s].
    fn lift(&mut self, time: f64) {
        for _ in 0..(time / STEP).round() as u32 {
            self.step(&[]);
        }
    }
}

#[test]
fn a_contact_keeps_its_number_from_facet_to_facet() {
    let mut steps = Steps::default();
    for i in 0..1000 {
        let mut contact = at(0, f64::from(i) * 4e-4);
        (contact.facet, contact.edge) = (i as usize / 10, if i % 10 == 0 { i / 10 } else { -1 });
        assert_eq!(steps.step(&[contact]), [1], "at {}", contact.point.x);
    }
}

#[test]
fn a_contact_that_rattles_gets_its_number_back() {
    let mut steps = Steps::default();
    assert_eq!(steps.step(&[at(0, 0.0), at(0, 0.1)]), [1, 2]);
    for _ in 0..5 {
        steps.lift(0.99);
        assert_eq!(steps.step(&[at(0, 0.1004)]), [2]);
        // The second one was open longer than contacts are remembered; a place beside it would be another contact.
        steps.lift(0.02);
        assert_eq!(steps.step(&[at(0, 0.1004)]), [2]);
    }
    assert_eq!(steps.step(&[at(0, 0.0), at(0, 0.1)]), [3, 2]);
    steps.lift(1.01);
    assert_eq!(steps.step(&[at(0, 0.1)]), [4], "after a second it is anew");
}

#[test]
fn a_contact_that_comes_down_beside_another_does_not_take_its_number() {
    for other in [0.001, 0.007] {
        let mut steps = Steps::default();
        assert_eq!(steps.step(&[at(0, 0.004)]), [1]);
        let both = if other < 0.004 { [2, 1] } else { [1, 2] };
        let mut places = [0.0041, other];
        places.sort_by(f64::total_cmp);
        assert_eq!(steps.step(&places.map(|x| at(0, x))), both);
    }
}

#[test]
fn a_contact_comes_back_to_its_place_and_its_part_alone() {
    let back = |contact: Contact| {
        let mut steps = Steps::default();
        steps.step(&[at(1, 0.0)]);
        steps.lift(0.01);
        steps.step(&[contact]) == [1]
    };
    assert!(back(at(1, 0.0049)));
    assert!(!back(at(1, 0.0051)));
    assert!(!back(at(0, 0.0)));
    let turned = |angle: f64| Contact {
        normal: direction(angle),
        ..at(1, 0.0)
    };
    // Normals belong to one contact up to acos(0.9), 25.8 degrees.
    assert!(back(turned(65_f64.to_radians())));
    assert!(!back(turned(64_f64.to_radians())));
}

#[test]
fn teeth_of_a_wheel_that_spins_on_the_spot_are_two_contacts() {
    // Each tooth stays on the ground for 24 mm, and the next comes down 16 mm behind it.
    let mut steps = Steps::default();
    let mut seen = Vec::new();
    for i in 0..2000_u32 {
        let way = f64::from(i) * 4e-4;
        let places = [way % 0.016, way % 0.016 + 0.016];
        let teeth = places.into_iter().filter(|x| *x < 0.024);
        let teeth: Vec<Contact> = teeth.map(|x| at(0, x)).collect();
        seen.extend(steps.step(&teeth));
    }
    seen.sort_unstable();
    seen.dedup();
    // The first step finds a tooth that is half-way already.
    assert_eq!(seen, [1, 2, 3]);
}

#[test]
fn two_contacts_of_one_part_never_share_a_number() {
    let mut draw = Draw(1);
    let mut steps = Steps::default();
    let mut part_of = std::collections::HashMap::new();
    let (mut kept, mut most) = (0, 0);
    for _ in 0..5000 {
        let mut contacts: Vec<Contact> = (0..draw.below(12))
            .map(|_| Contact {
                normal: direction(draw.between(1.0, 2.1)),
                ..at(draw.below(2), draw.between(0.0, 0.05))
            })
            .collect();
        contacts.sort_by(|a, b| {
            (a.part, a.point.x)
                .partial_cmp(&(b.part, b.point.x))
                .unwrap()
        });
        let numbers = steps.step(&contacts);
        for (contact, number) in contacts.iter().zip(&numbers) {
            let of = *part_of.entry(*number).or_insert(contact.part);
            assert_eq!(of, contact.part);
            kept += 1;
        }
        let lost = steps.identity.lost.iter().map(|lost| lost.contact.number);
        let mut all: Vec<u64> = numbers.iter().copied().chain(lost).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        assert!(all[0] > 0);
        most = most.max(steps.identity.lost.len());
    }
    assert!(part_of.len() < kept / 10, "most are recognised");
    assert!(most > 10, "{most}");
}

#[test]
fn of_two_contacts_that_move_on_each_keeps_its_own_number() {
    let mut steps = Steps::default();
    for i in 0..100 {
        let x = f64::from(i) * 3e-4;
        assert_eq!(steps.step(&[at(0, x), at(0, x + 0.001)]), [1, 2]);
    }
    // They merge into one with the number of the nearer, and separate again.
    assert_eq!(steps.step(&[at(0, 0.0308)]), [2]);
    let mut both = steps.step(&[at(0, 0.0301), at(0, 0.0309)]);
    both.sort_unstable();
    assert_eq!(both, [1, 2]);
}

#[test]
fn a_contact_that_comes_back_starts_without_its_forces() {
    let loaded = |x: f64, number: u64| Contact {
        number,
        normal_guess: number as f64,
        ..at(0, x)
    };
    let last = [loaded(0.0, 7), loaded(0.1, 3), loaded(0.2, 5)];
    let mut numbered = Numbered::new(&last);
    let guesses = [3, 5, 4, 7, 3].map(|number| numbered.get(number).map(|l| l.normal_guess));
    assert_eq!(guesses, [Some(3.0), Some(5.0), None, Some(7.0), Some(3.0)]);
}

#[test]
fn contacts_that_open_by_the_thousand_are_not_all_remembered() {
    let mut steps = Steps::default();
    for i in 0..1000 {
        steps.step(&[at(0, f64::from(i)), at(0, f64::from(i) + 0.5)]);
    }
    assert_eq!(steps.identity.lost.len(), MOST_LOST);
    // The oldest are forgotten first.
    assert_eq!(steps.step(&[at(0, 990.0)]), [1981]);
    assert_eq!(steps.step(&[at(0, 800.0)]), [2001]);
}

#[test]
fn numbers_that_no_step_gave_do_not_fit() {
    type Spoil = fn(&mut Identity, &mut Vec<Contact>);

    let ground = Ground::new(&engineer().terrain, engineer().robot.gauge).expect("a ground");
    let (dynamics, _) = setup(|_| {});
    let fits = |spoil: Spoil| {
        let mut steps = Steps::default();
        steps.step(&[at(0, 0.0), at(0, 0.1), at(0, 0.2)]);
        steps.step(&[at(0, 0.0), at(0, 0.1)]);
        spoil(&mut steps.identity, &mut steps.last);
        let mut impulses = dynamics.impulses();
        (impulses.identity, impulses.contacts) = (steps.identity, steps.last);
        dynamics.fits(&impulses, &ground.lanes)
    };
    assert!(fits(|_, _| {}));
    let all: [(&str, Spoil); 11] = [
        ("not numbered", |_, last| last[0].number = 0),
        ("one that was not given", |_, last| {
            last[0].number = 4;
        }),
        ("twice", |_, last| last[0].number = 2),
        ("one that is lost", |_, last| last[0].number = 3),
        ("too few given", |identity, _| identity.given = 2),
        ("too many given", |identity, _| identity.given = u64::MAX),
        ("of no time", |identity, _| {
            identity.lost[0].opened = f64::NAN;
        }),
        ("of the future", |identity, _| {
            identity.lost[0].opened = identity.time + STEP;
        }),
        ("of long ago", |identity, _| {
            identity.lost[0].opened = identity.time - REMEMBERED.value();
        }),
        ("after steps of no duration", |identity, _| {
            (identity.time, identity.lost) = (f64::NAN, Vec::new());
        }),
        ("of nobody", |identity, _| {
            identity.lost[0].contact.part = 999;
        }),
    ];
    for (what, spoil) in all {
        assert!(!fits(spoil), "{what}");
    }
    assert!(!fits(|identity, _| {
        let mut later = identity.lost[0];
        (later.contact.number, later.opened) = (4, 0.0);
        identity.lost.push(later);
        identity.given = 4;
    }));
    assert!(!fits(|identity, _| {
        let lost = identity.lost[0];
        let all = (10..).take(MOST_LOST + 1).map(|number| Lost {
            contact: Contact {
                number,
                ..lost.contact
            },
            opened: identity.time,
        });
        identity.lost = all.collect();
        identity.given = 1000;
    }));
}
