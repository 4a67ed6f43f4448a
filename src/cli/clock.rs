//! Wall and CPU time of this process, for progress, summaries and cost estimates. Results never depend on it.

use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

/// A running stopwatch.
pub(super) struct Stopwatch {
    wall: Instant,
    cpu: Option<ProcessTime>,
}

impl Stopwatch {
    /// Starts now.
    pub(super) fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
        }
    }

    /// Wall time since the start [s].
    pub(super) fn wall(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// CPU time of all threads since the start [s]; NaN where the system does not tell.
    pub(super) fn cpu(&self) -> f64 {
        self.cpu
            .and_then(|start| start.try_elapsed().ok())
            .as_ref()
            .map_or(f64::NAN, Duration::as_secs_f64)
    }
}

/// Largest resident memory of this process so far [bytes], where the system tells (Linux).
pub(super) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024)
}

/// Cores that a thread count of 0 means.
pub(super) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}
