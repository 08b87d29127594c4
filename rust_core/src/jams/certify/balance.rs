//! Whether forces can carry the weight at all: by Farkas's lemma they cannot if there is a twist against which the weight
//! works and none of the forces.

use super::interval::MARGIN;
use super::touch::Touch;
use crate::geometry::{Vector, cross};

/// A virtual motion: velocity of the centre of mass, and rate of turning times a length.
pub(super) type Twist = [f64; 3];

/// Whether no force of these contacts can work against a twist which the weight works with: with them it is not carried.
///
/// Forces and moments are taken about the centre of mass; `length` \[m\] makes moments forces.
pub(super) fn excludes(twist: Twist, touches: &[Touch], length: f64) -> bool {
    let [x, y, turn] = twist;
    y < -MARGIN
        && touches
            .iter()
            .all(|touch| least(touch, Vector::new(x, y), turn / length) > MARGIN)
}

/// The least power of a contact's forces, over the normal force.
fn least(touch: &Touch, velocity: Vector, rate: f64) -> f64 {
    // The axle's velocity, for d x F is F across d.
    let arm = touch.arm.middle;
    let at_axle = velocity + Vector::new(-arm.y, arm.x) * rate;
    let mut least = f64::INFINITY;
    for (slope, [one, other]) in touch.forces() {
        let size = one.length();
        let (first, last) = (at_axle.dot(one), at_axle.dot(other));
        // On an arc of less than half a turn the power falls, then rises, if it has a minimum inside.
        let dips = cross(one, at_axle) < 0.0 && cross(other, at_axle) > 0.0;
        let of_force = if dips {
            -at_axle.length() * size
        } else {
            first.min(last)
        };
        let off = rate.abs() * touch.arm.half.length() * size;
        least = least.min(of_force + rate * touch.radius * slope - off);
    }
    least
}

/// A twist that may exclude: the shortest vector to the hull of all forces, and of the weight turned over.
pub(super) fn candidate(touches: &[Touch], length: f64) -> Option<Twist> {
    let mut points = vec![[0.0, -1.0, 0.0]];
    for touch in touches {
        for (slope, forces) in touch.forces() {
            for force in forces {
                let moment = cross(touch.arm.middle, force) + touch.radius * slope;
                let size = force.length();
                points.push([force.x / size, force.y / size, moment / length / size]);
            }
        }
    }
    nearest(&points)
}

fn dot(a: &Twist, b: &Twist) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: &Twist, b: &Twist) -> Twist {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The point of the hull of points that is nearest to the origin; `None` if that is inside, or as good as.
///
/// Gilbert's, Johnson's and Keerthi's algorithm (1988).
fn nearest(points: &[Twist]) -> Option<Twist> {
    /// Square of the distance of an origin that is as good as inside.
    const INSIDE: f64 = 1e-12;
    let mut simplex: Vec<Twist> = vec![points[0]];
    let mut best = points[0];
    for _ in 0..32 {
        let square = dot(&best, &best);
        if square < INSIDE {
            return None;
        }
        let mut support = points[0];
        for point in points {
            if dot(point, &best) < dot(&support, &best) {
                support = *point;
            }
        }
        if dot(&support, &best) >= square * (1.0 - 1e-6) {
            return Some(best);
        }
        simplex.push(support);
        best = reduce(&mut simplex)?;
    }
    Some(best)
}

/// The nearest point of a simplex, of which only the corners that span it are kept.
fn reduce(simplex: &mut Vec<Twist>) -> Option<Twist> {
    let n = simplex.len();
    let mut best: Option<(f64, Twist, u8)> = None;
    for kept in 1_u8..1 << n {
        let corners: Vec<Twist> = (0..n)
            .filter(|i| kept >> i & 1 == 1)
            .map(|i| simplex[i])
            .collect();
        if let Some(point) = foot(&corners) {
            let square = dot(&point, &point);
            if best.as_ref().is_none_or(|(least, ..)| square < *least) {
                best = Some((square, point, kept));
            }
        }
    }
    let (_, point, kept) = best?;
    if kept.count_ones() == 4 {
        return None;
    }
    let corners = (0..n)
        .filter(|i| kept >> i & 1 == 1)
        .map(|i| simplex[i])
        .collect();
    *simplex = corners;
    Some(point)
}

/// The foot of the perpendicular from the origin on the span of corners, if it is between them.
fn foot(corners: &[Twist]) -> Option<Twist> {
    match corners {
        [a] => Some(*a),
        [a, b] => {
            let along = minus(b, a);
            let share = -dot(a, &along) / dot(&along, &along);
            (0.0..=1.0)
                .contains(&share)
                .then(|| std::array::from_fn(|i| a[i] + share * along[i]))
        }
        [a, b, c] => {
            let (u, v) = (minus(b, a), minus(c, a));
            let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
            let (au, av) = (-dot(a, &u), -dot(a, &v));
            let scale = uu * vv - uv * uv;
            let (s, t) = ((au * vv - av * uv) / scale, (av * uu - au * uv) / scale);
            (s >= 0.0 && t >= 0.0 && s + t <= 1.0)
                .then(|| std::array::from_fn(|i| a[i] + s * u[i] + t * v[i]))
        }
        [a, b, c, d] => {
            // The origin is inside if it lies on the inner side of every face.
            let faces = [(a, b, c, d), (a, b, d, c), (a, c, d, b), (b, c, d, a)];
            let inside = faces.iter().all(|(p, q, r, inner)| {
                let (u, v) = (minus(q, p), minus(r, p));
                let normal = [
                    u[1] * v[2] - u[2] * v[1],
                    u[2] * v[0] - u[0] * v[2],
                    u[0] * v[1] - u[1] * v[0],
                ];
                let of_inner = dot(&normal, &minus(inner, p));
                let of_origin = -dot(&normal, p);
                of_inner * of_origin > 0.0
            });
            inside.then_some([0.0; 3])
        }
        _ => None,
    }
}
