//! The carriers of parts.

/// A body of the robot that carries parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mount {
    /// The chassis.
    Chassis,
    /// The shoe of this number.
    Shoe(usize),
    /// The arms at one end, by number.
    Flipper(usize),
}

impl Mount {
    /// What carries the track that it belongs to: the chassis carries chains.
    pub(crate) fn carrier(self) -> Self {
        match self {
            Self::Chassis | Self::Shoe(_) => Self::Chassis,
            Self::Flipper(_) => self,
        }
    }

    /// Number of the shoe, if it is one.
    pub fn shoe(self) -> Option<usize> {
        match self {
            Self::Shoe(shoe) => Some(shoe),
            Self::Chassis | Self::Flipper(_) => None,
        }
    }
}
