//! How a run ended.

#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

/// How a run ended; where several apply, the first of this list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// The chain of the track has left its guide.
    Detracked,
    /// The chassis turned past its balance point.
    TippedOver,
    /// An end axle left the terrain.
    LeftTerrain,
    /// The goal lies behind the robot.
    Cleared,
    /// It moves to and fro without gain.
    Cycling,
    /// Stopped by ground in a pocket of the track.
    Seized,
    /// Stopped with weight on the belly.
    HungUp,
    /// Stopped by the torque limit.
    Stalled,
    /// Stopped with the surfaces turning.
    Slipping,
    /// The time ran out on the way.
    TimedOut,
}

impl Outcome {
    /// All of them; where several apply, the first counts.
    pub const ALL: [Self; 10] = [
        Self::Detracked,
        Self::TippedOver,
        Self::LeftTerrain,
        Self::Cleared,
        Self::Cycling,
        Self::Seized,
        Self::HungUp,
        Self::Stalled,
        Self::Slipping,
        Self::TimedOut,
    ];

    /// Name as in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Detracked => "detracked",
            Self::TippedOver => "tipped_over",
            Self::LeftTerrain => "left_terrain",
            Self::Cleared => "cleared",
            Self::Cycling => "cycling",
            Self::Seized => "seized",
            Self::HungUp => "hung_up",
            Self::Stalled => "stalled",
            Self::Slipping => "slipping",
            Self::TimedOut => "timed_out",
        }
    }

    /// Whether the robot got nowhere although commanded.
    pub fn is_stop(self) -> bool {
        matches!(
            self,
            Self::Cycling | Self::Seized | Self::HungUp | Self::Stalled | Self::Slipping
        )
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
