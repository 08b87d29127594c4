//! Number of bytes that a batch needs, from what its runs build and will record.

use super::Checked;
use super::needs::{BYTES_A_CORNER, corners};
use super::record::{Columns, Record};
use crate::error::LimitError;
use crate::limits::memory::Budget;
use crate::robot::Model;

/// Bytes of the stack of a thread.
pub(crate) const STACK: usize = 2 << 20;
/// Bytes per corner that the edges of a run take, including their copy as table columns.
const BYTES_AN_EDGE: u64 = 128;
/// Bytes of everything else that a run builds and returns.
const BYTES_A_RUN: u64 = 64 << 10;
/// Checks that the memory for a batch is available, and returns the budget for its records.
///
/// # Errors
/// The batch needs more than it may have; the message says what would need less.
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

/// Bytes of a sample with half of the robot's parts in contact.
fn bytes_of_sample(model: &Model) -> u64 {
    let columns = Columns::of(model);
    let touching = (columns.parts / 2).max(2);
    columns.bytes() + touching as u64 * Columns::BYTES_A_CONTACT
}
