//! A closed belt instead of a track, to find out what a track without gaps would do in the same pose.

use super::track::with_grousers;
use super::{BodyKind, Model, Mount, Part, Shape};
use crate::geometry::{Disc, Envelope};
use crate::scenario::{ClosedSurface, ScenarioError, TrackOutline};

impl Model {
    /// The same robot with a closed belt, taut round the circumscribed circles of each track's bodies, with all their
    /// motor force and mass. Grousers are as high as the track's, if it has any, and within the same circles.
    ///
    /// # Errors
    /// The outline's pitch requires more grousers than a belt may have.
    pub(super) fn closed(
        &self,
        surface: ClosedSurface,
        outline: &TrackOutline,
    ) -> Result<Self, ScenarioError> {
        let round = |mount| -> Vec<Disc> { self.discs_of_track(0, mount).map(|d| d.0).collect() };
        let has_belt = self.has_track(Mount::Chassis);
        let belt = has_belt.then(|| Envelope::new(&round(Mount::Chassis)));
        // A closed belt covers the part of the belly inside it.
        let is_bare = |part: &&Part| match (&part.shape, &belt) {
            (Shape::Polygon { corners }, Some(belt)) => {
                corners.iter().any(|corner| belt.depth(*corner) < 0.0)
            }
            _ => true,
        };
        let tracks = self.tracks();
        let belly = self.belly().filter(is_bare).cloned();
        // Wheels without a track round them stay, all of a side on its motor.
        let wheels = self
            .track_parts()
            .filter(|part| !self.has_track(part.mount));
        let on_motor = wheels.map(|wheel| Part {
            drive: Some(wheel.lane),
            ..wheel.clone()
        });
        let mut parts: Vec<Part> = on_motor.collect();
        for lane in 0..tracks {
            for mount in self.mounts_of_tracks() {
                let height = match surface {
                    ClosedSurface::Own => self.grouser_height(mount, outline),
                    ClosedSurface::Smooth => 0.0,
                };
                let (belt, _) = with_grousers(round(mount), height, None, outline)?;
                parts.extend(belt.into_iter().map(|part| Part {
                    drive: Some(lane),
                    lane,
                    mount,
                    ..part
                }));
            }
        }
        let whole = self.with_circulating_mass();
        let mass: f64 = whole.drive_masses.iter().sum();
        // A chain has all of the force: that of belts on arms is separate.
        let sharers = if self.chains.is_empty() {
            self.motors
        } else {
            self.chains.len()
        };
        Ok(Self {
            parts: Self::in_order(parts, belly),
            drives: tracks,
            motors: tracks,
            drive_masses: vec![mass / tracks as f64; tracks],
            motor: self.motor.shared(sharers, tracks),
            pushes_chassis: false,
            ..whole
        })
    }

    /// [m] Height of the grousers of the track on a mount: gears have their own, chains and belts those of the outline.
    /// A belt has none if the outline has no thickness of grousers.
    fn grouser_height(&self, mount: Mount, outline: &TrackOutline) -> f64 {
        if outline.grouser_thickness <= 0.0 {
            return 0.0;
        }
        let of_part = |part: &Part| match &part.shape {
            Shape::Gear { gear, .. } => gear.radius - gear.root_radius,
            Shape::Hull { grouser_height, .. } if *grouser_height > 0.0 => outline.grouser_height,
            _ => 0.0,
        };
        // Parts that travel with a belt are covered by the belt itself.
        let bears_them = |part: &&Part| {
            let is_other = matches!(part.kind, BodyKind::Belly | BodyKind::Grouser);
            part.mount == mount && !is_other
        };
        let heights = self.parts.iter().filter(bears_them).map(of_part);
        // Wheels of several sizes have several heights; the smallest fits all of them.
        heights.reduce(f64::min).unwrap_or(0.0)
    }
}
