//! Findings about a stop: how the ground inside the track is held, and results of trials, each of which changes one
//! thing.

use crate::contact::Intrusion;
use crate::geometry::Vector;
use crate::names::named;
use crate::observe::Outcome;
use crate::robot::BodyKind;
use crate::scenario::SeizureCriteria;
use crate::terrain::Side;

/// Why a robot stopped although commanded to move.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The kind of stop, after trials.
    pub outcome: Outcome,
    /// Its symptom, before any trials: cycling, hung up, stalled or slipping.
    pub symptom: Outcome,
    /// Trials and their results.
    pub trials: Vec<Trial>,
    /// Ground between two bodies of a track, deeper than their root circles, bears on that track.
    pub jammed: bool,
    /// How the ground inside the track is held, if there is any.
    pub mechanism: Option<Mechanism>,
    /// [s] When the stop was examined.
    pub time: f64,
    /// [s] When the stop began.
    pub since: f64,
    /// [m] Mean position of the chassis frame.
    pub position: [f64; 2],
    /// [rad] Mean chassis angle.
    pub chassis_angle: f64,
    /// The most loaded ground inside the track: among jammed ground if there is any, else anywhere.
    pub intrusion: Option<LoadedIntrusion>,
    /// The contacts that bear, averaged over the last one to two stop windows.
    pub contacts: Vec<StopContact>,
    /// Share of the load that the belly carries, 0 to 1.
    pub belly_share: f64,
    /// Share of the normal force that is at sliding contacts.
    pub sliding_share: f64,
    /// Share of the motors with ground contact that are at their torque limit.
    pub stalled_share: f64,
    /// Share of the commanded distance made in the last stop window.
    pub progress: f64,
    /// The pose did not change.
    pub stationary: bool,
    /// Smallest residual that any choice of forces leaves, as a share of the weight; `None` if it is unknown.
    pub imbalance: Option<f64>,
    /// Whether the imbalance is within the criteria, so that the pose may be an equilibrium.
    pub certified: bool,
}

impl Diagnosis {
    /// Whether the stop would not have lasted: a trial without a change left it.
    pub fn is_transient(&self) -> bool {
        let left =
            |trial: &Trial| trial.freed && Change::CONTROLS.iter().any(|c| c.name() == trial.name);
        self.trials.iter().any(left)
    }
}

/// A connected piece of ground inside the track, with what bears on it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedIntrusion {
    /// Its place and size.
    pub place: Intrusion,
    /// Kinds of the bodies on either side of it.
    pub kinds: [BodyKind; 2],
    /// Name of what carries them.
    pub carrier: &'static str,
    /// [N] Mean normal force on it.
    pub force: f64,
}

/// A contact of a stop, averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopContact {
    /// Its number.
    pub number: u64,
    /// Its lane.
    pub side: Side,
    /// Index of the part.
    pub body: usize,
    /// Kind of the part.
    pub kind: BodyKind,
    /// Facet of the ground, counted from the left.
    pub segment: usize,
    /// Edge, or -1.
    pub edge: i32,
    /// [m] Position.
    pub point: Vector,
    /// Direction from the ground to the robot.
    pub normal: Vector,
    /// [N] Normal force.
    pub normal_force: f64,
    /// [N] Friction on the robot, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Slip velocity of the robot's surface relative to the ground, in that direction.
    pub surface_speed: f64,
    /// It slides at its friction limit.
    pub slides: bool,
    /// It bears on the most loaded ground inside the track.
    pub in_pocket: bool,
}

named! {
    /// How the ground inside the track is held.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Mechanism {
        /// Two bodies bear on it.
        Straddled = "straddled",
        /// One body alone bears on it and slides at its friction limit.
        Undercut = "undercut",
        /// The motors are at their limit.
        Blocked = "blocked",
        /// The motors are at their limit, with the flank of a grouser against it.
        Interlocked = "interlocked",
        /// It is in the gap between two shoes of a chain, which closes as they move.
        Pinched = "pinched",
        /// It has got through a chain of shoes to the guide or wheels inside.
        Fouled = "fouled",
    }
}

impl Mechanism {
    /// The first mechanism that the facts show; `None` if one body sticks to the ground and turns with it.
    pub(super) fn of(facts: &Facts, criteria: &SeizureCriteria, weight: f64) -> Option<Self> {
        let on_it = || facts.contacts.iter().filter(|c| c.in_pocket);
        let force_of = |body: usize| -> f64 {
            on_it()
                .filter(|c| c.body == body)
                .map(|c| c.normal_force)
                .sum()
        };
        let least = criteria.intrusion_load * weight;
        let mut bodies: Vec<usize> = on_it().map(|c| c.body).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let bearing = bodies.iter().filter(|b| force_of(**b) > 0.5 * least);
        if on_it().any(|c| c.kind.is_in_chain() && force_of(c.body) > 0.5 * least) {
            Some(Self::Fouled)
        } else if facts.pinched {
            Some(Self::Pinched)
        } else if facts.stalled_share >= 0.5 {
            Some(if facts.flank {
                Self::Interlocked
            } else {
                Self::Blocked
            })
        } else if bearing.count() >= 2 {
            Some(Self::Straddled)
        } else if on_it().any(|c| c.slides) {
            Some(Self::Undercut)
        } else {
            None
        }
    }
}

