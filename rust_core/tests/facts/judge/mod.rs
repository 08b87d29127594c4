//! A judge of contact and motion: slow, plain, and without a line or a method of the core.
//!
//! Corners that overlap are pushed apart by stiff springs with dampers, friction is a bristle that
//! slips at Coulomb's limit, time goes on in steps of some microseconds. There is no solver, no
//! prediction and no memory but for the bristles. Only the description is shared: masses, the places of
//! the wheels, the points of the ground.

mod closed_forms;
mod distance;
mod ensemble;
mod ground;
mod law;
mod motion;
mod robot;
mod scenes;
mod statistics;
mod wheel;

pub(crate) use ensemble::{Tally, core_passes, standstills};
pub(crate) use motion::Settings;
pub(crate) use scenes::{Scene, drawn_scene, fixed_scenes};

use crawler2d_core::Vector;

/// Turned by +90 degrees.
fn left_of(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

/// Turned by -90 degrees.
fn right_of(v: Vector) -> Vector {
    Vector::new(v.y, -v.x)
}

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// A turn in the plane.
#[derive(Clone, Copy)]
struct Turn {
    cosine: f64,
    sine: f64,
}

impl Turn {
    fn by(angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        Self { cosine, sine }
    }

    fn of(self, v: Vector) -> Vector {
        Vector::new(
            self.cosine * v.x - self.sine * v.y,
            self.sine * v.x + self.cosine * v.y,
        )
    }

    fn back(self, v: Vector) -> Vector {
        Vector::new(
            self.cosine * v.x + self.sine * v.y,
            self.cosine * v.y - self.sine * v.x,
        )
    }
}
