//! Legal values that are probably mistakes: a size in the wrong unit, an angle in degrees, a field without effect.
//!
//! Where possible, bounds are lengths of the robot itself, and lie far beyond what anyone builds or drives over.

use std::f64::consts::{PI, TAU};

use super::fields::joined;
use super::{
    CircumferentialWheels, Flippers, Gait, LineOfWheels, Robot, Scenario, ScenarioError,
    SegmentalTrack, Terrain, Track,
};

/// Obstacles larger than this many robot lengths are probably mistakes, as is a goal this many times farther than a run
/// gets.
const FAR: f64 = 3.0;
/// Fraction of the robot's length that is visible as penetration of the ground.
const SUNK: f64 = 1e-3;
/// [kg/m^3] Densities far from those of any robot.
const AIR: f64 = 1.2;
const GOLD: f64 = 19_300.0;
/// Friction that no ground has: rubber on dry concrete has about 1.
const MOST_FRICTION: f64 = 3.0;

/// A warning about a field; the scenario is accepted nevertheless.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Dotted path of the field, for example `terrain.height`.
    pub path: String,
    /// Its value.
    pub value: f64,
    /// Why it is probably a mistake: "is usually ...".
    pub reason: String,
}

/// Collects warnings.
#[derive(Default)]
struct Warnings(Vec<Warning>);

impl Warnings {
    fn add(&mut self, path: impl Into<String>, value: f64, reason: impl Into<String>) {
        let (path, reason) = (path.into(), reason.into());
        self.0.push(Warning {
            path,
            value,
            reason,
        });
    }

    /// Warns of a magnitude beyond `most`; `what` describes that limit in words.
    fn at_most(
        &mut self,
        path: impl Into<String>,
        value: f64,
        (most, unit): (f64, &str),
        what: &str,
    ) {
        if value.abs() > most {
            let reason = format!("is usually at most {most:.3} {unit}, {what}");
            self.add(path, value, reason);
        }
    }

    fn angle(&mut self, path: impl Into<String>, value: f64) {
        let reason = "is usually between -3.14 and 3.14 rad, because angles are in radians";
        if value.abs() > PI {
            self.add(path, value, reason);
        }
    }
}

impl Scenario {
    /// All warnings about a scenario whose goal is `to_goal` [m] away, on ground that ends at `end` [m]; takes only a
    /// few comparisons.
    pub(crate) fn warnings(&self, to_goal: f64, end: f64) -> Vec<Warning> {
        let mut warnings = Warnings::default();
        self.robot.add_warnings(&mut warnings);
        self.terrain
            .add_warnings("terrain", self.robot.length(), &mut warnings);
        self.warn_of_drive(to_goal, &mut warnings);
        self.warn_of_goal(to_goal, end, &mut warnings);
        let most = (30.0, "m/s^2");
        warnings.at_most("gravity", self.gravity, most, "more than on any planet");
        self.warn_of_softness(&mut warnings);
        warnings.0
    }

    /// An error about the start of the robot, with the first warning about the robot itself, which is the likely
    /// reason.
    pub(crate) fn explained(&self, mut error: ScenarioError) -> ScenarioError {
        let mut warnings = Warnings::default();
        self.robot.add_warnings(&mut warnings);
        if let Some(warning) = warnings.0.first() {
            let why = format!(" ({} = {} {})", warning.path, warning.value, warning.reason);
            error.rule.push_str(&why);
        }
        error
    }

    /// Warns of a goal that no robot reaches, since it must be entirely past it with both end axles over the ground,
    /// and of a goal that is behind the robot at the start.
    fn warn_of_goal(&self, to_goal: f64, end: f64, warnings: &mut Warnings) {
        let outline = &self.robot.outline;
        let last = end - outline.axle_distance() - outline.rear_radius();
        let given = match (self.goal, &self.terrain) {
            (Some(goal), _) => Some(("goal", goal)),
            (None, Terrain::Points { goal, .. }) => Some(("terrain.goal", *goal)),
            _ => None,
        };
        if let Some((path, goal)) = given.filter(|(_, goal)| *goal > last) {
            let reason = format!(
                "cannot be cleared: beyond {last:.3} m the robot leaves the ground, which ends at {end:.3} m"
            );
            warnings.add(path, goal, reason);
        }
        if let Some((path, goal)) = given.filter(|_| to_goal <= 0.0) {
            let reason = "is behind the robot at its start, which clears where it stands";
            warnings.add(path, goal, reason);
        }
    }

