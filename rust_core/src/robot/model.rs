//! The robot as it is simulated: one body, the parts that meet the ground, and the drives.

use std::ops::Range;

use super::{BodyKind, ChainOfShoes, Flipper, MotorRule, Mount, Part, Running, Shape, track};
use crate::geometry::{Disc, Envelope, Pose, Vector};
use crate::scenario::{Robot, ScenarioError, Track};

/// Everything about a robot that does not change during a run.
#[derive(Clone, Debug)]
pub struct Model {
    /// [kg] Mass without chains and flippers, which `total_mass` includes.
    pub mass: f64,
    /// [m] Its centre in the chassis frame.
    pub center_of_mass: Vector,
    /// [kg m^2] Moment of inertia without the parts that turn with the drives.
    pub moment_of_inertia: f64,
    /// Parts that can meet the ground, in the order of `in_order`.
    pub parts: Vec<Part>,
    /// Number of drives.
    pub drives: usize,
    /// Number of drives with a motor, which are `driven`.
    pub motors: usize,
    /// [kg] Mass that moves at the surface speed, for each drive.
    pub drive_masses: Vec<f64>,
    /// [m] Radius that relates surface speed and spin of a drive.
    pub drive_radius: f64,
    /// The limits of each motor.
    pub motor: MotorRule,
    /// Whether a drive, `push_drive`, pushes the chassis along its axis, even in the air.
    pub pushes_chassis: bool,
    /// Chains of shoes, each with the drive of the same number. If there are any, `mass`, `center_of_mass` and
    /// `moment_of_inertia` are those of the chassis without them.
    pub chains: Vec<ChainOfShoes>,
    /// Arms that pivot on it; those figures do not include their mass either.
    pub flippers: Vec<Flipper>,
    /// Whether no track runs round the wheels on the chassis, and on the flippers.
    pub wheels_alone: [bool; 2],
}

impl Model {
    /// The model of a robot, both tracks lumped; mass, centre of mass and moments of inertia are those of the real
    /// robot for every track model.
    ///
    /// # Errors
    /// Wheels that do not fit the robot; shoes and arms that leave no mass for the chassis.
    pub fn new(robot: &Robot) -> Result<Self, ScenarioError> {
        let track = track::build(robot)?;
        let belly = robot.belly_polygons().map(|corners| {
            let corners = corners.iter().copied().map(Vector::from).collect();
            Part::new(BodyKind::Belly, Shape::Polygon { corners }, None)
        });
        let parts = Self::in_order(track.parts, belly);
        let radius = robot.outline.rear_radius();
        let flippers = Flipper::of(robot);
        // A chain has all of the track's mass and force; only flippers have other drives.
        let has_chain = !track.chains.is_empty();
        let (sharers, of_track) = if has_chain {
            (1, 1)
        } else {
            (track.motors, track.drives)
        };
        let mut drive_masses = vec![robot.track_mass / of_track as f64; of_track];
        let beside = flippers.iter().map(Flipper::mass_of_track);
        drive_masses.extend(beside.take(track.drives - of_track));
        let circulating = robot.track_mass + drive_masses[of_track..].iter().sum::<f64>();
        let model = Self {
            mass: robot.mass,
            center_of_mass: Vector::from(robot.center_of_mass),
            moment_of_inertia: robot.moment_of_inertia - circulating * radius * radius,
            parts,
            drives: track.drives,
            motors: track.motors,
            drive_masses,
            drive_radius: radius,
            motor: MotorRule::of(&robot.drivetrain, &robot.outline).shared(1, sharers),
            pushes_chassis: track.pushes_chassis,
            chains: Vec::new(),
            flippers: Vec::new(),
            wheels_alone: [
                !robot.track.is_track(),
                (robot.flippers.as_ref())
                    .is_some_and(|arms| !arms.track_model(&robot.track).is_track()),
            ],
        }
        .with_flippers(flippers)
        .with_chains(track.chains);
        let left = model.moment_of_inertia;
        if left <= 0.0 {
            let rule = format!(
                "must exceed that of all moving parts; it leaves the chassis {left} kg m^2"
            );
            let path = "robot.moment_of_inertia";
            return Err(ScenarioError::new(path, robot.moment_of_inertia, rule));
        }
        match &robot.track {
            Track::Closed(closed) => model.closed(closed.surface, &robot.outline),
            _ => Ok(model),
        }
    }

