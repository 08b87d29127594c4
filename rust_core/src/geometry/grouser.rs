//! A grouser that travels with a belt.

use std::sync::Arc;

use super::{Envelope, Motion};
use super::{Pose, Rotation, Vector};
use crate::scenario::{MAX_GROUSERS, ScenarioError, TrackOutline};

/// A grouser fixed to a belt, which carries it along.
#[derive(Clone, Debug)]
pub struct Grouser {
    /// The line of the belt.
    belt: Arc<Envelope>,
    /// [m] Position along the line at the start.
    way: f64,
    /// [m] Corners, counter-clockwise, x along the belt's travel and y outwards from its line.
    corners: [Vector; 4],
}

impl Grouser {
    /// A grouser of a height and thickness [m] that starts at the position `way` [m] of the belt's line.
    pub(crate) fn new(belt: &Arc<Envelope>, way: f64, height: f64, thickness: f64) -> Self {
        let half = 0.5 * thickness;
        // It reaches into the belt, so that no corner of the ground can slip under it where the belt bends.
        let corner = |x: f64, y: f64| Vector::new(x, y);
        Self {
            belt: Arc::clone(belt),
            way,
            corners: [
                corner(-half, -half),
                corner(half, -half),
                corner(half, height),
                corner(-half, height),
            ],
        }
    }

    /// The grousers of a belt, evenly spaced: as many as given, or closest to the outline's pitch.
    ///
    /// # Errors
    /// The pitch makes more grousers than a belt may have.
    pub(crate) fn along(
        line: &Arc<Envelope>,
        count: Option<u32>,
        height: f64,
        outline: &TrackOutline,
    ) -> Result<impl Iterator<Item = Self> + use<>, ScenarioError> {
        let length = line.length();
        let count = match count {
            Some(count) => count,
            None => outline.pitches_along(length, [1, MAX_GROUSERS])?,
        };
        let pitch = length / f64::from(count);
        let (line, thickness) = (Arc::clone(line), outline.grouser_thickness);
        Ok((0..count).map(move |i| Self::new(&line, f64::from(i) * pitch, height, thickness)))
    }

    /// [m] Its corners in its own frame, counter-clockwise.
    pub fn corners(&self) -> &[Vector; 4] {
        &self.corners
    }

    /// Its frame in the chassis frame when the belt has run so far [m].
    pub fn place(&self, run: f64) -> Pose {
        let (point, outward) = self.belt.place_at(self.way + run);
        // Turns +y outwards.
        let rotation = Rotation::from_cos_sin_unchecked(outward.y, -outward.x);
        Pose::from_parts(point, rotation)
    }

    /// [m] Position along the belt's line at which it starts.
    pub fn start(&self) -> f64 {
        self.way
    }

    /// [rad] Angle of that frame; it counts full turns.
    pub(crate) fn angle(&self, run: f64) -> f64 {
        self.belt.angle_at(self.way + run)
    }

    /// How the belt moves a point [m] of the chassis frame when it has run so far [m]: as part of this grouser, unless
    /// that is elsewhere.
    pub(crate) fn motion_where(&self, run: f64, point: Vector) -> Motion {
        let reach = self
            .corners
            .map(Vector::length)
            .into_iter()
            .fold(0.0, f64::max);
        if (self.place(run).translation - point).length() <= 1.1 * reach {
            return self.motion(run, 0.0);
        }
        self.belt.motion_at(self.belt.way_of(point), 0.0)
    }

    /// How the belt moves it there, averaged while it runs from `reach` [m] before to `reach` behind.
    pub(crate) fn motion(&self, run: f64, reach: f64) -> Motion {
        self.belt.motion_at(self.way + run, reach)
    }
}
