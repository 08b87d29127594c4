//! How much memory a request may take, checked before it is allocated.
//!
//! Rust ends the process if an allocation fails. So whatever grows with the input is first checked against the
//! user's limit, and against what the system can give at this moment.

use std::collections::TryReserveError;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{LimitError, MEMORY_VARIABLE};

const DEFAULT: f64 = 8.0; // [GiB]
const GIB: f64 = 1024.0 * 1024.0 * 1024.0;
/// Bytes for all the small parts of a request that are not counted.
const SPARE: u64 = 32 << 20;
/// Bytes that a request in a web page may take.
const OF_A_PAGE: u64 = 512 << 20;

/// What is left of the memory that a request may take.
pub(crate) struct Budget {
    limit: u64,
    left: AtomicU64,
}

impl Budget {
    /// All that a request may have: the user's limit, or less if the system has less.
    ///
    /// # Errors
    /// The environment variable of the limit is invalid.
    pub(crate) fn new() -> Result<Self, LimitError> {
        let limit = limit()?;
        let given = given_now(limit.saturating_add(SPARE)).saturating_sub(SPARE);
        Ok(Self {
            limit,
            left: AtomicU64::new(given),
        })
    }

    /// So many bytes.
    #[cfg(test)]
    pub(crate) fn of(bytes: u64) -> Self {
        Self {
            limit: bytes,
            left: AtomicU64::new(bytes),
        }
    }

    /// Bytes that are taken.
    #[cfg(test)]
    pub(crate) fn taken(&self) -> u64 {
        self.limit - self.left.load(Ordering::Relaxed)
    }

    /// Checks that so many bytes are left.
    ///
    /// # Errors
    /// They are not.
    pub(crate) fn check(&self, what: &str, bytes: u64) -> Result<(), LimitError> {
        let left = self.left.load(Ordering::Relaxed);
        if bytes <= left {
            return Ok(());
        }
        Err(LimitError::Memory {
            what: what.to_owned(),
            needed: bytes,
            available: left,
            limit: self.limit,
        })
    }

    /// Takes so many bytes.
    ///
    /// # Errors
    /// They are not left.
    pub(crate) fn take(&self, what: &str, bytes: u64) -> Result<(), LimitError> {
        let less = |left: u64| left.checked_sub(bytes);
        match self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, less)
        {
            Ok(_) => Ok(()),
            Err(_) => self.check(what, bytes),
        }
    }

    /// Gives back bytes that are not needed.
    pub(crate) fn give_back(&self, bytes: u64) {
        self.left.fetch_add(bytes, Ordering::Relaxed);
    }
}

/// Checks that the bytes for building something are available.
///
/// # Errors
/// They are not, because of the limit or the system.
pub(crate) fn ask(what: &str, bytes: u64) -> Result<(), LimitError> {
    // Small requests are not worth asking the system.
    if bytes < SPARE {
        return Ok(());
    }
    Budget::new()?.check(what, bytes)
}

/// Columns that grow together, row by row, within a budget.
pub(crate) struct Rows<'a> {
    budget: &'a Budget,
    row_bytes: u64,
    /// Rows that have room.
    room: usize,
}

impl<'a> Rows<'a> {
    /// For rows of so many bytes; no room yet.
    pub(crate) fn new(budget: &'a Budget, row_bytes: u64) -> Self {
        Self {
            budget,
            row_bytes,
            room: 0,
        }
    }

    /// Makes room for so many rows in all; `reserve` is called with the number of rows to make room for.
    ///
    /// # Errors
    /// Memory is exhausted.
    pub(crate) fn make_room(
        &mut self,
        rows: usize,
        reserve: impl FnOnce(usize) -> Result<(), TryReserveError>,
    ) -> Result<(), LimitError> {
        /// The first room, and the least that it grows by.
        const LEAST: usize = 64;
        const WHAT: &str =
            "what a run has recorded so far (a longer sample_interval, or \"summary\", takes less)";

        if rows <= self.room {
            return Ok(());
        }
        let room = rows.max(2 * self.room).max(LEAST);
        let bytes = (room - self.room) as u64 * self.row_bytes;
        self.budget.take(WHAT, bytes)?;
        self.room = room;
        // The system may have less than the budget says.
        reserve(room).map_err(|_| LimitError::Memory {
            what: WHAT.to_owned(),
            needed: bytes,
            available: 0,
            limit: self.budget.limit,
        })
    }

    /// Gives back the room beyond so many rows.
    pub(crate) fn shrink(&mut self, rows: usize) {
        self.budget
            .give_back((self.room - rows) as u64 * self.row_bytes);
        self.room = rows;
    }
}

/// Reserves room in a column for so many entries in all.
///
/// # Errors
/// The system has no more memory.
pub(crate) fn reserve<T>(column: &mut Vec<T>, entries: usize) -> Result<(), TryReserveError> {
    column.try_reserve_exact(entries - column.len())
}

/// [bytes] The user's limit.
fn limit() -> Result<u64, LimitError> {
    let Ok(text) = std::env::var(MEMORY_VARIABLE) else {
        return Ok((DEFAULT * GIB) as u64);
    };
    let gib = text.trim().parse::<f64>().ok();
    match gib.filter(|gib| *gib > 0.0 && *gib <= 1e6) {
        Some(gib) => Ok((gib * GIB) as u64),
        None => Err(LimitError::Setting(text.chars().take(40).collect())),
    }
}

/// [bytes] How much of this the system has now; nothing is written to it, so none is used.
fn given_now(most: u64) -> u64 {
    // What a web page once gave to the core it does not take back, even if none of it was used.
    if cfg!(target_family = "wasm") {
        return most.min(OF_A_PAGE);
    }
    let mut bytes = most;
    while bytes > 1 << 20 {
        let asked = usize::try_from(bytes).unwrap_or(usize::MAX);
        if Vec::<u8>::new().try_reserve_exact(asked).is_ok() {
            return bytes;
        }
        // Steps of a quarter find most of what is available.
        bytes -= bytes / 4;
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_gone_until_it_is_given_back() {
        let budget = Budget::of(100);
        assert!(budget.take("a run", 70).is_ok());
        let refused = budget.take("a run", 40).expect_err("30 bytes are left");
        assert!(matches!(
            refused,
            LimitError::Memory {
                needed: 40,
                available: 30,
                limit: 100,
                ..
            }
        ));
        budget.give_back(10);
        assert!(budget.take("a run", 40).is_ok());
    }

    #[test]
    fn rows_take_what_they_have_room_for_and_no_more() {
        let budget = Budget::of(10_000);
        let mut rows = Rows::new(&budget, 8);
        let mut column: Vec<f64> = Vec::new();
        for row in 0..200 {
            let made = rows.make_room(row + 1, |room| reserve(&mut column, room));
            made.expect("there is room");
            column.push(0.0);
        }
        assert_eq!(budget.taken(), 8 * column.capacity() as u64);
        rows.shrink(column.len());
        assert_eq!(budget.taken(), 8 * 200);
        let too_many = rows.make_room(2000, |_| unreachable!("the budget has no room"));
        assert!(too_many.is_err());
    }
}