    /// The order of parts: the belly is the last, so that the others keep their numbers without it.
    pub(super) fn in_order(
        of_tracks: Vec<Part>,
        belly: impl IntoIterator<Item = Part>,
    ) -> Vec<Part> {
        let mut parts = of_tracks;
        parts.extend(belly);
        parts
    }

    /// The parts except the belly.
    pub(super) fn track_parts(&self) -> impl Iterator<Item = &Part> {
        self.parts
            .iter()
            .filter(|part| part.kind != BodyKind::Belly)
    }

    /// The parts of the belly.
    pub(super) fn belly(&self) -> impl Iterator<Item = &Part> {
        self.parts
            .iter()
            .filter(|part| part.kind == BodyKind::Belly)
    }

    /// The drives with a motor; the others turn freely.
    pub(crate) fn driven(&self) -> Range<usize> {
        0..self.motors
    }

    /// Whether a drive has a motor.
    pub(crate) fn has_motor(&self, drive: usize) -> bool {
        self.driven().contains(&drive)
    }

    /// Whether a drive is that of the chain of the same number.
    pub(crate) fn has_chain(&self, drive: usize) -> bool {
        drive < self.chains.len()
    }

    /// The drive that pushes the chassis.
    pub(crate) fn push_drive(&self) -> Option<usize> {
        self.pushes_chassis.then_some(0)
    }

    /// Indices of the drives in a list of all motors.
    pub(crate) fn drive_motors(&self) -> Range<usize> {
        0..self.drives
    }

    /// Indices of the flippers in a list of all motors.
    pub(crate) fn flipper_motors(&self) -> Range<usize> {
        self.drives..self.drives + self.flippers.len()
    }

    /// Positions of the moving parts at time 0, with the tracks advanced by `track_phase` [m].
    pub(crate) fn running_at_start(&self, track_phase: f64) -> Running {
        let mut running = Running::default();
        let drives = std::iter::repeat_n(track_phase, self.drives);
        let places = |chain: &ChainOfShoes| chain.path.places(track_phase);
        let shoes = self.chains.iter().flat_map(places);
        let turns = self.flippers.iter().map(|arm| arm.sign() * arm.start_angle);
        self.set_running(&mut running, drives, shoes, turns);
        running
    }

    /// The same with given positions of drives [m], frames of shoes in that of the chassis, and angles of flippers
    /// [rad] relative to it, counter-clockwise: at the start, in a step, or at a sample of a trace.
    pub(crate) fn set_running(
        &self,
        running: &mut Running,
        drives: impl Iterator<Item = f64>,
        shoes: impl Iterator<Item = Pose>,
        turns: impl Iterator<Item = f64>,
    ) {
        running.drives.clear();
        running.drives.extend(drives);
        running.shoes.clear();
        running.shoes.extend(shoes);
        let flippers = self.flippers.iter().zip(turns);
        let mounted = flippers.map(|(arm, turn)| arm.mounted(turn, self.drive_radius));
        running.flippers.clear();
        running.flippers.extend(mounted);
    }

    /// [kg m^2] Moment of inertia of one drive.
    pub(crate) fn drive_inertia(&self, drive: usize) -> f64 {
        self.drive_masses[drive] * self.drive_radius * self.drive_radius
    }

    /// [kg m^2] Moment of inertia of the rotor of one drive, for its rotation relative to the chassis.
    pub(crate) fn rotor_inertia(&self, drive: usize) -> f64 {
        if self.has_motor(drive) {
            self.motor.rotor_mass * self.drive_radius * self.drive_radius
        } else {
            0.0
        }
    }

