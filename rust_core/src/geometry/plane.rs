//! Vectors and poses of the plane: the engine's types, which no other file names.

/// A point or a direction in the plane.
pub use rapier2d_f64::math::Vector;
pub(crate) use rapier2d_f64::math::{Pose, Rotation};

/// The z component of the product of two vectors.
pub(crate) fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The vector turned by +90 degrees.
pub(crate) fn left_of(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

/// The vector turned by -90 degrees.
pub(crate) fn right_of(v: Vector) -> Vector {
    Vector::new(v.y, -v.x)
}

/// The unit vector at an angle [rad] from +x; bit-identical on every platform.
pub(crate) fn direction(angle: f64) -> Vector {
    let (sine, cosine) = libm::sincos(angle);
    Vector::new(cosine, sine)
}
