//! Sums in a fixed order: partial sums of fixed chunks, added up one after the other, whatever the number of threads.

use super::{CHUNK, Workers};

/// sum_i f(i) for i < n, the same bits for any number of threads.
#[must_use]
pub fn sum_rows(workers: &Workers, n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    workers.chunk_sums(n, |range| {
        let mut s = 0.0;
        for i in range {
            s += f(i);
        }
        s
    })
}

/// Largest f(i) for i < n, 0 if there is none above it. NaN values win, so that they are seen.
#[must_use]
pub fn maximum(n: usize, f: impl Fn(usize) -> f64) -> f64 {
    let mut m = 0.0;
    for i in 0..n {
        let v = f(i);
        if v > m || v.is_nan() {
            m = v;
        }
        if v.is_nan() {
            break;
        }
    }
    m
}

/// Number of chunks of n rows.
pub(super) fn chunks(n: usize) -> usize {
    n.div_ceil(CHUNK)
}
