//! The state of motion: the body, its drives, shoes and flippers.
//!
//! The equations: docs/physics.md, "State".

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, Rotation, Twist, Vector, direction, left_of};
use crate::robot::{ChainOfShoes, Flipper, Model, Mount, Running};
use crate::solver::Layout;

/// The state of motion.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    /// [m] Centre of mass.
    pub center: Vector,
    /// [rad] Chassis angle; full turns count.
    pub angle: f64,
    /// [m/s] Velocity of the centre of mass.
    pub velocity: Vector,
    /// [rad/s] Angular velocity of the chassis.
    pub angular_velocity: f64,
    /// State of each drive.
    pub drives: Vec<DriveState>,
    /// The shoes of all chains.
    pub shoes: Vec<Shoe>,
    /// The idlers of all chains.
    pub idlers: Vec<Idler>,
    /// The flippers.
    pub flippers: Vec<Turn>,
}

/// Rotation of a flipper relative to the ground.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Turn {
    /// [rad] Angle; full turns count.
    pub angle: f64,
    /// [rad/s] Rate of the angle.
    pub rate: f64,
    /// [N m] Mean torque of its motor over the last step, counter-clockwise.
    pub torque: f64,
}

/// Pose of a body that carries parts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Carrier {
    /// [m] The centre of mass of the chassis, or the pivot of a flipper.
    pub center: Vector,
    /// [m] The same point in the body's own frame.
    pub origin: Vector,
    /// [rad] Angle of the body.
    pub angle: f64,
}

/// State of the idler of a chain.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Idler {
    /// [m] Travel, outwards.
    pub travel: f64,
    /// [m/s] Its rate.
    pub rate: f64,
}

/// State of a shoe of a chain.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Shoe {
    /// [m] Halfway between its pins.
    pub center: Vector,
    /// [rad] Direction of travel along the chain; full turns count.
    pub angle: f64,
    /// Its velocity.
    pub twist: Twist,
}

impl Shoe {
    fn is_finite(&self) -> bool {
        is_speed(self.twist.velocity)
            && self.twist.turn.is_finite()
            && self.center.is_finite()
            && self.angle.is_finite()
    }

    /// Unit vector along its travel.
    pub(crate) fn along(&self) -> Vector {
        direction(self.angle)
    }

    /// Its frame: x along its travel, y outwards.
    pub(crate) fn pose(&self) -> Pose {
        Pose::new(self.center, self.angle)
    }

    /// [rad] Angle of the next shoe relative to this one, at most half a turn either way.
    pub(crate) fn bend(&self, next: &Self) -> f64 {
        let bend = next.angle - self.angle;
        bend - TAU * (bend / TAU).round()
    }

    /// The shoe after a time [s] at constant velocity.
    pub(crate) fn after(&self, time: f64) -> Self {
        Self {
            center: self.center + self.twist.velocity * time,
            angle: self.angle + self.twist.turn * time,
            ..*self
        }
    }
}

/// State of one drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DriveState {
    /// [rad/s] Spin relative to the ground; 0 for a robot at rest.
    pub spin: f64,
    /// [m] Travel of the surface along its path.
    pub position: f64,
    /// [N] Part of its motor's force that comes from the integral of the speed error, if the motor corrects its speed.
    pub integral: f64,
    /// [N] Mean force of the motor at the surface over the last step.
    pub force: f64,
    /// [N] Mean force of the ground on the robot along the surface over the last step.
    pub traction: f64,
}

impl State {
    /// A robot at rest with its chassis frame at `position`.
    pub(crate) fn at_rest(model: &Model, position: Vector, angle: f64, track_phase: f64) -> Self {
        let rotation = Rotation::new(angle);
        let drive = DriveState {
            position: track_phase,
            ..DriveState::default()
        };
        Self {
            center: position + rotation * model.center_of_mass,
            angle,
            velocity: Vector::ZERO,
            angular_velocity: 0.0,
            drives: vec![drive; model.drives],
            shoes: shoes_at_rest(model, Pose::new(position, angle), track_phase),
            idlers: idlers_at_rest(model, track_phase),
            flippers: flippers_at_rest(model, angle),
        }
    }

    /// Velocity of the chassis.
    pub(crate) fn twist(&self) -> Twist {
        Twist {
            velocity: self.velocity,
            turn: self.angular_velocity,
        }
    }

    /// Writes its velocities as the unknowns of a solve.
    pub(super) fn write_velocities(&self, layout: Layout, into: &mut [f64]) {
        into[..3].copy_from_slice(&self.twist().entries());
        for (k, flipper) in self.flippers.iter().enumerate() {
            into[layout.joint(k)] = flipper.rate;
        }
        for (k, drive) in self.drives.iter().enumerate() {
            into[layout.spin(k)] = drive.spin;
        }
        for (k, idler) in self.idlers.iter().enumerate() {
            into[layout.slide(k)] = idler.rate;
        }
        let links = into[layout.link(0)..].chunks_exact_mut(3);
        for (link, shoe) in links.zip(&self.shoes) {
            link.copy_from_slice(&shoe.twist.entries());
        }
    }

