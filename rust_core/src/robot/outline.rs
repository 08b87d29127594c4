//! The bodies of a robot for pictures: their outlines, mounts and motion.

use std::f64::consts::TAU;

use super::{BodyKind, Model, Mount, Part, Running, Shape};
use crate::geometry::{Disc, Envelope, Vector, direction};
use crate::scenario::End;

/// Corners of a circle.
const CIRCLE: u32 = 180;
/// Points of one root arc between two grousers.
const ARC_POINTS: usize = 12;
/// [rad] Angle between two points on the arc of a belt.
const BELT_TURN: f64 = 0.05;

/// A body with its outline.
#[derive(Clone, Debug)]
pub struct Body {
    /// Index of its part; `None` for wheels inside a belt or a guide, which never touch the ground.
    pub part: Option<usize>,
    /// What it represents.
    pub kind: BodyKind,
    /// Index of the lane under its track, or under the belly.
    pub lane: usize,
    /// Its carrier.
    pub mount: Mount,
    /// [m] Radius, if it is a circle.
    pub radius: Option<f64>,
    /// [m] Corners in its own frame, counter-clockwise.
    pub outline: Vec<Vector>,
    turning: Turning,
}

/// How a body moves relative to its carrier.
#[derive(Clone, Copy, Debug)]
enum Turning {
    /// Like its part, which has this index.
    AsPart(usize),
    /// About its centre, with the belt or chain that runs round it.
    With { drive: usize, disc: Disc },
    /// With the pins of the chain with this index.
    Sprocket(usize),
}

/// The closed path of a belt.
#[derive(Clone, Debug)]
pub struct Circuit {
    /// [m] Distances along the belt; between two of them it is straight enough to interpolate poses.
    pub ways: Vec<f64>,
    /// [m, m, rad] Poses there in the frame of the belt's carrier; the last is the first after a full turn.
    pub poses: Vec<[f64; 3]>,
}

impl Model {
    /// The bodies of all tracks and the belly: the parts in order, then the wheels inside belts and guides.
    pub fn outlines(&self) -> Vec<Body> {
        let parts = self.parts.iter().enumerate();
        let mut bodies: Vec<Body> = parts.map(|(i, part)| self.outline(i, part)).collect();
        bodies.extend(self.parts.iter().flat_map(|part| self.within(part)));
        bodies
    }

    fn outline(&self, index: usize, part: &Part) -> Body {
        let mut body = Body::beside(part, part.kind, Turning::AsPart(index));
        body.part = Some(index);
        match &part.shape {
            Shape::Disc { radius, .. } => body.round(*radius),
            Shape::Gear { gear, .. } => body.outline = gear.outline(ARC_POINTS),
            Shape::Polygon { corners } => body.outline.clone_from(corners),
            Shape::Grouser(grouser) => body.outline = grouser.corners().to_vec(),
            Shape::Hull { discs, .. } => match discs[..] {
                [disc] if part.kind.is_in_chain() => self.wheel_in_chain(&mut body, disc),
                _ => {
                    body.outline = Envelope::new(discs).polyline(BELT_TURN);
                    body.outline.reverse();
                }
            },
        }
        body
    }

    /// Sets up the sprocket of a chain, or a wheel turned by its plates.
    fn wheel_in_chain(&self, body: &mut Body, disc: Disc) {
        let chain = &self.chains[body.lane];
        if let (BodyKind::Sprocket, Some(sprocket)) = (body.kind, &chain.sprocket) {
            body.outline = sprocket.teeth.outline(0.5 * chain.plate_thickness);
            body.turning = Turning::Sprocket(body.lane);
        } else {
            body.round(disc.radius);
            let drive = chain.number;
            body.turning = Turning::With { drive, disc };
        }
    }

    /// The wheels inside a belt, or inside a chain on a guide.
    fn within(&self, part: &Part) -> Vec<Body> {
        let drive = match part.kind {
            BodyKind::Belt => part.drive,
            BodyKind::Guide => Some(self.chains[part.lane].number),
            _ => None,
        };
        let (Shape::Hull { discs, .. }, Some(drive)) = (&part.shape, drive) else {
            return Vec::new();
        };
        // A belt is driven at the rear of the robot, or at the pivot of its arm.
        let driven = match part.mount {
            Mount::Flipper(k) if self.flippers[k].end == End::Rear => discs.len() - 1,
            _ => 0,
        };
        let wheel = |(i, disc): (usize, &Disc)| {
            let kind = if i == driven {
                BodyKind::Sprocket
            } else {
                BodyKind::Idler
            };
            let mut body = Body::beside(part, kind, Turning::With { drive, disc: *disc });
            body.round(disc.radius);
            body
        };
        discs.iter().enumerate().map(wheel).collect()
    }
}

impl Body {
    /// A body without outline, over the lane and on the mount of a part.
    fn beside(part: &Part, kind: BodyKind, turning: Turning) -> Self {
        Self {
            part: None,
            kind,
            lane: part.lane,
            mount: part.mount,
            radius: None,
            outline: Vec::new(),
            turning,
        }
    }

    fn round(&mut self, radius: f64) {
        let corner = |i: u32| direction(TAU * f64::from(i) / f64::from(CIRCLE)) * radius;
        self.radius = Some(radius);
        self.outline = (0..CIRCLE).map(corner).collect();
    }

    /// Origin [m] and angle [rad] of its frame in that of its mount; full turns count.
    pub(crate) fn place(&self, model: &Model, running: &Running) -> (Vector, f64) {
        match self.turning {
            Turning::AsPart(index) => {
                let part = &model.parts[index];
                let place = part.place(running);
                (place.translation, part.turn(part.run(running)))
            }
            Turning::With { drive, disc } => {
                let run = running.run(self.mount, drive);
                (disc.center, -run / disc.radius)
            }
            Turning::Sprocket(number) => {
                let chain = &model.chains[number];
                let run = running.run(self.mount, chain.number);
                let angle = chain.sprocket.as_ref().map_or(0.0, |s| s.angle(run));
                (chain.ends[0].center, angle)
            }
        }
    }

    /// [m] Travel of its surface relative to its mount.
    pub(crate) fn run(&self, model: &Model, running: &Running) -> f64 {
        self.part.map_or(0.0, |part| model.parts[part].run(running))
    }
}

impl Part {
    /// Its path, if it is a belt.
    pub fn circuit(&self) -> Option<Circuit> {
        let (Shape::Hull { discs, .. }, BodyKind::Belt) = (&self.shape, self.kind) else {
            return None;
        };
        let belt = Envelope::new(discs);
        let pose = |way: &f64| {
            let [x, y] = belt.point_at(*way).into();
            [x, y, belt.angle_at(*way)]
        };
        let ways: Vec<f64> = belt.positions(BELT_TURN).chain([belt.length()]).collect();
        let poses = ways.iter().map(pose).collect();
        Some(Circuit { ways, poses })
    }
}
