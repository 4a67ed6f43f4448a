//! Many seeds, several side by side.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::checks::{Check, Failure};
use super::run::{Bounds, Figures, run};
use super::{Case, generate};

/// What to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// First seed.
    pub seed: u64,
    /// Number of scenes: seeds from the first on.
    pub count: u64,
    /// Only this kind; all in turn by weight if none.
    pub kind: Option<String>,
    /// Scenes side by side, at least 1.
    pub jobs: usize,
    /// What each may take.
    pub bounds: Bounds,
}

/// One scene that was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Its kind.
    pub kind: String,
    /// Its seed.
    pub seed: u64,
    /// Checks that it failed.
    pub failures: Vec<Failure>,
    /// What was measured.
    pub figures: Figures,
}

impl Campaign {
    /// The case of a seed.
    ///
    /// # Errors
    /// As [`generate::of_kind`].
    pub fn case(&self, seed: u64) -> Result<Case, String> {
        let kind = self.kind.as_deref();
        generate::of_kind(kind.unwrap_or(generate::kind_of(seed).name), seed)
    }

    /// Tries one seed.
    #[must_use]
    pub fn attempt(&self, seed: u64) -> Tried {
        let kind = self.kind.as_deref();
        let kind = kind.unwrap_or(generate::kind_of(seed).name);
        let (failures, figures) = match self.case(seed) {
            Ok(case) => {
                let outcome = run(&case, &self.bounds);
                (outcome.failures, outcome.figures)
            }
            Err(what) => {
                let check = Check::Expectation;
                (vec![Failure { check, what }], Figures::default())
            }
        };
        Tried {
            kind: kind.to_owned(),
            seed,
            failures,
            figures,
        }
    }

    /// Tries all seeds that are not among `known`; `watch` hears of each, from all threads. Stops early when `stop` becomes
    /// true. What was tried, by seed, `known` included.
    pub fn run(
        &self,
        known: Vec<Tried>,
        stop: &AtomicBool,
        watch: &(dyn Fn(&Tried) + Sync),
    ) -> Vec<Tried> {
        let done: std::collections::BTreeSet<u64> = known.iter().map(|t| t.seed).collect();
        let (next, all) = (AtomicU64::new(0), Mutex::new(known));
        let work = || {
            while !stop.load(Ordering::SeqCst) {
                let offset = next.fetch_add(1, Ordering::SeqCst);
                if offset >= self.count {
                    break;
                }
                // Seeds go round: every number is one.
                let seed = self.seed.wrapping_add(offset);
                if done.contains(&seed) {
                    continue;
                }
                let tried = self.attempt(seed);
                watch(&tried);
                all.lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(tried);
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..self.jobs {
                scope.spawn(work);
            }
            work();
        });
        let mut all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
        all.sort_by_key(|t| t.seed);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_not_tried_again_and_order_does_not_depend_on_jobs() {
        let mut campaign = Campaign {
            seed: 5,
            count: 4,
            kind: Some("illegal".to_owned()),
            jobs: 2,
            bounds: Bounds::default(),
        };
        let stop = AtomicBool::new(false);
        let all = campaign.run(Vec::new(), &stop, &|_| ());
        assert_eq!(all.iter().map(|t| t.seed).collect::<Vec<_>>(), [5, 6, 7, 8]);
        campaign.jobs = 1;
        let heard = Mutex::new(Vec::new());
        let again = campaign.run(all[..3].to_vec(), &stop, &|t| {
            heard.lock().unwrap().push(t.seed);
        });
        assert_eq!(heard.into_inner().unwrap(), [8]);
        assert_eq!(again, all);
        stop.store(true, Ordering::SeqCst);
        assert!(campaign.run(Vec::new(), &stop, &|_| ()).is_empty());
    }
}
