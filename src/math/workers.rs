//! Threads of one component: a pool of its own, or none at all for one thread (so that nothing outlives it).

use super::launch::launch;
use rayon::prelude::*;
use std::ops::Range;
use std::thread::JoinHandle;

/// Rows per chunk. Part of the results: partial sums are formed per chunk, so it must not depend on the machine.
pub const CHUNK: usize = 128;

/// Sweeps of fewer rows run in the calling thread: handing them round costs more than it saves. Results do not depend on it.
/// Sweeps over pairs ([`Workers::blocks`] and its like) take some 100 ns a row, the others some ns: with 2500 for both a column
/// of 1856 particles had nothing of a second thread (8.2 s), with these it takes 6.6 s, a dam of 1318 particles 2.7 s for 3.8.
const PAIRS_FROM: usize = 512;
const ROWS_FROM: usize = 8192;

/// Number of chunks of n rows.
fn chunks(n: usize) -> usize {
    n.div_ceil(CHUNK)
}

/// Runs sweeps over rows on a set number of threads. Results never depend on that number.
#[derive(Debug, Default)]
pub struct Workers {
    pool: Option<Pool>,
}

/// A pool whose threads have ended when it is gone: a library may be unloaded right after that.
#[derive(Debug)]
struct Pool {
    pool: Option<rayon::ThreadPool>,
    threads: Vec<JoinHandle<()>>,
    /// The process that has the threads: one that was forked from it has none of them.
    process: u32,
}

impl Pool {
    /// `None` if the machine cannot start so many threads.
    fn new(count: usize) -> Option<Self> {
        launch(|| Self::start(count))?
    }

    fn start(count: usize) -> Option<Self> {
        let mut threads = Vec::new();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .spawn_handler(|worker| {
                threads.push(std::thread::Builder::new().spawn(|| worker.run())?);
                Ok(())
            })
            .build()
            .ok();
        let pool = Self {
            pool,
            threads,
            process: std::process::id(),
        };
        pool.pool.is_some().then_some(pool)
    }

    /// Whether this process was forked from the one that has the threads.
    fn is_lost(&self) -> bool {
        self.process != std::process::id()
    }

    /// Runs `f` in the pool: sweeps inside it share its threads, never the process-wide pool.
    fn run<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            None => f(),
        }
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        if self.is_lost() {
            // There is nobody to ask and nobody to wait for; what is said about them here is true of another process.
            std::mem::forget(self.pool.take());
            self.threads.drain(..).for_each(std::mem::forget);
            return;
        }
        // Dropping rayon's pool only asks its threads to end.
        drop(self.pool.take());
        for thread in self.threads.drain(..) {
            // A worker that panicked has ended too, and the panic went to the caller of the sweep.
            let _ = thread.join();
        }
    }
}

