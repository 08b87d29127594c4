//! Observation of a simulation: its state at an instant of the last step, its centre of mass and its energy.

use super::Simulation;
use super::attempt::Scratch;
use crate::dynamics::State;
use crate::geometry::{Pose, Vector, left_of};
use crate::observe::Reading;
use crate::robot::{ChainOfShoes, Model, Running};
use crate::solver::Effort;

/// A simulation at an instant.
#[derive(Clone, Copy)]
pub(crate) struct StateView<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    /// [s] Simulated time.
    pub time: f64,
    /// [m/s] Set-point of the drivetrain.
    pub set_point: f64,
}

impl<'a> StateView<'a> {
    /// Pose of the chassis frame.
    pub(crate) fn pose(&self) -> Pose {
        self.state.pose(self.model)
    }

    /// The state as users see it.
    pub(crate) fn reading(&self) -> Reading {
        let (state, pose) = (self.state, self.pose());
        let driven = self.model.driven();
        let motors = driven.len() as f64;
        Reading {
            time: self.time,
            position: pose.translation,
            velocity: state.velocity_at(pose.translation),
            chassis_angle: state.angle,
            angular_velocity: state.angular_velocity,
            commanded_speed: self.set_point,
            track_speed: driven.clone().map(|k| self.drive_speed(k)).sum::<f64>() / motors,
            track_position: driven.map(|k| state.drives[k].position).sum::<f64>() / motors,
        }
    }

    /// Positions of the moving parts.
    pub(crate) fn running(&self, running: &mut Running) {
        self.state.running_after(0.0, self.model, running);
    }

    /// [m/s] Surface speed of one drive.
    pub(crate) fn drive_speed(&self, drive: usize) -> f64 {
        self.state.track_speed(self.model, drive)
    }

    /// [rad] Angles of the flippers relative to the chassis, the front first, upwards > 0.
    pub(crate) fn flipper_angles(self) -> impl Iterator<Item = f64> + 'a {
        let flippers = self.model.flippers.iter().enumerate();
        flippers.map(move |(k, flipper)| flipper.sign() * self.state.over_chassis(k))
    }

    /// [rad/s] Rates of these angles.
    pub(crate) fn flipper_rates(self) -> impl Iterator<Item = f64> + 'a {
        let turns = self.model.flippers.iter().zip(&self.state.flippers);
        turns.map(move |(flipper, turn)| flipper.sign() * (turn.rate - self.state.angular_velocity))
    }

    /// [N m] Torques of the flipper motors, means over the last step, upwards > 0.
    pub(crate) fn flipper_torques(self) -> impl Iterator<Item = f64> + 'a {
        let turns = self.model.flippers.iter().zip(&self.state.flippers);
        turns.map(move |(flipper, turn)| flipper.sign() * turn.torque)
    }
}

impl Simulation {
    /// The present instant.
    pub(crate) fn now(&self) -> StateView<'_> {
        StateView {
            model: self.dynamics.model(),
            state: &self.state,
            time: self.time,
            set_point: self.set_point,
        }
    }

    /// An instant of the last step, whose state is written to `state`.
    pub(crate) fn at<'a>(&'a self, time: f64, state: &'a mut State) -> StateView<'a> {
        if time >= self.time {
            return self.now();
        }
        let last = &self.last;
        let h = self.time - last.began;
        let share = (time - last.began) / h;
        let model = self.dynamics.model();
        state.set_between([&last.before, &self.state], model, (h, share));
        StateView {
            model,
            state,
            time,
            set_point: last.set_point + (self.set_point - last.set_point) * share,
        }
    }

    /// Passes the last step, and the solver's work in it, to the monitor, in parts that end at its checks.
    pub(super) fn observe(&mut self, effort: Effort) {
        // This comes first, because a chain that has come off takes precedence over all other outcomes of the same
        // step.
        if !self.dynamics.model().chains.is_empty() {
            self.monitor.observe_chains(self.dynamics.chain_reading());
        }
        self.monitor.observe_effort(effort);
        let mut scratch = std::mem::take(&mut self.scratch);
        let mut from = self.last.began;
        while from < self.time {
            let look = self.monitor.next_look();
            let to = if look > from {
                look.min(self.time)
            } else {
                self.time
            };
            self.observe_part(from, to, &mut scratch);
            from = to;
        }
        self.scratch = scratch;
    }

    fn observe_part(&mut self, from: f64, to: f64, scratch: &mut Scratch) {
        let middle = self.at(0.5 * (from + to), &mut scratch.state);
        let speeds = &mut scratch.drive_speeds;
        speeds.clear();
        speeds.extend((0..middle.state.drives.len()).map(|k| middle.drive_speed(k)));
        let forward_speed = middle.reading().forward_speed();
        let end = self.at(to, &mut scratch.state);
        let reading = end.reading();
        if !end.model.flippers.is_empty() {
            end.running(&mut scratch.running);
        }
        let drives = self.state.drives.iter().copied();
        self.monitor.observe(
            (&reading, forward_speed),
            self.commands.speed,
            self.dynamics.loaded(),
            drives.zip(speeds.iter().copied()),
            &scratch.running,
        );
    }
}

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

    /// [J] Kinetic energy, including that of the motors' rotors, potential energy relative to y = 0, and energy of the
    /// tensioners and bushings of chains. Energy stored in deformed contacts and stops is not counted.
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
        let of_bushings = |chain: &ChainOfShoes| {
            let pairs = self.state.shoes[chain.shoes.clone()].windows(2);
            let squares: f64 = pairs.map(|pair| pair[0].bend(&pair[1]).powi(2)).sum();
            0.5 * chain.bushing.stiffness * squares
        };
        let bodies: f64 = self.bodies().into_iter().map(of_body).sum();
        let chains = self.dynamics.model().chains.iter();
        let springs = chains.map(|chain| of_tensioner(chain) + of_bushings(chain));
        bodies + springs.sum::<f64>() + self.energy_of_rotors()
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
        // A drive has only inertia; its mass is part of the chassis.
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
