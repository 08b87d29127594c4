//! How the track is modelled: one variant for each family of the literature.

use serde::Serialize;

use super::ScenarioError;
use super::drivetrain::TorqueSharing;
use super::fields::{
    COORDINATE, Checked, DAMPING, FORCE, Fields, PIN_DAMPING, PIN_STIFFNESS, Range, SIZE,
    STIFFNESS, is_zero, joined, one_of,
};
use super::objects::{Choice, FromJson, choice, kinds, object};
use super::terrain::COEFFICIENT;

/// Largest number of wheels per side.
pub(crate) const MAX_WHEELS: u32 = 200;
/// Largest number of grousers of one wheel.
pub(crate) const MAX_GROUSERS: u32 = 200;
/// Largest number of shoes of a chain.
pub(crate) const MAX_SHOES: u32 = 400;
/// Of the grousers of a wheel.
const PART: Range = Range::above(0.0, 100.0, "m");

kinds! {
    /// A track model.
    pub enum Track {
        /// Wheels on the straight line between the end axles.
        "line" Line(LineOfWheels),
        /// Small wheels all round the outline.
        "circumferential" Circumferential(CircumferentialWheels),
        /// Wheels of various sizes, placed by hand.
        "hybrid" Hybrid(HybridWheels),
        /// A smooth closed belt whose surface moves along the outline.
        "belt" Belt(BeltTrack),
        /// The belt with grousers that travel along it.
        "grouser_belt" GrouserBelt(GrouserBeltTrack),
        /// A chain of shoes linked by pins.
        "segmental" Segmental(SegmentalTrack),
        /// No track at all: the drive pushes the chassis.
        "force" Force(ForceTrack),
        /// A belt closed round the bodies of another model.
        "closed" Closed(ClosedTrack),
    }
}

object! {
    /// Wheels on one straight line, overlapping, touching or spaced.
    pub struct LineOfWheels {
        /// Number of wheels per side, including those at the end axles.
        count: u32 = integer(2, MAX_WHEELS),
        /// [m] Radius of every wheel; `None` takes the outline's, linear between unequal ends.
        wheel_radius: Option<f64> = optional_number(SIZE),
        /// The shape of each wheel.
        wheel: Wheel = object(),
        /// Whether they represent a track; otherwise nothing runs round them.
        as_track: bool = flag(),
    }
}

object! {
    /// Equal wheels inside the outline, each touching it, evenly spaced all the way round.
    pub struct CircumferentialWheels {
        /// Number of wheels per side.
        count: u32 = integer(3, MAX_WHEELS),
        /// [m] Radius of every wheel; `None` packs them tightly, so that neighbours touch.
        wheel_radius: Option<f64> = optional_number(SIZE),
        /// The shape of each wheel.
        wheel: Wheel = object(),
    }
}

object! {
    /// Wheels of various sizes at given places.
    pub struct HybridWheels {
        /// [m] Centre (x, y) in the chassis frame and radius of each wheel, in the order of eq. (1).
        placements: Vec<[f64; 3]> = placements(),
        /// The shape of each wheel.
        wheel: Wheel = object(),
    }
}

/// A smooth belt; it has no parameters of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeltTrack {}

object! {
    /// A belt whose grousers travel with it (Okada et al. 2020).
    pub struct GrouserBeltTrack {
        /// Grousers per belt; `None` takes the whole number that comes closest to the outline's pitch.
        grouser_count: Option<u32> = optional_integer(1, MAX_GROUSERS),
    }
}

object! {
    /// Rigid shoes linked by pins into a closed chain (section 2.3 of the paper).
    pub struct SegmentalTrack {
        /// Shoes per chain; `None` takes the whole number that comes closest to the outline's pitch.
        shoe_count: Option<u32> = optional_integer(3, MAX_SHOES),
        /// What they run on, and what drives them.
        mechanism: ChainMechanism = choice(),
        /// Shape of the shoes.
        shoe_shape: ShoeShape = choice(),
        /// [m] Thickness of the plates; `None` takes 1/16 of the pitch.
        plate_thickness: Option<f64> = optional_number(SIZE),
        /// [N] Force of the tensioner of one track; `None` takes 1/40 of the weight.
        pre_tension: Option<f64> = optional_number(FORCE),
        /// [N/m] Its stiffness; `None` takes the one at which a tenth of the pitch relieves its whole force.
        tensioner_stiffness: Option<f64> = optional_number(STIFFNESS),
        /// [N s/m] Its damping; `None` takes critical damping for the mass of one track.
        tensioner_damping: Option<f64> = optional_number(DAMPING),
        /// [N m/rad] Stiffness of the bushing of each pin of one track, which is relaxed when its shoes are in line.
        #[serde(skip_serializing_if = "is_zero")]
        pin_stiffness: f64 = number_or_zero(PIN_STIFFNESS),
        /// [N m s/rad] Its damping.
        #[serde(skip_serializing_if = "is_zero")]
        pin_damping: f64 = number_or_zero(PIN_DAMPING),
        /// Wheels between sprocket and idler on the lower run; `None` takes enough to leave gaps of at most one pitch.
        road_wheel_count: Option<u32> = optional_integer(0, MAX_WHEELS),
        /// Rollers under the upper run; `None` takes enough to leave gaps of at most two pitches.
        return_roller_count: Option<u32> = optional_integer(0, MAX_WHEELS),
    }
    then check
}

