//! Runs what is missing of a list of jobs, several side by side, until done or told to stop.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::member::Job;
use super::{Error, Outcome, Progress, Store};

/// What happened to a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It is finished by an earlier run with the same scene, plan and sources.
    Kept,
    /// It is under way.
    Advanced(Progress),
    /// It ended now; CPU time in all [s].
    Ended(Outcome, f64),
    /// It was stopped on its way and saved.
    Saved,
}

/// How jobs are run.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Where recordings are kept.
    pub store: &'a Store,
    /// Jobs side by side, at least 1.
    pub jobs: usize,
    /// Threads of each; more than one only where jobs run one after the other, so that their CPU time is told apart.
    pub threads: usize,
    /// Wall time between saves of a job.
    pub saved_every: Duration,
    /// Becomes true when the user wants to stop: jobs under way are saved, no other is begun.
    pub stop: &'a AtomicBool,
}

/// Runs the jobs that are not finished, in their order. `watch` is told from all threads, with the job's index.
///
/// # Errors
/// The first [`Error`] of any job; the others are stopped and saved then.
pub fn run(plan: Plan, jobs: &[Job], watch: &(dyn Fn(usize, Event) + Sync)) -> Result<(), Error> {
    let (next, broken) = (AtomicUsize::new(0), Mutex::new(None));
    let work = || {
        while !plan.stop.load(Ordering::SeqCst) {
            let index = next.fetch_add(1, Ordering::SeqCst);
            let Some(job) = jobs.get(index) else { break };
            match one(plan, job, &|event| watch(index, event)) {
                Ok(event) => watch(index, event),
                Err(error) => {
                    plan.stop.store(true, Ordering::SeqCst);
                    if let Ok(mut slot) = broken.lock() {
                        slot.get_or_insert(error);
                    }
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..plan.jobs.min(jobs.len()) {
            scope.spawn(work);
        }
        work();
    });
    match broken.into_inner() {
        Ok(Some(error)) => Err(error),
        _ => Ok(()),
    }
}

/// One job, from start, from what was saved, or not at all.
fn one(plan: Plan, job: &Job, watch: &(dyn Fn(Event) + Sync)) -> Result<Event, Error> {
    if plan.store.current(job.study, job.member).is_some() {
        return Ok(Event::Kept);
    }
    let tell = |progress| watch(Event::Advanced(progress));
    let recording = job.run(plan, &tell)?;
    Ok(match recording.outcome {
        Outcome::Running => Event::Saved,
        outcome => Event::Ended(outcome, recording.cpu),
    })
}
