//! Rings of links.

use super::*;
use crate::draw::Draw;
use crate::geometry::{cross, direction, left_of};

/// [kg], [kg m^2] and [m] A link: its mass, inertia, and the way from its centre to either hinge.
const MASS: f64 = 0.3;
const INERTIA: f64 = 0.002;
const HALF: f64 = 0.1;

/// A ring whose links are the sides of a polygon that stands still, with the places of their centres.
fn polygon(count: usize) -> (Problem, Vec<Vector>) {
    let of = RingSpec {
        links: count,
        mass: MASS,
        inertia: INERTIA,
        spin: None,
    };
    let mut problem = Problem::new([5.0, 0.3], 0, &[], &[of]);
    let ring = &mut problem.rings[0];
    ring.slide = Damper::new(0.0, 1.0);
    let turn = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
    let inner = HALF / (0.5 * turn(1)).tan();
    let along = |k: usize| direction(turn(k));
    for (k, hinge) in ring.hinges.iter_mut().enumerate() {
        let arms = [along(k) * HALF, along((k + 1) % count) * -HALF];
        (hinge.ends, hinge.pushed_at) = (arms, arms);
    }
    let centers = (0..count).map(|k| -left_of(along(k)) * inner).collect();
    problem.motors.push(Motor::new(Driven::Ring(0), 1.0, false));
    (problem, centers)
}

/// Gives the links velocities without constraints.
fn throw(problem: &mut Problem, free: &[Twist]) {
    let first = problem.layout.link(0);
    for (link, twist) in problem.free[first..].chunks_exact_mut(3).zip(free) {
        link.copy_from_slice(&twist.entries());
    }
    problem.rings[0].start(&vec![INERTIA; free.len()], &problem.free);
}

/// The velocities of the links.
fn links(problem: &Problem) -> Vec<Twist> {
    let links = problem.unknowns[problem.layout.link(0)..].chunks_exact(3);
    links
        .map(|own| Twist::from([own[0], own[1], own[2]]))
        .collect()
}

/// Links of a triangle hold each other: they move on as one body, with the momentum that they have.
#[test]
fn a_closed_chain_of_three_links_is_a_rigid_body() {
    let (mut problem, centers) = polygon(3);
    let free = [
        Twist::from([1.0, -0.5, 4.0]),
        Twist::from([0.0, 2.0, -1.0]),
        Twist::from([-0.7, 0.1, 0.5]),
    ];
    throw(&mut problem, &free);
    problem.solve();
    assert_eq!(problem.effort.unresolved, 0);
    let momentum: Vector = free.iter().map(|link| link.velocity * MASS).sum();
    let of_link = |(link, center): (&Twist, &Vector)| {
        cross(*center, link.velocity) * MASS + INERTIA * link.turn
    };
    let moment: f64 = free.iter().zip(&centers).map(of_link).sum();
    let inertia: f64 = centers
        .iter()
        .map(|c| c.length_squared() * MASS + INERTIA)
        .sum();
    let whole = Twist {
        velocity: momentum / (3.0 * MASS),
        turn: moment / inertia,
    };
    for (link, center) in links(&problem).iter().zip(&centers) {
        let off = link.velocity - whole.at(*center);
        assert!(off.length() < 1e-12, "{off}");
        assert_relative_eq!(link.turn, whole.turn, max_relative = 1e-12);
    }
}

/// A ring that lies on the ground with one link and is thrown onto it: contacts bear, hinges stay closed, and all
/// momentum is that of the ground.
#[test]
fn a_ring_that_falls_keeps_its_hinges_closed() {
    let count = 12;
    let (mut problem, _) = polygon(count);
    throw(&mut problem, &[Twist::from([0.3, -1.0, 0.0]); 12]);
    for end in [-1.0, 1.0] {
        let link = Link::new(problem.layout, 0, 0);
        let arm = Vector::new(end * HALF, -0.01);
        let rows = [Vector::Y, right_of(Vector::Y)]
            .map(|unit| Row::on_link(link, [unit.x, unit.y, cross(arm, unit)]));
        let mut below = bearing(rows, 0.4);
        below.mass = None;
        problem.contacts.push(below);
    }
    problem.solve();
    assert_eq!(problem.effort.unresolved, 0);
    let links = links(&problem);
    for (k, hinge) in problem.rings[0].hinges.iter().enumerate() {
        let [own, next] = hinge.ends;
        let opens = links[(k + 1) % count].at(next) - links[k].at(own);
        assert!(opens.length() < 1e-12, "{opens}");
    }
    let gained: Vector = links
        .iter()
        .map(|link| (link.velocity - Vector::new(0.3, -1.0)) * MASS)
        .sum();
    let of_contact = |c: &Contact| Vector::new(c.friction_impulse, c.normal_impulse);
    let of_ground: Vector = problem.contacts.iter().map(of_contact).sum();
    assert!((gained - of_ground).length() < 1e-10 * of_ground.length());
    assert!(of_ground.y > 0.0);
}

