//! Results for cells of a robot at a step, compared with single poses in them.

mod enclosures;
mod family;
mod held;
mod inside;
mod search;
mod touches;

use super::cell::{Affine, Cell, MOST_PARAMETERS, NUMBERS, Shares, Turns};
use super::family::Family;
use super::interval::{Interval, MARGIN, Rectangle};
use super::touch::Possible;
use crate::draw::Draw;
use crate::geometry::Vector;
use crate::jams::contact::{Contact, Posture};
use crate::jams::setting::Setting;
use crate::limits::Cancel;
use crate::robot::Model;
use crate::scenario::{
    ClosedSurface, ClosedTrack, LineOfWheels, Scenario, ScenarioError, Surface, Terrain, Track,
    Wheel, shared,
};
use crate::terrain::Ground;

/// [m] Smallest and largest height of the step, and both values of friction.
const HEIGHTS: [f64; 2] = [0.07, 0.09];
const FRICTIONS: [f64; 2] = [0.5, 0.9];
/// [rad] Largest angle of the chassis.
const MOST_ANGLE: f64 = 1.3;

/// The Engineer on four wheels in a row before a step.
pub(super) fn scenario(height: f64, friction: f64) -> Scenario {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.track = Track::Line(LineOfWheels {
        count: 4,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.terrain = Terrain::Step {
        height,
        surface: Surface::rounded(0.004, friction),
    };
    scenario
}

pub(super) fn built(scenario: &Scenario) -> (Model, Ground) {
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
    let model = Model::on(&scenario.robot, &ground).expect("it can be built");
    (model, ground)
}

/// The family of these scenarios, with height and friction as parameters.
fn family(scenarios: &[Scenario]) -> Result<Family, ScenarioError> {
    let all: Vec<(Model, Ground)> = scenarios.iter().map(built).collect();
    let all: Vec<(&Model, &Ground)> = all.iter().map(|(model, ground)| (model, ground)).collect();
    let names = ["terrain.height", "terrain.friction"].map(str::to_owned);
    Family::new(&all, &names, true, MOST_ANGLE)
}

/// The scenarios with the smallest values, the largest of each alone, of both, and the middle.
fn members() -> [Scenario; 5] {
    let ([low, high], [smooth, rough]) = (HEIGHTS, FRICTIONS);
    [
        (low, smooth),
        (high, smooth),
        (low, rough),
        (high, rough),
        (0.5 * (low + high), 0.5 * (smooth + rough)),
    ]
    .map(|(height, friction)| scenario(height, friction))
}

pub(super) fn family_on_a_step() -> Family {
    family(&members()).expect("height and friction are in proportion")
}

/// The same with a belt round their wheels.
pub(super) fn belts_on_a_step() -> Family {
    let closed = members().map(|mut scenario| {
        scenario.robot.track = Track::Closed(ClosedTrack {
            of: Box::new(scenario.robot.track.clone()),
            surface: ClosedSurface::Smooth,
        });
        scenario
    });
    family(&closed).expect("height and friction are in proportion")
}

/// A cell of one pose, at these shares of the parameters' ranges.
fn cell_at(posture: &Posture, shares: &Shares) -> Cell {
    let mut cell = Cell::ZERO;
    let pose = [posture.position.x, posture.position.y, posture.angle];
    cell.low[..3].copy_from_slice(&pose);
    cell.low[3..].copy_from_slice(shares);
    cell.high = cell.low;
    cell
}

/// A cell of this size about the middle of another one.
fn cell_round(draw: &mut Draw, inside: &Cell, half: f64) -> Cell {
    let mut cell = *inside;
    for number in 0..NUMBERS {
        let (before, after) = (draw.between(0.0, half), draw.between(0.0, half));
        cell.low[number] -= before;
        cell.high[number] += after;
    }
    cell
}

/// A random pose and random fractions in a cell.
fn anywhere(draw: &mut Draw, cell: &Cell) -> Cell {
    let mut point = *cell;
    for number in 0..NUMBERS {
        point.low[number] = draw.between(cell.low[number], cell.high[number]);
    }
    point.high = point.low;
    point
}

fn posture(point: &Cell) -> Posture {
    Posture {
        position: Vector::new(point.low[0], point.low[1]),
        angle: point.low[2],
    }
}

/// The poses on three contacts at the middle of the ranges, with their contacts.
pub(super) fn stands(family: &Family, shares: &Shares) -> (Setting, Vec<(Posture, Vec<usize>)>) {
    let cancel = Cancel::default();
    let setting = family
        .setting(shares, &cancel)
        .expect("there are few contacts");
    let fixed = setting.fixed(&cancel).expect("nobody asks it to end");
    let with_contacts = fixed.into_iter().filter_map(|posture| {
        let contacts = setting.touching(&posture)?;
        Some((posture, contacts))
    });
    let found = with_contacts.collect();
    (setting, found)
}
