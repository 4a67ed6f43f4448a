//! The pace of free running: simulated time at a multiple of wall time.

use std::time::{Duration, Instant};

/// Keeps simulated time at a multiple of wall time.
pub(super) struct Pace {
    began: Instant,
    from: f64,
    /// Simulated over wall time.
    pub(super) factor: f64,
    /// Epoch in which it was set.
    pub(super) epoch: u64,
}

impl Pace {
    /// From `from` [s] on, now.
    pub(super) fn new(from: f64, factor: f64, epoch: u64) -> Self {
        Self {
            began: Instant::now(),
            from,
            factor,
            epoch,
        }
    }

    /// How long until the step that begins at `time` [s] may begin. A run that is behind does not wait.
    pub(super) fn wait(&self, time: f64) -> Duration {
        let due = Duration::try_from_secs_f64(((time - self.from) / self.factor).max(0.0))
            .unwrap_or(Duration::MAX);
        due.saturating_sub(self.began.elapsed())
    }
}
