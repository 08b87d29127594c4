//! The drive of a chain: a motor turns the sprocket against the chassis, and its teeth pull the chain.
//!
//! On a guide the sprocket has no teeth: the drive acts with forces along the shoes on the driving arc, and
//! with the reaction on the chassis. It then holds the rate at which these shoes go round, up to its torque
//! limit. Both refer to the radius at which a full turn moves the chain by as many pitches as there are shoes
//! to a turn, so that the mean speed of the chain is the set-point.
//!
//! The equations: docs/physics.md, "Chains".

use serde::{Deserialize, Serialize};

use crate::dynamics::damper::Damper;
use crate::dynamics::state::{Shoe, State, Twist};
use crate::geometry::{Vector, cross, direction, left_of, plausible};
use crate::robot::ChainOfShoes;

/// Compliance of the drive's damper, in units of its admittance.
const DAMPING: f64 = 1e-8;

/// [1/s] Rate at which the drive makes up for lag of the chain: a real sprocket keeps count of the shoes,
/// however the polygon effect changes their speed.
const CATCHING_UP: f64 = 5.0;

/// The drive of one chain.
#[derive(Clone, Debug, Default)]
pub(super) struct Pull {
    /// The shoes on the driving arc of a guide.
    pub shoes: Vec<Grasp>,
    /// [m] The radius at which a sprocket pulls, if there is one.
    pub lever: Option<f64>,
    pub impulses: PullImpulses,
    /// [kg] Impulse per speed.
    stiffness: f64,
}

/// The part of the drive that is kept from step to step.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct PullImpulses {
    /// [N s] Impulse on the chain in this step.
    pub impulse: f64,
    /// [N s] Impulse about which a direct solve damps it.
    pub center: f64,
    /// [N] Force from which the next step starts.
    pub force: f64,
    /// [m] How far the chain lags behind the set-point or behind its sprocket.
    pub behind: f64,
}

impl PullImpulses {
    pub(super) fn is_plausible(&self) -> bool {
        plausible(&[self.impulse, self.center, self.force, self.behind])
    }
}

/// How the drive acts on one shoe and on the chassis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grasp {
    /// Index in the chain.
    pub shoe: usize,
    pub on_shoe: [f64; 3],
    pub on_chassis: [f64; 3],
}

impl Pull {
    /// Selects the shoes on the arc round the driving end `axle`; they point along `alongs`. A chain that has
    /// come off may have none there.
    pub(super) fn follow(
        &mut self,
        chain: &ChainOfShoes,
        (shoes, alongs): (&[Shoe], &[Vector]),
        state: &State,
        axle: Vector,
    ) {
        self.shoes.clear();
        if let Some(sprocket) = &chain.sprocket {
            let lever = chain.drive_radius();
            self.lever = Some(lever);
            self.stiffness = sprocket.inertia / (DAMPING * lever * lever);
            return;
        }
        let forwards = direction(state.angle);
        let (mut torque, mut squares) = (0.0, 0.0);
        for (i, (shoe, along)) in shoes.iter().zip(alongs).enumerate() {
            // A smooth weight, so that no shoe joins or leaves the arc abruptly.
            let share = (-left_of(*along).dot(forwards)).max(0.0).powi(2);
            if share > 0.0 {
                let along = along * share;
                // Torque counts: a shoe farther out is faster, so the force on it is smaller.
                torque += cross(along, shoe.center - axle);
                squares += share * share;
                let back = cross(shoe.center - state.center, along);
                self.shoes.push(Grasp {
                    shoe: i,
                    on_shoe: [along.x, along.y, 0.0],
                    on_chassis: [-along.x, -along.y, -back],
                });
            }
        }
        if torque <= 0.0 {
            self.shoes.clear();
            return;
        }
        let scale = chain.drive_radius() / torque;
        for grasp in &mut self.shoes {
            grasp.on_shoe = grasp.on_shoe.map(|entry| entry * scale);
            grasp.on_chassis = grasp.on_chassis.map(|entry| entry * scale);
        }
        let admittance = scale * scale * squares / chain.shoe_mass;
        self.stiffness = 1.0 / (DAMPING * admittance);
    }

    /// Whether there is a sprocket or a shoe to pull on.
    pub(super) fn has_hold(&self) -> bool {
        self.lever.is_some() || !self.shoes.is_empty()
    }

    /// [m/s] Speed that the drive aims for.
    pub(super) fn aim(&self, set_point: f64) -> f64 {
        match self.lever {
            Some(_) => set_point,
            None => set_point + CATCHING_UP * self.impulses.behind,
        }
    }

    pub(super) fn damper(&self) -> Damper {
        Damper::new(self.impulses.center, self.stiffness)
    }

    /// [m/s] Speed of the chain on a guide, or the speed given by the spin of the sprocket.
    pub(super) fn speed(&self, chassis: Twist, spin: f64, shoe: impl Fn(usize) -> Twist) -> f64 {
        if let Some(lever) = self.lever {
            return lever * (chassis.turn - spin);
        }
        let along = |row: &[f64; 3], twist: Twist| -> f64 {
            row.iter().zip(twist.entries()).map(|(a, v)| a * v).sum()
        };
        let of = |g: &Grasp| along(&g.on_shoe, shoe(g.shoe)) + along(&g.on_chassis, chassis);
        self.shoes.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Disc, Envelope, ShoeLoop};
    use crate::robot::Tensioner;

    #[test]
    fn a_drive_without_a_shoe_behind_it_finds_no_hold() {
        let end = |x| Disc {
            center: Vector::new(x, 0.0),
            radius: 0.05,
        };
        let ends = [end(-0.2), end(0.2)];
        let chain = ChainOfShoes {
            number: 0,
            shoes: 0..22,
            path: ShoeLoop::new(ends, 22).unwrap(),
            ends,
            wheels: Vec::new(),
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
            hull: Envelope::new(&ends),
        };
        let shoe = |angle: f64| Shoe {
            center: Vector::new(-0.25, 0.0),
            angle,
            twist: Twist::default(),
        };
        let state = State {
            center: Vector::ZERO,
            angle: 0.0,
            velocity: Vector::ZERO,
            angular_velocity: 0.0,
            drives: Vec::new(),
            shoes: Vec::new(),
            flippers: Vec::new(),
            idlers: Vec::new(),
        };
        let mut pull = Pull::default();
        // A shoe that points up behind the axle is on the arc; one that points down is on the front side.
        for (angle, holds) in [(1.6, true), (-1.6, false)] {
            let shoes = [shoe(angle)];
            let along = [shoes[0].along()];
            pull.follow(&chain, (&shoes, &along), &state, end(-0.2).center);
            assert_eq!(pull.has_hold(), holds);
        }
    }
}
