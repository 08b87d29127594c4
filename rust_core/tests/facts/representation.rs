//! What the motion of drawn robots does not depend on: the number of pieces that the ground is cut into, where it lies,
//! and from which side it is seen.

use crawler2d_core::{Ground, Profile, Scenario, Simulation, Surface, Track, Wheel};

use crate::common::*;
use crate::drawn::drawn;

/// [s] Instants at which paths are compared.
const LOOK: f64 = 0.01;
const LOOKS: usize = 100;
/// So many of these the twins may part later.
const LATER: usize = 3;
/// Paths part exponentially: a few twins tell how far to a power of ten.
const TIMES: f64 = 10.0;

/// Ground of sharp corners.
struct Course {
    points: Vec<[f64; 2]>,
    friction: f64,
    first_edge: f64,
}

impl Course {
    /// Level ground, then a dozen steps up and down with slopes between them.
    fn drawn(draw: &mut Draw, height: f64) -> Self {
        let mut points = vec![[-20.0, 0.0], [0.0, 0.0]];
        let mut x = 0.0;
        for _ in 0..12 {
            points.push([x, height * draw.between(-1.0, 1.0)]);
            x += height * draw.between(0.2, 4.0);
            points.push([x, height * draw.between(-1.0, 1.0)]);
        }
        points.push([x + 20.0, points[points.len() - 1][1]]);
        Self {
            points,
            friction: draw.between(0.0, 1.5),
            first_edge: 0.0,
        }
    }

    /// The same with each face in so many pieces.
    fn cut(&self, pieces: u32) -> Self {
        let along = |pair: &[[f64; 2]]| {
            let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
            (0..pieces)
                .map(|k| f64::from(k) / f64::from(pieces))
                .map(move |share| [ax + share * (bx - ax), ay + share * (by - ay)])
                .collect::<Vec<_>>()
        };
        let mut points: Vec<_> = self.points.windows(2).flat_map(along).collect();
        points.extend(self.points.last());
        Self { points, ..*self }
    }

    fn moved(&self, by: f64) -> Self {
        let points = self.points.iter().map(|[x, y]| [x + by, *y]).collect();
        Self {
            points,
            first_edge: self.first_edge + by,
            ..*self
        }
    }

    /// As it is seen from the other side.
    fn mirrored(&self) -> Self {
        Self {
            points: self.points.iter().rev().map(|[x, y]| [-x, *y]).collect(),
            first_edge: -self.first_edge,
            ..*self
        }
    }

    fn ground(&self) -> Ground {
        let lane = Profile::new("ground", &self.points, Surface::sharp(self.friction), false);
        Ground {
            lanes: vec![lane.expect("a profile")],
            tracks: 1,
            goal: 1e3,
            first_edge: self.first_edge,
        }
    }
}

/// Pose over the first second, an angle as how far an axle moves by it [m].
fn path(scenario: &Scenario, course: &Course) -> Vec<[f64; 3]> {
    let mut simulation = Simulation::on_ground(scenario, course.ground()).expect("it fits");
    let arm = 0.5 * scenario.robot.outline.axle_distance();
    (0..LOOKS)
        .map(|_| {
            advance(&mut simulation, LOOK);
            let r = simulation.reading();
            [r.position.x, r.position.y, arm * r.chassis_angle]
        })
        .collect()
}

/// [m] How far apart two paths have been up to each instant.
fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<f64> {
    let mut most = 0.0_f64;
    let pairs = a.iter().zip(b);
    pairs
        .map(|(p, q)| {
            let off = (0..3).map(|k| (p[k] - q[k]).abs());
            most = off.fold(most, f64::max);
            most
        })
        .collect()
}

