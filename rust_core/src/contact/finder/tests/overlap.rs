//! Parts that overlap the ground.

use super::super::OwnContact;
use super::curve::Curve;
use super::grounds::{Ground, largest_radius};
use super::judge::Judge;
use super::scene::Scene;
use crate::contact::Contact;
use crate::draw::{Draw, cases};
use crate::geometry::{Pose, Rotation, Vector, cross, left_of};
use crate::robot::{BodyKind, Mount, Part, Running, Shape};

/// [m] Tolerance of the comparison.
const SAME: f64 = 1e-9;

/// One overlap: its depth [m], and the normal out of the ground.
#[derive(Debug)]
struct Overlap {
    depth: f64,
    normal: Vector,
}

/// The part of one solid that lies beyond a line of the other.
struct Beyond<'a> {
    /// [m] The line that is crossed twice.
    line: [Vector; 2],
    /// Outward normal of the solid with the line.
    outward: Vector,
    /// The other features of the same solid.
    others: Vec<&'a Curve>,
    /// Features of the other solid from one crossing to the next.
    inside: Vec<Curve>,
}

impl Beyond<'_> {
    /// The depth, if no other feature is near.
    fn depth(&self) -> Option<f64> {
        let [a, b] = self.line;
        let below = |p: Vector| (a - p).dot(self.outward);
        let joints = self.inside.windows(2).map(|pair| {
            let [p, q] = pair[0].ends();
            let next = pair[1];
            if (next.nearest(p) - p).length() < (next.nearest(q) - q).length() {
                p
            } else {
                q
            }
        });
        let supports = self.inside.iter().filter_map(|curve| match *curve {
            Curve::Arc { center, radius, .. } if curve.points(-self.outward) => {
                Some(center - self.outward * radius)
            }
            _ => None,
        });
        let joints: Vec<Vector> = joints.collect();
        if joints.iter().any(|p| below(*p) <= 0.0) {
            return None;
        }
        let deepest = joints
            .iter()
            .copied()
            .chain(supports)
            .max_by(|p, q| below(*p).total_cmp(&below(*q)))?;
        let depth = below(deepest);
        let margin = 2.0 * depth + 1e-7;
        let along = (b - a).normalize();
        let foot = (deepest - a).dot(along);
        let clear = foot > margin
            && foot < (b - a).length() - margin
            && self
                .others
                .iter()
                .all(|c| (c.nearest(deepest) - deepest).length() > margin);
        clear.then_some(depth)
    }
}

/// The only overlap of a part with the ground, if it is one of just two features.
fn only_overlap(judge: &Judge) -> Option<Overlap> {
    let crossings = judge.crossings();
    let [(i, j, _), (k, l, _)] = crossings[..] else {
        return None;
    };
    let ground = &judge.ground.curves;
    let except = |curves: &'_ [Curve], n: usize| -> Vec<Curve> {
        curves
            .iter()
            .enumerate()
            .filter(|(m, _)| *m != n)
            .map(|(_, c)| *c)
            .collect()
    };
    if j == l
        && let Curve::Line([a, b]) = ground[j]
    {
        let outward = left_of((b - a).normalize());
        let count = judge.part.len();
        let way = |from: usize, to: usize| -> Vec<Curve> {
            let steps = (to + count - from) % count;
            (0..=steps)
                .map(|s| judge.part[(from + s) % count])
                .collect()
        };
        let (one, other) = (way(i, k), way(k, i));
        let inside = if one.len() <= other.len() { one } else { other };
        let others = except(ground, j);
        let beyond = Beyond {
            line: [a, b],
            outward,
            others: others.iter().collect(),
            inside,
        };
        return beyond.depth().map(|depth| Overlap {
            depth,
            normal: outward,
        });
    }
    if i == k
        && let Curve::Line([a, b]) = judge.part[i]
    {
        let outward = -left_of((b - a).normalize());
        let inside = ground[j.min(l)..=j.max(l)].to_vec();
        let others = except(&judge.part, i);
        let beyond = Beyond {
            line: [a, b],
            outward,
            others: others.iter().collect(),
            inside,
        };
        return beyond.depth().map(|depth| Overlap {
            depth,
            normal: -outward,
        });
    }
    if i == k
        && let Curve::Arc { center, radius, .. } = judge.part[i]
    {
        // The feet of the perpendiculars from the centre.
        let feet = ground.iter().map(|c| c.nearest(center));
        let near = |p: &Vector| (*p - center).length();
        let foot = feet.min_by(|p, q| near(p).total_cmp(&near(q)))?;
        let (depth, normal) = (radius - near(&foot), (center - foot).normalize());
        let others = except(&judge.part, i);
        let margin = 2.0 * depth + 1e-7;
        let clear = judge.part[i].points(-normal)
            && center.y > judge.ground.height(center.x)
            && others
                .iter()
                .all(|c| (c.nearest(foot) - foot).length() > margin);
        return clear.then_some(Overlap { depth, normal });
    }
    None
}

