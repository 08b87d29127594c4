//! The drive of a chain: a motor turns the sprocket against the chassis, and its teeth pull the chain.
//!
//! On a guide there is no sprocket. The travel of the motor is then a function of where the shoes are: each adds one
//! pitch, little by little, as it goes round the driving end. Motor and chain therefore exchange exactly the force of the
//! motor times its travel. Forces that are shared among the shoes in another way derive from no such function, and would
//! feed energy into a chain that swings.
//!
//! The equations: docs/physics.md, "Chains".

use std::f64::consts::FRAC_2_PI;

use crate::dynamics::state::Shoe;
use crate::geometry::{Pose, Vector, cross, right_of};
use crate::robot::ChainOfShoes;
use crate::solver::Grasp;

/// Finds how the travel of the motor depends on the positions of the shoes at the driving end. The chassis has the pose
/// `chassis` and its centre of mass at `center`. A chain that has come off may have no shoe there.
pub(super) fn find_grasps(
    grasps: &mut Vec<Grasp>,
    chain: &ChainOfShoes,
    shoes: &[Shoe],
    (chassis, center): (Pose, Vector),
) {
    grasps.clear();
    let end = chain.ends[0];
    let axle = chassis.transform_point(end.center);
    let rearwards = chassis.rotation * -Vector::X;
    for (link, shoe) in shoes.iter().enumerate() {
        let arm = shoe.center - axle;
        let (squared, behind) = (arm.length_squared(), arm.dot(rearwards));
        if behind <= 0.0 || squared < 0.25 * end.radius * end.radius {
            continue;
        }
        // The square of a cosine adds up to a pitch over half a turn, and starts and ends smoothly.
        let share = FRAC_2_PI * behind * behind / squared;
        let along = right_of(arm) * (chain.path.pitch * share / squared);
        grasps.push(Grasp {
            link,
            on_link: [along.x, along.y, 0.0],
            on_base: [-along.x, -along.y, -cross(shoe.center - center, along)],
        });
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use approx::assert_relative_eq;

    use super::*;
    use crate::geometry::{Disc, Envelope, ShoeLoop, Twist, direction};
    use crate::robot::{Bushing, Tensioner};

    const RADIUS: f64 = 0.05;
    const PIECES: u32 = 400;

    /// A chain of 22 shoes on a guide, with its driving end at the origin.
    fn chain() -> ChainOfShoes {
        let ends = [0.0, 0.4].map(|x| Disc {
            center: Vector::new(x, 0.0),
            radius: RADIUS,
        });
        ChainOfShoes {
            number: 0,
            shoes: 0..22,
            path: ShoeLoop::new(ends.to_vec(), 22).unwrap(),
            ends,
            between: Vec::new(),
            sprocket: None,
            plate_thickness: 0.003,
            shoe_mass: 0.1,
            shoe_inertia: 1e-5,
            tensioner: Tensioner {
                pre_tension: 8.0,
                stiffness: 1000.0,
                damping: 10.0,
                stop: f64::INFINITY,
            },
            bushing: Bushing::default(),
            hull: Envelope::new(&ends),
        }
    }

    fn shoe_at(center: Vector) -> Shoe {
        Shoe {
            center,
            angle: 0.0,
            twist: Twist::default(),
        }
    }

    /// [m] Travel of the motor while a shoe goes along a path, which it does from 0 to 1.
    fn travel(path: impl Fn(f64) -> Vector) -> f64 {
        let (chain, mut grasps) = (chain(), Vec::new());
        let mut travel = 0.0;
        for i in 0..PIECES {
            let [from, to] = [i, i + 1].map(|k| path(f64::from(k) / f64::from(PIECES)));
            let still = (Pose::default(), Vector::ZERO);
            find_grasps(&mut grasps, &chain, &[shoe_at((from + to) * 0.5)], still);
            let moved = to - from;
            let of = |g: &Grasp| g.on_link[0] * moved.x + g.on_link[1] * moved.y;
            travel += grasps.iter().map(of).sum::<f64>();
        }
        travel
    }

    fn at(radius: f64, turned: f64) -> Vector {
        direction(-turned) * -radius
    }

    #[test]
    fn the_travel_of_a_shoe_round_the_driving_end_is_a_pitch() {
        let pitch = chain().path.pitch;
        for radius in [RADIUS, 2.0 * RADIUS] {
            let round = travel(|share| at(radius, PI * (share - 0.5)));
            assert_relative_eq!(round, pitch, max_relative = 1e-4);
        }
    }

    /// So a chain that swings takes no energy from a motor that gives a constant force.
    #[test]
    fn a_shoe_that_comes_back_leaves_the_motor_where_it_was() {
        let round = |share: f64| {
            let angle = TAU * share;
            at(RADIUS * (1.5 + 0.4 * angle.cos()), 0.4 + 0.8 * angle.sin())
        };
        assert!(travel(round).abs() < 1e-4 * chain().path.pitch);
    }

    #[test]
    fn a_drive_without_a_shoe_behind_its_axle_finds_no_hold() {
        let (chain, mut grasps) = (chain(), Vec::new());
        let still = (Pose::default(), Vector::ZERO);
        for (x, holds) in [(-RADIUS, true), (RADIUS, false)] {
            find_grasps(&mut grasps, &chain, &[shoe_at(Vector::new(x, 0.0))], still);
            assert_eq!(!grasps.is_empty(), holds);
        }
    }
}