/// The same robot seen from the other side, if all of it has a mirror image: grousers have a phase, shoes a number.
fn mirrored(scenario: &Scenario) -> Option<Scenario> {
    let mut mirrored = scenario.clone();
    let robot = &mut mirrored.robot;
    let is_symmetric = match &mut robot.track {
        Track::Belt(_) | Track::Force(_) => true,
        Track::Line(line) => line.wheel == Wheel::Round,
        Track::Hybrid(hybrid) => {
            hybrid
                .placements
                .iter_mut()
                .for_each(|disc| disc[0] *= -1.0);
            hybrid.wheel == Wheel::Round
        }
        _ => false,
    };
    let radii = [robot.outline.front_radius(), robot.outline.rear_radius()];
    if !is_symmetric || radii[0] != radii[1] || robot.flippers.is_some() {
        return None;
    }
    robot.outline.discs.reverse();
    robot
        .outline
        .discs
        .iter_mut()
        .for_each(|disc| disc[0] *= -1.0);
    robot.center_of_mass[0] *= -1.0;
    if let Some(belly) = &mut robot.belly {
        belly.reverse();
        belly.iter_mut().for_each(|point| point[0] *= -1.0);
    }
    mirrored.drive.speed *= -1.0;
    for row in mirrored.drive.schedule.iter_mut().flatten() {
        row[1] *= -1.0;
    }
    Some(mirrored)
}

/// The paths of a scenario, and of twins that begin a few tenths of a micrometre off, as steps may be.
struct Paths {
    base: Vec<[f64; 3]>,
    /// [m] How far the twins have led, up to each instant.
    spread: Vec<f64>,
}

impl Paths {
    fn of(scenario: &Scenario, course: &Course) -> Self {
        let base = path(scenario, course);
        let mut spread = vec![0.0_f64; LOOKS];
        for k in 1..=6 {
            let mut twin = scenario.clone();
            twin.start.approach += 1e-7 * f64::from(k);
            for (most, off) in spread.iter_mut().zip(apart(&base, &path(&twin, course))) {
                *most = most.max(off);
            }
        }
        Self { base, spread }
    }

    /// How many times as far as the twins another path leads, at most. They may part a little later.
    fn times(&self, other: &[[f64; 3]]) -> f64 {
        let off = apart(&self.base, other);
        let of_twins = (0..LOOKS).map(|i| self.spread[(i + LATER).min(LOOKS - 1)]);
        off.iter()
            .zip(of_twins)
            .map(|(off, most)| off / most)
            .fold(0.0, f64::max)
    }
}

/// With `CRAWLER2D_SOAK` five hundred robots.
#[test]
fn drawn_robots_move_alike_however_their_ground_is_given() {
    let mut draw = Draw(51);
    let (mut compared, mut farther, mut mirrors) = (0, 0, 0);
    for case in 0..few_or_many(6, 500) {
        let mut scenario = drawn(&mut draw);
        let size = scenario.robot.outline.smallest_radius();
        let height = size * draw.between(0.1, 1.0);
        let course = Course::drawn(&mut draw, height);
        scenario.start.approach = size * draw.between(0.0, 3.0);
        let paths = Paths::of(&scenario, &course);
        let pieces = 2 + (draw.unit() * 30.0) as u32;
        let by = draw.between(-1e3, 1e3);
        let mut there = path(&scenario, &course.moved(by));
        there.iter_mut().for_each(|pose| pose[0] -= by);
        let mut others = vec![
            ("in pieces", path(&scenario, &course.cut(pieces))),
            ("elsewhere", there),
        ];
        if let Some(other) = mirrored(&scenario) {
            mirrors += 1;
            let begin = |scenario: &Scenario, course: &Course| {
                let simulation = Simulation::on_ground(scenario, course.ground()).expect("it fits");
                simulation.reading().position.x
            };
            let mut seen = course.mirrored();
            seen.first_edge -= begin(&other, &seen) + begin(&scenario, &course);
            let mut there = path(&other, &seen);
            for pose in &mut there {
                (pose[0], pose[2]) = (-pose[0], -pose[2]);
            }
            others.push(("in a mirror", there));
        }
        for (name, other) in others {
            let times = paths.times(&other);
            compared += 1;
            if times > TIMES {
                farther += 1;
                println!("case {case}, {name}: {times:.0} times as far as the twins");
            }
        }
    }
    println!("{farther} of {compared} led farther, {mirrors} in a mirror");
    assert!(mirrors > 0);
    // Six twins do not show all ways in which a path may part.
    assert!(farther * 100 <= compared);
}