#[test]
fn no_penetration_is_missed_and_that_of_two_features_has_its_depth_and_normal() {
    const SEED: u64 = 20_270_115;
    let mut draw = Draw(SEED);
    let count = cases(5_000, 1_000_000);
    let mut judged = 0;
    for number in 0..count {
        let mut scene = Scene::random(number, &mut draw);
        // Less than would come out on the other side.
        let depth = draw.size(1e-8, 1e-3_f64.min(0.5 * scene.outline.thinnest));
        scene.approach(-depth);
        let judge = scene.judge(depth);
        // Two thin tips may have passed each other.
        if judge.is_clear() {
            continue;
        }
        let contacts = scene.contacts(1e-3);
        let distances = contacts.iter().map(|c| c.distance);
        let deepest = distances.fold(f64::INFINITY, f64::min);
        assert!(deepest < 0.0, "{depth} {contacts:?} {}", scene.describe());
        if let Some(overlap) = only_overlap(&judge) {
            judged += 1;
            let is_it = |c: &Contact| {
                (c.distance + overlap.depth).abs() < SAME
                    && (c.normal - overlap.normal).length() < 1e-6
            };
            let is_reported = contacts.iter().any(is_it) && (deepest + overlap.depth).abs() < SAME;
            assert!(is_reported, "{overlap:?} {contacts:?} {}", scene.describe());
        }
    }
    println!("seed {SEED}: {count} poses, {judged} of two features");
    assert!(judged > count / 2);
}

/// The shortest displacement that leaves no contact in penetration, if there is one.
fn way_out(contacts: &[Contact], slack: f64) -> Option<Vector> {
    let room = |c: &Contact| slack - c.distance;
    let of_one = contacts.iter().map(|c| c.normal * room(c));
    let of_two = contacts.iter().enumerate().flat_map(|(i, a)| {
        contacts[..i].iter().filter_map(move |b| {
            let area = cross(a.normal, b.normal);
            let way = (left_of(a.normal) * room(b) - left_of(b.normal) * room(a)) / area;
            (area.abs() > 1e-6).then_some(way)
        })
    });
    std::iter::once(Vector::ZERO)
        .chain(of_one)
        .chain(of_two)
        .filter(|way| {
            contacts
                .iter()
                .all(|c| way.dot(c.normal) >= room(c) - 1e-12)
        })
        .min_by(|a, b| a.length().total_cmp(&b.length()))
}

#[test]
fn a_part_leaves_the_ground_along_its_contacts() {
    const SEED: u64 = 20_270_116;
    const PREDICTION: f64 = 3e-3;
    let mut draw = Draw(SEED);
    let count = cases(5_000, 1_000_000);
    let mut moved = 0;
    for number in 0..count {
        let mut scene = Scene::random(number, &mut draw);
        let depth = draw.size(1e-6, 3e-4);
        scene.approach(-depth);
        scene.push(Vector::new(
            draw.between(-depth, depth),
            draw.between(-depth, depth),
        ));
        scene.turn(draw.between(-depth, depth) / scene.outline.reach);
        let before = scene.describe();
        let least = 1e-8 + scene.unreported();
        let mut is_free = true;
        // A second time, in case the adjacent face is deeper than the one it was in.
        for _ in 0..2 {
            let contacts = scene.contacts(PREDICTION);
            // There is none if it is wedged; and on a long way out it may meet more ground.
            let way = way_out(&contacts, least).filter(|w| w.length() < PREDICTION);
            is_free &= way.is_some();
            scene.push(way.unwrap_or_default());
        }
        moved += usize::from(is_free);
        assert!(!is_free || scene.judge(0.0).is_clear(), "{before}");
    }
    println!("seed {SEED}: {count} poses, {moved} moved out");
    assert!(moved > count / 2);
}

/// The contact of a polygon with a step of 0.1 m, whose foot is the origin.
fn polygon_at_step(corners: &[[f64; 2]]) -> OwnContact {
    let step = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]].map(|[x, y]| Vector::new(x, y));
    let corners: Vec<Vector> = corners.iter().map(|[x, y]| Vector::new(*x, *y)).collect();
    polygon_on(&step, 0.0, &corners)
}

/// The contact of a polygon with a ground whose edges have this radius [m].
fn polygon_on(ground: &[Vector], radius: f64, corners: &[Vector]) -> OwnContact {
    let part = Part {
        kind: BodyKind::Belly,
        shape: Shape::Polygon {
            corners: corners.to_vec(),
        },
        drive: None,
        friction_limit: f64::INFINITY,
        lane: 0,
        mount: Mount::Chassis,
    };
    OwnContact::new(&[part], &[Ground::new(ground, radius).unwrap().profile])
}

