//! Parts that do not touch the ground.

use std::f64::consts::TAU;

use super::super::OwnContact;
use super::judge::Approach;
use super::outlines::driven;
use super::scene::Scene;
use crate::contact::Contact;
use crate::draw::{Draw, cases};
use crate::geometry::{Disc, Pose, Vector, cross, left_of};
use crate::robot::{Running, Shape};
use crate::scenario::Surface;
use crate::terrain::Profile;

/// [m] Tolerance of the comparison.
const SAME: f64 = 1e-9;

/// [m] The smallest gap of a place after any displacement of the part, by up to `far` along x and y, that closes
/// no gap of the contacts: at a corner of the range of these displacements.
fn reached(approach: &Approach, contacts: &[Contact], far: f64) -> f64 {
    let sides = [Vector::X, -Vector::X, Vector::Y, -Vector::Y].map(|normal| (normal, far));
    let gaps = contacts.iter().map(|c| (c.normal, c.distance));
    let gaps: Vec<(Vector, f64)> = sides.into_iter().chain(gaps).collect();
    let crossing = |(m, a): (Vector, f64), (n, b): (Vector, f64)| {
        let turn = cross(m, n);
        let at = Vector::new(b * m.y - a * n.y, a * n.x - b * m.x) / turn;
        (turn.abs() > 1e-12).then_some(at)
    };
    let is_open = |at: &Vector| gaps.iter().all(|(n, gap)| n.dot(*at) + gap > -1e-12);
    let pairs = (0..gaps.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let corners = pairs.filter_map(|(i, j)| crossing(gaps[i], gaps[j]).filter(is_open));
    let at_corner = |at: Vector| approach.distance() + approach.normal().dot(at);
    corners.map(at_corner).fold(f64::INFINITY, f64::min)
}

/// Whether the place is a contact; or other contacts keep the part off it on finely divided ground; or it lies between
/// two others with the same normal and is no nearer than these.
fn is_reported(approach: &Approach, contacts: &[Contact], scene: &Scene, prediction: f64) -> bool {
    let [p, q] = approach.ends;
    let (middle, distance) = (0.5 * (p + q), approach.distance());
    // If the gap is mere rounding, so is its direction; contacts count as parallel up to 1.4e-6 rad.
    let alike = |c: &&Contact| distance < 1e-6 || (c.normal - approach.normal()).length() < 3e-6;
    let alike: Vec<&Contact> = contacts.iter().filter(alike).collect();
    let is_it =
        |c: &Contact| (c.distance - distance).abs() < SAME && (c.point - middle).length() < 1e-6;
    let makes_up = |a: &Contact, b: &Contact| {
        let along = left_of(approach.normal());
        let share = (middle - a.point).dot(along) / (b.point - a.point).dot(along);
        let chord = a.distance + (b.distance - a.distance) * share;
        (0.0..=1.0).contains(&share) && distance > chord - scene.unreported()
    };
    let is_fine = scene.ground.curves.len() > 16;
    alike.iter().any(|c| is_it(c))
        || (is_fine && reached(approach, contacts, prediction) > -2.6e-7)
        || alike.iter().any(|a| {
            alike
                .iter()
                .any(|b| !std::ptr::eq(*a, *b) && makes_up(a, b))
        })
}

#[test]
fn every_nearest_place_within_the_prediction_is_a_contact_and_none_is_nearer() {
    const SEED: u64 = 20_270_114;
    let mut draw = Draw(SEED);
    let (mut places, mut within) = (0, 0);
    let count = cases(5_000, 1_000_000);
    for number in 0..count {
        let mut scene = Scene::random(number, &mut draw);
        let gap = draw.size(1e-6, 20e-3);
        scene.approach(gap);
        // Often only just enough, sometimes too little.
        let just = draw.chance(0.3);
        let ahead = if just {
            draw.size(2e-9, 1e-6)
        } else {
            gap * draw.between(-0.2, 3.0)
        };
        let prediction = gap + ahead;
        let judge = scene.judge(1.5 * prediction.max(gap));
        assert!(judge.is_clear(), "{}", scene.describe());
        let contacts = scene.contacts(prediction);
        let least = judge.nearest(1.0).map_or(f64::INFINITY, |a| a.distance());
        let told = contacts
            .iter()
            .map(|c| c.distance)
            .fold(f64::INFINITY, f64::min);
        assert!(
            told > least - SAME,
            "{told}, not {least} {contacts:?} {}",
            scene.describe()
        );
        let approaches = judge.approaches(prediction - SAME);
        for approach in &approaches {
            assert!(
                is_reported(approach, &contacts, &scene, prediction),
                "{approach:?} {prediction} {contacts:?} {}",
                scene.describe()
            );
        }
        places += approaches.len();
        within += usize::from(least < prediction);
    }
    println!("seed {SEED}: {count} poses, {within} within the prediction, {places} places");
    assert!(within > count / 2);
}

#[test]
fn a_rounded_edge_is_a_true_arc() {
    const SEED: u64 = 20_270_118;
    let mut draw = Draw(SEED);
    for _ in 0..10_000 {
        let (edge_radius, radius) = (draw.size(0.5e-3, 20e-3), draw.size(1e-3, 0.12));
        let corners = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
        let profile = Profile::new(
            "terrain",
            &corners,
            Surface::rounded(edge_radius, 0.9),
            true,
        )
        .unwrap();
        let part = driven(Shape::Disc {
            center: Vector::ZERO,
            radius,
        });
        let contact = OwnContact::new(&[part], &[profile]);
        let angle = draw.between(0.25, 0.5) * TAU;
        let outward = Vector::new(angle.cos(), angle.sin());
        let middle = Vector::new(edge_radius, 0.1 - edge_radius);
        let gap = draw.between(-1e-4, 1e-3);
        let pose = Pose::from_translation(middle + outward * (edge_radius + radius + gap));
        let mut contacts = Vec::new();
        let running = Running {
            drives: vec![0.0],
            ..Running::default()
        };
        contact.find(pose, &running, 2e-3, &mut contacts);
        let is_it =
            |c: &Contact| (c.distance - gap).abs() < 1e-12 && (c.normal - outward).length() < 1e-9;
        assert!(
            contacts.iter().any(is_it),
            "{edge_radius} {radius} {angle} {gap} {contacts:?}"
        );
    }
}

#[test]
fn a_part_on_rough_ground_has_few_contacts_however_finely_it_is_cut() {
    let mut draw = Draw(20_270_122);
    let disc = Shape::Disc {
        center: Vector::ZERO,
        radius: 0.064,
    };
    let ends = [-0.18, 0.18].map(|x| Disc {
        center: Vector::new(x, 0.0),
        radius: 0.064,
    });
    for jitter in [1e-6, 1e-5, 1e-4] {
        let mut point = |i: u32| [1e-5 * f64::from(i) - 0.3, draw.between(-jitter, jitter)];
        let corners: Vec<[f64; 2]> = (0..60_000).map(&mut point).collect();
        let profile = Profile::new("terrain", &corners, Surface::sharp(0.9), true).unwrap();
        for shape in [
            disc.clone(),
            Shape::Hull {
                discs: ends.to_vec(),
                grouser_height: 0.0,
            },
        ] {
            let contact = OwnContact::new(&[driven(shape)], std::slice::from_ref(&profile));
            for prediction in [2e-4, 1e-3, 6e-3] {
                for _ in 0..20 {
                    let place = Vector::new(draw.between(-0.01, 0.01), 0.064 + jitter);
                    let running = Running {
                        drives: vec![0.0],
                        ..Running::default()
                    };
                    let mut contacts = Vec::new();
                    let pose = Pose::from_translation(place);
                    contact.find(pose, &running, prediction, &mut contacts);
                    assert!(
                        (1..=60).contains(&contacts.len()),
                        "{jitter} {prediction}: {}",
                        contacts.len()
                    );
                }
            }
        }
    }
}
