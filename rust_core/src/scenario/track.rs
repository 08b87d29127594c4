//! How the track is modelled: one variant for each family of the literature.

use serde::Serialize;

use super::ScenarioError;
use super::drivetrain::TorqueSharing;
use super::fields::{COORDINATE, DAMPING, FORCE, Fields, Range, SIZE, STIFFNESS, joined, one_of};

/// Largest number of wheels per side.
pub(crate) const MAX_WHEELS: u32 = 200;
/// Largest number of shoes of a chain.
pub(crate) const MAX_SHOES: u32 = 400;

/// A track model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Track {
    /// Wheels on the straight line between the end axles.
    Line(LineOfWheels),
    /// Small wheels all round the outline.
    Circumferential(CircumferentialWheels),
    /// Wheels of various sizes, placed by hand.
    Hybrid(HybridWheels),
    /// A smooth closed belt whose surface moves along the outline.
    Belt(BeltTrack),
    /// The belt with grousers that travel along it.
    GrouserBelt(GrouserBeltTrack),
    /// A chain of shoes linked by pins.
    Segmental(SegmentalTrack),
    /// No track at all: the drive pushes the chassis.
    Force(ForceTrack),
    /// A belt closed round the bodies of another model.
    Closed(ClosedTrack),
}

/// Wheels on one straight line, overlapping, touching or spaced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineOfWheels {
    /// Number of wheels per side, including those at the end axles.
    pub count: u32,
    /// [m] Radius of every wheel; `None` takes the outline's, linear between unequal ends.
    pub wheel_radius: Option<f64>,
    /// The shape of each wheel.
    pub wheel: Wheel,
    /// They stand for a track; else nothing runs round them.
    pub as_track: bool,
}

/// Equal wheels inside the outline, each touching it, evenly spaced all the way round.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircumferentialWheels {
    /// Number of wheels per side.
    pub count: u32,
    /// [m] Radius of every wheel; `None` packs them tightly, so that neighbours touch.
    pub wheel_radius: Option<f64>,
    /// The shape of each wheel.
    pub wheel: Wheel,
}

/// Wheels of various sizes at given places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HybridWheels {
    /// [m] Centre (x, y) in the chassis frame and radius of each wheel, in the order of eq. (1).
    pub placements: Vec<[f64; 3]>,
    /// The shape of each wheel.
    pub wheel: Wheel,
}

/// A smooth belt; it has no parameters of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeltTrack {}

/// A belt whose grousers travel with it (Okada et al. 2020).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GrouserBeltTrack {
    /// Grousers per belt; `None` takes the whole number that comes closest to the outline's pitch.
    pub grouser_count: Option<u32>,
}

/// Rigid shoes linked by pins into a closed chain (section 2.3 of the paper).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentalTrack {
    /// Shoes per chain; `None` takes the whole number that comes closest to the outline's pitch.
    pub shoe_count: Option<u32>,
    /// What they run on, and what drives them.
    pub mechanism: ChainMechanism,
    /// Shape of the shoes.
    pub shoe_shape: ShoeShape,
    /// [m] Thickness of the plates; `None` takes 1/16 of the pitch.
    pub plate_thickness: Option<f64>,
    /// [N] Force of the tensioner of one track; `None` takes 1/40 of the weight.
    pub pre_tension: Option<f64>,
    /// [N/m] Its stiffness; `None`: a tenth of the pitch takes up its whole force.
    pub tensioner_stiffness: Option<f64>,
    /// [N s/m] Its damping; `None`: critical for the mass of one track.
    pub tensioner_damping: Option<f64>,
    /// Wheels between sprocket and idler on the lower run; `None` takes enough to leave gaps of at most one pitch.
    pub road_wheel_count: Option<u32>,
    /// Rollers under the upper run; `None` takes enough to leave gaps of at most two pitches.
    pub return_roller_count: Option<u32>,
}

/// What a chain of shoes runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChainMechanism {
    /// A low-friction guide of the outline's shape; the drive pulls on the shoes at its rear end.
    Guide,
    /// A toothed sprocket at the rear, an idler at the front, road wheels and return rollers.
    Sprocket,
}

