//! The poses in which three sliding contacts may hold a row of equal wheels before a step, by plane statics.

use crawler2d_core::{Scenario, TrackOutline};

use crate::common::*;

/// A row of equal, turning wheels before a step; lengths [m].
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub count: u32,
    pub spacing: f64,
    pub radius: f64,
    /// Centre of mass ahead of the rear axle.
    pub behind: f64,
    /// Centre of mass above the axles.
    pub above: f64,
    pub height: f64,
    pub friction: f64,
}

/// A pose in which three sliding contacts may hold the robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Rear one of the wheels on the edge.
    pub on_edge: u32,
    /// Wheel of the third contact: `on_edge + 1` on the same edge, or a wheel on the top.
    pub third: Third,
    pub angle: f64,
    /// Normal forces of rear wheel, edge and third contact as shares of the weight.
    pub shares: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Third {
    SameEdge,
    OnTop(u32),
}

impl Row {
    /// Axle of a wheel if the rear one stands at x.
    fn axle(&self, x: f64, angle: f64, wheel: u32) -> [f64; 2] {
        let (s, c) = libm::sincos(angle);
        let along = f64::from(wheel) * self.spacing;
        [x + along * c, self.radius + along * s]
    }

    /// Whether no wheel cuts ground, face, edge or top.
    fn is_clear(&self, x: f64, angle: f64) -> bool {
        let gap = |wheel: u32| {
            let [ax, ay] = self.axle(x, angle, wheel);
            if ax >= 0.0 {
                ay - self.height
            } else if ay <= self.height {
                ay.min(-ax)
            } else {
                ay.min(libm::hypot(ax, ay - self.height))
            }
        };
        (0..self.count).all(|wheel| gap(wheel) > self.radius - 1e-9)
    }

    pub(crate) fn candidates(&self) -> Vec<Candidate> {
        let mut found = Vec::new();
        for on_edge in 0..self.count - 1 {
            found.extend(self.pocket(on_edge));
            for top in on_edge + 1..self.count {
                for side in [-1.0, 1.0] {
                    found.extend(self.on_top(on_edge, top, side));
                }
            }
        }
        found
    }

    /// The edge at the bottom of the pocket between two wheels.
    fn pocket(&self, on_edge: u32) -> Option<Candidate> {
        let depth = (self.radius.powi(2) - 0.25 * self.spacing.powi(2)).sqrt();
        if depth.is_nan() {
            return None;
        }
        let half_way = (f64::from(on_edge) + 0.5) * self.spacing;
        let edge_height =
            |angle: f64| self.radius + half_way * libm::sin(angle) - depth * libm::cos(angle);
        if edge_height(0.0) > self.height || edge_height(1.5) < self.height {
            return None;
        }
        let angle = bisect(1e-12, 1.5, |angle| edge_height(angle) < self.height);
        let (mut low, mut high) = (angle - 1e-3, angle + 1e-3);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if edge_height(middle) < self.height {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (s, c) = libm::sincos(low);
        let x = -(half_way * c + depth * s);
        let rear = self.axle(x, low, 0);
        let edge = [0.0, self.height];
        let towards = |wheel| unit([0.0, self.height], self.axle(x, low, wheel));
        let contacts = [
            ([rear[0], 0.0], [0.0, 1.0]),
            (edge, towards(on_edge)),
            (edge, towards(on_edge + 1)),
        ];
        self.balance(on_edge, Third::SameEdge, x, low, contacts)
    }

    /// One wheel on the edge, one in front of it on the top.
    fn on_top(&self, on_edge: u32, top: u32, side: f64) -> Option<Candidate> {
        let sine = self.height / (f64::from(top) * self.spacing);
        if sine >= 1.0 {
            return None;
        }
        let angle = libm::asin(sine);
        let [along, axle_height] = self.axle(0.0, angle, on_edge);
        let reach = self.radius.powi(2) - (axle_height - self.height).powi(2);
        if reach < 0.0 {
            return None;
        }
        let x = side * reach.sqrt() - along;
        let (rear, front) = (self.axle(x, angle, 0), self.axle(x, angle, top));
        let edge = [0.0, self.height];
        let contacts = [
            ([rear[0], 0.0], [0.0, 1.0]),
            (edge, unit(edge, self.axle(x, angle, on_edge))),
            ([front[0], self.height], [0.0, 1.0]),
        ];
        self.balance(on_edge, Third::OnTop(top), x, angle, contacts)
    }

    /// Forces and moment about the centre of mass: three linear equations for three normal forces.
    fn balance(
        &self,
        on_edge: u32,
        third: Third,
        x: f64,
        angle: f64,
        contacts: [([f64; 2], [f64; 2]); 3],
    ) -> Option<Candidate> {
        if !self.is_clear(x, angle) {
            return None;
        }
        let (s, c) = libm::sincos(angle);
        let com = [
            x + self.behind * c - self.above * s,
            self.radius + self.behind * s + self.above * c,
        ];
        let mut columns = [[0.0; 3]; 3];
        for (column, (point, normal)) in columns.iter_mut().zip(contacts) {
            // The surface turns forwards: its friction is known, along the normal turned by -90 degrees.
            let force = [
                normal[0] + self.friction * normal[1],
                normal[1] - self.friction * normal[0],
            ];
            let moment = (point[0] - com[0]) * force[1] - (point[1] - com[1]) * force[0];
            *column = [force[0], force[1], moment];
        }
        let shares = solve(columns, [0.0, 1.0, 0.0])?;
        shares.iter().all(|n| *n >= 0.0).then_some(Candidate {
            on_edge,
            third,
            angle,
            shares,
        })
    }

    pub(crate) fn scenario(&self) -> Scenario {
        let mut scenario = slow_and_strong();
        let length = f64::from(self.count - 1) * self.spacing;
        let outline = &mut scenario.robot.outline;
        outline.discs = TrackOutline::two_discs(length, [self.radius, self.radius]);
        scenario.robot.center_of_mass = [self.behind - 0.5 * length, self.above];
        scenario.robot.track = line(self.count);
        scenario.terrain = step(self.height, self.friction);
        scenario.duration = 40.0;
        scenario
    }
}

/// Cramer's rule; columns of the matrix are given.
fn solve(columns: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let [a, b, c] = columns;
    let whole = det(a, b, c);
    (whole.abs() > 1e-12).then(|| {
        [
            det(right, b, c) / whole,
            det(a, right, c) / whole,
            det(a, b, right) / whole,
        ]
    })
}

fn unit(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(d[0], d[1]);
    [d[0] / length, d[1] / length]
}
