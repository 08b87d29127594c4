//! The equations of motion: one body, drives that turn surfaces, contacts with Coulomb friction.
//!
//! A substep applies gravity, solves the constraints by projected Gauss-Seidel until they agree,
//! moves the body, and solves once more without the penetration push (a soft step after Catto,
//! "Solver2D", 2024). The drives are degrees of freedom of their own: the speed of a belt is found
//! together with the contact forces, so its force limit acts on the net traction inside the step.

use rapier2d_f64::math::{Pose, Rotation, Vector};

use crate::contact::Contact;
use crate::error::SimulationError;
use crate::robot::Model;
use crate::scenario::Solver;

/// [m/s] The sweeps end when no constraint changes a velocity by more than this: over a substep of
/// 0.25 ms that is a force of 4e-5 of the weight, far below what any outcome turns on.
const AGREEMENT: f64 = 1e-7;
/// [m] A contact carries on from the last step's if it moved less than this.
const CARRIED_OVER: f64 = 5e-3;

/// The moving state.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// [m] Centre of mass.
    pub center: Vector,
    /// [rad] Chassis angle; it counts full turns.
    pub angle: f64,
    /// [m/s] Velocity of the centre of mass.
    pub velocity: Vector,
    /// [rad/s] Angular velocity of the chassis.
    pub angular_velocity: f64,
    /// One for each drive.
    pub drives: Vec<DriveState>,
}

/// State of one drive.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DriveState {
    /// [rad/s] Spin over ground; a drive of a robot at rest has none.
    pub spin: f64,
    /// [m] How far the surface has run along its path.
    pub position: f64,
    /// [N] Mean force of the motor at the surface over the last step.
    pub force: f64,
    /// [N] Mean force of the ground on the robot along the surface over the last step.
    pub traction: f64,
}

/// A contact as the solver keeps it from step to step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadedContact {
    /// Where and what.
    pub contact: Contact,
    /// [N] Mean normal force over the step.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface over ground in the same direction.
    pub surface_speed: f64,
    normal_impulse: f64,
    friction_impulse: f64,
    carried_over: bool,
}

/// Solves the motion of one robot.
pub(crate) struct Dynamics {
    model: Model,
    friction: f64,
    gravity: f64,
    solver: Solver,
    rows: Vec<Row>,
    push_impulse: f64,
    motor_impulses: Vec<f64>,
    loaded: Vec<LoadedContact>,
}

/// One contact's constraint in one step.
#[derive(Clone, Copy, Debug)]
struct Row {
    normal: Vector,
    tangent: Vector,
    /// [m] From the centre of mass to the contact at the start of the step.
    arm: Vector,
    normal_lever: f64,
    tangent_lever: f64,
    drive: Option<usize>,
    friction: f64,
    /// What an impulse does to the velocities of the contact: with the drive free, ...
    free: Admittance,
    /// ... and while the motor holds it at its set-point.
    held: Admittance,
    normal_impulse: f64,
    friction_impulse: f64,
    normal_total: f64,
    friction_total: f64,
    /// [m] Gap at the start of the step and now.
    start_gap: f64,
    gap: f64,
}

/// Velocity change at a contact for a unit impulse along normal and tangent.
#[derive(Clone, Copy, Debug)]
struct Admittance {
    normal: f64,
    tangent: f64,
    /// Normal velocity for a tangent impulse, and the other way round.
    cross: f64,
}

impl Admittance {
    fn new(
        inverse_mass: f64,
        inverse_inertia: f64,
        normal_lever: f64,
        tangent_lever: f64,
        of_drive: f64,
    ) -> Self {
        Self {
            normal: inverse_mass + normal_lever * normal_lever * inverse_inertia,
            tangent: inverse_mass + tangent_lever * tangent_lever * inverse_inertia + of_drive,
            cross: normal_lever * tangent_lever * inverse_inertia,
        }
    }
}

/// Coefficients of a damped spring integrated implicitly.
#[derive(Clone, Copy)]
struct Softness {
    /// [1/s] Share of a penetration that is pushed out in a second.
    push_rate: f64,
    /// Compliance in units of the contact's own admittance.
    compliance: f64,
}

impl Softness {
    const RIGID: Self = Self {
        push_rate: 0.0,
        compliance: 0.0,
    };

    fn new(frequency: f64, damping_ratio: f64, h: f64) -> Self {
        let omega = std::f64::consts::TAU * frequency;
        let a1 = 2.0 * damping_ratio + h * omega;
        Self {
            push_rate: omega / a1,
            compliance: 1.0 / (h * omega * a1),
        }
    }
}

