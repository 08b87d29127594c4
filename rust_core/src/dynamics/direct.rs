//! All constraints at once: which contacts are open, stick or slide is guessed from the last solve, the
//! velocities follow from one small linear system, and the guess is mended until it fits.
//!
//! A contact enters as a stiff damper about the impulse that it had (the proximal point of an augmented
//! Lagrangian), so that contacts that share one load have a solution, too, and the nearest one. What
//! the damping leaves vanishes as the impulses become their own starting point. The system has three
//! rows for the chassis, whatever the number of contacts, and one more to be eliminated at once for
//! each drive with a spin of its own.

use rapier2d_f64::math::Vector;

use super::Dynamics;
use super::chain::Chain;
use super::grip::Grip;
use super::row::{Link, Row};
use super::solve::{AGREEMENT, Action, Phase, Push};
use super::state::State;

/// Compliance of the dampers, in units of the contact's own admittance.
pub(super) const DAMPING: f64 = 1e-6;
/// Solutions of the system in search of one that fits, with all misfits mended at once: they can chase each
/// other for ever.
const AT_ONCE: u32 = 4;
/// The same of a chain, whose many contacts are then mended one by one, the worst first.
const MENDINGS: u32 = 12;
/// Flippers at most: one at either end.
const FLIPPERS: usize = 2;
/// Columns of the chassis, of the flippers, and the right-hand side.
const CHASSIS: usize = 3;
const UNKNOWNS: usize = CHASSIS + FLIPPERS;
const RIGHT: usize = UNKNOWNS;
/// A pivot smaller than this share of the largest entry is none.
const SINGULAR: f64 = 1e-12;

/// An impulse that falls with the speed along its direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Damper {
    /// [N s] At rest.
    impulse: f64,
    /// [kg]
    pub stiffness: f64,
}

impl Damper {
    pub(super) fn new(impulse: f64, stiffness: f64) -> Self {
        Self { impulse, stiffness }
    }

    /// The same about a speed other than rest [m/s].
    pub(super) fn shifted(self, speed: f64) -> Self {
        Self::new(self.at(-speed), self.stiffness)
    }

    /// One that no speed changes.
    pub(super) fn constant(impulse: f64) -> Self {
        Self {
            impulse,
            stiffness: 0.0,
        }
    }

    /// [N s] Its impulse at a speed.
    pub(super) fn at(self, speed: f64) -> f64 {
        self.impulse - self.stiffness * speed
    }

    /// [m/s] The speed at which it has an impulse.
    pub(super) fn speed_for(self, impulse: f64) -> f64 {
        (self.impulse - impulse) / self.stiffness
    }
}

/// The linear system, and what the drives with a spin of their own add to it.
pub(super) struct System {
    /// Of the chassis and of the flippers that turn by themselves.
    rows: [[f64; UNKNOWNS + 1]; UNKNOWNS],
    flippers: usize,
    pub(super) spins: Vec<Spin>,
    /// [rad/s] Turns of the flippers as they were solved, ...
    pub(super) turns: [f64; FLIPPERS],
    /// ... and what a step of the descent changes them by.
    pub(super) changes: [f64; FLIPPERS],
}

/// What an impulse acts on besides the chassis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Acts {
    pub drive: Option<usize>,
    pub flipper: Option<usize>,
}

/// The equation of one drive's spin: `inertia x spin + columns . velocity = moment`; the velocity's
/// equations have `rows x spin`.
#[derive(Clone, Copy, Default)]
pub(super) struct Spin {
    inertia: f64,
    moment: f64,
    columns: [f64; UNKNOWNS],
    rows: [f64; UNKNOWNS],
    /// Whether a constraint acts on it.
    acts: bool,
    /// [rad/s] As it was solved.
    pub value: f64,
    /// [rad/s] What a step of the descent changes it by.
    pub change: f64,
}

impl System {
    /// Of a robot with so many drives and flippers.
    pub(super) fn new(drives: usize, flippers: usize) -> Self {
        Self {
            rows: [[0.0; UNKNOWNS + 1]; UNKNOWNS],
            flippers,
            spins: vec![Spin::default(); drives],
            turns: [0.0; FLIPPERS],
            changes: [0.0; FLIPPERS],
        }
    }

