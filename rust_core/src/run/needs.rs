//! How many bytes runs need, from what they will record and build.

use super::Checked;
use super::trace::{Columns, Record};
use crate::error::LimitError;
use crate::limits::memory::{self, Budget};
use crate::robot::Model;
use crate::scenario::Terrain;

/// Bytes of the stack of a thread.
pub(crate) const STACK: usize = 2 << 20;
/// Bytes of the ground and its index while a run is built and under way, a corner; measured: 250, and as much
/// again while it is built.
const BYTES_A_CORNER: u64 = 600;
/// Bytes that the edges of a run take, a corner, as they are and as columns of a table.
const BYTES_AN_EDGE: u64 = 128;
/// Bytes of all else that a run builds and gives back.
const BYTES_A_RUN: u64 = 64 << 10;
/// Bytes of the tree that a text is read into, a character of it, at most: `[0],` is a row of one number.
const BYTES_A_CHARACTER: u64 = 40;

/// Asks for what reading a scenario takes.
pub(crate) fn ask_for_text(text: &str) -> Result<(), LimitError> {
    memory::ask("reading a scenario", text.len() as u64 * BYTES_A_CHARACTER)
}

/// Asks for what building the ground of a scenario takes.
pub(crate) fn ask_for_ground(terrain: &Terrain) -> Result<(), LimitError> {
    memory::ask("the ground", corners(terrain) * BYTES_A_CORNER)
}

/// Asks for what a batch needs, and hands on what its runs may record.
///
/// # Errors
/// It is more than the batch may have; the message says what takes less.
pub(crate) fn of_batch(
    scenarios: &[Checked],
    record: Record,
    threads: usize,
) -> Result<Budget, LimitError> {
    let terrain_of = |checked: &Checked| corners(&checked.scenario().terrain);
    let corners = scenarios.iter().map(terrain_of);
    let largest = corners.clone().max().unwrap_or(0);
    let built = threads as u64 * (STACK as u64 + largest * BYTES_A_CORNER);
    let given_back = corners.map(|corners| BYTES_A_RUN + corners * BYTES_AN_EDGE);
    let kept = built + given_back.sum::<u64>();
    let mut recorded = 0;
    if record.history {
        for checked in scenarios {
            recorded += record.samples(checked.scenario()) * bytes_of_sample(checked.model());
        }
    }
    let budget = Budget::new()?;
    budget.check(&described(scenarios, record), kept + recorded)?;
    budget.take("a batch", kept)?;
    Ok(budget)
}

fn described(scenarios: &[Checked], record: Record) -> String {
    let runs = match scenarios.len() {
        1 => "a run".to_owned(),
        n => format!("a batch of {n} runs"),
    };
    if record.history {
        let every = record.sample_interval;
        format!(
            "{runs} sampled every {every} s (a longer sample_interval, or \"summary\", takes less)"
        )
    } else {
        runs
    }
}

/// Bytes of a sample as the robot stands: half of its parts touch.
fn bytes_of_sample(model: &Model) -> u64 {
    let columns = Columns::of(model);
    let touching = (columns.parts / 2).max(2);
    columns.bytes() + touching as u64 * Columns::BYTES_A_CONTACT
}

/// Corners of a ground at most, all its lanes together: facets of rounded edges are corners, too.
fn corners(terrain: &Terrain) -> u64 {
    /// Of a rounded edge that turns by a right angle, and of all on a lane at most.
    const FACETS: (u64, u64) = (90, 1_000_000);

    let rounded = |corners: u64, radius: f64| {
        if radius > 0.0 {
            corners + (corners * FACETS.0).min(FACETS.1)
        } else {
            corners
        }
    };
    match terrain {
        Terrain::Points {
            points,
            edge_radius,
            ..
        } => rounded(points.len() as u64, *edge_radius),
        Terrain::Lanes {
            left,
            right,
            middle,
        } => {
            let own = [left, right].map(|lane| corners(lane));
            let of_belly = middle.as_ref().map_or(own[0] + own[1], |m| corners(m));
            own[0] + own[1] + of_belly
        }
        Terrain::Stairs {
            count, edge_radius, ..
        } => rounded(2 * u64::from(*count), *edge_radius),
        Terrain::RandomStepfield(field) => {
            3 * rounded(2 * u64::from(field.posts), field.edge_radius)
        }
        _ => 1000,
    }
}
