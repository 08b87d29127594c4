//! Plane statics of a stop: can forces within friction and torque limits balance it?
//!
//! Every contact has a normal force and friction: anywhere in the friction cone while it sticks, against the slip
//! on the edge of the cone while it slides. Forces, the moment about the centre of mass and the torque of each
//! drive must balance; the imbalance is the smallest residual that any choice of forces leaves.

#[cfg(test)]
mod tests;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

use crate::dynamics::{Direction, push_axis};
use crate::robot::Model;

/// Multiple of the weight above which a force counts as unlimited.
const WITHOUT_LIMIT: f64 = 1e3;
/// The balances of the whole robot; those of its drives and arms follow.
const HORIZONTAL: usize = 0;
const VERTICAL: usize = 1;
const MOMENT: usize = 2;

/// A stop as a set of possible forces.
#[derive(Clone, Debug)]
pub(super) struct Statics {
    supports: Vec<Support>,
    /// For each drive, whether its motor acts on the ground.
    motors: Vec<bool>,
    /// Smallest and largest force of the motor of each drive, in weights.
    bounds: Vec<[f64; 2]>,
    /// [m] Lever arm that converts moments to forces.
    lever: f64,
    radius: f64,
    /// Force of a model that pushes the chassis along its axis: drive, direction and lever.
    push: Option<(usize, (f64, f64, f64))>,
    /// Pivots of the arms.
    hinges: Vec<Hinge>,
}

/// A contact that bears or could bear.
#[derive(Clone, Debug)]
pub(super) struct Support {
    pub normal: Direction,
    pub tangent: Direction,
    pub drive: Option<usize>,
    /// Pivot of the arm that it is on, if any.
    pub hinge: Option<usize>,
    /// Coefficient of friction.
    pub friction: f64,
    /// Sign of its slip along the tangent; 0 while it sticks.
    pub slides: f64,
}

impl Support {
    /// The edges of the friction cone between which its force lies; only one while it slides.
    fn sides(&self) -> &'static [f64] {
        if self.slides == 0.0 {
            &[-1.0, 1.0]
        } else if self.slides > 0.0 {
            &[-1.0]
        } else {
            &[1.0]
        }
    }
}

/// The pivot of the arms at one end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hinge {
    /// [m] Holding moment against the arms' weight about it, counter-clockwise, over the robot's weight.
    pub weight: f64,
    /// [m] Largest torque of their motors, over the robot's weight; infinite behind a gear that locks itself.
    pub torque: f64,
}

impl Statics {
    /// `bounds` are the smallest and largest force of the motor of each drive in weights; `lever` [m] converts moments
    /// to forces.
    pub(super) fn new(
        model: &Model,
        angle: f64,
        supports: Vec<Support>,
        hinges: Vec<Hinge>,
        bounds: Vec<[f64; 2]>,
        lever: f64,
    ) -> Self {
        let bears =
            |k: usize| model.push_drive() == Some(k) || supports.iter().any(|s| s.drive == Some(k));
        let motors = (0..model.drives).map(|k| model.has_motor(k) && bears(k));
        let push = model.push_drive().map(|drive| {
            let axis = push_axis(model, angle);
            (drive, (axis.unit.x, axis.unit.y, axis.lever))
        });
        Self {
            motors: motors.collect(),
            supports,
            bounds,
            lever,
            radius: model.drive_radius,
            push,
            hinges,
        }
    }

    /// Smallest residual for any choice of forces, as a fraction of the weight; `None` if the linear program has no
    /// solution.
    pub(super) fn imbalance(&self) -> Option<f64> {
        let forces = self.forces();
        let mut cost = vec![0.0; forces.len()];
        cost.push(1.0);
        let found = self.rows(&forces).minimise(&cost)?;
        found.last().map(|residual| residual.max(0.0))
    }

