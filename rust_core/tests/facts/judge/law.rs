//! The force at one place of overlap: a damped spring, and a bristle that slips at Coulomb's limit.

use super::distance::Touch;
use super::motion::Settings;

/// Damping of a bristle beside that of an impact.
const BRISTLE_DAMPING: f64 = 0.25;

/// What friction remembers of a touch.
#[derive(Clone, Copy)]
pub(super) struct Bristle {
    part: usize,
    feature: u32,
    place: u32,
    /// [m] How far it is bent.
    bend: f64,
}

/// All bristles of the last step and of this one.
#[derive(Default)]
pub(super) struct Bristles {
    last: Vec<Bristle>,
    now: Vec<Bristle>,
}

/// Speed of the robot's surface over the ground in one direction, and the mass that it meets there.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    pub speed: f64,
    pub mass: f64,
}

impl Bristles {
    pub(super) fn next_step(&mut self) {
        std::mem::swap(&mut self.last, &mut self.now);
        self.now.clear();
    }

    /// [m] Sum of the squares of all bends, which is twice their energy over the stiffness.
    pub(super) fn bends(&self) -> f64 {
        self.now.iter().map(|b| b.bend * b.bend).sum()
    }

    /// [N] Force on the robot along the normal and along the tangent.
    pub(super) fn force(
        &mut self,
        touch: &Touch,
        friction: f64,
        settings: Settings,
        [normal, tangent]: [Motion; 2],
    ) -> [f64; 2] {
        let Settings {
            time_step,
            stiffness,
            damping,
        } = settings;
        let damper = 2.0 * damping * (stiffness * normal.mass).sqrt();
        let pressing = (stiffness * touch.depth - damper * normal.speed).max(0.0);
        // A face and the corner at its end pass a round part on to each other.
        let before = self.last.iter().find(|b| {
            b.part == touch.part && b.feature == touch.feature && b.place.abs_diff(touch.place) <= 1
        });
        let bend = before.map_or(0.0, |b| b.bend) + tangent.speed * time_step;
        let damper = 2.0 * BRISTLE_DAMPING * damping * (stiffness * tangent.mass).sqrt();
        let limit = friction * pressing;
        let holding = -(stiffness * bend + damper * tangent.speed);
        let dragging = holding.clamp(-limit, limit);
        // Where it slips it is bent as far as its limit bends it.
        let most = limit / stiffness;
        self.now.push(Bristle {
            part: touch.part,
            feature: touch.feature,
            place: touch.place,
            bend: bend.clamp(-most, most),
        });
        [pressing, dragging]
    }
}
