//! CPU time of pieces of work, and what repeated timings say.

use std::time::{Duration, Instant};

use cpu_time::{ProcessTime, ThreadTime};

/// CPU time of the calling thread over a piece of work, and what that returns. Time in which the thread did not run is not
/// counted; what others on the machine do to its caches is. NaN where the system does not tell [s].
pub fn timed<R>(work: impl FnOnce() -> R) -> (f64, R) {
    let clock = ThreadTime::try_now().ok();
    let result = work();
    let spent = clock.and_then(|c| c.try_elapsed().ok());
    (
        spent.as_ref().map_or(f64::NAN, Duration::as_secs_f64),
        result,
    )
}

/// Wall time, CPU time of all threads [s], and what the work returns.
pub fn timed_threads<R>(work: impl FnOnce() -> R) -> (f64, f64, R) {
    let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
    let result = work();
    let spent = cpu.and_then(|c| c.try_elapsed().ok());
    (
        wall.elapsed().as_secs_f64(),
        spent.as_ref().map_or(f64::NAN, Duration::as_secs_f64),
        result,
    )
}

/// The middle one, the mean of the two middle ones of an even number; NaN of none.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// Median of a[k]/b[k] over rounds k, in each of which both were timed one after the other.
#[must_use]
pub fn median_ratio(a: &[f64], b: &[f64]) -> f64 {
    let ratios: Vec<f64> = a.iter().zip(b).map(|(a, b)| a / b).collect();
    median(&ratios)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_do_not_see_one_outlier() {
        assert_eq!(median(&[3.0, 1.0, 1e9]), 3.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 1e9]), 3.0);
        assert!(median(&[]).is_nan());
        assert_eq!(median_ratio(&[2.0, 20.0, 4.0], &[1.0, 10.0, 1e-9]), 2.0);
    }

    #[test]
    fn sleep_takes_no_cpu_time() {
        let pause = Duration::from_millis(30);
        let (cpu, ()) = timed(|| std::thread::sleep(pause));
        let (wall, _, ()) = timed_threads(|| std::thread::sleep(pause));
        assert!(cpu < 0.015 && wall >= 0.03, "{cpu} {wall}");
    }
}