/// The hinges of a ring but the last one resist that its links turn against each other. What each does to them is its
/// damper at the rates that are found, and neither momentum nor what the hinges hold is changed by it.
#[test]
fn stiff_hinges_turn_links_by_their_dampers_and_keep_momentum() {
    let (problem, centers) = polygon(7);
    let (free, found) = stiff_ring(problem);
    let moment = |twists: &[Twist]| -> f64 {
        let of_link = |(link, center): (&Twist, &Vector)| {
            cross(*center, link.velocity) * MASS + INERTIA * link.turn
        };
        twists.iter().zip(&centers).map(of_link).sum()
    };
    assert_relative_eq!(moment(&found), moment(&free), epsilon = 1e-12);
}

/// The same while hinges that are off each other close again.
#[test]
fn stiff_hinges_close_at_the_speed_that_is_asked_for() {
    let (mut problem, _) = polygon(7);
    let mut draw = Draw(6);
    for hinge in &mut problem.rings[0].hinges {
        hinge.velocity = Vector::new(draw.between(-0.1, 0.1), draw.between(-0.1, 0.1));
    }
    stiff_ring(problem);
}

/// Throws the links of a ring with stiff hinges, solves, and checks each link and hinge; returns the velocities of the
/// links before and after.
fn stiff_ring(mut problem: Problem) -> (Vec<Twist>, Vec<Twist>) {
    let count = problem.rings[0].hinges.len();
    let mut draw = Draw(5);
    let mut speed = || draw.between(-1.0, 1.0);
    let free: Vec<Twist> = (0..count)
        .map(|_| Twist::from([speed(), speed(), 5.0 * speed()]))
        .collect();
    throw(&mut problem, &free);
    let dampers: Vec<Damper> = (0..count - 1)
        .map(|_| Damper::new(0.01 * speed(), 0.01 * (1.0 + speed())))
        .collect();
    for (hinge, damper) in problem.rings[0].hinges.iter_mut().zip(&dampers) {
        hinge.twist = *damper;
    }
    problem.solve();
    assert_eq!(problem.effort.unresolved, 0);
    let links = links(&problem);
    let ring = &problem.rings[0];
    let pushes: Vec<Vector> = ring.impulses().collect();
    for k in 0..count {
        let (next, behind) = ((k + 1) % count, (k + count - 1) % count);
        let [own, of_next] = ring.hinges[k].ends;
        let opens = links[next].at(of_next) - links[k].at(own) - ring.hinges[k].velocity;
        assert!(opens.length() < 1e-12, "{opens}");
        // What the hinges before and behind a link do to it is all that changes its momentum.
        let twist = |k: usize| {
            let rate = links[(k + 1) % count].turn - links[k].turn;
            dampers.get(k).map_or(0.0, |damper| damper.at(rate))
        };
        let push = pushes[behind] - pushes[k];
        let gained = (links[k].velocity - free[k].velocity) * MASS;
        assert!((gained - push).length() < 1e-12, "{k}: {gained} of {push}");
        let arms = [ring.hinges[behind].ends[1], own];
        let turned = cross(arms[0], pushes[behind]) - cross(arms[1], pushes[k]);
        let moment = INERTIA * (links[k].turn - free[k].turn);
        assert_relative_eq!(moment, turned + twist(behind) - twist(k), epsilon = 1e-12);
    }
    (free, links)
}