/// Shape of a shoe in side view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShoeShape {
    /// A flat plate with a grouser in the middle.
    Rectangle,
    /// One body that tapers from the plate to the tip of the grouser.
    Trapezoid,
}

/// The drive acts on the chassis as a force along its axis, x of the chassis frame, in the air, too.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForceTrack {
    /// What the robot slides or rolls on.
    pub support: ForceSupport,
    /// Friction of the skids; the smaller of this and the terrain's friction applies.
    pub skid_friction: f64,
    /// Number of free wheels per side.
    pub wheel_count: u32,
}

/// What carries a robot that is pushed by a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceSupport {
    /// Skids in the shape of the outline.
    Skids,
    /// Round wheels on a line that turn freely and independently.
    Wheels,
}

/// A belt taut round the bodies of another model, on the chassis and on every arm: what that model would be without
/// pockets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedTrack {
    /// The model round whose bodies it runs.
    pub of: Box<Track>,
    /// Whether it has grousers.
    pub surface: ClosedSurface,
}

/// The surface of a closed track.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClosedSurface {
    /// Grousers where the model has some: as high as the model's, as thick and as far apart as the outline's.
    Own,
    /// No grousers.
    Smooth,
}

impl Track {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const KINDS: [&str; 8] = [
            "line",
            "circumferential",
            "hybrid",
            "belt",
            "grouser_belt",
            "segmental",
            "force",
            "closed",
        ];
        let track = match f.text("kind")? {
            "line" => Self::Line(LineOfWheels {
                count: f.integer("count", 2, MAX_WHEELS)?,
                wheel_radius: f.optional_number("wheel_radius", SIZE)?,
                wheel: Wheel::read(f.child("wheel")?)?,
                as_track: f.flag("as_track")?,
            }),
            "circumferential" => Self::Circumferential(CircumferentialWheels {
                count: f.integer("count", 3, MAX_WHEELS)?,
                wheel_radius: f.optional_number("wheel_radius", SIZE)?,
                wheel: Wheel::read(f.child("wheel")?)?,
            }),
            "hybrid" => Self::Hybrid(HybridWheels {
                placements: read_placements(&mut f)?,
                wheel: Wheel::read(f.child("wheel")?)?,
            }),
            "belt" => Self::Belt(BeltTrack {}),
            "grouser_belt" => Self::GrouserBelt(GrouserBeltTrack {
                grouser_count: f.optional_integer("grouser_count", 1, MAX_GROUSERS)?,
            }),
            "segmental" => Self::Segmental(read_segmental(&mut f)?),
            "force" => Self::Force(ForceTrack {
                support: f.choice(
                    "support",
                    &[
                        ("skids", ForceSupport::Skids),
                        ("wheels", ForceSupport::Wheels),
                    ],
                )?,
                skid_friction: f.number("skid_friction", Range::between(0.0, 100.0, ""))?,
                wheel_count: f.integer("wheel_count", 2, MAX_WHEELS)?,
            }),
            "closed" => Self::Closed(ClosedTrack {
                of: Box::new(read_open(&mut f)?),
                surface: f.choice(
                    "surface",
                    &[
                        ("own", ClosedSurface::Own),
                        ("smooth", ClosedSurface::Smooth),
                    ],
                )?,
            }),
            other => return Err(f.error("kind", other, one_of(Some(other), &KINDS))),
        };
        f.finish()?;
        Ok(track)
    }

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

    /// Whether ground can get in between its bodies.
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

    /// The model itself, or the one round which it is closed.
    pub(crate) fn open(&self) -> &Self {
        match self {
            Self::Closed(closed) => &closed.of,
            open => open,
        }
    }

    /// Checks that it can stand at `path` for a track round so many discs.
    pub(super) fn check_discs(&self, path: &str, count: usize) -> Result<(), ScenarioError> {
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
    pub(super) fn check(&self, sharing: TorqueSharing) -> Result<(), ScenarioError> {
        if sharing == TorqueSharing::Wheel && self.wheel().is_none() {
            let rule = "must be \"track\" for a model without driven wheels";
            return Err(ScenarioError::new(
                "robot.drivetrain.torque_sharing",
                "wheel",
                rule,
            ));
        }
        Ok(())
    }
}

