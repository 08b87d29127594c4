//! Carriers of a track, the chassis or the flippers at one end, with the same data as `drawings/scene.py` has for
//! pictures.

use crawler2d_core::{
    Body, BodyKind, Circuit, Ground, Model, Mount, Part, Poses, Shape, Trace, Vector,
};

/// [rad] Change of direction between two points on a belt.
const BELT_TURN: f64 = 0.05;
/// [m] Lines that coincide enclose slivers by rounding; anything shallower is not an intrusion.
const SLIVER: f64 = 2e-5;

/// [m, m, rad] A pose; in angles full turns count.
pub(crate) type Pose = [f64; 3];

/// A carrier with its part of the near track.
pub(crate) struct Carrier {
    pub(crate) name: &'static str,
    /// [m] Circles that the envelope runs round, in its own frame: centre and radius.
    pub(crate) circles: Vec<(Vector, f64)>,
    /// Whether ground cannot get inside.
    pub(crate) closed: bool,
    /// [m] Taut belts round the circumscribed and the root circles.
    pub(crate) envelopes: [Vec<Vector>; 2],
    /// [m] The first of them, offset inwards by the depth from which ground in it is an intrusion.
    pub(crate) inner: Vec<Vector>,
    /// The path of its belt, if it has one, and the belt's body.
    pub(crate) circuit: Option<(usize, Circuit)>,
    /// Bodies of the grousers on its belt, with their positions along it [m].
    pub(crate) grousers: Vec<(usize, f64)>,
    /// The bodies that may be visible.
    pub(crate) bodies: Vec<usize>,
    /// Its pose at each sample.
    pub(crate) poses: Vec<Pose>,
}

/// The chassis, then the flippers.
pub(crate) fn all(
    (model, ground): (&Model, &Ground),
    bodies: &[Body],
    (trace, poses): (&Trace, &Poses),
    depth: f64,
) -> Vec<Carrier> {
    let of_mount = |mount: Mount| {
        let frames = match mount {
            Mount::Flipper(k) => (0..poses.samples)
                .map(|i| pose(&poses.arms, i * poses.flippers + k))
                .collect(),
            Mount::Chassis | Mount::Shoe(_) => (0..poses.samples)
                .map(|i| {
                    let [x, y] = [trace.position[2 * i], trace.position[2 * i + 1]];
                    [x, y, trace.chassis_angle[i]]
                })
                .collect(),
        };
        of((model, mount, ground.tracks - 1), bodies, frames, depth)
    };
    model.mounts().map(of_mount).collect()
}

/// The pose with this number in a list of numbers.
pub(crate) fn pose(numbers: &[f64], number: usize) -> Pose {
    [0, 1, 2].map(|i| numbers[3 * number + i])
}

fn of(
    (model, mount, lane): (&Model, Mount, usize),
    bodies: &[Body],
    poses: Vec<Pose>,
    depth: f64,
) -> Carrier {
    let [envelope, root] = model.envelopes(mount, BELT_TURN);
    let name = model.carrier(mount);
    let is_seen = |body: &Body| {
        model.carrier(body.mount) == name && (body.lane == lane || body.kind == BodyKind::Belly)
    };
    let mut carrier = Carrier {
        name,
        circles: Vec::new(),
        closed: !model.has_track(mount),
        inner: inset(&envelope, depth.max(SLIVER)),
        envelopes: [envelope, root],
        circuit: None,
        grousers: Vec::new(),
        bodies: (0..bodies.len()).filter(|i| is_seen(&bodies[*i])).collect(),
        poses,
    };
    let of_track = |part: &Part| part.lane == lane && part.mount == mount;
    for (number, part) in model.parts.iter().enumerate().filter(|(_, p)| of_track(p)) {
        match &part.shape {
            Shape::Disc { center, radius } => carrier.circles.push((*center, *radius)),
            Shape::Gear { center, gear } => carrier.circles.push((*center, gear.radius)),
            Shape::Hull { discs, .. } => {
                carrier.closed = true;
                let circles = discs.iter().map(|disc| (disc.center, disc.radius));
                carrier.circles.extend(circles);
            }
            Shape::Grouser(grouser) => carrier.grousers.push((number, grouser.start())),
            Shape::Polygon { .. } => {}
        }
        carrier.circuit = carrier
            .circuit
            .take()
            .or_else(|| part.circuit().map(|circuit| (number, circuit)));
    }
    carrier
}

/// [m] A closed convex line, counter-clockwise, offset inwards by a depth.
fn inset(belt: &[Vector], depth: f64) -> Vec<Vector> {
    let next = |points: &[Vector], i: usize| points[(i + 1) % points.len()];
    let is_apart = |i: &usize| (next(belt, *i) - belt[*i]).length() > 1e-9;
    let belt: Vec<Vector> = (0..belt.len()).filter(is_apart).map(|i| belt[i]).collect();
    let inwards = |i: usize| {
        let side = next(&belt, i) - belt[i];
        Vector::new(-side.y, side.x) / side.length()
    };
    let n = belt.len();
    let moved = |i: usize| {
        let both = inwards(i) + inwards((i + n - 1) % n);
        belt[i] + depth * both / both.length()
    };
    (0..n).map(moved).collect()
}

/// Expresses a pose relative to a frame.
pub(crate) fn relative(pose: Pose, frame: Pose) -> Pose {
    let [x, y, angle] = [0, 1, 2].map(|i| pose[i] - frame[i]);
    let (sine, cosine) = frame[2].sin_cos();
    [cosine * x + sine * y, cosine * y - sine * x, angle]
}

/// [m] Transforms a point from a frame.
pub(crate) fn placed(point: Vector, frame: Pose) -> Vector {
    let (sine, cosine) = frame[2].sin_cos();
    let turned = Vector::new(
        cosine * point.x - sine * point.y,
        sine * point.x + cosine * point.y,
    );
    Vector::new(frame[0], frame[1]) + turned
}
