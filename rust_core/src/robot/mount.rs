//! The carriers of parts.

/// A body of the robot that carries parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mount {
    /// The chassis.
    Chassis,
    /// The shoe with this index.
    Shoe(usize),
    /// The arms at one end, by index.
    Flipper(usize),
}

impl Mount {
    /// The index of its shoe, if it is one.
    pub fn shoe(self) -> Option<usize> {
        match self {
            Self::Shoe(shoe) => Some(shoe),
            Self::Chassis | Self::Flipper(_) => None,
        }
    }
}