    /// Warns of contacts so soft that the robot visibly penetrates the ground under its own weight.
    ///
    /// A contact is a spring of stiffness m (2 pi f)^2, where m is the robot's mass. Its weight on one contact presses
    /// it in by g / (2 pi f)^2, whatever its mass; the damper decides how long that takes. The contacts of shoes are
    /// softer.
    fn warn_of_softness(&self, warnings: &mut Warnings) {
        let frequency = self.solver.contact_frequency;
        let sinkage = self.gravity / (TAU * frequency).powi(2);
        if sinkage > SUNK * self.robot.length() {
            let reason = format!(
                "is so low that the robot sinks up to {sinkage:.2e} m into rigid ground under its own weight, gravity / (2 pi f)^2"
            );
            warnings.add("solver.contact_frequency", frequency, reason);
        }
    }

    fn warn_of_drive(&self, to_goal: f64, warnings: &mut Warnings) {
        let drive = &self.drive;
        match &drive.gait {
            Some(Gait::Hold(hold)) => {
                warnings.angle("drive.gait.angle", hold.angle);
                for (end, angle) in [("front", hold.front), ("rear", hold.rear)] {
                    if let Some(angle) = angle {
                        warnings.angle(format!("drive.gait.{end}"), angle);
                    }
                }
                for (i, [_, angle]) in hold.schedule.iter().flatten().enumerate() {
                    warnings.angle(format!("drive.gait.schedule[{i}][1]"), *angle);
                }
            }
            Some(Gait::Climb(climb)) => {
                warnings.angle("drive.gait.reach_angle", climb.reach_angle);
                warnings.angle("drive.gait.sweep_angle", climb.sweep_angle);
                warnings.angle("drive.gait.push_angle", climb.push_angle);
            }
            None => {}
        }
        let later = drive.schedule.iter().flatten().map(|[_, speed]| *speed);
        let fastest = later.fold(drive.speed, f64::max);
        if fastest <= 0.0 {
            return;
        }
        let (time, reach) = (self.duration, fastest * self.duration);
        let gets = format!("{fastest} m/s takes the robot {reach:.3} m in {time} s");
        // A short run may be just for viewing, and a run on a ready-made terrain may stop before its goal, but not far
        // before.
        if reach > FAR * self.robot.length() {
            let way = format!("it is {to_goal:.3} m away, and {gets}");
            match self.goal {
                Some(goal) if to_goal > reach => {
                    warnings.add("goal", goal, format!("cannot be reached: {way}"));
                }
                None if to_goal > FAR * reach => {
                    let reason = format!("is too short for the goal: {way}");
                    warnings.add("duration", time, reason);
                }
                _ => {}
            }
        }
        let approach = self.start.approach;
        if approach > reach.max(self.robot.length()) {
            let reason = format!("is longer than the run: {gets}");
            warnings.add("start.approach", approach, reason);
        }
    }
}

impl Robot {
    /// [m] Length of its track.
    fn length(&self) -> f64 {
        let o = &self.outline;
        o.axle_distance() + o.front_radius() + o.rear_radius()
    }

    fn add_warnings(&self, warnings: &mut Warnings) {
        let o = &self.outline;
        let length = self.length();
        for (i, value) in self.center_of_mass.into_iter().enumerate() {
            let path = format!("robot.center_of_mass[{i}]");
            warnings.at_most(path, value, (length, "m"), "the robot's length");
        }
        // Limits of mass come from floating-point numbers; a robot in grams or tonnes is recognised by its density.
        let box_round = length * 2.0 * o.largest_radius() * length.max(self.gauge);
        let [least, most] = [AIR, GOLD].map(|density| density * box_round);
        let what = "the mass of gold of its length and height";
        warnings.at_most("robot.mass", self.mass, (most, "kg"), what);
        if self.mass < least {
            let reason = format!(
                "is usually at least {least:.3} kg, the mass of air of its length and height"
            );
            warnings.add("robot.mass", self.mass, reason);
        }
        let most = (self.mass * length * length, "kg m^2");
        let what = "mass x the square of the robot's length";
        let inertia = self.moment_of_inertia;
        warnings.at_most("robot.moment_of_inertia", inertia, most, what);
        let size = (o.largest_radius(), o.axle_distance());
        warn_of_wheels(&self.track, "robot.track", size, warnings);
        if let Track::Segmental(chain) = &self.track {
            self.warn_of_pins(chain, warnings);
        }
        if let Some(flippers) = &self.flippers {
            flippers.add_warnings(self, warnings);
        }
    }

    /// Round an end of radius r, shoes of pitch p bend by p/r, and a spring k presses them off it with k/r. At a speed
    /// v they bend at a rate v/r, and a damper d reduces the traction by about d v/r^2.
    fn warn_of_pins(&self, chain: &SegmentalTrack, warnings: &mut Warnings) {
        let (half, radius) = (0.5 * self.earth_weight(), self.outline.smallest_radius());
        let most = (half * radius, "N m/rad");
        let what = "with which a track presses itself off its smaller end with half the weight";
        let path = "robot.track.pin_stiffness";
        warnings.at_most(path, chain.pin_stiffness, most, what);
        let most = half * radius * radius / self.drivetrain.max_speed;
        let what = "with which pins take half the weight of traction at robot.drivetrain.max_speed";
        let path = "robot.track.pin_damping";
        warnings.at_most(path, chain.pin_damping, (most, "N m s/rad"), what);
    }
}