    /// Takes the velocities that a solve has found.
    pub(super) fn take_velocities(&mut self, layout: Layout, found: &[f64]) {
        let twist = |own: &[f64]| Twist::from([own[0], own[1], own[2]]);
        let base = twist(found);
        (self.velocity, self.angular_velocity) = (base.velocity, base.turn);
        for (k, flipper) in self.flippers.iter_mut().enumerate() {
            flipper.rate = found[layout.joint(k)];
        }
        for (k, drive) in self.drives.iter_mut().enumerate() {
            drive.spin = found[layout.spin(k)];
        }
        for (k, idler) in self.idlers.iter_mut().enumerate() {
            idler.rate = found[layout.slide(k)];
        }
        let links = found[layout.link(0)..].chunks_exact(3);
        for (link, shoe) in links.zip(&mut self.shoes) {
            shoe.twist = twist(link);
        }
    }

    /// Pose of the chassis frame.
    pub(crate) fn pose(&self, model: &Model) -> Pose {
        pose_at(self.center, self.angle, model)
    }

    /// The same after a time [s] at constant velocity.
    pub(crate) fn pose_after(&self, time: f64, model: &Model) -> Pose {
        let (center, angle) = self.mass_pose_after(time);
        pose_at(center, angle, model)
    }

    /// Computes where the moving parts are after a time [s].
    pub(crate) fn running_after(&self, time: f64, model: &Model, running: &mut Running) {
        let speeds = (0..self.drives.len()).map(|k| self.track_speed(model, k));
        let drives = self.drives.iter().zip(speeds);
        let drives = drives.map(|(d, speed)| d.position + speed * time);
        let has_shoes = !self.shoes.is_empty();
        let back = has_shoes.then(|| self.pose_after(time, model).inverse());
        let shoes = back.iter().flat_map(|back| {
            let shoes = self.shoes.iter();
            shoes.map(|shoe| *back * shoe.after(time).pose())
        });
        let turns = self.flippers.iter().enumerate().map(|(k, flipper)| {
            let rate = flipper.rate - self.angular_velocity;
            self.over_chassis(k) + rate * time
        });
        model.set_running(running, drives, shoes, turns);
    }

    /// [rad] Angle of a flipper relative to the chassis, counter-clockwise.
    pub(crate) fn over_chassis(&self, flipper: usize) -> f64 {
        self.flippers[flipper].angle - self.angle
    }

    /// The carrier of a part after a time [s] at constant velocity.
    pub(super) fn carrier(&self, mount: Mount, time: f64, model: &Model) -> Carrier {
        let (center, angle) = self.mass_pose_after(time);
        match mount {
            Mount::Flipper(k) => {
                let arm = &model.flippers[k];
                let pivot = arm.pivot - model.center_of_mass;
                Carrier {
                    center: center + Rotation::new(angle) * pivot,
                    origin: -arm.arm,
                    angle: self.flippers[k].angle + self.flippers[k].rate * time,
                }
            }
            Mount::Chassis | Mount::Shoe(_) => Carrier {
                center,
                origin: model.center_of_mass,
                angle,
            },
        }
    }

    /// [m] Travel of a drive's surface relative to a mount.
    pub(super) fn run_over(&self, mount: Mount, drive: usize, model: &Model) -> f64 {
        let run = self.drives[drive].position;
        match mount {
            Mount::Flipper(k) => run + Flipper::run(self.over_chassis(k), model.drive_radius),
            Mount::Chassis | Mount::Shoe(_) => run,
        }
    }

    /// [m/s] Speed of a drive's surface relative to a mount.
    pub(super) fn speed_over(&self, mount: Mount, drive: usize, model: &Model) -> f64 {
        let turn = match mount {
            Mount::Flipper(k) => self.flippers[k].rate,
            Mount::Chassis | Mount::Shoe(_) => self.angular_velocity,
        };
        (turn - self.drives[drive].spin) * model.drive_radius
    }

    /// Makes this state equal to another one, without allocating memory.
    pub(crate) fn copy(&mut self, other: &Self) {
        (self.center, self.angle) = (other.center, other.angle);
        (self.velocity, self.angular_velocity) = (other.velocity, other.angular_velocity);
        self.drives.clone_from(&other.drives);
        self.shoes.clone_from(&other.shoes);
        self.idlers.clone_from(&other.idlers);
        self.flippers.clone_from(&other.flippers);
    }

    /// [m/s] Upper bound of the speed of any point; `reach` is the farthest from the centre of mass.
    pub(crate) fn fastest(&self, reach: f64) -> f64 {
        let turns = self.flippers.iter().map(|flipper| flipper.rate.abs());
        let turn = turns.fold(self.angular_velocity.abs(), f64::max);
        self.velocity.length() + turn * reach
    }

    /// Centre of mass [m] and angle [rad] after a time [s] at constant velocity.
    pub(crate) fn mass_pose_after(&self, time: f64) -> (Vector, f64) {
        (
            self.center + self.velocity * time,
            self.angle + self.angular_velocity * time,
        )
    }