choice! {
    /// What a chain of shoes runs on.
    pub enum ChainMechanism {
        /// A low-friction guide of the outline's shape; the drive pulls on the shoes at its rear end.
        "guide" Guide,
        /// A toothed sprocket at the rear, an idler at the front, road wheels and return rollers.
        "sprocket" Sprocket,
    }
}

choice! {
    /// Shape of a shoe in side view.
    pub enum ShoeShape {
        /// A flat plate with a grouser in the middle.
        "rectangle" Rectangle,
        /// One body that tapers from the plate to the tip of the grouser.
        "trapezoid" Trapezoid,
    }
}

object! {
    /// The drive acts on the chassis as a force along its axis, x of the chassis frame, in the air, too.
    pub struct ForceTrack {
        /// What the robot slides or rolls on.
        support: ForceSupport = choice(),
        /// Friction of the skids; the smaller of this and the terrain's friction applies.
        skid_friction: f64 = number(COEFFICIENT),
        /// Number of free wheels per side.
        wheel_count: u32 = integer(2, MAX_WHEELS),
    }
}

choice! {
    /// What carries a robot that is pushed by a force.
    pub enum ForceSupport {
        /// Skids in the shape of the outline.
        "skids" Skids,
        /// Round wheels on a line that turn freely and independently.
        "wheels" Wheels,
    }
}

object! {
    /// A belt taut round the bodies of another model, on the chassis and on every arm: that model without pockets.
    pub struct ClosedTrack {
        /// The model round whose bodies it runs.
        of: Box<Track> = open_track(),
        /// Whether it has grousers.
        surface: ClosedSurface = choice(),
    }
}

choice! {
    /// The surface of a closed track.
    pub enum ClosedSurface {
        /// Grousers, if the model has any, as high as the model's, and with the outline's thickness and spacing.
        "own" Own,
        /// No grousers.
        "smooth" Smooth,
    }
}

impl Track {
    /// The shape of the driven wheels, if the model has any.
    pub(crate) fn wheel(&self) -> Option<&Wheel> {
        match self {
            Self::Line(LineOfWheels { wheel, .. })
            | Self::Circumferential(CircumferentialWheels { wheel, .. })
            | Self::Hybrid(HybridWheels { wheel, .. }) => Some(wheel),
            Self::Closed(closed) => closed.of.wheel(),
            Self::Belt(_) | Self::GrouserBelt(_) | Self::Segmental(_) | Self::Force(_) => None,
        }
    }

    /// Whether a track runs round its bodies.
    pub(crate) fn is_track(&self) -> bool {
        !matches!(self.open(), Self::Line(line) if !line.as_track)
    }

    /// Whether ground can get between its bodies.
    pub(crate) fn has_pockets(&self) -> bool {
        match self {
            Self::Belt(_) | Self::GrouserBelt(_) | Self::Closed(_) => false,
            Self::Force(force) => force.support == ForceSupport::Wheels,
            Self::Line(_) | Self::Circumferential(_) | Self::Hybrid(_) | Self::Segmental(_) => {
                self.is_track()
            }
        }
    }

    /// Whether its surface has grousers.
    pub(crate) fn has_grousers(&self) -> bool {
        match self {
            Self::GrouserBelt(_) | Self::Segmental(_) => true,
            Self::Closed(closed) => {
                closed.surface == ClosedSurface::Own && closed.of.has_grousers()
            }
            _ => matches!(self.wheel(), Some(Wheel::Gear(_))),
        }
    }

    /// The model itself, or the one inside a closed track.
    pub(crate) fn open(&self) -> &Self {
        match self {
            Self::Closed(closed) => &closed.of,
            open => open,
        }
    }