impl Workers {
    /// `threads` = 1 runs in the calling thread; 0 means all cores.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        if threads == 1 {
            return Self { pool: None };
        }
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        let count = if threads == 0 { all() } else { threads };
        // A machine that cannot start threads still gets the same results from the calling thread.
        let pool = Pool::new(count);
        Self { pool }
    }

    /// As many in this process, if these stayed in another one, from which it was forked.
    #[must_use]
    pub fn renewed(&self) -> Option<Self> {
        let lost = self.pool.as_ref().filter(|pool| pool.is_lost())?;
        Some(Self::new(lost.threads.len()))
    }

    /// Number of threads at work.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.threads.len())
    }

    /// The pool, if sweeps over the pairs of so many rows are worth it.
    fn pool_for_pairs(&self, rows: usize) -> Option<&Pool> {
        self.pool.as_ref().filter(|_| rows >= PAIRS_FROM)
    }

    /// The pool, if so many rows are worth it.
    fn pool_for_rows(&self, rows: usize) -> Option<&Pool> {
        self.pool.as_ref().filter(|_| rows >= ROWS_FROM)
    }

    /// Runs many sweeps of `rows` rows inside the pool, which is entered once for all of them.
    pub fn install<R: Send>(&self, rows: usize, f: impl FnOnce() -> R + Send) -> R {
        match self.pool_for_pairs(rows) {
            Some(pool) => pool.run(f),
            None => f(),
        }
    }

    /// out[i] written by f(i, &mut out[i]).
    pub fn each<T: Send>(&self, out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
        self.in_chunks(out, |first, part| {
            for (k, o) in part.iter_mut().enumerate() {
                f(first + k, o);
            }
        });
    }

    /// As [`Workers::each`], a chunk at a time: f(first row, rows of out).
    pub fn in_chunks<T: Send>(&self, out: &mut [T], f: impl Fn(usize, &mut [T]) + Sync) {
        hand_round(self.pool_for_rows(out.len()), out, &|c, part| {
            f(c * CHUNK, part);
        });
    }

    /// Blocks of rows side by side with the chunk of `out` that belongs to them: f(block, first row, rows of out).
    pub fn blocks<B: Send, T: Send>(
        &self,
        blocks: &mut [B],
        out: &mut [T],
        f: impl Fn(&mut B, usize, &mut [T]) + Sync,
    ) {
        let pool = self.pool_for_pairs(out.len());
        hand_round_two(pool, (blocks, 1), out, &|c, block, part| {
            f(&mut block[0], c * CHUNK, part);
        });
    }

    /// As [`Workers::blocks`] with blocks that are only read.
    pub fn blocks_read<B: Sync, T: Send>(
        &self,
        blocks: &[B],
        out: &mut [T],
        f: impl Fn(&B, usize, &mut [T]) + Sync,
    ) {
        hand_round(self.pool_for_pairs(out.len()), out, &|c, part| {
            f(&blocks[c], c * CHUNK, part);
        });
    }

    /// As [`Workers::blocks_read`]; the sum of what f returns for the chunks, added in their order.
    pub fn blocks_sum<B: Sync, T: Send>(
        &self,
        blocks: &[B],
        out: &mut [T],
        f: impl Fn(&B, usize, &mut [T]) -> f64 + Sync,
    ) -> f64 {
        let parts = hand_round(self.pool_for_pairs(out.len()), out, &|c, part| {
            f(&blocks[c], c * CHUNK, part)
        });
        parts.iter().fold(0.0, |sum, part| sum + part)
    }

    /// a[i] and b[i] written by f(i, &mut a[i], &mut b[i]), which returns what is to be summed; added chunk by chunk.
    pub fn both<A: Send, B: Send, const K: usize>(
        &self,
        a: &mut [A],
        b: &mut [B],
        f: impl Fn(usize, &mut A, &mut B) -> [f64; K] + Sync,
    ) -> [f64; K] {
        let pool = self.pool_for_rows(a.len());
        let parts = hand_round_two(pool, (a, CHUNK), b, &|c, a, b| {
            let mut sum = [0.0; K];
            for (k, (a, b)) in a.iter_mut().zip(b).enumerate() {
                sum = super::add(&sum, &f(c * CHUNK + k, a, b));
            }
            sum
        });
        parts
            .iter()
            .fold([0.0; K], |sum, part| super::add(&sum, part))
    }

    /// What f gives for the chunks of 0..n, in their order.
    fn chunks<R: Send>(&self, n: usize, f: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
        count_round(self.pool_for_rows(n), chunks(n), &|c| {
            f(c * CHUNK..((c + 1) * CHUNK).min(n))
        })
    }

    /// sum_i f(i) for i < n, partial sums of chunks added in their order: the same bits for any number of threads.
    #[must_use]
    pub fn sums<const K: usize>(&self, n: usize, f: impl Fn(usize) -> [f64; K] + Sync) -> [f64; K] {
        let part = |range: Range<usize>| range.fold([0.0; K], |s, i| super::add(&s, &f(i)));
        let parts = self.chunks(n, part);
        parts.iter().fold([0.0; K], |s, p| super::add(&s, p))
    }

    /// Largest of each of f(i)'s numbers for i < n, at least 0. NaN values win, so that they are seen.
    #[must_use]
    pub fn largest<const K: usize>(
        &self,
        n: usize,
        f: impl Fn(usize) -> [f64; K] + Sync,
    ) -> [f64; K] {
        let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        let both =
            |a: [f64; K], b: [f64; K]| -> [f64; K] { std::array::from_fn(|k| larger(a[k], b[k])) };
        let parts = self.chunks(n, |range| range.fold([0.0; K], |m, i| both(m, f(i))));
        parts.into_iter().fold([0.0; K], both)
    }

    /// The first i < n for which `is_bad`.
    #[must_use]
    pub fn first_bad(&self, n: usize, is_bad: impl Fn(usize) -> bool + Sync) -> Option<usize> {
        let parts = self.chunks(n, |mut range| range.find(|&i| is_bad(i)));
        parts.into_iter().flatten().next()
    }
}

