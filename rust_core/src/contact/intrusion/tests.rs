//! Intrusions against a judge that shares no code with them: it uses support functions and slices.
//!
//! The ground below a profile is a stack of vertical slices and the envelope is convex, so a piece of the
//! ground inside it is a range of x over which the profile lies above the lower side of the envelope. The
//! depth of a point is its smallest distance to any tangent of the envelope; the only candidates are
//! tangents that touch two discs and those perpendicular to the line from a disc's centre.

#![allow(clippy::print_stdout)] // the printed counts say what was judged

mod judge;
mod pieces;

use judge::{Judge, Range, SLICES, ranges};

use super::*;
use crate::draw::{Draw, cases};
use crate::geometry::{Pose, Rotation, Vector};
use crate::robot::{Model, Mount};
use crate::scenario::{
    CircumferentialWheels, GearWheel, HybridWheels, LineOfWheels, Surface, Terrain, Track, Wheel,
    shared,
};
use crate::terrain::Ground;

fn wheels() -> [Wheel; 2] {
    let gear = GearWheel {
        grouser_count: None,
        grouser_height: None,
        tip_thickness: None,
        base_thickness: None,
        phase_fraction: 1.0 / 3.0,
    };
    [Wheel::Round, Wheel::Gear(gear)]
}

fn model(track: Track) -> Model {
    let mut robot = shared("engineer_belt_step").robot;
    robot.track = track;
    Model::new(&robot).expect("it can be built")
}

fn tracks() -> Vec<Track> {
    let mut tracks = Vec::new();
    for wheel in wheels() {
        for (count, wheel_radius) in [(3, None), (4, Some(0.0608)), (5, None), (9, None)] {
            tracks.push(Track::Line(LineOfWheels {
                count,
                wheel_radius,
                wheel: wheel.clone(),
                as_track: true,
            }));
        }
        for (count, wheel_radius) in [(24, None), (14, Some(0.02))] {
            tracks.push(Track::Circumferential(CircumferentialWheels {
                count,
                wheel_radius,
                wheel: wheel.clone(),
            }));
        }
        let placements = vec![
            [-0.18, 0.0, 0.064],
            [-0.07, -0.03, 0.03],
            [0.0, -0.025, 0.03],
            [0.06, -0.034, 0.03],
            [0.19, 0.01, 0.05],
        ];
        tracks.push(Track::Hybrid(HybridWheels { placements, wheel }));
    }
    tracks
}

fn terrain(kind: usize, draw: &mut Draw) -> Terrain {
    let (height, edge_radius, friction) = (draw.between(0.02, 0.12), 0.0, 0.9);
    match kind {
        0 => Terrain::Step {
            height,
            surface: Surface::rounded(edge_radius, friction),
        },
        1 => Terrain::Barrier {
            height,
            thickness: draw.between(0.005, 0.2),
            surface: Surface::rounded(edge_radius, friction),
        },
        2 => Terrain::Ridge {
            height,
            edge_angle: draw.between(0.3, 2.5),
            surface: Surface::rounded(edge_radius, friction),
        },
        3 => Terrain::Gap {
            width: draw.between(0.05, 0.3),
            depth: height,
            surface: Surface::rounded(edge_radius, friction),
        },
        4 => Terrain::Step {
            height,
            surface: Surface::rounded(draw.between(0.002, 0.015), friction),
        },
        _ => {
            let mut x = -1.0;
            let points = (0..48)
                .map(|_| {
                    x += draw.between(0.0, 0.1);
                    [x, draw.between(-0.05, 0.06)]
                })
                .collect();
            Terrain::Points {
                points,
                goal: 0.0,
                surface: Surface::rounded(edge_radius, friction),
                segment_friction: None,
            }
        }
    }
}

/// [m] Range of x of the profile in a piece.
fn extent(intrusion: &Intrusion, profile: &Profile) -> (f64, f64) {
    let x = |place: f64| profile.point_at(place).x;
    let ends = intrusion
        .stretches
        .iter()
        .flat_map(|(from, to)| [x(*from), x(*to)]);
    ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    })
}

