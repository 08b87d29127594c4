//! Trials: what came of changing one thing at a stop.

use super::LoadedIntrusion;
use crate::observe::Outcome;

/// What a trial changes in the pose of a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the run goes on.
    Nothing,
    /// Nothing, but the track is built anew, as others are.
    Rebuilt,
    /// A closed track, with the grousers of the model where it has some.
    ClosedTrack,
    /// The same, at rest in the nearest pose in which no ground is inside it.
    ClosedTrackClear,
    /// A closed track without grousers.
    ClosedSmoothTrack,
    /// A belt along the outlines of the robot and its arms, wherever the model has its bodies.
    Belt,
    /// The same from the start of the run on.
    BeltFromStart,
    /// A closed track, with the grousers of the model, from the start of the run on.
    ClosedTrackFromStart,
    /// One motor for each track in place of one for each wheel.
    OneMotor,
    /// Twice the torque.
    TwiceTheTorque,
    /// Ten times the torque.
    TenTimesTheTorque,
    /// Twice the friction.
    TwiceTheFriction,
    /// No belly.
    NoBelly,
    /// The arms turn to angle 0.
    FlippersLevel,
}

impl Change {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Nothing,
        Self::Rebuilt,
        Self::ClosedTrack,
        Self::ClosedTrackClear,
        Self::ClosedSmoothTrack,
        Self::Belt,
        Self::BeltFromStart,
        Self::ClosedTrackFromStart,
        Self::OneMotor,
        Self::TwiceTheTorque,
        Self::TenTimesTheTorque,
        Self::TwiceTheFriction,
        Self::NoBelly,
        Self::FlippersLevel,
    ];

    /// Those that change nothing.
    pub const CONTROLS: [Self; 2] = [Self::Nothing, Self::Rebuilt];

    /// Whether the robot starts again where its run began, in place of going on from the stop.
    pub fn is_from_the_start(self) -> bool {
        matches!(self, Self::ClosedTrackFromStart | Self::BeltFromStart)
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "unchanged",
            Self::Rebuilt => "rebuilt",
            Self::ClosedTrack => "closed track",
            Self::ClosedTrackClear => "closed track, clear of the ground",
            Self::ClosedSmoothTrack => "closed smooth track",
            Self::Belt => "belt",
            Self::BeltFromStart => "belt, from the start",
            Self::ClosedTrackFromStart => "closed track, from the start",
            Self::OneMotor => "one motor",
            Self::TwiceTheTorque => "torque x 2",
            Self::TenTimesTheTorque => "torque x 10",
            Self::TwiceTheFriction => "friction x 2",
            Self::NoBelly => "no belly",
            Self::FlippersLevel => "flippers level",
        }
    }

    /// The change of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|change| change.name() == name)
    }
}

/// Which trials to make of a stop, besides those that its outcome needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    changes: [bool; Change::ALL.len()],
}

impl Wanted {
    /// These changes.
    pub fn of(changes: impl IntoIterator<Item = Change>) -> Self {
        let mut wanted = Self::default();
        for change in changes {
            wanted.changes[change as usize] = true;
        }
        wanted
    }

    pub(crate) fn changes(self) -> impl Iterator<Item = Change> {
        let all = Change::ALL.into_iter();
        all.filter(move |change| self.changes[*change as usize])
    }
}

/// What came of a change.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What was changed: the name of a [`Change`], or "changed".
    pub name: &'static str,
    /// It freed the robot, which was not lost afterwards; of one from the start: the robot got past the stop.
    pub freed: bool,
    /// From how many instants it was tried.
    pub starts: u32,
    /// From how many of these it freed the robot.
    pub freeing: u32,
    /// [m] How far the robot got ahead of its greatest x before, in the commanded direction; less than 0 if it did not
    /// come so far.
    pub distance: f64,
    /// [s] How long that took; infinite if it was not freed.
    pub time: f64,
    /// How it ended: an outcome without a stop, or what is seen of the stop.
    pub outcome: Outcome,
    /// It ended in a stop with ground jammed between two bodies of a track.
    pub jammed: bool,
    /// The most loaded ground inside the track in that stop: where it is jammed, or else anywhere.
    pub intrusion: Option<LoadedIntrusion>,
    /// [s] For how long it was tried, unless it ended before.
    pub duration: f64,
    /// [m, m, rad] Pose of the chassis frame at its end.
    pub pose: [f64; 3],
    /// [rad] Angles of the flippers then, the front first; not a number where there are none.
    pub flipper_angles: [f64; 2],
}
