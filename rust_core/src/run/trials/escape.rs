//! The escape force of a stop: a push that is raised until the robot moves.

use super::Simulation;
use crate::error::Error;
use crate::limits::Cancel;
use crate::observe::Outcome;

/// First level of the push and the last, in weights, and from one to the next.
const LEVELS: (f64, f64, f64) = (0.01, 10.0, 1.1);
/// [s] For how long a level is held at least, and how long it takes to rise to it.
const HOLD: f64 = 0.5;
const RISE: f64 = 0.1;
/// [m] A robot that moves by more in the last half of a hold is still on its way, and the level is held again, as
/// often as this: just beyond what it can bear, it takes seconds to leave.
const SETTLED: f64 = 5e-5;
const HOLDS: usize = 10;
/// [m] A push that moves the robot as far as this, ahead or up over what holds it, has overcome that; a robot that
/// rattles, as far as this beyond what it does by itself.
const MOVES: f64 = 5e-3;
/// [s] How long the push goes on then, to see whether the robot tips over; and for how long it is seen without one.
const AFTERWARDS: f64 = 2.0;

/// A measured escape force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapeForce {
    /// [N] The last level that was held; 0 if none was.
    pub low: f64,
    /// [N] The first level that moved the robot; infinite if none did.
    pub high: f64,
    /// That push tipped it over.
    pub tips: bool,
}

/// Measures the escape force of a stop, along the command.
pub(crate) fn measure(stop: &Simulation, cancel: &Cancel) -> Result<EscapeForce, Error> {
    let weight = stop.weight();
    let mut robot = stop.copy();
    let direction = robot.direction();
    let begin = robot.reading().position;
    let way = |robot: &Simulation| (robot.reading().position - begin).length();
    let by_itself = own_way(&robot, &way, cancel)?;
    let (first, last, ratio) = LEVELS;
    let (mut low, mut level) = (0.0, first * weight);
    while level <= last * weight {
        robot.raise_push(direction * level, RISE)?;
        let moved = |robot: &Simulation| way(robot) > by_itself + MOVES;
        let mut leaves = false;
        for _ in 0..HOLDS {
            leaves = follow(&mut robot, 0.5 * HOLD, &moved, cancel)?;
            let half_way = way(&robot);
            leaves = leaves || follow(&mut robot, 0.5 * HOLD, &moved, cancel)?;
            if leaves || way(&robot) - half_way < SETTLED {
                break;
            }
        }
        if leaves {
            let tips = |robot: &Simulation| robot.monitor().ended_as() == Some(Outcome::TippedOver);
            return Ok(EscapeForce {
                low,
                high: level,
                tips: follow(&mut robot, AFTERWARDS, &tips, cancel)?,
            });
        }
        (low, level) = (level, level * ratio);
    }
    Ok(EscapeForce {
        low,
        high: f64::INFINITY,
        tips: false,
    })
}

/// [m] How far a robot moves without a push: one that rattles is not at rest.
fn own_way(
    stop: &Simulation,
    way: &dyn Fn(&Simulation) -> f64,
    cancel: &Cancel,
) -> Result<f64, Error> {
    let mut robot = stop.copy();
    let end = robot.time() + AFTERWARDS;
    let mut farthest: f64 = 0.0;
    while robot.time() < end {
        robot.step_until(end)?;
        cancel.check()?;
        farthest = farthest.max(way(&robot));
    }
    Ok(farthest)
}

/// Goes on for a time [s], or until something is so; returns whether it is.
fn follow(
    robot: &mut Simulation,
    time: f64,
    until: &dyn Fn(&Simulation) -> bool,
    cancel: &Cancel,
) -> Result<bool, Error> {
    let end = robot.time() + time;
    while robot.time() < end {
        robot.step_until(end)?;
        cancel.check()?;
        if until(robot) {
            return Ok(true);
        }
    }
    Ok(false)
}