impl Flippers {
    fn add_warnings(&self, robot: &Robot, warnings: &mut Warnings) {
        warnings.angle("robot.flippers.angle", self.angle);
        let size = (self.root_radius.max(self.tip_radius), self.length);
        let (path, track) = match &self.track {
            Some(track) => ("robot.flippers.track", track),
            None => ("robot.track", robot.track.open()),
        };
        if self.track.is_some() {
            warn_of_wheels(track, path, size, warnings);
        }
        let Track::Line(line) = track else { return };
        let Some(radius) = line.wheel_radius else {
            return;
        };
        // Wheels of a line may be a little smaller than the outline, so that they just touch.
        if (radius - self.tip_radius).abs() > 0.1 * self.tip_radius {
            let reason = format!(
                "has no effect, because {path}.wheel_radius = {radius} m sets the radius of all wheels of the arms"
            );
            warnings.add("robot.flippers.tip_radius", self.tip_radius, reason);
        }
    }
}

/// Warns of wheels that do not fit a track of this size [m]: its largest radius, and the length between its axles.
fn warn_of_wheels(track: &Track, path: &str, (built, length): (f64, f64), warnings: &mut Warnings) {
    let most = ((2.0 * built).max(0.5 * length), "m");
    let what = "twice the outline's radius or half its axle distance";
    match track {
        Track::Line(LineOfWheels { wheel_radius, .. })
        | Track::Circumferential(CircumferentialWheels { wheel_radius, .. }) => {
            if let Some(radius) = wheel_radius {
                warnings.at_most(joined(path, "wheel_radius"), *radius, most, what);
            }
        }
        Track::Hybrid(wheels) => {
            let farthest = (length + 2.0 * built, "m");
            for (i, [x, y, radius]) in wheels.placements.iter().enumerate() {
                let path = |column| format!("{path}.placements[{i}][{column}]");
                warnings.at_most(path(0), *x, farthest, "the length of the outline");
                warnings.at_most(path(1), *y, farthest, "the length of the outline");
                warnings.at_most(path(2), *radius, most, what);
            }
        }
        Track::Closed(closed) => {
            let path = joined(path, "of");
            warn_of_wheels(&closed.of, &path, (built, length), warnings);
        }
        Track::Belt(_) | Track::GrouserBelt(_) | Track::Segmental(_) | Track::Force(_) => {}
    }
}

impl Terrain {
    /// Warns of friction that no ground has, and obstacles that no robot of that length [m] could drive over.
    fn add_warnings(&self, path: &str, length: f64, warnings: &mut Warnings) {
        let mut friction = |name: &str, coefficient: f64| {
            if coefficient > MOST_FRICTION {
                let reason = format!(
                    "is usually at most {MOST_FRICTION}, three times that of rubber on dry concrete"
                );
                warnings.add(joined(path, name), coefficient, reason);
            }
        };
        if let Some(coefficient) = self.friction() {
            friction("friction", coefficient);
        }
        if let Self::Points {
            segment_friction: Some(of_segments),
            ..
        } = self
        {
            let mut segments = of_segments.iter().enumerate();
            if let Some((i, most)) = segments.find(|(_, own)| **own > MOST_FRICTION) {
                friction(&format!("segment_friction[{i}]"), *most);
            }
        }
        let mut size = |name: &str, value: f64| {
            let what = "three times the robot's length";
            warnings.at_most(joined(path, name), value, (FAR * length, "m"), what);
        };
        match self {
            Self::Step { height, .. }
            | Self::Barrier { height, .. }
            | Self::Ridge { height, .. }
            | Self::DiagonalBarrier { height, .. } => size("height", *height),
            Self::Gap { width, .. } => size("width", *width),
            Self::Stairs { rise, .. } => size("rise", *rise),
            Self::HalfRound { radius, .. } => size("radius", *radius),
            Self::RandomStepfield(field) => {
                size("rise", field.rise);
                size("post", field.post);
                size("barrier_height", field.barrier_height);
            }
            Self::Flat { .. } | Self::Ramp { .. } | Self::Points { .. } => {}
            Self::Lanes {
                left,
                right,
                middle,
            } => {
                left.add_warnings(&joined(path, "left"), length, warnings);
                right.add_warnings(&joined(path, "right"), length, warnings);
                if let Some(middle) = middle {
                    middle.add_warnings(&joined(path, "middle"), length, warnings);
                }
            }
        }
    }
}