// What goes to the pool is no type of its own: else each sweep would be compiled with a copy of rayon's machinery and of itself
// in every part of it, a tenth of the time that the library takes. A chunk costs a call through a pointer.

/// f(chunk, rows of out) for all chunks; what it gives, in their order.
fn hand_round<T: Send, R: Send>(
    pool: Option<&Pool>,
    out: &mut [T],
    f: &(dyn Fn(usize, &mut [T]) -> R + Sync),
) -> Vec<R> {
    match pool {
        None => {
            let parts = out.chunks_mut(CHUNK).enumerate();
            parts.map(|(c, part)| f(c, part)).collect()
        }
        Some(pool) => pool.run(|| {
            let parts = out.par_chunks_mut(CHUNK).enumerate();
            parts.map(|(c, part)| f(c, part)).collect()
        }),
    }
}

/// What is done with a chunk of two lists: f(chunk, of the one, of the other).
type Both<'f, A, B, R> = dyn Fn(usize, &mut [A], &mut [B]) -> R + Sync + 'f;

/// As [`hand_round`], with as many of `a` to each chunk as said.
fn hand_round_two<A: Send, B: Send, R: Send>(
    pool: Option<&Pool>,
    (a, size): (&mut [A], usize),
    b: &mut [B],
    f: &Both<'_, A, B, R>,
) -> Vec<R> {
    match pool {
        None => {
            let parts = a.chunks_mut(size).zip(b.chunks_mut(CHUNK)).enumerate();
            parts.map(|(c, (a, b))| f(c, a, b)).collect()
        }
        Some(pool) => pool.run(|| {
            let parts = a.par_chunks_mut(size).zip(b.par_chunks_mut(CHUNK));
            parts.enumerate().map(|(c, (a, b))| f(c, a, b)).collect()
        }),
    }
}

/// As [`hand_round`], without rows.
fn count_round<R: Send>(
    pool: Option<&Pool>,
    count: usize,
    f: &(dyn Fn(usize) -> R + Sync),
) -> Vec<R> {
    match pool {
        None => (0..count).map(f).collect(),
        Some(pool) => pool.run(|| (0..count).into_par_iter().map(f).collect()),
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
            w.install(10_007, || w.sums(10_007, |i| [value(i)]))[0].to_bits()
        };
        assert_eq!(sum(1), sum(2));
        assert_eq!(sum(1), sum(7));
    }

    #[test]
    fn the_largest_is_found_and_nan_is_larger() {
        let values: Vec<f64> = (0..5000).map(|i| f64::from((i * 7919) % 5003)).collect();
        for threads in [1, 3] {
            let w = Workers::new(threads);
            assert_eq!(w.largest(5000, |i| [values[i], -values[i]]), [5002.0, 0.0]);
            let [seen] = w.largest(5000, |i| [if i == 777 { f64::NAN } else { values[i] }]);
            assert!(seen.is_nan());
            assert_eq!(
                w.first_bad(5000, |i| i > 3000 && values[i] > 10.0),
                Some(3001)
            );
            assert_eq!(w.first_bad(5000, |i| values[i] < 0.0), None);
        }
    }

    #[test]
    fn sweeps_use_threads_of_their_own_also_outside_install() {
        let workers = Workers::new(3);
        let mut seen = vec![0; ROWS_FROM];
        workers.each(&mut seen, |_, threads| {
            *threads = rayon::current_num_threads()
        });
        assert_eq!(workers.threads(), 3);
        assert!(seen.iter().all(|threads| *threads == 3));
    }

    #[test]
    fn no_thread_outlives_its_workers() {
        let ended = std::sync::Arc::new(());
        let workers = Workers::new(3);
        if let Some(pool) = workers.pool.as_ref().and_then(|pool| pool.pool.as_ref()) {
            // Each thread holds the mark until its thread-local storage goes, which is the last thing it does.
            thread_local!(static MARK: std::cell::RefCell<Option<std::sync::Arc<()>>> = const { std::cell::RefCell::new(None) });
            pool.broadcast(|_| MARK.set(Some(ended.clone())));
        }
        assert_eq!(std::sync::Arc::strong_count(&ended), 4);
        drop(workers);
        assert_eq!(std::sync::Arc::strong_count(&ended), 1);
    }
}
