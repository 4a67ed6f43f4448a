//! Threads of one component: a pool of its own, or none at all for one thread (so that nothing outlives it).

use rayon::prelude::*;
use std::ops::Range;

use super::sum::chunks;

/// Rows per chunk. Part of the results: partial sums are formed per chunk, so it must not depend on the machine.
pub const CHUNK: usize = 128;

/// Runs sweeps over rows on a set number of threads. Results never depend on that number.
#[derive(Debug, Default)]
pub struct Workers {
    pool: Option<rayon::ThreadPool>,
}

impl Workers {
    /// `threads` = 1 runs in the calling thread; 0 means all cores.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        if threads == 1 {
            return Self { pool: None };
        }
        // A machine that cannot start threads still gets the same results from the calling thread.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .ok();
        Self { pool }
    }

    /// Number of threads at work.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool
            .as_ref()
            .map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// Runs `f` where sweeps inside it use the pool.
    pub fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            None => f(),
        }
    }

    /// out[i] written by f(i, &mut out[i]).
    pub fn each<T: Send>(&self, out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
        match &self.pool {
            None => out.iter_mut().enumerate().for_each(|(i, o)| f(i, o)),
            Some(_) => out.par_chunks_mut(CHUNK).enumerate().for_each(|(c, part)| {
                for (k, o) in part.iter_mut().enumerate() {
                    f(c * CHUNK + k, o);
                }
            }),
        }
    }

    /// Blocks of rows side by side with the chunk of `out` that belongs to them: f(block, first row, rows of out).
    pub fn blocks<B: Send, T: Send>(
        &self,
        blocks: &mut [B],
        out: &mut [T],
        f: impl Fn(&mut B, usize, &mut [T]) + Sync,
    ) {
        match &self.pool {
            None => {
                for (c, (b, part)) in blocks.iter_mut().zip(out.chunks_mut(CHUNK)).enumerate() {
                    f(b, c * CHUNK, part);
                }
            }
            Some(_) => blocks
                .par_iter_mut()
                .zip(out.par_chunks_mut(CHUNK))
                .enumerate()
                .for_each(|(c, (b, part))| f(b, c * CHUNK, part)),
        }
    }

    /// As [`Workers::blocks`] with blocks that are only read.
    pub fn blocks_read<B: Sync, T: Send>(
        &self,
        blocks: &[B],
        out: &mut [T],
        f: impl Fn(&B, usize, &mut [T]) + Sync,
    ) {
        match &self.pool {
            None => {
                for (c, (b, part)) in blocks.iter().zip(out.chunks_mut(CHUNK)).enumerate() {
                    f(b, c * CHUNK, part);
                }
            }
            Some(_) => blocks
                .par_iter()
                .zip(out.par_chunks_mut(CHUNK))
                .enumerate()
                .for_each(|(c, (b, part))| f(b, c * CHUNK, part)),
        }
    }

    /// Sum of f over the chunks of 0..n, added in chunk order.
    #[must_use]
    pub fn chunk_sums(&self, n: usize, f: impl Fn(Range<usize>) -> f64 + Sync) -> f64 {
        let range = |c: usize| c * CHUNK..((c + 1) * CHUNK).min(n);
        match &self.pool {
            None => (0..chunks(n)).fold(0.0, |s, c| s + f(range(c))),
            Some(_) => {
                let parts: Vec<f64> = (0..chunks(n))
                    .into_par_iter()
                    .map(|c| f(range(c)))
                    .collect();
                parts.iter().fold(0.0, |s, v| s + v)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_have_the_same_bits_for_any_number_of_threads() {
        let value = |i: usize| (i as f64 * 0.37).sin() / (1.0 + i as f64);
        let sum = |threads| {
            let w = Workers::new(threads);
            w.install(|| super::super::sum_rows(&w, 10_007, value))
                .to_bits()
        };
        assert_eq!(sum(1), sum(2));
        assert_eq!(sum(1), sum(7));
    }
}