/// A track of three wheels with a slot between each two.
fn slotted() -> Model {
    let placements = vec![[-0.186, 0.0, 0.08], [0.0, 0.0, 0.08], [0.186, 0.0, 0.08]];
    let wheel = Wheel::Round;
    model(Track::Hybrid(HybridWheels { placements, wheel }))
}

/// A post that stands halfway between the rear and the middle wheel of a track that is turned by an angle [rad].
fn post_in_a_slot(angle: f64) -> Intrusion {
    let envelope = TrackEnvelope::new(&slotted().parts, (0, Mount::Chassis), 0.0);
    let terrain = Terrain::Barrier {
        height: 0.03,
        thickness: 0.02,
        surface: Surface::sharp(0.9),
    };
    let ground = Ground::new(&terrain, 0.2).expect("a ground");
    let pose = Pose::from_parts(Vector::new(0.103, 0.081), Rotation::new(angle));
    let mut found = envelope.intrusions(&ground.lanes[0], pose);
    assert_eq!(found.len(), 1);
    found.remove(0)
}

#[test]
fn post_in_a_slot_counts_by_its_height_and_thickness() {
    let post = post_in_a_slot(0.0);
    // The belt is offset by a millimetre above the ground.
    assert!((post.depth - 0.029).abs() < 1e-12 && (post.root_depth - 0.029).abs() < 1e-12);
    assert!((post.area - 0.02 * 0.029).abs() < 1e-12, "{}", post.area);
    assert_eq!(
        (post.edges.as_slice(), post.bodies),
        ([1, 2].as_slice(), [1, 0])
    );
}

/// Its edges are 2 cm apart; turned by a thousandth, the belt is 20 um closer to one than to the other.
#[test]
fn of_the_edges_of_a_post_the_deeper_counts_and_if_they_are_equally_deep_the_left_one() {
    for (angle, edge) in [(0.0, 1), (-1e-6, 1), (1e-6, 1), (1e-3, 1), (-1e-3, 2)] {
        let post = post_in_a_slot(angle);
        assert_eq!(
            (post.edges.as_slice(), post.edge),
            ([1, 2].as_slice(), edge)
        );
    }
}

/// No point of the belt is deeper than its axis, 0.08 m from its lower side.
#[test]
fn ground_that_rises_above_the_axles_is_as_deep_as_the_axles() {
    let envelope = TrackEnvelope::new(&slotted().parts, (0, Mount::Chassis), 0.0);
    let terrain = Terrain::Step {
        height: 0.1,
        surface: Surface::sharp(0.9),
    };
    let ground = Ground::new(&terrain, 0.2).expect("a ground");
    for (rises, depth) in [(-0.03, 0.05), (0.01, 0.08), (0.05, 0.08)] {
        let pose = Pose::from_translation(Vector::new(-5.0, -rises));
        let found = envelope.intrusions(&ground.lanes[0], pose);
        assert_eq!(found.len(), 1);
        let off = [found[0].depth - depth, found[0].root_depth - depth].map(f64::abs);
        // The search for the deepest point ends within a nanometre.
        assert!(off[0] < 1e-9 && off[1] < 1e-9, "{:?}", found[0]);
    }
}

