//! The motion of one rigid body with drives, in steps of some microseconds.

use crawler2d_core::{Ground, Reading, Scenario, Simulation, Vector};

use super::distance::{Finder, Touch};
use super::ground::Lane;
use super::law::{Bristles, Motion};
use super::robot::{Form, Part, Robot};
use super::{Turn, cross, right_of};
use crate::common::checked;

/// How finely the judge looks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// [s] Step.
    pub time_step: f64,
    /// [N/m] Of every touch, along its normal and along its tangent.
    pub stiffness: f64,
    /// Damping of an impact over the critical one: at 4 it returns 1 / (4 x 4^2), under 2 %, of its
    /// speed.
    pub damping: f64,
}

/// With a quarter of the stiffness contacts settle slowly enough, in 6 ms, to help a robot out of a jam.
impl Default for Settings {
    fn default() -> Self {
        Self {
            time_step: 5e-6,
            stiffness: 4e7,
            damping: 4.0,
        }
    }
}

/// [m] The faces near a part are looked for anew when it has come this far.
const MARGIN: f64 = 0.02;

/// A robot on its way.
pub(crate) struct Judge {
    robot: Robot,
    ground: Lane,
    settings: Settings,
    gravity: f64,
    command: f64,
    acceleration: f64,
    set_point: f64,
    /// Centre of mass.
    center: Vector,
    velocity: Vector,
    angle: f64,
    spin: f64,
    /// [m] Way of each drive's surface over the chassis, and its speed.
    ways: Vec<f64>,
    speeds: Vec<f64>,
    near: Vec<std::ops::Range<usize>>,
    looked_from: (Vector, f64),
    bristles: Bristles,
    touches: Vec<Touch>,
    /// [N] Force of the ground on each part in the last step.
    pub(crate) loads: Vec<Vector>,
    /// [m] Deepest overlap so far.
    pub(crate) deepest: f64,
    spring_energy: f64,
}

impl Judge {
    /// At rest where the scenario starts, which is part of the description.
    pub(crate) fn new(scenario: &Scenario, settings: Settings) -> Self {
        let ground =
            Ground::new(&scenario.terrain, scenario.robot.gauge).expect("the ground can be built");
        let ground = Lane::new(&ground);
        let robot = Robot::new(scenario, ground.friction);
        let start = Simulation::new(&checked(scenario));
        let start = start.reading();
        let center = start.position + Turn::by(start.chassis_angle).of(robot.center_of_mass);
        let mut judge = Self {
            settings,
            gravity: scenario.gravity,
            command: scenario.drive.speed,
            acceleration: scenario.robot.drivetrain.max_acceleration,
            set_point: 0.0,
            center,
            velocity: Vector::ZERO,
            angle: start.chassis_angle,
            spin: 0.0,
            ways: vec![scenario.start.track_phase; robot.drives],
            speeds: vec![0.0; robot.drives],
            near: vec![0..0; robot.parts.len()],
            looked_from: (center, start.chassis_angle),
            bristles: Bristles::default(),
            touches: Vec::new(),
            loads: vec![Vector::ZERO; robot.parts.len()],
            deepest: 0.0,
            spring_energy: 0.0,
            robot,
            ground,
        };
        judge.look_round();
        judge
    }

    /// At rest where a reading has it, with the motors on.
    pub(crate) fn at_rest(scenario: &Scenario, settings: Settings, there: &Reading) -> Self {
        let mut judge = Self::new(scenario, settings);
        judge.angle = there.chassis_angle;
        judge.center =
            there.position + Turn::by(there.chassis_angle).of(judge.robot.center_of_mass);
        judge.ways.fill(there.track_position);
        judge.set_point = judge.command;
        judge.look_round();
        judge
    }

    /// [m] Origin of the chassis frame.
    pub(crate) fn position(&self) -> Vector {
        self.center - Turn::by(self.angle).of(self.robot.center_of_mass)
    }

    /// [m/s] Velocity of the centre of mass.
    pub(crate) fn velocity(&self) -> Vector {
        self.velocity
    }

    /// [rad] Nose up > 0.
    pub(crate) fn angle(&self) -> f64 {
        self.angle
    }

    /// [m/s] Surface speed of each drive.
    pub(crate) fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// Sets the robot in motion without turning.
    pub(crate) fn launch(&mut self, shift: Vector, velocity: Vector) {
        self.center += shift;
        self.velocity = velocity;
        self.look_round();
    }

    /// [J] Of motion, height and springs.
    pub(crate) fn energy(&self) -> f64 {
        let r = &self.robot;
        let circulating = |s: &f64| (r.drive_radius * self.spin - s).powi(2) * r.drive_mass;
        0.5 * (r.mass * self.velocity.dot(self.velocity)
            + r.inertia * self.spin * self.spin
            + self.speeds.iter().map(circulating).sum::<f64>())
            + r.mass * self.gravity * self.center.y
            + self.spring_energy
    }

    /// Advances by about `duration` [s].
    pub(crate) fn advance(&mut self, duration: f64) {
        for _ in 0..(duration / self.settings.time_step).round() as u64 {
            self.step();
        }
    }

    fn look_round(&mut self) {
        self.looked_from = (self.center, self.angle);
        let turn = Turn::by(self.angle);
        for (near, part) in self.near.iter_mut().zip(&self.robot.parts) {
            let place = self.center + turn.of(part.place());
            *near = self.ground.near(place, part.reach + MARGIN);
        }
    }

    fn has_come_far(&self) -> bool {
        let (center, angle) = self.looked_from;
        let turned = (self.angle - angle).abs();
        let farthest = self.robot.parts.iter().map(|p| p.place().length());
        (self.center - center).length() + turned * farthest.fold(0.0, f64::max) > 0.9 * MARGIN
    }