impl State {
    /// A robot at rest with its chassis frame at `position`.
    pub(crate) fn at_rest(model: &Model, position: Vector, angle: f64, track_phase: f64) -> Self {
        let rotation = Rotation::new(angle);
        let drive = DriveState {
            position: track_phase,
            ..DriveState::default()
        };
        Self {
            center: position + rotation * model.center_of_mass,
            angle,
            velocity: Vector::ZERO,
            angular_velocity: 0.0,
            drives: vec![drive; model.drives],
        }
    }

    /// Pose of the chassis frame.
    pub(crate) fn pose(&self, model: &Model) -> Pose {
        let rotation = Rotation::new(self.angle);
        Pose::from_parts(self.center - rotation * model.center_of_mass, rotation)
    }

    /// [m/s] Velocity of a point that rides with the chassis.
    pub(crate) fn velocity_at(&self, point: Vector) -> Vector {
        self.velocity + self.angular_velocity * left_of(point - self.center)
    }

    /// [m/s] Surface speed of a drive; positive drives towards +x.
    pub(crate) fn track_speed(&self, model: &Model, drive: usize) -> f64 {
        (self.angular_velocity - self.drives[drive].spin) * model.drive_radius
    }

    fn is_finite(&self) -> bool {
        let body = self.center.is_finite() && self.velocity.is_finite();
        let turn = self.angle.is_finite() && self.angular_velocity.is_finite();
        body && turn
            && self
                .drives
                .iter()
                .all(|d| d.spin.is_finite() && d.position.is_finite())
    }
}

impl Dynamics {
    pub(crate) fn new(model: Model, friction: f64, gravity: f64, solver: Solver) -> Self {
        let motor_impulses = vec![0.0; model.drives];
        Self {
            model,
            friction,
            gravity,
            solver,
            rows: Vec::new(),
            push_impulse: 0.0,
            motor_impulses,
            loaded: Vec::new(),
        }
    }