/// Facets of a rounded edge are a tenth of a millimetre long, those beside it are centimetres.
#[test]
fn a_contact_bears_within_half_a_millimetre_whatever_the_lengths_of_facets() {
    let terrain = Terrain::Barrier {
        height: 0.03,
        thickness: 0.02,
        surface: Surface::rounded(0.005, 0.9),
    };
    let ground = Ground::new(&terrain, 0.2).expect("a ground");
    let profile = &ground.lanes[0];
    let model = model(tracks().remove(0));
    let [rear, front] = [1, 2].map(|edge| profile.edges[edge].span.map(|i| i as usize));
    let on_rear = Intrusion {
        lane: 0,
        mount: Mount::Chassis,
        side: Side::Both,
        edges: vec![1],
        edge: 1,
        bodies: [1, 0],
        depth: 0.01,
        root_depth: 0.01,
        x: 0.0,
        y: 0.03,
        area: 1e-4,
        stretches: vec![(rear[0] as f64, rear[1] as f64)],
    };
    let bears = |facet: usize, point: Vector| {
        let contact = Contact::new(0, (facet, -1), (point, Vector::Y), 0.0);
        on_rear.bears(&ground.lanes, &model.parts, &contact)
    };
    // On the level top, and on the vertical face before it.
    let (top, foot) = (profile.points[rear[1]], profile.points[rear[0]]);
    for (off, expected) in [(4e-4, true), (6e-4, false)] {
        let [ahead, below] = [top + off * Vector::X, foot - off * Vector::Y];
        assert_eq!(bears(rear[1], ahead), expected, "{off} m ahead");
        assert_eq!(bears(rear[0] - 1, below), expected, "{off} m below");
    }
    // A centimetre away, on the arc at the other end of the top.
    assert!(!bears(front[0], profile.points[front[0]]));
    let on_front = Intrusion {
        stretches: vec![(front[0] as f64 + 1.5, front[1] as f64)],
        ..on_rear
    };
    let end = Contact::new(0, (rear[1] - 1, 0), (top, Vector::Y), 0.0);
    assert!(!on_front.bears(&ground.lanes, &model.parts, &end));
}

/// A model in a pose above a ground, with the judges of both its belts.
struct Case<'a> {
    name: String,
    profile: &'a Profile,
    tips: Judge,
    roots: Judge,
    /// Deepest places of both judges.
    middles: [(f64, Vector); 2],
    /// [m] Width of a few slices.
    narrow: f64,
}

impl Case<'_> {
    /// Too close to call: pieces or gaps a few slices wide, or a mere touch.
    fn is_unclear(&self, found: &[Intrusion], expected: &[Range]) -> bool {
        let extents: Vec<(f64, f64)> = found.iter().map(|i| extent(i, self.profile)).collect();
        let ranges: Vec<(f64, f64)> = expected.iter().map(|r| (r.left, r.right)).collect();
        let is_wide = |ranges: &[(f64, f64)]| {
            ranges.iter().all(|r| r.1 - r.0 > self.narrow)
                && ranges.windows(2).all(|w| w[1].0 - w[0].1 > self.narrow)
        };
        !is_wide(&extents) || !is_wide(&ranges) || found.iter().any(|i| i.depth < 1e-5)
    }

    /// Depth and place of the deepest point of a piece, and whether it is the deepest of the whole envelope.
    fn deepest(&self, judge: &Judge, middle: (f64, Vector), range: &Range) -> (f64, Vector, bool) {
        let inside = |x: f64| (range.left - self.narrow..=range.right + self.narrow).contains(&x);
        let on_profile = self
            .profile
            .points
            .windows(2)
            .filter(|p| p[1].x >= range.left - self.narrow && p[0].x <= range.right + self.narrow)
            .map(|p| judge.deepest_on(p[0], p[1]))
            .filter(|(_, p)| inside(p.x))
            .fold((f64::NEG_INFINITY, Vector::ZERO), |a, b| {
                if b.0 > a.0 { b } else { a }
            });
        let (depth, place) = middle;
        if inside(place.x) && self.profile.height_under_disc(place.x, 0.0) > place.y {
            (depth.max(on_profile.0), place, true)
        } else {
            (on_profile.0, on_profile.1, false)
        }
    }

    /// Edges inside a range.
    fn edges(&self, range: &Range) -> Vec<i32> {
        let inside = range.left - self.narrow..=range.right + self.narrow;
        let points = self.profile.points.iter().zip(&self.profile.edge_of_point);
        let mut edges: Vec<i32> = points
            .filter(|(p, edge)| {
                **edge >= 0 && inside.contains(&p.x) && self.tips.depth(**p).0 > 1e-9
            })
            .map(|(_, edge)| *edge)
            .collect();
        edges.dedup();
        edges
    }

    /// Checks a piece; whether its bodies could be judged.
    fn check(&self, intrusion: &Intrusion, range: &Range) -> bool {
        let context = format!("{}: {intrusion:?}", self.name);
        let inside = range.left - self.narrow..=range.right + self.narrow;
        assert!(inside.contains(&intrusion.x), "{context}");
        // The slices at both ends of a piece are only partly inside.
        let off = (intrusion.area - range.area).abs();
        assert!(
            off < 3e-3 * range.area + 8e-5,
            "{context}, not {}",
            range.area
        );
        let (depth, place, is_middle) = self.deepest(&self.tips, self.middles[0], range);
        assert!(
            (intrusion.depth - depth).abs() < 1e-9,
            "{context}, not {depth}"
        );
        let root = self.deepest(&self.roots, self.middles[1], range).0.max(0.0);
        assert!(
            (intrusion.root_depth - root).abs() < 1e-9,
            "{context}, not {root}"
        );
        assert_eq!(intrusion.edges, self.edges(range), "{context}");
        let bodies = self.tips.bodies(place).filter(|_| !is_middle);
        if let Some(bodies) = bodies {
            assert_eq!(intrusion.bodies, bodies, "{context}");
        }
        bodies.is_some()
    }
}