    fn find_touches(&mut self) {
        let turn = Turn::by(self.angle);
        self.touches.clear();
        for (i, part) in self.robot.parts.iter().enumerate() {
            if self.near[i].is_empty() {
                continue;
            }
            let wheel = match (&part.form, part.drive) {
                // Driving forwards is turning clockwise.
                (Form::Toothed { wheel, .. }, Some((drive, radius))) => {
                    self.angle + wheel.phase - self.ways[drive] / radius
                }
                _ => 0.0,
            };
            let mut finder = Finder {
                ground: &self.ground,
                range: self.near[i].clone(),
                part: i,
                touches: &mut self.touches,
            };
            finder.find(part, self.center + turn.of(part.place()), turn, wheel);
        }
    }

    /// One step: forces of now, speeds from them, places from the new speeds.
    pub(crate) fn step(&mut self) {
        let dt = self.settings.time_step;
        self.find_touches();
        self.bristles.next_step();
        let mut force = Vector::new(0.0, -self.robot.mass * self.gravity);
        let mut moment = 0.0;
        let mut pulls = vec![0.0; self.robot.drives];
        self.loads.fill(Vector::ZERO);
        let (turn, mut squares) = (Turn::by(self.angle), 0.0);
        for touch in &self.touches {
            let part = &self.robot.parts[touch.part];
            let arm = touch.point - self.center;
            let surface = surface(part, arm - turn.of(part.place()));
            let along = |direction: Vector| {
                let lever = surface.dot(direction);
                let driven = part
                    .drive
                    .map_or(0.0, |(drive, _)| self.speeds[drive] * lever);
                let turned = cross(arm, direction);
                Motion {
                    speed: self.velocity.dot(direction) + self.spin * turned + driven,
                    mass: self.robot.mass_at(turned, lever, part.drive.is_some()),
                }
            };
            let tangent = right_of(touch.normal);
            let motions = [along(touch.normal), along(tangent)];
            let [pressing, dragging] =
                self.bristles
                    .force(touch, part.friction, self.settings, motions);
            let total = touch.normal * pressing + tangent * dragging;
            force += total;
            moment += cross(arm, total);
            if let Some((drive, _)) = part.drive {
                pulls[drive] += surface.dot(total);
            }
            self.loads[touch.part] += total;
            self.deepest = self.deepest.max(touch.depth);
            squares += touch.depth * touch.depth;
        }
        self.spring_energy = 0.5 * self.settings.stiffness * (squares + self.bristles.bends());

        let rate = self.acceleration * dt;
        self.set_point += (self.command - self.set_point).clamp(-rate, rate);
        self.drive(moment, &pulls);
        self.velocity += force * (dt / self.robot.mass);
        self.center += self.velocity * dt;
        self.angle += self.spin * dt;
        for (way, speed) in self.ways.iter_mut().zip(&self.speeds) {
            *way += speed * dt;
        }
        if self.has_come_far() {
            self.look_round();
        }
    }

    /// New spin and surface speeds under the moment and the pulls of the ground.
    ///
    /// A motor works between chassis and drive. With the angular acceleration a of the chassis
    /// m (s' - r a) = pull + motor for each drive, I a = moment + r sum(pull + motor), without the drives'
    /// inertia in I. What a motor has to give to meet its set-point falls with a, so that there is
    /// one solution, found by guessing which motors are at their limit.
    fn drive(&mut self, moment: f64, pulls: &[f64]) {
        let r = &self.robot;
        let dt = self.settings.time_step;
        let needed = |drive: usize, a: f64| {
            let gain = (self.set_point - self.speeds[drive]) / dt;
            r.drive_mass * (gain - r.drive_radius * a) - pulls[drive]
        };
        let mut a = 0.0;
        for tries in 0.. {
            assert!(tries < 100, "the motors find their forces");
            let (mut push, mut inertia) = (moment, r.inertia);
            for (drive, pull) in pulls.iter().enumerate() {
                let motor = needed(drive, a);
                if motor.abs() < r.drive_force {
                    push += r.drive_radius * (needed(drive, 0.0) + pull);
                    inertia += r.drive_mass * r.drive_radius * r.drive_radius;
                } else {
                    push += r.drive_radius * (r.drive_force.copysign(motor) + pull);
                }
            }
            let next = push / inertia;
            if (next - a).abs() <= 1e-12 * (1.0 + a.abs()) {
                break;
            }
            a = next;
        }
        let limit = r.drive_force;
        let gains: Vec<f64> = (0..pulls.len())
            .map(|drive| {
                let motor = needed(drive, a).clamp(-limit, limit);
                (pulls[drive] + motor) / r.drive_mass + r.drive_radius * a
            })
            .collect();
        self.spin += a * dt;
        for (speed, gain) in self.speeds.iter_mut().zip(gains) {
            *speed += gain * dt;
        }
    }
}

/// Velocity of a part's surface over the chassis, for a surface speed of 1, at a spoke from its centre.
fn surface(part: &Part, spoke: Vector) -> Vector {
    part.drive
        .map_or(Vector::ZERO, |(_, radius)| right_of(spoke) / radius)
}

impl Robot {
    /// [kg] What an impact meets whose arm about the centre of mass is `turned` and whose lever on the
    /// drive, if the part has one, is `lever`.
    fn mass_at(&self, turned: f64, lever: f64, driven: bool) -> f64 {
        let lever = if driven { lever } else { 0.0 };
        let spun = turned + self.drive_radius * lever;
        1.0 / (1.0 / self.mass + spun * spun / self.inertia + lever * lever / self.drive_mass)
    }
}