    /// The same with all friction multiplied by a factor.
    pub(super) fn with_friction(&self, factor: f64) -> Self {
        let supports = self.supports.iter().map(|support| Support {
            friction: factor * support.friction,
            ..support.clone()
        });
        Self {
            supports: supports.collect(),
            ..self.clone()
        }
    }

    /// The pull that each support would need, in weights, in the balance with the smallest total pull; `None` if there
    /// is no balance up to a residual.
    pub(super) fn least_pulls(&self, residual: f64) -> Option<Vec<f64>> {
        let pushes = self.forces();
        let count: usize = self.supports.iter().map(|s| s.sides().len()).sum();
        let pulls = pushes[..count].iter().map(Force::reversed);
        let forces: Vec<Force> = pushes.iter().cloned().chain(pulls).collect();
        let mut rows = self.rows(&forces);
        let mut at_most = vec![0.0; forces.len() + 1];
        at_most[forces.len()] = 1.0;
        rows.push(at_most, residual);
        let mut cost = vec![0.0; forces.len() + 1];
        cost[pushes.len()..forces.len()].fill(1.0);
        let found = rows.minimise(&cost)?;
        let mut pulled = found[pushes.len()..forces.len()].iter();
        let of = |support: &Support| {
            let own = pulled.by_ref().take(support.sides().len());
            own.map(|pull| pull.max(0.0)).sum()
        };
        Some(self.supports.iter().map(of).collect())
    }

    /// Two inequalities for each balance with the weight, and the bounds. The variables are the forces and, last, the
    /// residual.
    fn rows(&self, forces: &[Force]) -> Rows {
        let n = forces.len();
        let mut rows = Rows::default();
        for i in 0..self.size() {
            let weight = match i.checked_sub(self.of_hinge(0)) {
                Some(k) => self.hinges[k].weight / self.lever,
                None if i == VERTICAL => 1.0,
                None => 0.0,
            };
            for sign in [1.0, -1.0] {
                let mut row: Vec<f64> = forces.iter().map(|f| sign * f.effect[i]).collect();
                row.push(-1.0);
                rows.push(row, sign * weight);
            }
        }
        let mut at_most = |j: usize, sign: f64, bound: f64| {
            if bound.is_finite() {
                let mut row = vec![0.0; n + 1];
                row[j] = sign;
                rows.push(row, bound);
            }
        };
        for (j, force) in forces.iter().enumerate() {
            at_most(j, -1.0, -force.bounds[0]);
            at_most(j, 1.0, force.bounds[1]);
        }
        at_most(n, -1.0, 0.0);
        rows
    }

    /// All forces that may act.
    fn forces(&self) -> Vec<Force> {
        let mut forces = Vec::new();
        for support in &self.supports {
            for side in support.sides() {
                let effect = self.of_support(support, side * support.friction);
                forces.push(Force::pushing(effect));
            }
        }
        for (k, _) in self.motors.iter().enumerate().filter(|(_, bears)| **bears) {
            // The force at the surface, and its reaction on the chassis.
            let mut effect = self.nothing();
            effect[MOMENT] = self.radius / self.lever;
            effect[Self::of_drive(k)] = -1.0;
            let bounds = self.bounds[k];
            forces.push(Force { effect, bounds });
        }
        for (k, hinge) in self.hinges.iter().enumerate() {
            let mut effect = self.nothing();
            effect[self.of_hinge(k)] = 1.0;
            forces.push(Force::within(effect, hinge.torque / self.lever));
        }
        if let Some((drive, (x, y, lever))) = self.push {
            let mut effect = self.nothing();
            (effect[HORIZONTAL], effect[VERTICAL]) = (x, y);
            effect[MOMENT] = lever / self.lever;
            effect[Self::of_drive(drive)] = 1.0;
            forces.push(Force::within(effect, WITHOUT_LIMIT));
        }
        forces
    }

    /// The balance of the torque on a drive.
    fn of_drive(drive: usize) -> usize {
        MOMENT + 1 + drive
    }

    /// The balance of the moment on an arm about its pivot.
    fn of_hinge(&self, hinge: usize) -> usize {
        Self::of_drive(self.motors.len()) + hinge
    }