    /// [m/s] Velocity of a point fixed to the chassis.
    pub(crate) fn velocity_at(&self, point: Vector) -> Vector {
        self.velocity + self.angular_velocity * left_of(point - self.center)
    }

    /// [m/s] Surface speed of a drive; positive drives towards +x.
    pub(crate) fn track_speed(&self, model: &Model, drive: usize) -> f64 {
        (self.angular_velocity - self.drives[drive].spin) * model.drive_radius
    }

    /// Makes the shoes move with the chassis, and along their chains at a track speed [m/s].
    pub(crate) fn run_shoes(&mut self, model: &Model, track_speed: f64) {
        let pose = self.pose(model);
        for chain in &model.chains {
            for i in chain.shoes.clone() {
                let origin = self.shoes[i].center;
                let on_chassis = pose.inverse_transform_point(origin);
                let motion = chain.path.motion_at(on_chassis);
                let along = motion.at(on_chassis) * track_speed;
                self.shoes[i].twist = Twist {
                    velocity: self.velocity_at(origin) + pose.rotation * along,
                    turn: self.angular_velocity - motion.turn * track_speed,
                };
            }
        }
    }

    /// Whether a robot can be in this state: it has the robot's parts, and none of them is far away.
    pub(crate) fn fits(&self, model: &Model) -> bool {
        /// [m] Largest distance from the chassis to a shoe.
        const FAR: f64 = 1e3;
        /// [m/s], [rad/s], [rad] No run comes near these values; only something in free fall gets ever faster.
        const MOST: f64 = 1e6;
        const FALLS: f64 = -1e9;

        let counts = [
            (self.drives.len(), model.drives),
            (self.shoes.len(), model.shoes()),
            (self.idlers.len(), model.chains.len()),
            (self.flippers.len(), model.flippers.len()),
        ];
        let velocity = |v: Vector| v.x.abs() < MOST && (FALLS..MOST).contains(&v.y);
        counts.iter().all(|(has, needs)| has == needs)
            && self.is_finite()
            && velocity(self.velocity)
            && self.angular_velocity.abs() < MOST
            && self.angle.abs() < MOST
            && self.drives.iter().all(|d| d.spin.abs() < MOST)
            && self.flippers.iter().all(|f| f.rate.abs() < MOST)
            && self
                .idlers
                .iter()
                .all(|i| i.travel.abs() < FAR && i.rate.abs() < MOST)
            && self.shoes.iter().all(|shoe| {
                let near = (shoe.center - self.center).length() < FAR;
                near && velocity(shoe.twist.velocity) && shoe.twist.turn.abs() < MOST
            })
    }

    /// Whether all of its numbers are finite, and no speed is above that of light.
    pub(crate) fn is_finite(&self) -> bool {
        let body = self.center.is_finite() && is_speed(self.velocity);
        let turn = self.angle.is_finite() && self.angular_velocity.is_finite();
        body && turn
            && self
                .drives
                .iter()
                .all(|d| d.spin.is_finite() && d.position.is_finite() && d.integral.is_finite())
            && self.shoes.iter().all(Shoe::is_finite)
            && self.idlers.iter().all(|i| i.travel.is_finite())
            && self
                .flippers
                .iter()
                .all(|f| f.angle.is_finite() && f.rate.is_finite())
    }
}

/// Whether it is below the speed of light [m/s], which failed solves soon exceed.
fn is_speed(velocity: Vector) -> bool {
    velocity.length() < 3e8
}

/// The shoes of a robot at rest with its chassis frame at `pose`.
pub(crate) fn shoes_at_rest(model: &Model, pose: Pose, track_phase: f64) -> Vec<Shoe> {
    let of_chain = |chain: &ChainOfShoes| chain.path.places(track_phase);
    let places = model.chains.iter().flat_map(of_chain);
    let shoe = |place: Pose| {
        let place = pose * place;
        Shoe {
            center: place.translation,
            angle: place.rotation.angle(),
            twist: Twist::default(),
        }
    };
    places.map(shoe).collect()
}

/// The idlers of a robot at rest, in the position where its chains are taut.
pub(crate) fn idlers_at_rest(model: &Model, track_phase: f64) -> Vec<Idler> {
    let idler = |chain: &ChainOfShoes| Idler {
        travel: chain.path.travel(track_phase),
        rate: 0.0,
    };
    model.chains.iter().map(idler).collect()
}

/// The flippers of a robot at rest, at an angle [rad].
pub(crate) fn flippers_at_rest(model: &Model, angle: f64) -> Vec<Turn> {
    let turned = |arm: &Flipper| Turn {
        angle: angle + arm.sign() * arm.start_angle,
        ..Turn::default()
    };
    model.flippers.iter().map(turned).collect()
}

fn pose_at(center: Vector, angle: f64, model: &Model) -> Pose {
    let rotation = Rotation::new(angle);
    Pose::from_parts(center - rotation * model.center_of_mass, rotation)
}