    /// The contacts of the last step with their forces.
    pub(crate) fn loaded(&self) -> &[LoadedContact] {
        &self.loaded
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Advances the state by one step towards the surface speed `set_point`.
    pub(crate) fn advance(
        &mut self,
        state: &mut State,
        contacts: &[Contact],
        set_point: f64,
        step: u64,
    ) -> Result<(), SimulationError> {
        let substeps = self.solver.substeps;
        let dt = self.solver.time_step;
        let h = dt / f64::from(substeps);
        let soft = Softness::new(
            self.solver.contact_frequency,
            self.solver.contact_damping_ratio,
            h,
        );
        self.prepare(state, contacts);
        for drive in &mut state.drives {
            (drive.force, drive.traction) = (0.0, 0.0);
        }
        let start = (state.center, state.angle);
        for _ in 0..substeps {
            state.velocity.y -= self.gravity * h;
            self.apply_last_impulses(state);
            self.solve(state, set_point, h, soft);
            state.center += state.velocity * h;
            state.angle += state.angular_velocity * h;
            for k in 0..state.drives.len() {
                state.drives[k].position += state.track_speed(&self.model, k) * h;
            }
            self.follow(state, start);
            self.solve(state, set_point, h, Softness::RIGID);
            self.collect(state, dt);
        }
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

    /// Turns contacts into rows, each with the impulses of the last step's nearest one.
    fn prepare(&mut self, state: &State, contacts: &[Contact]) {
        let m = &self.model;
        let (inverse_mass, inverse_inertia) = (1.0 / m.mass, 1.0 / m.moment_of_inertia);
        let inverse_drive = 1.0 / m.drive_mass;
        let inverse_locked_inertia = 1.0 / self.locked_inertia();
        self.rows.clear();
        for contact in contacts {
            let part = &m.parts[contact.part];
            let tangent = right_of(contact.normal);
            let arm = contact.point - state.center;
            // A surface that runs on a drive pulls at the drive's own radius from its axle: force at
            // the contact is force at the axle plus torque on the drive.
            let reach = if part.drive.is_some() {
                m.drive_radius
            } else {
                0.0
            };
            let normal_lever = cross(arm, contact.normal);
            let tangent_lever = cross(arm + reach * contact.normal, tangent);
            let last = take_nearest(&mut self.loaded, contact);
            let of_drive = if part.drive.is_some() {
                inverse_drive
            } else {
                0.0
            };
            self.rows.push(Row {
                normal: contact.normal,
                tangent,
                arm,
                normal_lever,
                tangent_lever,
                drive: part.drive,
                friction: self.friction.min(part.friction_limit),
                free: Admittance::new(
                    inverse_mass,
                    inverse_inertia,
                    normal_lever,
                    tangent_lever,
                    of_drive,
                ),
                held: Admittance::new(
                    inverse_mass,
                    inverse_locked_inertia,
                    normal_lever,
                    cross(arm, tangent),
                    0.0,
                ),
                normal_impulse: last.map_or(0.0, |l| l.normal_impulse),
                friction_impulse: last.map_or(0.0, |l| l.friction_impulse),
                normal_total: 0.0,
                friction_total: 0.0,
                start_gap: contact.distance,
                gap: contact.distance,
            });
        }
    }

    /// [kg m^2] Moment of inertia of the robot with its drives locked to the chassis.
    fn locked_inertia(&self) -> f64 {
        let m = &self.model;
        m.moment_of_inertia + m.drives as f64 * m.drive_mass * m.drive_radius * m.drive_radius
    }

    /// Starts a substep from the impulses of the last one.
    fn apply_last_impulses(&self, state: &mut State) {
        for row in &self.rows {
            self.push_normal(state, row, row.normal_impulse);
            self.push_tangent(state, row, row.friction_impulse);
        }
        for (k, impulse) in self.motor_impulses.iter().enumerate() {
            self.push_motor(state, k, *impulse);
        }
        if self.model.pushes_chassis {
            self.push_chassis(state, self.push_impulse);
        }
    }

    /// Sweeps over all constraints until they agree.
    fn solve(&mut self, state: &mut State, set_point: f64, h: f64, softness: Softness) {
        for _ in 0..self.solver.iterations {
            let mut change: f64 = 0.0;
            for k in 0..self.motor_impulses.len() {
                change = change.max(self.solve_motor(state, k, set_point, h));
            }
            if self.model.pushes_chassis {
                change = change.max(self.solve_push(state, set_point, h));
            }
            for i in 0..self.rows.len() {
                change = change.max(self.solve_contact(state, i, set_point, h, softness));
            }
            if change < AGREEMENT {
                break;
            }
        }
    }

    /// The motor holds the surface at the set-point within its force limit.
    fn solve_motor(&mut self, state: &mut State, k: usize, set_point: f64, h: f64) -> f64 {
        let m = &self.model;
        let admittance = 1.0 / m.drive_mass + m.drive_radius * m.drive_radius / m.moment_of_inertia;
        let limit = m.drive_force * h;
        let error = set_point - state.track_speed(m, k);
        let old = self.motor_impulses[k];
        let new = (old + error / admittance).clamp(-limit, limit);
        self.motor_impulses[k] = new;
        self.push_motor(state, k, new - old);
        (new - old).abs() * admittance
    }

    /// The push drives the chassis as if its axis ran on a rail: no slip, the motor limits it.
    fn solve_push(&mut self, state: &mut State, set_point: f64, h: f64) -> f64 {
        let m = &self.model;
        let (axis, lever) = self.push_axis(state);
        let slip = axis.dot(state.velocity)
            + lever * state.angular_velocity
            + m.drive_radius * state.drives[0].spin;
        let held = self.holds(0, h);
        let admittance = if held {
            // The lever at the line of action itself: the locked drive turns with the chassis.
            let lever = lever + m.drive_radius;
            1.0 / m.mass + lever * lever / self.locked_inertia()
        } else {
            1.0 / m.mass + lever * lever / m.moment_of_inertia + 1.0 / m.drive_mass
        };
        let impulse = -slip / admittance;
        self.push_impulse += impulse;
        self.push_chassis(state, impulse);
        if held {
            self.solve_motor(state, 0, set_point, h);
        }
        slip.abs()
    }

    /// The motor is within its limit, so that it gives the speed of its surface.
    ///
    /// Friction on such a surface moves the robot with the drive locked to it. Solving both
    /// together makes the sweeps agree about ten times sooner than a free, light drive would.
    fn holds(&self, drive: usize, h: f64) -> bool {
        self.motor_impulses[drive].abs() < self.model.drive_force * h * (1.0 - 1e-12)
    }

    /// One contact by itself, exactly: open, sticking or sliding.
    fn solve_contact(
        &mut self,
        state: &mut State,
        i: usize,
        set_point: f64,
        h: f64,
        softness: Softness,
    ) -> f64 {
        let row = self.rows[i];
        let held = row.drive.filter(|k| self.holds(*k, h));
        let a = if held.is_some() { row.held } else { row.free };
        // An open gap may close within the substep, rigidly; a penetration is pushed out softly.
        let (bias, softness) = if row.gap > 0.0 {
            (row.gap / h, Softness::RIGID)
        } else {
            (
                (softness.push_rate * row.gap).max(-self.solver.max_push_speed),
                softness,
            )
        };
        let compliance = softness.compliance * a.normal;
        let approach =
            row.normal.dot(state.velocity) + row.normal_lever * state.angular_velocity + bias;
        let slip = self.slip(state, &row);
        // Velocities that the contact would have without its impulses.
        let free_approach =
            approach - a.normal * row.normal_impulse - a.cross * row.friction_impulse;
        let free_slip = slip - a.cross * row.normal_impulse - a.tangent * row.friction_impulse;
        let (normal, friction) = coulomb(free_approach, free_slip, a, compliance, row.friction);
        self.rows[i].normal_impulse = normal;
        self.rows[i].friction_impulse = friction;
        let (more_normal, more_friction) =
            (normal - row.normal_impulse, friction - row.friction_impulse);
        self.push_normal(state, &row, more_normal);
        self.push_tangent(state, &row, more_friction);
        if let Some(k) = held {
            self.solve_motor(state, k, set_point, h);
        }
        (more_normal.abs() * a.normal).max(more_friction.abs() * a.tangent)
    }

    /// [m/s] Velocity of the robot's surface over the ground along the tangent.
    fn slip(&self, state: &State, row: &Row) -> f64 {
        let of_drive = row
            .drive
            .map_or(0.0, |k| self.model.drive_radius * state.drives[k].spin);
        row.tangent.dot(state.velocity) + row.tangent_lever * state.angular_velocity + of_drive
    }

    fn push_normal(&self, state: &mut State, row: &Row, impulse: f64) {
        state.velocity += row.normal * (impulse / self.model.mass);
        state.angular_velocity += row.normal_lever * impulse / self.model.moment_of_inertia;
    }

    fn push_tangent(&self, state: &mut State, row: &Row, impulse: f64) {
        state.velocity += row.tangent * (impulse / self.model.mass);
        state.angular_velocity += row.tangent_lever * impulse / self.model.moment_of_inertia;
        if let Some(k) = row.drive {
            self.spin_up(state, k, impulse);
        }
    }

    fn push_motor(&self, state: &mut State, k: usize, impulse: f64) {
        self.spin_up(state, k, -impulse);
        state.angular_velocity += self.model.drive_radius * impulse / self.model.moment_of_inertia;
    }

    fn push_chassis(&self, state: &mut State, impulse: f64) {
        let (axis, lever) = self.push_axis(state);
        state.velocity += axis * (impulse / self.model.mass);
        state.angular_velocity += lever * impulse / self.model.moment_of_inertia;
        self.spin_up(state, 0, impulse);
    }

    /// An impulse at the drive's radius; its inertia is `drive_mass x drive_radius^2`.
    fn spin_up(&self, state: &mut State, k: usize, impulse: f64) {
        state.drives[k].spin += impulse / (self.model.drive_mass * self.model.drive_radius);
    }

    /// Direction and lever of a force along the chassis at axle height.
    fn push_axis(&self, state: &State) -> (Vector, f64) {
        let rotation = Rotation::new(state.angle);
        let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
        // As for a contact, one drive radius above the line of action: the motor's reaction does the rest.
        let arm = self.model.drive_radius * up - rotation * self.model.center_of_mass;
        (axis, cross(arm, axis))
    }

    /// Updates the gaps for the motion since the start of the step.
    fn follow(&mut self, state: &State, (center, angle): (Vector, f64)) {
        let moved = state.center - center;
        let turned = Rotation::new(state.angle - angle);
        for row in &mut self.rows {
            row.gap = row.start_gap + row.normal.dot(moved + turned * row.arm - row.arm);
        }
    }

    /// Adds what this substep applied.
    fn collect(&mut self, state: &mut State, dt: f64) {
        for row in &mut self.rows {
            row.normal_total += row.normal_impulse;
            row.friction_total += row.friction_impulse;
            if let Some(k) = row.drive {
                state.drives[k].traction += row.friction_impulse / dt;
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
                surface_speed: self.slip(state, row),
                normal_impulse: row.normal_impulse,
                friction_impulse: row.friction_impulse,
                carried_over: false,
            });
        }
        self.loaded = loaded;
    }
}

/// Impulses of one contact under Signorini's and Coulomb's laws, given its velocities without them.
fn coulomb(approach: f64, slip: f64, a: Admittance, compliance: f64, friction: f64) -> (f64, f64) {
    if approach >= 0.0 {
        return (0.0, 0.0);
    }
    let normal_admittance = a.normal + compliance;
    let determinant = normal_admittance * a.tangent - a.cross * a.cross;
    let normal = (a.cross * slip - a.tangent * approach) / determinant;
    let sticking = (a.cross * approach - normal_admittance * slip) / determinant;
    if normal >= 0.0 && sticking.abs() <= friction * normal {
        return (normal, sticking);
    }
    // It slides, and friction opposes the slip that sticking would have to overcome.
    let limit = friction.copysign(sticking);
    let along = normal_admittance + limit * a.cross;
    if along > 0.0 {
        let normal = -approach / along;
        return (normal, limit * normal);
    }
    // The friction would press the contact together faster than it resists: it jams.
    (
        normal.max(0.0),
        (friction * normal.max(0.0)).copysign(sticking),
    )
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

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

fn left_of(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

fn right_of(v: Vector) -> Vector {
    Vector::new(v.y, -v.x)
}
