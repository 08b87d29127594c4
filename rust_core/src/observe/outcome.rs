//! The outcome of a run.

#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

/// The outcome of a run; if several apply, the first in this list counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// The chain of the track has come off its guide.
    Detracked,
    /// The chassis turned past its balance point.
    TippedOver,
    /// An end axle left the terrain.
    LeftTerrain,
    /// The robot is past the goal.
    Cleared,
    /// Stopped by ground in a pocket of the track: a closed track gets free.
    Seized,
    /// The robot moves to and fro without progress.
    Cycling,
    /// Stopped with weight on the belly.
    HungUp,
    /// Stopped by the torque limit.
    Stalled,
    /// Stopped with the surfaces turning.
    Slipping,
    /// The time ran out while the robot was still moving.
    TimedOut,
}

impl Outcome {
    /// All outcomes; if several apply, the first counts.
    pub const ALL: [Self; 10] = [
        Self::Detracked,
        Self::TippedOver,
        Self::LeftTerrain,
        Self::Cleared,
        Self::Seized,
        Self::Cycling,
        Self::HungUp,
        Self::Stalled,
        Self::Slipping,
        Self::TimedOut,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Detracked => "detracked",
            Self::TippedOver => "tipped_over",
            Self::LeftTerrain => "left_terrain",
            Self::Cleared => "cleared",
            Self::Seized => "seized",
            Self::Cycling => "cycling",
            Self::HungUp => "hung_up",
            Self::Stalled => "stalled",
            Self::Slipping => "slipping",
            Self::TimedOut => "timed_out",
        }
    }

    /// Whether the robot made no progress although a speed was commanded.
    pub fn is_stop(self) -> bool {
        matches!(
            self,
            Self::Seized | Self::Cycling | Self::HungUp | Self::Stalled | Self::Slipping
        )
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
