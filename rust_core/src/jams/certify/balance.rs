//! Whether forces can carry the weight at all. By Farkas's lemma they cannot if there is a twist in which the weight
//! does positive work and no force does negative work.

use super::interval::MARGIN;
use super::touch::Touch;
use crate::geometry::{Vector, cross};

/// A virtual motion: velocity of the centre of mass, and rate of rotation times a length.
pub(super) type Twist = [f64; 3];

/// Whether no force of these contacts can do negative work in a twist in which the weight does positive work, so that
/// they cannot carry it.
///
/// Forces and moments are taken about the centre of mass; `length` \[m\] converts moments to forces.
pub(super) fn excludes(twist: Twist, touches: &[Touch], length: f64) -> bool {
    let [x, y, turn] = twist;
    y < -MARGIN
        && touches
            .iter()
            .all(|touch| least(touch, Vector::new(x, y), turn / length) > MARGIN)
}

/// The least power of a contact's forces, divided by the normal force.
fn least(touch: &Touch, velocity: Vector, rate: f64) -> f64 {
    // The axle's velocity, for d x F is F across d.
    let arm = touch.arm.middle;
    let at_axle = velocity + Vector::new(-arm.y, arm.x) * rate;
    let mut least = f64::INFINITY;
    for (slope, [one, other]) in touch.forces() {
        let size = one.length();
        let (first, last) = (at_axle.dot(one), at_axle.dot(other));
        // If the power has a minimum inside an arc of less than half a turn, it falls and then rises.
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

/// A twist that may exclude the cell: the shortest vector to the hull of all forces and of the reversed weight.
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

/// The point of the hull of points nearest to the origin; `None` if the origin is inside, or almost.
///
/// This is the algorithm of Gilbert, Johnson and Keerthi (1988).
fn nearest(points: &[Twist]) -> Option<Twist> {
    /// Square of the distance below which the origin counts as inside.
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

/// The nearest point of a simplex, which keeps only the corners that span that point.
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

/// The foot of the perpendicular from the origin to the span of corners, if it is between them.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::right_of;
    use crate::jams::certify::interval::Rectangle;
    use crate::jams::certify::touch::Normals;

    fn twist(draw: &mut Draw, most: f64) -> Twist {
        std::array::from_fn(|_| draw.between(-most, most))
    }

    /// The distance of a hull from the origin by the method of Frank and Wolfe, with steps towards corners.
    fn distance(points: &[Twist]) -> f64 {
        let mut at = points[0];
        for _ in 0..20_000 {
            let of = |p: &&Twist| dot(p, &at);
            let corner = points.iter().min_by(|a, b| of(a).total_cmp(&of(b)));
            let way = minus(corner.expect("there is one"), &at);
            let share = (-dot(&at, &way) / dot(&way, &way).max(1e-300)).clamp(0.0, 1.0);
            at = std::array::from_fn(|i| at[i] + share * way[i]);
        }
        dot(&at, &at).sqrt()
    }

    /// The whole hull is beyond the plane through the nearest point normal to it.
    #[test]
    fn the_nearest_point_of_a_hull_is_as_far_as_the_hull() {
        let mut draw = Draw(11);
        let (mut outside, mut inside) = (0, 0);
        for case in 0..150 {
            let away = twist(&mut draw, 0.7);
            let of = |_| {
                let own = twist(&mut draw, 1.0);
                std::array::from_fn(|i| own[i] + away[i])
            };
            let points: Vec<Twist> = (0..=case % 12).map(of).collect();
            let expected = distance(&points);
            if let Some(found) = nearest(&points) {
                outside += 1;
                let length = dot(&found, &found).sqrt();
                // After 20,000 steps there is an error, which is inversely proportional to their number.
                assert!(
                    (length - expected).abs() < 1e-3,
                    "{case}: {length} {expected}"
                );
                let least = points
                    .iter()
                    .map(|p| dot(p, &found))
                    .fold(f64::INFINITY, f64::min);
                assert!(least >= length * length * (1.0 - 2e-6), "{case}");
            } else {
                inside += 1;
                assert!(expected < 1e-3, "{case}: {expected}");
            }
        }
        assert!(outside > 80 && inside > 10, "{outside} {inside}");
    }

    /// Whether it is at the end of a hull, in the middle of one, or in a corner.
    #[test]
    fn a_hull_through_the_origin_has_no_nearest_point() {
        let [x, y, origin] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
        for points in [
            vec![origin],
            vec![x, minus(&origin, &x)],
            vec![x, y, [-1.0, -1.0, 0.0]],
            vec![x, y, origin],
        ] {
            assert_eq!(nearest(&points), None, "{points:?}");
        }
        // A micrometre off it is none.
        let found = nearest(&[[-1.0, 2e-6, 0.0], [1.0, 2e-6, 0.0]]);
        assert_eq!(found, Some([0.0, 2e-6, 0.0]));
    }

    #[test]
    fn four_corners_in_a_plane_hold_nothing() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        for height in [0.0, 2.0] {
            assert_eq!(foot(&square.map(|[x, y]| [x, y, height])), None);
        }
    }

    #[test]
    fn a_foot_is_between_the_corners_and_square_to_all_edges() {
        let on_line = [[1.0, -1.0, 0.5], [1.0, 3.0, 0.5]];
        assert_eq!(foot(&on_line), Some([1.0, 0.0, 0.5]));
        assert_eq!(foot(&[[1.0, 1.0, 0.0], [1.0, 3.0, 0.0]]), None);
        assert_eq!(foot(&[[1.0, -3.0, 0.0], [1.0, -1.0, 0.0]]), None);
        // A triangle at the height 2, whose sides are at the distances 1, 1 and sqrt(1/2) from the axis.
        let triangle = |x: f64, y: f64| {
            [[-1.0, -1.0], [2.0, -1.0], [-1.0, 2.0]].map(|[p, q]| [p + x, q + y, 2.0])
        };
        let found = foot(&triangle(0.0, 0.0)).expect("it is over the origin");
        assert!(
            minus(&found, &[0.0, 0.0, 2.0])
                .iter()
                .all(|x| x.abs() < 1e-15)
        );
        for (x, y, is_over) in [
            (0.9, 0.0, true),
            (1.1, 0.0, false),
            (0.0, 0.9, true),
            (0.0, 1.1, false),
            (-0.4, -0.4, true),
            (-0.6, -0.6, false),
        ] {
            assert_eq!(foot(&triangle(x, y)).is_some(), is_over, "{x} {y}");
        }
        // The origin is inside over a corner of it, and not above or below.
        for (height, is_inside) in [(-1.0, true), (0.5, false), (-3.0, false)] {
            let mut corners = triangle(0.0, 0.0).map(|[x, y, _]| [x, y, height]).to_vec();
            corners.push([0.0, 0.0, height + 2.0]);
            assert_eq!(foot(&corners).is_some(), is_inside, "{height}");
        }
    }

    fn touch(draw: &mut Draw) -> Touch {
        let mut two = |low: f64, high: f64| {
            let [a, b] = [0.0; 2].map(|_| draw.between(low, high));
            [a.min(b), a.max(b)]
        };
        let (sines, slopes) = (two(-0.8, 0.8), two(-1.0, 1.0));
        let [middle, half] = [two(-0.3, 0.3), two(0.0, 0.05)].map(Vector::from);
        let [x, _] = two(-3.0, 3.0);
        Touch {
            surface: 0,
            place: 0,
            normals: Normals {
                bisector: Vector::from_angle(x),
                sines,
                circle: None,
                is_on_face: false,
            },
            slopes,
            arm: Rectangle { middle, half },
            radius: two(-0.1, 0.1)[0],
            slides: true,
        }
    }

    /// The power of the force at its point of the ground, for a normal that is turned from the bisector by the arc of
    /// `sine`.
    fn power(touch: &Touch, (sine, slope): (f64, f64), arm: Vector, [x, y, rate]: Twist) -> f64 {
        let normal = Vector::from_angle(libm::asin(sine)).rotate(touch.normals.bisector);
        let force = normal + right_of(normal) * slope;
        let point = arm - normal * touch.radius;
        Vector::new(x, y).dot(force) + rate * cross(point, force)
    }

    /// A force is a normal of the arc with a friction in its range. The error of 400 steps on the arc is that of their
    /// square.
    #[test]
    fn no_force_of_a_touch_has_less_power_than_the_least() {
        let mut draw = Draw(12);
        for case in 0..200 {
            let (mut touch, motion) = (touch(&mut draw), twist(&mut draw, 1.0));
            let is_point = case % 2 == 0;
            if is_point {
                touch.arm.half = Vector::ZERO;
            }
            let [x, y, rate] = motion;
            let found = least(&touch, Vector::new(x, y), rate);
            let [from, to] = touch.normals.sines;
            let mut lowest = f64::INFINITY;
            for k in 0..=400 {
                let sine = from + (to - from) * f64::from(k) / 400.0;
                for slope in touch.slopes {
                    for corner in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                        let arm = touch.arm.middle + touch.arm.half * Vector::from(corner);
                        lowest = lowest.min(power(&touch, (sine, slope), arm, motion));
                    }
                }
            }
            assert!(found <= lowest + 1e-15, "{case}: {found} {lowest}");
            // If the axle is known; otherwise the error is at most twice what the far corner of its range adds.
            let slack = 2.0 * rate.abs() * touch.arm.half.length() * 1.5;
            assert!(lowest - found <= slack + 1e-4, "{case}: {found} {lowest}");
        }
    }

    /// A level touch of a disc, at a distance [m] ahead of the centre of mass and a height below it.
    fn below(ahead: f64, slopes: [f64; 2]) -> Touch {
        Touch {
            surface: 0,
            place: 0,
            normals: Normals {
                bisector: Vector::Y,
                sines: [0.0; 2],
                circle: None,
                is_on_face: true,
            },
            slopes,
            arm: Rectangle::at(Vector::new(ahead, -0.1)),
            radius: 0.05,
            slides: true,
        }
    }

    /// Two supports carry a plank whose centre of mass is between them.
    #[test]
    fn a_twist_excludes_what_does_not_carry_and_nothing_else() {
        let length = 0.5;
        for (places, carries) in [
            ([-0.2, 0.1], true),
            ([0.05, 0.2], false),
            ([-0.3, -0.1], false),
        ] {
            // Whatever the friction is: along level ground it adds up to nothing.
            for friction in [0.2, 2.0] {
                let touches = places.map(|ahead| below(ahead, [-friction, friction]));
                let found = candidate(&touches, length);
                let excluded = found.is_some_and(|twist| excludes(twist, &touches, length));
                assert_eq!(excluded, !carries, "{places:?} {friction}");
            }
        }
        // Every support does negative work in a fall without rotation, and the weight does in a rise.
        let touches = [below(0.2, [0.0; 2])];
        let falls = |y: f64, turn: f64| excludes([0.0, y, turn], &touches, length);
        assert!(!falls(-1.0, 0.0) && !falls(1.0, 0.0));
        // Falling by 1 and turning, nose up, so that the support 0.2 m ahead rises or falls.
        assert!(falls(-1.0, 5.1 * length) && !falls(-1.0, 4.9 * length));
        assert!(!falls(1.0, 5.1 * length));
    }
}