    /// A chassis that nothing acts on.
    pub(super) fn start(&mut self, mass: f64, inertia: f64, velocity: Vector, moment: f64) {
        self.rows = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        let momentum = [mass * velocity.x, mass * velocity.y, moment];
        for (i, mass) in [mass, mass, inertia].into_iter().enumerate() {
            self.rows[i][i] = mass;
            self.rows[i][RIGHT] = momentum[i];
        }
    }

    /// Gives a flipper that turns with the chassis a row of its own.
    pub(super) fn hold(&mut self, flipper: usize) {
        self.rows[CHASSIS + flipper][CHASSIS + flipper] = 1.0;
    }

    /// The rows of the chassis alone: three columns and the right-hand side.
    pub(super) fn of_chassis(&self) -> [[f64; 4]; 3] {
        let row = |i: usize| {
            let [a, b, c, ..] = self.rows[i];
            [a, b, c, self.rows[i][RIGHT]]
        };
        [row(0), row(1), row(2)]
    }

    pub(super) fn set_of_chassis(&mut self, rows: [[f64; 4]; 3]) {
        for (own, [a, b, c, right]) in self.rows.iter_mut().zip(rows) {
            own[..CHASSIS].copy_from_slice(&[a, b, c]);
            own[RIGHT] = right;
        }
    }

    /// Adds a constraint whose impulse along `force` is that of a damper along `action`.
    pub(super) fn add(&mut self, force: &Action, action: &Action, acts: Acts, damper: Damper) {
        let (f, d) = (force.body(), action.body());
        let (impulse, stiffness) = (damper.at(action.offset), damper.stiffness);
        for (row, f) in self.rows.iter_mut().zip(f) {
            for (entry, d) in row.iter_mut().zip(d) {
                *entry += stiffness * f * d;
            }
            row[RIGHT] += f * impulse;
        }
        if let Some(k) = acts.flipper {
            let own = CHASSIS + k;
            for i in 0..CHASSIS {
                self.rows[i][own] += stiffness * f[i] * action.flipper_lever;
                self.rows[own][i] += stiffness * force.flipper_lever * d[i];
            }
            self.rows[own][own] += stiffness * force.flipper_lever * action.flipper_lever;
            self.rows[own][RIGHT] += force.flipper_lever * impulse;
        }
        let Some(k) = acts
            .drive
            .filter(|_| action.spin_lever != 0.0 || force.spin_lever != 0.0)
        else {
            return;
        };
        let spin = &mut self.spins[k];
        spin.acts = true;
        spin.inertia += stiffness * force.spin_lever * action.spin_lever;
        spin.moment += force.spin_lever * impulse;
        for i in 0..CHASSIS {
            spin.rows[i] += stiffness * f[i] * action.spin_lever;
            spin.columns[i] += stiffness * force.spin_lever * d[i];
        }
        if let Some(k) = acts.flipper {
            let own = CHASSIS + k;
            spin.rows[own] += stiffness * force.flipper_lever * action.spin_lever;
            spin.columns[own] += stiffness * force.spin_lever * action.flipper_lever;
        }
    }

    /// Velocity and angular velocity; none if the constraints contradict each other.
    pub(super) fn solve(&mut self) -> Option<(Vector, f64)> {
        let count = CHASSIS + self.flippers;
        for spin in self.spins.iter().filter(|spin| spin.acts) {
            for i in 0..count {
                let share = spin.rows[i] / spin.inertia;
                for j in 0..count {
                    self.rows[i][j] -= share * spin.columns[j];
                }
                self.rows[i][RIGHT] -= share * spin.moment;
            }
        }
        for own in (CHASSIS..count).rev() {
            self.eliminate_flipper(own)?;
        }
        let body = eliminate(self.of_chassis())?;
        let mut known = [0.0; UNKNOWNS];
        known[..CHASSIS].copy_from_slice(&body);
        for own in CHASSIS..count {
            let row = &self.rows[own];
            let of_known: f64 = (0..own).map(|j| row[j] * known[j]).sum();
            known[own] = (row[RIGHT] - of_known) / row[own];
            self.turns[own - CHASSIS] = known[own];
        }
        for spin in &mut self.spins {
            let of_body: f64 = (0..count).map(|i| spin.columns[i] * known[i]).sum();
            spin.value = (spin.moment - of_body) / spin.inertia;
        }
        let [x, y, turn] = body;
        Some((Vector::new(x, y), turn))
    }

