//! The equations of motion: one body, drives that turn surfaces, contacts with Coulomb friction.
//!
//! A substep applies gravity, solves the constraints by projected Gauss-Seidel until they agree,
//! moves the body, and solves once more without the penetration push: the soft step of Erin Catto's
//! 2D solvers (2024). The drives are degrees of freedom of their own: the speed of a belt is found
//! together with the contact forces, so its force limit acts on the net traction inside the step.

mod drives;
mod law;
mod row;
mod state;
#[cfg(test)]
mod tests;

use rapier2d_f64::math::Vector;
use serde::{Deserialize, Serialize};

use crate::contact::{Contact, LoadedContact};
use crate::error::SimulationError;
use crate::robot::Model;
use crate::scenario::Solver;
pub(crate) use drives::push_axis;
use law::{Softness, coulomb};
use row::Row;
pub(crate) use row::{Direction, Levers};
pub(crate) use state::{DriveState, State};

/// [m/s] The sweeps end when no constraint changes a velocity by more than this: over a substep of
/// 0.25 ms that is a force of 4e-5 of the weight, far below what any outcome turns on.
const AGREEMENT: f64 = 1e-7;
/// [s] Contacts that stick can pull against each other without end, which no body that gives way at
/// all would keep up. The friction that balance does not ask for fades with this time.
const SELF_STRESS_TIME: f64 = 0.1;
/// [m] Surfaces closer than this touch; a gap that a substep has just closed is rounding.
const TOUCHING: f64 = 1e-10;
/// [m/s] A gap that closes faster is a collision; slower ones are contacts that come and go. Jammed
/// small gear wheels rattle at some mm/s: at 10 mm/s they shake themselves free too often.
const COLLISION_SPEED: f64 = 0.001;
/// [s] Substep of a collision. What motor and weight do during the substep in which a wheel strikes
/// an edge adds to the impact in proportion to its length: 0.25 ms would shift the friction at which
/// a robot just climbs by 1 %, this shifts it by less than 0.1 %.
const COLLISION_SUBSTEP: f64 = 2e-5;
/// [m] A contact carries on from the last step's if it moved less than this.
const CARRIED_OVER: f64 = 5e-3;

/// Solves the motion of one robot.
pub(crate) struct Dynamics {
    model: Model,
    inverse: Inverse,
    friction: f64,
    gravity: f64,
    solver: Solver,
    rows: Vec<Row>,
    push_impulse: f64,
    motor_impulses: Vec<f64>,
    loaded: Vec<LoadedContact>,
    /// [N] Push of the surroundings at the centre of mass.
    pub outer_force: Vector,
}

/// What a step hands to the next besides the state: impulses to start from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Impulses {
    push: f64,
    motors: Vec<f64>,
    contacts: Vec<LoadedContact>,
}

/// What a unit impulse does.
#[derive(Clone, Copy)]
struct Inverse {
    /// [1/kg] To the velocity.
    mass: f64,
    /// [1/(kg m^2)] To the angular velocity.
    inertia: f64,
    /// [1/(kg m^2)] To the spin of a drive.
    drive: f64,
}

impl Inverse {
    fn of(m: &Model) -> Self {
        Self {
            mass: 1.0 / m.mass,
            inertia: 1.0 / m.moment_of_inertia,
            drive: 1.0 / (m.drive_mass * m.drive_radius * m.drive_radius),
        }
    }
}

impl Dynamics {
    pub(crate) fn new(model: Model, friction: f64, gravity: f64, solver: Solver) -> Self {
        let motor_impulses = vec![0.0; model.motors];
        Self {
            inverse: Inverse::of(&model),
            model,
            friction,
            gravity,
            solver,
            rows: Vec::new(),
            push_impulse: 0.0,
            motor_impulses,
            loaded: Vec::new(),
            outer_force: Vector::ZERO,
        }
    }

    /// The impulses that the next step starts from.
    pub(crate) fn impulses(&self) -> Impulses {
        Impulses {
            push: self.push_impulse,
            motors: self.motor_impulses.clone(),
            contacts: self.loaded.clone(),
        }
    }

    /// Starts from impulses of the same model.
    pub(crate) fn start_from(&mut self, impulses: Impulses) {
        self.push_impulse = impulses.push;
        self.motor_impulses = impulses.motors;
        self.loaded = impulses.contacts;
    }