/// The facts of a stop.
pub(super) struct Facts {
    /// Contacts that bear.
    pub contacts: Vec<StopContact>,
    /// Share of the load that the belly carries.
    pub belly_share: f64,
    /// Share of the normal force that is at sliding contacts.
    pub sliding_share: f64,
    /// Share of the motors that are at their limit.
    pub stalled_share: f64,
    /// The flank of a grouser bears on the ground inside the track.
    pub flank: bool,
    /// Two neighbouring shoes bear on the ground inside the track and are about to close the gap between them.
    pub pinched: bool,
}

named! {
    /// What a trial changes in the pose of a stop.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Change {
        /// Nothing: the run continues.
        Nothing = "unchanged",
        /// Nothing, but the track is rebuilt, as for other changes.
        Rebuilt = "rebuilt",
        /// A closed track, with the model's grousers if it has any.
        ClosedTrack = "closed track",
        /// The same, at rest in the nearest pose in which no ground is inside it.
        ClosedTrackClear = "closed track, clear of the ground",
        /// A closed track without grousers.
        ClosedSmoothTrack = "closed smooth track",
        /// A belt along the outlines of the robot and its arms, wherever the model's bodies are.
        Belt = "belt",
        /// The same from the start of the run on.
        BeltFromStart = "belt, from the start",
        /// A closed track, with the model's grousers, from the start of the run on.
        ClosedTrackFromStart = "closed track, from the start",
        /// One motor for each track instead of one for each wheel.
        OneMotor = "one motor",
        /// Twice the torque.
        TwiceTheTorque = "torque x 2",
        /// Ten times the torque.
        TenTimesTheTorque = "torque x 10",
        /// Twice the friction.
        TwiceTheFriction = "friction x 2",
        /// No belly.
        NoBelly = "no belly",
        /// The arms turn to angle 0.
        FlippersLevel = "flippers level",
    }
}

impl Change {
    /// Trials that change nothing.
    pub const CONTROLS: [Self; 2] = [Self::Nothing, Self::Rebuilt];

    /// Whether the robot starts again at the beginning of its run instead of continuing from the stop.
    pub fn is_from_the_start(self) -> bool {
        matches!(self, Self::ClosedTrackFromStart | Self::BeltFromStart)
    }

    /// The change with this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|change| change.name() == name)
    }
}

/// Trials to make at a stop, in addition to those that decide its outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    changes: [bool; Change::ALL.len()],
    nothing: bool,
}

impl Wanted {
    /// None at all: the outcome is the symptom, which takes less time.
    pub const NOTHING: Self = Self {
        changes: [false; Change::ALL.len()],
        nothing: true,
    };

    /// These changes.
    pub fn of(changes: impl IntoIterator<Item = Change>) -> Self {
        let mut wanted = Self::default();
        for change in changes {
            wanted.changes[change as usize] = true;
        }
        wanted
    }

    pub(crate) fn is_nothing(self) -> bool {
        self.nothing
    }

    pub(crate) fn changes(self) -> impl Iterator<Item = Change> {
        let all = Change::ALL.into_iter();
        all.filter(move |change| self.changes[*change as usize])
    }
}

/// The result of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What was changed: the name of a [`Change`], or "changed".
    pub name: &'static str,
    /// Whether it freed the robot, which was not lost afterwards; or in a trial from the start, the robot got past the
    /// stop.
    pub freed: bool,
    /// Number of instants from which it was tried.
    pub starts: u32,
    /// Number of these from which it freed the robot.
    pub freeing: u32,
    /// [m] Advance beyond the farthest position before, in the commanded direction; negative if the robot did not get
    /// that far.
    pub distance: f64,
    /// [s] Time until it was free; infinite if it was not freed.
    pub time: f64,
    /// How it ended: an outcome other than a stop, or the symptom of a stop.
    pub outcome: Outcome,
    /// Whether it ended in a stop with ground jammed between two bodies of a track.
    pub jammed: bool,
    /// The most loaded ground inside the track in that stop: among jammed ground if there is any, else anywhere.
    pub intrusion: Option<LoadedIntrusion>,
    /// [s] Duration of the trial, unless it ended earlier.
    pub duration: f64,
    /// [m, m, rad] Pose of the chassis frame at its end.
    pub pose: [f64; 3],
    /// [rad] Angles of the flippers at its end, the front first; not a number where there are none.
    pub flipper_angles: [f64; 2],
}
