//! What carries a part.

/// A body of the robot that carries parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mount {
    /// The chassis.
    Chassis,
    /// The shoe of that number.
    Shoe(usize),
    /// The arms at one end, of that number.
    Flipper(usize),
}

impl Mount {
    /// The number of its shoe.
    pub fn shoe(self) -> Option<usize> {
        match self {
            Self::Shoe(shoe) => Some(shoe),
            Self::Chassis | Self::Flipper(_) => None,
        }
    }
}