fn read_open(f: &mut Fields) -> Result<Track, ScenarioError> {
    match Track::read(f.child("of")?)? {
        Track::Closed(_) => Err(f.error("of", "a closed track", "must not be closed itself")),
        open => Ok(open),
    }
}

fn read_segmental(f: &mut Fields) -> Result<SegmentalTrack, ScenarioError> {
    let mechanisms = [
        ("guide", ChainMechanism::Guide),
        ("sprocket", ChainMechanism::Sprocket),
    ];
    let shapes = [
        ("rectangle", ShoeShape::Rectangle),
        ("trapezoid", ShoeShape::Trapezoid),
    ];
    let track = SegmentalTrack {
        shoe_count: f.optional_integer("shoe_count", 3, MAX_SHOES)?,
        mechanism: f.choice("mechanism", &mechanisms)?,
        shoe_shape: f.choice("shoe_shape", &shapes)?,
        plate_thickness: f.optional_number("plate_thickness", SIZE)?,
        pre_tension: f.optional_number("pre_tension", FORCE)?,
        tensioner_stiffness: f.optional_number("tensioner_stiffness", STIFFNESS)?,
        tensioner_damping: f.optional_number("tensioner_damping", DAMPING)?,
        road_wheel_count: f.optional_integer("road_wheel_count", 0, MAX_WHEELS)?,
        return_roller_count: f.optional_integer("return_roller_count", 0, MAX_WHEELS)?,
    };
    let wheels = [
        ("road_wheel_count", track.road_wheel_count),
        ("return_roller_count", track.return_roller_count),
    ];
    for (name, count) in wheels {
        if let Some(count) = count.filter(|_| track.mechanism == ChainMechanism::Guide) {
            let rule =
                "must not be given for a guide, which has no wheels (mechanism \"sprocket\" has)";
            return Err(f.error(name, count, rule));
        }
    }
    Ok(track)
}

fn read_placements(f: &mut Fields) -> Result<Vec<[f64; 3]>, ScenarioError> {
    let columns = [("x", COORDINATE), ("y", COORDINATE), ("radius", SIZE)];
    let placements = f.rows("placements", columns, MAX_WHEELS as usize)?;
    if placements.is_empty() {
        return Err(f.error("placements", "[]", "must place at least one wheel"));
    }
    Ok(placements)
}

/// Largest number of grousers of one wheel.
pub(crate) const MAX_GROUSERS: u32 = 200;

/// The shape of a wheel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Wheel {
    /// A disc.
    Round,
    /// A disc with grousers.
    Gear(GearWheel),
}

/// A wheel with grousers; fields that are `None` follow from the robot's outline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GearWheel {
    /// Grousers on the wheel.
    pub grouser_count: Option<u32>,
    /// [m] Radial height: the wheel's radius less that of its root circle.
    pub grouser_height: Option<f64>,
    /// [m] Thickness of a grouser at its tip.
    pub tip_thickness: Option<f64>,
    /// [m] Thickness of a grouser at the root circle; `None` takes that at the tip: parallel flanks.
    pub base_thickness: Option<f64>,
    /// Share of the angle between two grousers by which each wheel starts ahead of the previous one.
    pub phase_fraction: f64,
}

impl Wheel {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const SIZE: Range = Range::above(0.0, 100.0, "m");
        let wheel = match f.text("kind")? {
            "round" => Self::Round,
            "gear" => Self::Gear(GearWheel {
                grouser_count: f.optional_integer("grouser_count", 3, MAX_GROUSERS)?,
                grouser_height: f.optional_number("grouser_height", SIZE)?,
                tip_thickness: f.optional_number("tip_thickness", SIZE)?,
                base_thickness: f.optional_number("base_thickness", SIZE)?,
                phase_fraction: f.number("phase_fraction", Range::between(0.0, 1.0, ""))?,
            }),
            other => return Err(f.error("kind", other, one_of(Some(other), &["round", "gear"]))),
        };
        f.finish()?;
        Ok(wheel)
    }
}
