//! Random problems, each solved again by a method that has nothing in common with the solver.
//!
//! If the solver's forces are a solution of Coulomb's law, its velocities are those of the convex program in which
//! friction is limited by what the normal forces of the solution allow; and that program has one solution.

use nalgebra::{DMatrix, DVector};

use super::interior_point::minimised;
use super::*;
use crate::draw::Draw;

/// What acts along a row: its entries, target, compliance and the bounds of its impulse.
type Acting = (DVector<f64>, f64, f64, (f64, f64));

/// Where the other method gets, from the limits of friction that the solver has found: velocities of body and spins.
fn by_interior_point(problem: &Problem) -> DVector<f64> {
    let inertias = problem.masses.clone();
    let dofs = inertias.len();
    let mut free = DVector::from_column_slice(&problem.free);
    let mut rows: Vec<Acting> = Vec::new();
    for c in &problem.contacts {
        let row = |along: &Row| {
            let mut row = DVector::zeros(dofs);
            for (at, lever) in along.entries() {
                row[at] = lever;
            }
            row
        };
        let soft = c.compliance / c.mass.expect("a mass");
        rows.push((row(&c.normal), -c.bias, soft, (0.0, f64::INFINITY)));
        let most = c.friction.coefficient * c.normal_impulse;
        rows.push((row(&c.tangent), 0.0, 0.0, (-most, most)));
    }
    for motor in &problem.motors {
        if let Driven::Body(at) = motor.on
            && motor.state != MotorState::Absent
        {
            let mut row = DVector::zeros(dofs);
            (row[TURN], row[at]) = (-motor.lever, motor.lever);
            let [most, least] = motor.limits.map(|limit| limit.at(0.0));
            if motor.locks {
                // It gives its limit the way that it turns, and stops hold it between rest and its target.
                let way = motor.target.signum();
                for (i, inertia) in inertias.iter().enumerate() {
                    free[i] += row[i] * way * most / inertia;
                }
                rows.push((&row * way, 0.0, 0.0, (0.0, f64::INFINITY)));
                let target = -motor.target * way;
                rows.push((&row * -way, target, 0.0, (0.0, f64::INFINITY)));
            } else {
                rows.push((row, motor.target, 0.0, (least, most)));
            }
        }
    }
    // What can give no impulse gives none.
    rows.retain(|(.., (low, high))| high - low > 1e-12);
    if rows.is_empty() {
        return free;
    }
    let jacobian = DMatrix::from_rows(&rows.iter().map(|r| r.0.transpose()).collect::<Vec<_>>());
    let by_inertia = DMatrix::from_fn(dofs, rows.len(), |i, k| jacobian[(k, i)] / inertias[i]);
    let mut quadratic = &jacobian * &by_inertia;
    let mut linear = &jacobian * &free;
    for (k, (_, target, soft, _)) in rows.iter().enumerate() {
        quadratic[(k, k)] += soft;
        linear[k] -= target;
    }
    let bounds: Vec<(f64, f64)> = rows.iter().map(|r| r.3).collect();
    free + by_inertia * minimised(&quadratic, &linear, &bounds)
}

#[test]
fn ten_thousand_random_problems_are_solved_as_by_an_interior_point_method() {
    let mut draw = Draw(7);
    let (mut off, mut unresolved) = (Vec::new(), 0);
    for _ in 0..10_000 {
        let mut problem = drawn(&mut draw);
        problem.solve();
        if problem.effort.unresolved > 0 {
            unresolved += 1;
            continue;
        }
        let found = DVector::from_column_slice(&problem.unknowns);
        off.push((found - by_interior_point(&problem)).amax());
    }
    assert_eq!(unresolved, 0);
    off.sort_by(f64::total_cmp);
    // Close to a jam a search ends within 1e-6 m/s of where the base stands; what spins can be lighter. Of the farthest
    // the other method is the one that is off: there the base stands.
    assert!(off[9_950] < 1e-6, "{:e}", off[9_950]);
    assert!(off[9_990] < 1e-5, "{:e}", off[9_990]);
    assert!(off[9_999] < 5e-4, "{:e}", off[9_999]);
}

/// The same with gears that lock themselves: a law of three pieces, as that of a motor with two limits.
#[test]
fn motors_behind_locks_are_solved_as_by_an_interior_point_method() {
    let mut draw = Draw(8);
    let (mut off, mut of_base, mut unresolved) = (Vec::new(), 0.0_f64, 0);
    let (mut off_law, mut holds) = ([0.0_f64; 2], [0; 3]);
    while off.len() < 5_000 {
        let mut problem = drawn(&mut draw);
        if problem.motors.is_empty() {
            continue;
        }
        for motor in &mut problem.motors {
            *motor = motor.behind_lock();
        }
        problem.solve();
        if problem.effort.unresolved > 0 {
            unresolved += 1;
            continue;
        }
        for motor in &problem.motors {
            let of_law = off_its_law(&problem, motor);
            off_law = [0, 1].map(|i| off_law[i].max(of_law[i]));
            let kind = match motor.state {
                MotorState::Holds => 0,
                MotorState::Locked => 1,
                MotorState::LimitForwards | MotorState::LimitBackwards | MotorState::Absent => 2,
            };
            holds[kind] += 1;
        }
        let found = DVector::from_column_slice(&problem.unknowns);
        let difference = found - by_interior_point(&problem);
        of_base = of_base.max(difference.rows(0, 3).amax());
        off.push(difference.amax());
    }
    assert_eq!(unresolved, 0);
    assert!(holds.iter().all(|count| *count > 500), "{holds:?}");
    off.sort_by(f64::total_cmp);
    // As above; the other method is off where a spin is at a stop, whose two sides it takes for two constraints.
    assert!(off[4_975] < 1e-6, "{:e}", off[4_975]);
    // Close to a jam the base moves by up to 1e-6 m/s where the other method finds it at rest.
    assert!(of_base < 5e-6, "{of_base:e}");
    // What changes a velocity by less counts as agreed; impulses are those of the law.
    assert!(
        off_law[0] < AGREEMENT.value() && off_law[1] < 1e-9,
        "{off_law:?}"
    );
}