    /// Number of balances.
    fn size(&self) -> usize {
        self.of_hinge(self.hinges.len())
    }

    fn nothing(&self) -> Vec<f64> {
        vec![0.0; self.size()]
    }

    /// The effect of a unit normal force with friction along the tangent.
    fn of_support(&self, support: &Support, friction: f64) -> Vec<f64> {
        let (n, t) = (&support.normal, &support.tangent);
        let unit = n.unit + t.unit * friction;
        let mut effect = self.nothing();
        (effect[HORIZONTAL], effect[VERTICAL]) = (unit.x, unit.y);
        effect[MOMENT] = (n.lever + t.lever * friction) / self.lever;
        if let Some(k) = support.drive {
            effect[Self::of_drive(k)] = (n.spin_lever + t.spin_lever * friction) / self.radius;
        }
        if let Some(k) = support.hinge {
            let lever = n.joint_lever + t.joint_lever * friction;
            effect[self.of_hinge(k)] = lever / self.lever;
        }
        effect
    }
}

/// A force that may act: the effect of a unit of it on each balance, and its bounds.
#[derive(Clone)]
struct Force {
    effect: Vec<f64>,
    bounds: [f64; 2],
}

impl Force {
    /// A force in one direction only.
    fn pushing(effect: Vec<f64>) -> Self {
        let bounds = [0.0, f64::INFINITY];
        Self { effect, bounds }
    }

    /// The same force in the opposite direction.
    fn reversed(&self) -> Self {
        Self::pushing(self.effect.iter().map(|share| -share).collect())
    }

    /// A force in either direction.
    fn within(effect: Vec<f64>, most: f64) -> Self {
        let bounds = [-most, most];
        Self { effect, bounds }
    }
}

/// The solver ends when no constraint is violated, and the cost cannot be reduced, by more than this.
const ACCURACY: f64 = 1e-9;

/// Rows `a x <= b`.
#[derive(Default)]
pub(super) struct Rows {
    coefficients: Vec<Vec<f64>>,
    bounds: Vec<f64>,
}

impl Rows {
    pub(super) fn push(&mut self, coefficients: Vec<f64>, bound: f64) {
        self.coefficients.push(coefficients);
        self.bounds.push(bound);
    }

    /// The point of smallest `cost`; `None` if there is none.
    pub(super) fn minimise(&self, cost: &[f64]) -> Option<Vec<f64>> {
        let n = cost.len();
        let matrix = CscMatrix::from(&self.coefficients);
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(ACCURACY)
            .tol_gap_rel(ACCURACY)
            .tol_feas(ACCURACY)
            .build()
            .ok()?;
        let cones = [SupportedConeT::NonnegativeConeT(self.bounds.len())];
        let mut solver = DefaultSolver::new(
            &CscMatrix::zeros((n, n)),
            cost,
            &matrix,
            &self.bounds,
            &cones,
            settings,
        )
        .ok()?;
        solver.solve();
        let found = &solver.solution;
        matches!(
            found.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        )
        .then(|| found.x.clone())
    }
}

#[cfg(test)]
mod linear_program_tests {
    use super::*;

    #[test]
    fn finds_the_corner_of_least_cost() {
        let mut rows = Rows::default();
        rows.push(vec![-1.0, 0.0], 0.0);
        rows.push(vec![0.0, -1.0], 0.0);
        rows.push(vec![-1.0, -2.0], -2.0);
        let x = rows.minimise(&[1.0, 1.0]).expect("it is bounded");
        assert!((x[0]).abs() < 1e-7 && (x[1] - 1.0).abs() < 1e-7);
    }

    #[test]
    fn says_so_when_nothing_fits_all_rows() {
        let mut rows = Rows::default();
        rows.push(vec![1.0], -1.0);
        rows.push(vec![-1.0], 0.0);
        assert!(rows.minimise(&[1.0]).is_none());
    }
}
