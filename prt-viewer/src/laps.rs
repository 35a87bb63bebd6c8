//! Wall time of the steps of a job.

use std::time::Instant;

/// A stopwatch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Laps {
    start: Instant,
    last: Instant,
}

impl Laps {
    pub(crate) fn start() -> Self {
        let now = Instant::now();
        Self { start: now, last: now }
    }

    /// Seconds since the last lap.
    pub(crate) fn lap(&mut self) -> f64 {
        let last = std::mem::replace(&mut self.last, Instant::now());
        (self.last - last).as_secs_f64()
    }

    /// Seconds since the start.
    pub(crate) fn total(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}
