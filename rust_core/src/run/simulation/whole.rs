//! The robot as a whole: centre of mass, moment of inertia and energy.

use super::Simulation;
use crate::geometry::{Vector, left_of};
use crate::robot::ChainOfShoes;

/// A body of the robot at an instant.
struct Body {
    /// [kg] Mass.
    mass: f64,
    /// [kg m^2] Moment of inertia about its centre of mass.
    inertia: f64,
    /// [m] Centre of mass.
    center: Vector,
    /// [m/s] Velocity of the centre of mass.
    velocity: Vector,
    /// [rad/s] Angular velocity.
    turn: f64,
}

impl Simulation {
    /// [m] Centre of mass of chassis, flippers and shoes.
    pub fn center_of_mass(&self) -> Vector {
        let bodies = self.bodies();
        let mass: f64 = bodies.iter().map(|body| body.mass).sum();
        let moment: Vector = bodies.iter().map(|body| body.center * body.mass).sum();
        moment / mass
    }

    /// [kg m^2] Moment of inertia about the centre of mass, drives included.
    pub fn moment_of_inertia(&self) -> f64 {
        let center = self.center_of_mass();
        let about = |body: &Body| (body.center - center).length_squared();
        let of_body = |body: Body| body.inertia + body.mass * about(&body);
        self.bodies().into_iter().map(of_body).sum()
    }

    /// [J] Kinetic energy, that of motors' rotors included, potential energy relative to y = 0, and energy of the tensioners
    /// of chains. Energy stored
    /// in contacts and stops while they give way is not counted.
    pub fn energy(&self) -> f64 {
        let gravity = self.scenario.gravity;
        let of_body = |body: Body| {
            0.5 * body.mass * body.velocity.length_squared()
                + 0.5 * body.inertia * body.turn * body.turn
                + body.mass * gravity * body.center.y
        };
        let of_tensioner = |chain: &ChainOfShoes| {
            let (travel, spring) = (self.state.idlers[chain.number].travel, &chain.tensioner);
            (0.5 * spring.stiffness * travel - spring.pre_tension) * travel
        };
        let bodies: f64 = self.bodies().into_iter().map(of_body).sum();
        let chains = self.dynamics.model().chains.iter();
        bodies + chains.map(of_tensioner).sum::<f64>() + self.energy_of_rotors()
    }

    /// [J] Kinetic energy of the motors' rotors, which turn over the chassis.
    fn energy_of_rotors(&self) -> f64 {
        let (model, state) = (self.dynamics.model(), &self.state);
        let over_chassis = |rate: f64| (rate - state.angular_velocity).powi(2);
        let drives = state.drives.iter().enumerate();
        let of_drives = drives.map(|(k, d)| model.rotor_inertia(k) * over_chassis(d.spin));
        let arms = model.flippers.iter().zip(&state.flippers);
        let of_arms = arms.map(|(arm, turn)| arm.rotor_inertia * over_chassis(turn.rate));
        0.5 * (of_drives.sum::<f64>() + of_arms.sum::<f64>())
    }

    /// Chassis, drives, flippers and shoes.
    fn bodies(&self) -> Vec<Body> {
        let (model, state) = (self.dynamics.model(), &self.state);
        let chassis = Body {
            mass: model.mass,
            inertia: model.moment_of_inertia,
            center: state.center,
            velocity: state.velocity,
            turn: state.angular_velocity,
        };
        // A drive has only inertia: its mass is part of the chassis.
        let turning = |inertia: f64, turn: f64| Body {
            mass: 0.0,
            inertia,
            center: state.center,
            velocity: Vector::ZERO,
            turn,
        };
        let drives =
            (0..state.drives.len()).map(|k| turning(model.drive_inertia(k), state.drives[k].spin));
        let sprockets = model.chains.iter().filter_map(|chain| {
            let inertia = chain.sprocket.as_ref()?.inertia;
            Some(turning(inertia, state.drives[chain.number].spin))
        });
        let flippers = model
            .flippers
            .iter()
            .zip(&state.flippers)
            .map(|(arm, turn)| {
                let [pivot, center] = arm.spokes(model.center_of_mass, [state.angle, turn.angle]);
                Body {
                    mass: arm.mass,
                    inertia: arm.moment_of_inertia,
                    center: state.center + pivot + center,
                    velocity: state.twist().at(pivot) + turn.rate * left_of(center),
                    turn: turn.rate,
                }
            });
        let shoes = model.chains.iter().flat_map(|chain| {
            let of_chain = &state.shoes[chain.shoes.clone()];
            of_chain.iter().map(|shoe| Body {
                mass: chain.shoe_mass,
                inertia: chain.shoe_inertia,
                center: shoe.center,
                velocity: shoe.twist.velocity,
                turn: shoe.twist.turn,
            })
        });
        std::iter::once(chassis)
            .chain(drives)
            .chain(sprockets)
            .chain(flippers)
            .chain(shoes)
            .collect()
    }
}