    /// Takes the turn of a flipper out of the rows before its own; none if it has no inertia.
    fn eliminate_flipper(&mut self, own: usize) -> Option<()> {
        let pivot = self.rows[own];
        if pivot[own] <= 0.0 || !pivot[own].is_finite() {
            return None;
        }
        for row in &mut self.rows[..own] {
            let share = row[own] / pivot[own];
            for j in (0..own).chain([RIGHT]) {
                row[j] -= share * pivot[j];
            }
        }
        Some(())
    }
}

/// Gauss's elimination with pivots.
fn eliminate(mut a: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    let largest = a
        .iter()
        .flat_map(|r| &r[..3])
        .fold(0.0, |m: f64, e| m.max(e.abs()));
    for i in 0..3 {
        let pivot = (i..3).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))?;
        a.swap(i, pivot);
        if a[i][i].abs() <= SINGULAR * largest {
            return None;
        }
        for j in i + 1..3 {
            let share = a[j][i] / a[i][i];
            let above = a[i];
            for (entry, above) in a[j].iter_mut().zip(above) {
                *entry -= share * above;
            }
        }
    }
    let turn = a[2][3] / a[2][2];
    let y = (a[1][3] - a[1][2] * turn) / a[1][1];
    let x = (a[0][3] - a[0][1] * y - a[0][2] * turn) / a[0][0];
    Some([x, y, turn])
}

impl Dynamics {
    /// Finds the impulses that all constraints agree on, if a guess can be mended to fit.
    pub(super) fn solve_at_once(&mut self, state: &mut State, phase: &Phase) -> bool {
        self.settle();
        let most = if self.chains.is_empty() {
            AT_ONCE
        } else {
            MENDINGS
        };
        for mendings in 1..=most {
            self.assemble(phase);
            let Some((velocity, turn)) = self.solve_system() else {
                return false;
            };
            (state.velocity, state.angular_velocity) = (velocity, turn);
            for (drive, spin) in state.drives.iter_mut().zip(&self.system.spins) {
                drive.spin = spin.value;
            }
            self.take_shoes(state);
            self.take_flippers(state);
            let mut change = self.rows_follow_velocities(state);
            let fits = self.mend(state, mendings > AT_ONCE);
            if let Some(push) = &mut self.push {
                change = change.max(push.follow_velocities(state));
            }
            change = change.max(self.chains_follow_velocities(state, phase));
            if !fits {
                continue;
            }
            self.turn_with_chassis(state, phase);
            if self.switch_motors(state, phase) {
                self.set_actions(state, phase);
            } else {
                if change < AGREEMENT {
                    return true;
                }
                self.settle();
            }
        }
        self.rows.iter_mut().for_each(Row::unsettle);
        self.chains.iter_mut().for_each(Chain::unsettle);
        false
    }

    /// Gives the rows the impulses that belong to the velocities; how far these are from what they should be
    /// [m/s].
    fn rows_follow_velocities(&mut self, state: &State) -> f64 {
        let bearing = self.rows.iter_mut().filter(|row| row.bears);
        bearing.fold(0.0, |off, row| off.max(row.follow_velocities(state)))
    }

    /// Changes the grips that do not fit, or the worst `one` of them; whether all fitted.
    fn mend(&mut self, state: &State, one: bool) -> bool {
        let (mut fits, mut worst) = (true, (0.0, None));
        for (i, row) in self.rows.iter_mut().enumerate() {
            let next = row.grip.towards(row.fitting);
            if !row.bears || next == row.grip {
                continue;
            }
            fits = false;
            if !one {
                row.grip = next;
            } else if row.misfit(state) >= worst.0 {
                worst = (row.misfit(state), Some(i));
            }
        }
        if let Some(i) = worst.1 {
            let row = &mut self.rows[i];
            row.grip = row.grip.towards(row.fitting);
        }
        fits
    }