    /// The contacts of the last step with their forces.
    pub(crate) fn loaded(&self) -> &[LoadedContact] {
        &self.loaded
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Advances the state by one step towards the surface speed `set_point`.
    ///
    /// The contacts are those of the middle of the step, [`State::pose_after`] half of it.
    pub(crate) fn advance(
        &mut self,
        state: &mut State,
        contacts: &[Contact],
        set_point: f64,
        step: u64,
    ) -> Result<(), SimulationError> {
        let dt = self.solver.time_step;
        self.prepare(state, contacts);
        for drive in &mut state.drives {
            (drive.force, drive.traction) = (0.0, 0.0);
        }
        let start = (state.center, state.angle);
        let substep = dt / f64::from(self.solver.substeps);
        // Between steps the last substep is kept as forces, for the next one may be shorter.
        let mut last = 1.0;
        for _ in 0..self.solver.substeps {
            let cuts = if self.collides(state, substep) {
                (substep / COLLISION_SUBSTEP).ceil()
            } else {
                1.0
            };
            let h = substep / cuts;
            self.scale_impulses(h / last);
            last = h;
            for _ in 0..cuts as u32 {
                self.substep(state, start, set_point, h);
            }
        }
        self.scale_impulses(1.0 / last);
        self.report(state, contacts, dt);
        if state.is_finite() {
            Ok(())
        } else {
            Err(SimulationError {
                step,
                body: "the robot".to_owned(),
            })
        }
    }

    /// Advances by a substep of `h` [s]; the step began at `start`.
    fn substep(&mut self, state: &mut State, start: (Vector, f64), set_point: f64, h: f64) {
        let soft = Softness::new(
            self.solver.contact_frequency,
            self.solver.contact_damping_ratio,
            h,
        );
        state.velocity += self.outer_force * (h * self.inverse.mass);
        state.velocity.y -= self.gravity * h;
        self.apply_last_impulses(state);
        self.solve(state, set_point, h, Some(soft));
        state.center += state.velocity * h;
        state.angle += state.angular_velocity * h;
        for k in 0..state.drives.len() {
            state.drives[k].position += state.track_speed(&self.model, k) * h;
        }
        for row in &mut self.rows {
            row.follow(state, start);
            // What pressed before the motion has closed its gap, but for the curve of a turning grouser.
            row.touches = row.normal_impulse > 0.0 || row.gap <= TOUCHING;
        }
        self.solve(state, set_point, h, None);
        self.collect(state, self.solver.time_step);
    }

    /// Turns contacts into rows, each with the impulses of the last step's nearest one.
    fn prepare(&mut self, state: &State, contacts: &[Contact]) {
        let half = 0.5 * self.solver.time_step;
        let middle = state.moved(half);
        let fading = 1.0 - self.solver.time_step / SELF_STRESS_TIME;
        self.rows.clear();
        for contact in contacts {
            let last = take_nearest(&mut self.loaded, contact);
            let mut row = Row::new(contact, last, state, &self.model, (middle, half));
            row.friction = row.friction.min(self.friction);
            row.friction_impulse *= fading;
            self.rows.push(row);
        }
    }

    /// A gap will close within a time [s], and not gently.
    fn collides(&self, state: &State, time: f64) -> bool {
        self.rows.iter().any(|row| {
            let speed = row.opening_speed(state);
            speed < -COLLISION_SPEED && row.gap + speed * time <= 0.0
        })
    }

    fn scale_impulses(&mut self, factor: f64) {
        for row in &mut self.rows {
            row.normal_impulse *= factor;
            row.friction_impulse *= factor;
        }
        for impulse in &mut self.motor_impulses {
            *impulse *= factor;
        }
        self.push_impulse *= factor;
    }

    /// Starts a substep from the impulses of the last one.
    fn apply_last_impulses(&self, state: &mut State) {
        for row in &self.rows {
            self.push(state, row, row.normal_impulse, row.friction_impulse);
        }
        for (k, impulse) in self.motor_impulses.iter().enumerate() {
            self.push_motor(state, k, *impulse);
        }
        if self.model.pushes_chassis {
            self.push_chassis(state, self.push_impulse);
        }
    }

    /// Sweeps over all constraints until they agree.
    fn solve(&mut self, state: &mut State, set_point: f64, h: f64, softness: Option<Softness>) {
        for _ in 0..self.solver.iterations {
            let mut change: f64 = 0.0;
            for i in 0..self.rows.len() {
                change = change.max(self.solve_contact(state, i, set_point, h, softness));
            }
            if self.model.pushes_chassis {
                change = change.max(self.solve_push(state, set_point, h));
            }
            // Last, so that no motor ever pushes on past its set-point.
            for k in 0..self.motor_impulses.len() {
                change = change.max(self.solve_motor(state, k, set_point, h));
            }
            if change < AGREEMENT {
                break;
            }
        }
    }

    /// One contact by itself, exactly: open, sticking or sliding.
    fn solve_contact(
        &mut self,
        state: &mut State,
        i: usize,
        set_point: f64,
        h: f64,
        softness: Option<Softness>,
    ) -> f64 {
        let row = &self.rows[i];
        let bias = match softness {
            // Before the motion an open gap may just close, and a penetration is pushed out softly.
            Some(_) if row.gap > 0.0 => row.gap / h,
            Some(soft) => (soft.push_rate * row.gap).max(-self.solver.max_push_speed),
            // After it, surfaces that touch may not approach; the others are left alone.
            None if row.touches => 0.0,
            None => f64::INFINITY,
        };
        let approach = row.opening_speed(state) + bias;
        if approach >= 0.0 && row.normal_impulse == 0.0 {
            return 0.0;
        }
        let held = row.drive.filter(|k| self.holds(*k, h));
        let a = if held.is_some() { row.held } else { row.free };
        let compliance = match softness {
            Some(soft) if row.gap <= 0.0 => soft.compliance * a.normal,
            _ => 0.0,
        };
        // Velocities that the contact would have without its impulses.
        let free_approach =
            approach - a.normal * row.normal_impulse - a.cross * row.friction_impulse;
        let free_slip =
            row.slip(state) - a.cross * row.normal_impulse - a.tangent * row.friction_impulse;
        let (normal, friction) = coulomb(free_approach, free_slip, a, compliance, row.friction);
        let (more_normal, more_friction) =
            (normal - row.normal_impulse, friction - row.friction_impulse);
        self.push(state, row, more_normal, more_friction);
        let row = &mut self.rows[i];
        (row.normal_impulse, row.friction_impulse) = (normal, friction);
        if let Some(k) = held {
            self.solve_motor(state, k, set_point, h);
        }
        (more_normal.abs() * a.normal).max(more_friction.abs() * a.tangent)
    }

    /// Applies impulses along normal and tangent.
    fn push(&self, state: &mut State, row: &Row, normal: f64, tangent: f64) {
        let (n, t) = (&row.normal, &row.tangent);
        let Inverse {
            mass,
            inertia,
            drive,
        } = self.inverse;
        state.velocity += (n.unit * normal + t.unit * tangent) * mass;
        state.angular_velocity += (n.lever * normal + t.lever * tangent) * inertia;
        if let Some(k) = row.drive {
            state.drives[k].spin += (n.drive_lever * normal + t.drive_lever * tangent) * drive;
        }
    }

    /// Adds what this substep applied.
    fn collect(&mut self, state: &mut State, dt: f64) {
        for row in &mut self.rows {
            row.normal_total += row.normal_impulse;
            row.friction_total += row.friction_impulse;
            if let Some(k) = row.drive {
                let along = row.normal.drive_lever * row.normal_impulse
                    + row.tangent.drive_lever * row.friction_impulse;
                state.drives[k].traction += along / (self.model.drive_radius * dt);
            }
        }
        for (drive, impulse) in state.drives.iter_mut().zip(&self.motor_impulses) {
            drive.force += impulse / dt;
        }
        if self.model.pushes_chassis {
            state.drives[0].traction += self.push_impulse / dt;
        }
    }

    fn report(&mut self, state: &State, contacts: &[Contact], dt: f64) {
        let mut loaded = std::mem::take(&mut self.loaded);
        loaded.clear();
        for (row, contact) in self.rows.iter().zip(contacts) {
            loaded.push(LoadedContact {
                contact: Contact {
                    distance: row.gap,
                    ..*contact
                },
                normal_force: row.normal_total / dt,
                friction_force: row.friction_total / dt,
                surface_speed: row.slip(state),
                normal_impulse: row.normal_impulse,
                friction_impulse: row.friction_impulse,
                carried_over: false,
            });
        }
        self.loaded = loaded;
    }
}

/// The last step's contact of the same part that lies nearest, if near enough; each is taken once.
fn take_nearest(loaded: &mut [LoadedContact], contact: &Contact) -> Option<LoadedContact> {
    let near = |l: &LoadedContact| (l.contact.point - contact.point).length();
    let last = loaded
        .iter_mut()
        .filter(|l| {
            !l.carried_over
                && l.contact.part == contact.part
                && l.contact.normal.dot(contact.normal) > 0.9
        })
        .filter(|l| near(l) < CARRIED_OVER)
        .min_by(|a, b| near(a).total_cmp(&near(b)))?;
    last.carried_over = true;
    Some(*last)
}