/// Circles of a model in a pose.
fn discs(model: &Model, pose: Pose, roots: bool) -> Vec<Disc> {
    let of_part = model.parts.iter().flat_map(Part::discs);
    let chosen = of_part.map(|(tip, root)| if roots { root } else { tip });
    let posed = |d: Disc| Disc {
        center: pose.transform_point(d.center),
        ..d
    };
    chosen.map(posed).collect()
}

#[test]
fn every_piece_is_found_with_its_depth_and_its_bodies() {
    const SEED: u64 = 20_261_121;
    let mut draw = Draw(SEED);
    let models: Vec<Model> = tracks().into_iter().map(model).collect();
    let judge = |model, pose, roots| Judge::new(discs(model, pose, roots));
    let middles: Vec<[(f64, Vector); 2]> = models
        .iter()
        .map(|m| [false, true].map(|roots| judge(m, Pose::IDENTITY, roots).deepest()))
        .collect();
    let (mut judged, mut pieces, mut pairs) = (0, 0, 0);
    let poses = cases(1_400, 50_000);
    for number in 0..poses {
        let model = &models[number % models.len()];
        let ground = Ground::new(&terrain(number % 6, &mut draw), 0.2).expect("a ground");
        let x = draw.between(-0.3, 0.5);
        // From buried to clear; most of them straddle an obstacle.
        let y = ground.lanes[0].height_under_disc(x, 0.1) + draw.between(-0.08, 0.02);
        let angle = Rotation::new(draw.between(-0.7, 0.7));
        let pose = Pose::from_parts(Vector::new(x, y), angle);
        let [tips, roots] = [false, true].map(|roots| judge(model, pose, roots));
        let case = Case {
            name: format!("seed {SEED}, pose {number}"),
            profile: &ground.lanes[0],
            narrow: 4.0 * (tips.support(Vector::X) + tips.support(-Vector::X)) / SLICES as f64,
            tips,
            roots,
            middles: middles[number % models.len()]
                .map(|(depth, place)| (depth, pose.transform_point(place))),
        };
        let found = TrackEnvelope::new(&model.parts, (0, Mount::Chassis), 0.0)
            .intrusions(&ground.lanes[0], pose);
        let expected = ranges(&case.tips, &ground.lanes[0]);
        if case.is_unclear(&found, &expected) {
            continue;
        }
        judged += 1;
        assert_eq!(found.len(), expected.len(), "{}", case.name);
        for (intrusion, range) in found.iter().zip(&expected) {
            pieces += 1;
            pairs += usize::from(case.check(intrusion, range));
        }
    }
    println!("seed {SEED}: {judged} poses judged, {pieces} pieces, {pairs} with their bodies");
    assert!(judged > poses * 9 / 10 && pairs > pieces / 2);
}
