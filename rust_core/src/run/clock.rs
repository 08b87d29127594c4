//! Computing time, where there is a clock.

use std::time::Instant;

/// Measures time since it was started.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock(Option<Instant>);

impl Clock {
    pub(super) fn start() -> Self {
        // The standard library has no clock in a web page, where asking for one panics.
        let has_clock = !cfg!(all(target_family = "wasm", target_os = "unknown"));
        Self(has_clock.then(Instant::now))
    }

    /// [s] Time since then; not a number without a clock.
    pub(super) fn elapsed(self) -> f64 {
        self.0
            .map_or(f64::NAN, |begin| begin.elapsed().as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_clock_runs_while_others_wait() {
        let clock = Clock::start();
        std::thread::sleep(Duration::from_millis(2));
        let elapsed = clock.elapsed();
        assert!((2e-3..0.9).contains(&elapsed), "{elapsed} s");
    }
}
