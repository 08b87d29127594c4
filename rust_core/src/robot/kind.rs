//! The kinds of bodies of a robot.

/// What a body represents; its code is the `body_kind` of the contact table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// A wheel.
    Wheel = 0,
    /// A moving belt.
    Belt = 1,
    /// A skid runner.
    Skid = 2,
    /// The underside of the chassis.
    Belly = 3,
    /// A grouser of a moving belt or of a shoe.
    Grouser = 4,
    /// The plate of a shoe.
    Shoe = 5,
    /// The guide that a chain slides on.
    Guide = 6,
    /// The toothed wheel that drives a chain.
    Sprocket = 7,
    /// The front wheel of a chain, on the tensioner.
    Idler = 8,
    /// A wheel that runs on the lower run of a chain.
    RoadWheel = 9,
    /// A return roller, which carries the upper run.
    Roller = 10,
}

impl BodyKind {
    /// All kinds, in the order of their codes.
    pub const ALL: [Self; 11] = [
        Self::Wheel,
        Self::Belt,
        Self::Skid,
        Self::Belly,
        Self::Grouser,
        Self::Shoe,
        Self::Guide,
        Self::Sprocket,
        Self::Idler,
        Self::RoadWheel,
        Self::Roller,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::Belt => "belt",
            Self::Skid => "skid",
            Self::Belly => "belly",
            Self::Grouser => "grouser",
            Self::Shoe => "shoe",
            Self::Guide => "guide",
            Self::Sprocket => "sprocket",
            Self::Idler => "idler",
            Self::RoadWheel => "road_wheel",
            Self::Roller => "roller",
        }
    }

    /// Whether a chain of shoes runs round it.
    pub(crate) fn is_in_chain(self) -> bool {
        match self {
            Self::Guide | Self::Sprocket | Self::Idler | Self::RoadWheel | Self::Roller => true,
            Self::Wheel | Self::Belt | Self::Skid | Self::Belly | Self::Grouser | Self::Shoe => {
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_listed_by_their_codes() {
        let codes = BodyKind::ALL.map(|kind| kind as usize);
        assert_eq!(codes, std::array::from_fn(|code| code));
    }
}
