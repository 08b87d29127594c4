//! Lengths, times and speeds that belong to the method and to no robot.
//!
//! Their dimension is in their type, so that a test can scale all of them: a copy of a robot on another scale then moves in
//! the same way to the last bit, which shows that there are no others.

/// A length [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metres(pub f64);

/// A time [s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seconds(pub f64);

/// A speed [m/s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetresPerSecond(pub f64);

#[cfg(not(test))]
mod values {
    use super::{Metres, MetresPerSecond, Seconds};

    impl Metres {
        pub(crate) const fn value(self) -> f64 {
            self.0
        }
    }

    impl Seconds {
        pub(crate) const fn value(self) -> f64 {
            self.0
        }
    }

    impl MetresPerSecond {
        pub(crate) const fn value(self) -> f64 {
            self.0
        }
    }
}

#[cfg(test)]
pub(crate) use scaled::with_units;

#[cfg(test)]
mod scaled {
    use std::cell::Cell;

    use super::{Metres, MetresPerSecond, Seconds};

    thread_local! {
        /// Lengths and times of the method, in units of their own.
        static UNITS: Cell<[f64; 2]> = const { Cell::new([1.0; 2]) };
    }

    impl Metres {
        pub(crate) fn value(self) -> f64 {
            self.0 * UNITS.get()[0]
        }
    }

    impl Seconds {
        pub(crate) fn value(self) -> f64 {
            self.0 * UNITS.get()[1]
        }
    }

    impl MetresPerSecond {
        pub(crate) fn value(self) -> f64 {
            let [length, time] = UNITS.get();
            self.0 * (length / time)
        }
    }

    /// Does something with all lengths and times of the method multiplied.
    pub(crate) fn with_units<T>(units: [f64; 2], work: impl FnOnce() -> T) -> T {
        UNITS.set(units);
        let done = work();
        UNITS.set([1.0; 2]);
        done
    }
}