    /// Makes the impulses the ones that constraints are damped about.
    pub(super) fn settle(&mut self) {
        self.rows.iter_mut().for_each(Row::settle);
        self.chains.iter_mut().for_each(Chain::settle);
        if let Some(push) = &mut self.push {
            push.center = push.impulse;
        }
    }

    /// The system without constraints.
    pub(super) fn assemble_bodies(&mut self, phase: &Phase) {
        let m = &self.model;
        let moment = self.free_moment(phase);
        let system = &mut self.system;
        system.start(m.mass, self.inertia, phase.velocity, moment);
        for (k, motor) in self.motors.iter().enumerate() {
            let share = motor.share().unwrap_or_default();
            let of_motor = phase.motor_turn(share, m);
            // The drive of a chain has no inertia but the chain's.
            let drive_inertia = if k < self.chains.len() {
                1.0
            } else {
                m.drive_inertia(k)
            };
            system.spins[k] = Spin {
                inertia: drive_inertia,
                moment: drive_inertia * phase.spins[k] - of_motor,
                ..Spin::default()
            };
        }
        self.assemble_chains(phase);
        self.assemble_flippers(phase);
    }

    /// The system of the constraints as they are guessed.
    fn assemble(&mut self, phase: &Phase) {
        self.assemble_bodies(phase);
        for i in 0..self.rows.len() {
            let row = &self.rows[i];
            if !row.bears {
                continue;
            }
            let [normal, tangent] = row.actions;
            let [n, t] = row.dampers();
            match row.grip {
                Grip::Open => {}
                Grip::Sticks => {
                    self.add(i, &normal, &normal, n);
                    self.add(i, &tangent, &tangent, t);
                }
                Grip::Forwards => {
                    let force = normal.plus(&tangent, row.friction);
                    self.add(i, &force, &normal, n);
                }
                Grip::Backwards => {
                    let force = normal.plus(&tangent, -row.friction);
                    self.add(i, &force, &normal, n);
                }
            }
        }
        self.add_push();
    }

    /// Adds a constraint of a row whose impulse along `force` is that of a damper along `action`.
    pub(super) fn add(&mut self, row: usize, force: &Action, action: &Action, damper: Damper) {
        let row = &self.rows[row];
        let on_body = [force.body(), action.body()];
        match row.link {
            Link::Chassis | Link::Flipper(_) => {
                let acts = Acts {
                    drive: row.drive,
                    flipper: row.flipper(),
                };
                self.system.add(force, action, acts, damper);
            }
            Link::Shoe(i) => {
                let (chain, i) = (i / self.shoes_a_chain, i % self.shoes_a_chain);
                self.chains[chain].add(i, on_body, damper);
            }
            Link::Guide { shoe, chain } => {
                let back = [force.reaction(), action.reaction()];
                self.chains[chain].add_rest(shoe % self.shoes_a_chain, on_body, back, damper);
            }
            Link::Tooth { shoe, chain } => {
                let back = [force.reaction(), action.reaction()];
                self.chains[chain].add_tooth(shoe % self.shoes_a_chain, on_body, back, damper);
            }
        }
    }

    /// Adds the push of a track that is modelled by a force alone to the system.
    pub(super) fn add_push(&mut self) {
        if let Some(push) = &self.push {
            let along = &push.action;
            let acts = Acts {
                drive: Some(0),
                ..Acts::default()
            };
            self.system.add(along, along, acts, push.damper());
        }
    }
}

impl Push {
    pub(super) fn damper(&self) -> Damper {
        Damper {
            impulse: self.center,
            stiffness: 1.0 / (DAMPING * self.admittance),
        }
    }

    /// [m/s] Of the rail that its axis runs on.
    pub(super) fn slip(&self, state: &State) -> f64 {
        let spin = state.drives[0].spin;
        self.action
            .speed(state.velocity, state.angular_velocity, spin)
    }

    /// Takes the impulse that belongs to the velocities; how far these are from what they should be [m/s].
    pub(super) fn follow_velocities(&mut self, state: &State) -> f64 {
        let slip = self.slip(state);
        self.impulse = self.damper().at(slip);
        slip.abs()
    }
}
