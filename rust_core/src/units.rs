//! Lengths, times and speeds that belong to the method, not to a robot.
//!
//! Their dimension is in their type, so that a test can scale all of them along with a robot: if any other length, time
//! or speed mattered, the run of the scaled copy would differ.

/// A length [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metres(pub f64);

/// A time [s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seconds(pub f64);

/// A speed [m/s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetresPerSecond(pub f64);

impl Metres {
    pub(crate) fn value(self) -> f64 {
        self.0 * units()[0]
    }
}

impl Seconds {
    pub(crate) fn value(self) -> f64 {
        self.0 * units()[1]
    }
}

impl MetresPerSecond {
    pub(crate) fn value(self) -> f64 {
        let [length, time] = units();
        self.0 * (length / time)
    }
}

/// Units of length [m] and time [s]: 1, except in a test.
#[cfg(not(test))]
const fn units() -> [f64; 2] {
    [1.0; 2]
}

#[cfg(test)]
thread_local! {
    static UNITS: std::cell::Cell<[f64; 2]> = const { std::cell::Cell::new([1.0; 2]) };
}

#[cfg(test)]
fn units() -> [f64; 2] {
    UNITS.get()
}

/// Calls a function with all lengths and times of the method scaled.
#[cfg(test)]
pub(crate) fn with_units<T>(units: [f64; 2], work: impl FnOnce() -> T) -> T {
    UNITS.set(units);
    let done = work();
    UNITS.set([1.0; 2]);
    done
}