    /// Checks that it is possible at `path`, for a track round a number of discs.
    pub(super) fn check_discs(&self, path: &str, count: usize) -> Checked<()> {
        let refused = |field: &str, value: &str, [instead, why]: [&str; 2]| {
            let rule =
                format!("must be {instead} round {count} discs (robot.outline.discs): {why}");
            Err(ScenarioError::new(joined(path, field), value, rule))
        };
        match self {
            _ if count <= 2 => Ok(()),
            Self::Line(_) => refused(
                "kind",
                "line",
                [
                    "another model",
                    "a line has two ends, and leaves out the others; circumferential wheels go all round",
                ],
            ),
            Self::Force(force) if force.support == ForceSupport::Wheels => refused(
                "support",
                "wheels",
                [
                    "\"skids\"",
                    "a line of wheels has two ends, and leaves out the others",
                ],
            ),
            Self::Segmental(chain) if chain.mechanism == ChainMechanism::Sprocket => refused(
                "mechanism",
                "sprocket",
                [
                    "\"guide\"",
                    "sprocket, idler and the wheels on two runs hold a chain round two",
                ],
            ),
            Self::Closed(closed) => closed.of.check_discs(&joined(path, "of"), count),
            _ => Ok(()),
        }
    }

    /// Checks that the motors can share their torque like this.
    pub(super) fn check(&self, sharing: TorqueSharing) -> Checked<()> {
        if sharing == TorqueSharing::Wheel && self.wheel().is_none() {
            let rule = "must be \"track\" for a model without driven wheels";
            let path = "robot.drivetrain.torque_sharing";
            return Err(ScenarioError::new(path, "wheel", rule));
        }
        Ok(())
    }
}

impl FromJson for BeltTrack {
    fn read(_: &mut Fields) -> Checked<Self> {
        Ok(Self {})
    }
}

impl SegmentalTrack {
    fn check(&self, f: &Fields) -> Checked<()> {
        let wheels = [
            ("road_wheel_count", self.road_wheel_count),
            ("return_roller_count", self.return_roller_count),
        ];
        for (name, count) in wheels {
            if let Some(count) = count.filter(|_| self.mechanism == ChainMechanism::Guide) {
                let rule = "must not be given for a guide, which has no wheels (mechanism \"sprocket\" has)";
                return Err(f.error(name, count, rule));
            }
        }
        Ok(())
    }
}

impl Fields<'_> {
    fn open_track(&mut self, name: &'static str) -> Checked<Box<Track>> {
        match self.object(name)? {
            Track::Closed(_) => {
                Err(self.error(name, "a closed track", "must not be closed itself"))
            }
            open => Ok(Box::new(open)),
        }
    }

    fn placements(&mut self, name: &'static str) -> Checked<Vec<[f64; 3]>> {
        let columns = [("x", COORDINATE), ("y", COORDINATE), ("radius", SIZE)];
        let placements = self.rows(name, columns, MAX_WHEELS as usize)?;
        if placements.is_empty() {
            return Err(self.error(name, "[]", "must place at least one wheel"));
        }
        Ok(placements)
    }
}

kinds! {
    /// The shape of a wheel.
    pub enum Wheel {
        /// A disc.
        "round" Round,
        /// A disc with grousers.
        "gear" Gear(GearWheel),
    }
}

object! {
    /// A wheel with grousers; fields that are `None` follow from the robot's outline.
    pub struct GearWheel {
        /// Grousers on the wheel.
        grouser_count: Option<u32> = optional_integer(3, MAX_GROUSERS),
        /// [m] Radial height: the wheel's radius minus that of its root circle.
        grouser_height: Option<f64> = optional_number(PART),
        /// [m] Thickness of a grouser at its tip.
        tip_thickness: Option<f64> = optional_number(PART),
        /// [m] Thickness of a grouser at the root circle; `None` takes that at the tip: parallel flanks.
        base_thickness: Option<f64> = optional_number(PART),
        /// Fraction of the angle between two grousers by which each wheel starts ahead of the previous one.
        phase_fraction: f64 = number(Range::between(0.0, 1.0, "")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::shared;

    #[test]
    fn a_track_has_grousers_if_its_surface_has_and_none_once_they_are_covered() {
        for (name, has_grousers) in [
            ("engineer_belt_step", false),
            ("engineer_grouser_belt_step", true),
            ("engineer_chain_step", true),
            ("engineer_gear3_step", true),
            ("engineer_force_step", false),
        ] {
            let open = shared(name).robot.track;
            assert_eq!(open.has_grousers(), has_grousers, "{open:?}");
            let closed = |surface| {
                let of = Box::new(open.clone());
                Track::Closed(ClosedTrack { of, surface }).has_grousers()
            };
            assert_eq!(closed(ClosedSurface::Own), has_grousers);
            assert!(!closed(ClosedSurface::Smooth));
        }
    }
}