    /// [kg m^2] Moment of inertia with all drives locked to the chassis.
    pub(crate) fn locked_inertia(&self) -> f64 {
        let drives = (0..self.drives).map(|k| self.drive_inertia(k));
        self.moment_of_inertia + drives.sum::<f64>()
    }

    /// Number of shoes in all chains.
    pub(crate) fn shoes(&self) -> usize {
        self.chains.iter().map(|chain| chain.shoes.len()).sum()
    }

    /// Number of lanes under the tracks.
    pub(crate) fn tracks(&self) -> usize {
        let lanes = self.track_parts().map(|part| part.lane + 1);
        lanes.max().unwrap_or(1)
    }

    /// The mounts that carry bodies of tracks or wheels: the chassis and the flippers.
    pub fn mounts(&self) -> impl Iterator<Item = Mount> + use<> {
        let flippers = (0..self.flippers.len()).map(Mount::Flipper);
        std::iter::once(Mount::Chassis).chain(flippers)
    }

    /// Whether a track runs round the bodies on a mount.
    pub fn has_track(&self, on: Mount) -> bool {
        let [chassis, flippers] = self.wheels_alone;
        match on {
            Mount::Chassis | Mount::Shoe(_) => !chassis,
            Mount::Flipper(_) => !flippers,
        }
    }

    /// The mounts that carry a track.
    pub(crate) fn mounts_of_tracks(&self) -> impl Iterator<Item = Mount> + '_ {
        self.mounts().filter(|mount| self.has_track(*mount))
    }

    /// Circumscribed and root circles of the bodies of the track on a mount and a lane.
    pub(crate) fn discs_of_track(
        &self,
        lane: usize,
        on: Mount,
    ) -> impl Iterator<Item = (Disc, Disc)> + '_ {
        let is_of_track = move |part: &&Part| part.lane == lane && part.mount == on;
        let of_track = self.parts.iter().filter(is_of_track);
        of_track.flat_map(|part| part.discs().collect::<Vec<_>>())
    }

    /// The taut belts round the circumscribed and the root circles of a track's bodies, as points in the frame of the
    /// mount, counter-clockwise; arcs are divided every `turn` [rad].
    pub fn envelopes(&self, on: Mount, turn: f64) -> [Vec<Vector>; 2] {
        let (tips, roots): (Vec<Disc>, Vec<Disc>) = self.discs_of_track(0, on).unzip();
        [tips, roots].map(|discs| {
            let mut points = Envelope::new(&discs).polyline(turn);
            points.reverse();
            points
        })
    }

    /// Speed of the fastest tip that a drive moves, relative to its carrier and in units of the surface speed; 0 if
    /// surfaces only move tangentially.
    pub(crate) fn tip_speed(&self) -> f64 {
        let of_part = |part: &Part| match &part.shape {
            Shape::Gear { .. } => 1.0,
            Shape::Hull {
                discs,
                grouser_height,
            } if *grouser_height > 0.0 => {
                let least = discs.iter().map(|d| d.radius).fold(f64::INFINITY, f64::min);
                1.0 + grouser_height / least
            }
            _ => 0.0,
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }

    /// [m] Largest distance of any part from the centre of mass.
    pub(crate) fn reach(&self) -> f64 {
        let from_center = |p: &Vector| (*p - self.center_of_mass).length();
        let of_part = |part: &Part| match &part.shape {
            // Shoes and arms reach at most a corner beyond the hull that they travel round.
            _ if part.mount != Mount::Chassis => 0.0,
            Shape::Polygon { corners } => corners.iter().map(from_center).fold(0.0, f64::max),
            // Grousers have no discs: they are never beyond the circles of the belt's hull.
            _ => part
                .discs()
                .map(|(tip, _)| from_center(&tip.center) + tip.radius)
                .fold(0.0, f64::max),
        };
        let of_flipper = |flipper: &Flipper| from_center(&flipper.pivot) + flipper.reach;
        let parts = self.parts.iter().map(of_part);
        let flippers = self.flippers.iter().map(of_flipper);
        parts.chain(flippers).fold(0.0, f64::max)
    }
}