#[test]
fn a_tip_wedged_into_an_inner_corner_bears_on_both_faces() {
    let contact = polygon_at_step(&[[0.0, 0.0], [-0.05, 0.05], [-0.05, 0.01]]);
    let mut contacts = Vec::new();
    for (behind, below) in [(1e-9, 1e-9), (1e-6, 1e-4), (1e-4, 1e-6), (5e-4, 5e-4)] {
        let pose = Pose::from_translation(Vector::new(behind, -below));
        contact.find(pose, &Running::default(), 1e-3, &mut contacts);
        for (normal, depth) in [(Vector::Y, below), (-Vector::X, behind)] {
            let is_it = |c: &Contact| c.normal == normal && (c.distance + depth).abs() < 1e-15;
            assert!(contacts.iter().any(is_it), "{behind} {below} {contacts:?}");
        }
    }
}

/// However flat it is: the corner of the step is then outside its underside only by rounding.
#[test]
fn a_block_that_lies_on_a_step_bears_with_both_ends() {
    let contact = polygon_at_step(&[[-0.01, 0.0], [0.01, 0.0], [0.01, 0.02], [-0.01, 0.02]]);
    let mut contacts = Vec::new();
    for exponent in 4..16 {
        let small = 10.0_f64.powi(-exponent);
        for (angle, depth) in [
            (0.0, small),
            (1e-11, small),
            (-1e-11, small),
            (small, 1e-12),
        ] {
            let pose = Pose::from_parts(Vector::new(0.5, 0.1 - depth), Rotation::new(angle));
            contact.find(pose, &Running::default(), 1e-3, &mut contacts);
            assert_eq!(contacts.len(), 2, "{angle} {depth} {contacts:?}");
        }
    }
}

/// Behind a block and before one, between two slopes, and before a slope that has none.
#[test]
fn a_tip_at_the_foot_of_an_arc_bears_on_the_arc_and_on_the_ground_beside_it() {
    let ([x, y], diagonal) = ([Vector::X, Vector::Y], Vector::ONE.normalize());
    let grounds: [(&[[f64; 2]], [Vector; 2]); 4] = [
        (&[[-1.0, 0.06], [0.0, 0.06], [0.0, 0.0], [1.0, 0.0]], [x, y]),
        (
            &[[-1.0, 0.0], [0.0, 0.0], [0.0, 0.06], [1.0, 0.06]],
            [y, -x],
        ),
        (
            &[
                [-1.0, 0.06],
                [-0.06, 0.06],
                [0.0, 0.0],
                [0.06, 0.06],
                [1.0, 0.06],
            ],
            [diagonal, Vector::new(-diagonal.x, diagonal.y)],
        ),
        (
            &[[-1.0, 0.06], [-0.06, 0.06], [0.0, 0.0], [1.0, 0.0]],
            [diagonal, y],
        ),
    ];
    for (points, normals) in grounds {
        let corners: Vec<Vector> = points.iter().map(|[x, y]| Vector::new(*x, *y)).collect();
        let up = (normals[0] + normals[1]).normalize();
        let needle = [
            Vector::ZERO,
            up * 0.1 + left_of(up) * -0.001,
            up * 0.1 + left_of(up) * 0.001,
        ];
        for short in [0.0, 1e-13, 1e-11, 1e-9, 1e-6, 1e-3] {
            let radius = largest_radius(&corners) * (1.0 - short);
            let contact = polygon_on(&corners, radius, &needle);
            for (a, b) in [(1e-9, 1e-9), (1e-6, 1e-4), (1e-4, 1e-6), (3e-4, 3e-4)] {
                let place = -(normals[0] * a + normals[1] * b);
                let mut contacts = Vec::new();
                let pose = Pose::from_translation(place);
                contact.find(pose, &Running::default(), 1e-3, &mut contacts);
                for normal in normals {
                    let is_it = |c: &Contact| {
                        (c.normal - normal).length() < 1e-5
                            && (c.distance - place.dot(normal)).abs() < 1e-8
                    };
                    let told = format!("{points:?} {short} {a} {b} {normal} {contacts:?}");
                    assert!(contacts.iter().any(is_it), "{told}");
                }
            }
        }
    }
}

/// The left side of the block is as near as its underside, but the corner does not face that side.
#[test]
fn a_corner_as_near_to_two_sides_of_a_block_bears_on_the_one_that_it_faces() {
    let contact = polygon_at_step(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.05], [0.0, 0.05]]);
    let (turn, deep) = (Rotation::new(0.1), 3e-4);
    let up = turn * Vector::Y;
    // Sides that differ by less than 10 nm count as equally near.
    for farther in [-1e-6, -1e-9, 0.0, 1e-9, 5e-9, 1e-6] {
        let corner = turn * Vector::new(deep + farther, deep);
        let pose = Pose::from_parts(Vector::new(0.0, 0.1) - corner, turn);
        let mut contacts = Vec::new();
        contact.find(pose, &Running::default(), 1e-3, &mut contacts);
        let is_it =
            |c: &Contact| (c.normal - up).length() < 1e-9 && (c.distance + deep).abs() < 1e-12;
        assert!(contacts.iter().any(is_it), "{farther} {contacts:?}");
    }
}
