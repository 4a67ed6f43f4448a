//! The queue between the thread that steps and the one that publishes: bounded, and it never makes the first one wait.
//!
//! When it is full the batch that waits last gives way to the new one, so that what is lost is between what is published:
//! the last batch is always among it, and a subscriber sees the gap in the numbers. The last value of a key that the new
//! batch does not have stays in the queue with it.

use super::publish::Publication;
use super::status::lock;
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// Batches that may wait for the publishing thread: what a step, a line of `out/log` or a jump publishes.
const WAITING_BATCHES: usize = 256;

/// What is published together.
pub(super) type Batch = Vec<Publication>;

#[derive(Default)]
struct Queue {
    waiting: Mutex<Waiting>,
    news: Condvar,
}

#[derive(Default)]
struct Waiting {
    batches: VecDeque<Batch>,
    closed: bool,
}

/// The end that gives; the queue closes with it.
pub(super) struct Giver(Arc<Queue>);

/// The end that takes, batch by batch until the queue is closed and empty.
pub(in crate::bus) struct Taker(Arc<Queue>);

/// An empty queue.
pub(super) fn queue() -> (Giver, Taker) {
    let queue = Arc::new(Queue::default());
    (Giver(queue.clone()), Taker(queue))
}

impl Giver {
    /// Adds a batch. Gives how many publications there was no room for.
    pub(super) fn give(&self, batch: Batch) -> u64 {
        let mut waiting = lock(&self.0.waiting);
        let full = waiting.batches.len() >= WAITING_BATCHES;
        let last = full.then(|| waiting.batches.pop_back()).flatten();
        let (batch, lost) = match last {
            Some(last) => superseding(last, batch),
            None => (batch, 0),
        };
        waiting.batches.push_back(batch);
        drop(waiting);
        self.0.news.notify_one();
        lost
    }
}

/// `new`, behind what `old` has of keys that `new` has not; and how many publications of `old` are lost.
fn superseding(old: Batch, new: Batch) -> (Batch, u64) {
    let keys: HashSet<_> = new
        .iter()
        .map(|publication| publication.key.clone())
        .collect();
    let before = old.len();
    let mut batch = old;
    batch.retain(|publication| !keys.contains(&publication.key));
    let lost = before - batch.len();
    batch.extend(new);
    (batch, lost as u64)
}

impl Drop for Giver {
    fn drop(&mut self) {
        lock(&self.0.waiting).closed = true;
        self.0.news.notify_one();
    }
}

impl Iterator for Taker {
    type Item = Batch;

    fn next(&mut self) -> Option<Batch> {
        let waiting = lock(&self.0.waiting);
        let empty = |waiting: &mut Waiting| waiting.batches.is_empty() && !waiting.closed;
        let mut waiting =
            (self.0.news.wait_while(waiting, empty)).unwrap_or_else(PoisonError::into_inner);
        waiting.batches.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn publication(key: &str, byte: usize) -> Publication {
        Publication {
            key: key.into(),
            schema: "test".into(),
            bytes: Arc::new(byte.to_be_bytes().to_vec()),
        }
    }

    fn shown(batch: &Batch) -> Vec<(String, usize)> {
        let number = |bytes: &[u8]| bytes.iter().fold(0, |n, b| n << 8 | usize::from(*b));
        let one = |p: &Publication| (p.key.to_string(), number(&p.bytes));
        batch.iter().map(one).collect()
    }

    #[test]
    fn what_comes_last_is_published_however_full_the_queue_was() {
        let (giver, taker) = queue();
        let mut lost = 0;
        for n in 0..WAITING_BATCHES + 10 {
            lost += giver.give(vec![publication("a", n), publication("b", n)]);
        }
        assert_eq!(lost, 20);
        // A line for people takes no other key's place, only that of the line before.
        for n in 0..2 {
            lost += giver.give(vec![publication("log", n)]);
        }
        assert_eq!(lost, 21);
        drop(giver);
        let batches: Vec<_> = taker.collect();
        assert_eq!(batches.len(), WAITING_BATCHES);
        for (n, batch) in batches[..WAITING_BATCHES - 1].iter().enumerate() {
            assert_eq!(shown(batch), [("a".to_owned(), n), ("b".to_owned(), n)]);
        }
        let newest = WAITING_BATCHES + 9;
        let last = [("a", newest), ("b", newest), ("log", 1)];
        assert_eq!(
            shown(&batches[WAITING_BATCHES - 1]),
            last.map(|(key, n)| (key.to_owned(), n))
        );
    }

    #[test]
    fn who_takes_waits_for_news_and_ends_with_who_gives() {
        let (giver, taker) = queue();
        let taking = std::thread::spawn(move || taker.map(|batch| batch.len()).sum::<usize>());
        for n in 0..1000 {
            giver.give(vec![publication("a", n)]);
            if n % 100 == 0 {
                std::thread::yield_now();
            }
        }
        drop(giver);
        assert!(taking.join().unwrap() >= WAITING_BATCHES);
    }
}
