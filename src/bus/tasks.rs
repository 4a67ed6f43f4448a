//! What waits for who steps the component: requests and set-points, in the order in which they came. Does not know Zenoh.
//!
//! Bounded, and the newest set-point of a variable is never what is lost: between two requests one waits for each variable,
//! and a newer one takes the place of the older, which nobody could have seen. Requests keep their order with them: a `step`
//! takes what came before it and nothing that came later.

use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;
use super::status::lock;
use super::values::Settable;
use std::collections::VecDeque;
use std::sync::mpsc::RecvTimeoutError;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Requests that may wait.
pub(super) const WAITING_REQUESTS: usize = 256;
/// Bytes of their bodies that may wait: two of the longest, since each holds a state and is held as text, too.
pub(super) const WAITING_BYTES: usize = 128 << 20;
/// Set-points that may wait where requests stand between them; more if more variables can be set. Of those beyond it the
/// oldest that has a newer one goes.
const WAITING_SET_POINTS: usize = 192;
/// Set-points that may wait although they will hardly be taken (no such variable, out of range): they take no other's
/// place, so that each is refused for what it is.
pub(super) const WAITING_ODD_POINTS: usize = 64;

/// Somebody who waits for a reply. Dropping it answers, too, with an error.
pub(super) trait Asked: Send {
    /// Hands the reply on to the thread that sends it.
    fn answer(self: Box<Self>, reply: Reply);
}

/// Something for the component.
pub(super) enum Task {
    /// A request, with its body as it came.
    Call {
        request: Box<Request>,
        body: String,
        asked: Box<dyn Asked>,
    },
    /// A set-point.
    SetPoint(SetPoint),
}

/// Why nothing more is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoRoom {
    /// As many wait as may.
    Full,
    /// As many bytes wait as may.
    Heavy,
    /// Who took them has ended.
    Ended,
}

/// A task, and whether it is a set-point that surely can be taken.
struct Entry {
    task: Task,
    sure: bool,
}

impl Entry {
    fn is_call(&self) -> bool {
        matches!(self.task, Task::Call { .. })
    }

    fn is_odd(&self) -> bool {
        !self.sure && !self.is_call()
    }

    /// Bytes of a request's body.
    fn bytes(&self) -> usize {
        match &self.task {
            Task::Call { body, .. } => body.len(),
            Task::SetPoint(_) => 0,
        }
    }

    /// The variable of a set-point that surely can be taken.
    fn sets(&self) -> Option<&str> {
        match &self.task {
            Task::SetPoint(point) if self.sure => Some(&point.variable),
            _ => None,
        }
    }
}

#[derive(Default)]
struct Waiting {
    entries: VecDeque<Entry>,
    /// Nobody gives any more.
    closed: bool,
    /// Nobody takes any more.
    ended: bool,
}

struct Queue {
    settable: Settable,
    waiting: Mutex<Waiting>,
    news: Condvar,
}

/// The end that gives; the queue closes with it.
pub(super) struct Giver(Arc<Queue>);

/// The end that takes.
pub(super) struct Taker(Arc<Queue>);

/// An empty queue for a component in which these variables can be set.
pub(super) fn tasks(settable: Settable) -> (Giver, Taker) {
    let queue = Arc::new(Queue {
        settable,
        waiting: Mutex::default(),
        news: Condvar::new(),
    });
    (Giver(queue.clone()), Taker(queue))
}

impl Giver {
    /// A request, behind all that waits; given back if there is no room.
    pub(super) fn call(&self, call: Task) -> Result<(), (NoRoom, Task)> {
        let mut waiting = lock(&self.0.waiting);
        if waiting.ended {
            return Err((NoRoom::Ended, call));
        }
        let calls = waiting.entries.iter().filter(|entry| entry.is_call());
        if calls.count() >= WAITING_REQUESTS {
            return Err((NoRoom::Full, call));
        }
        let entry = Entry {
            task: call,
            sure: false,
        };
        let bytes = waiting.entries.iter().map(Entry::bytes).sum::<usize>();
        if bytes + entry.bytes() > WAITING_BYTES {
            return Err((NoRoom::Heavy, entry.task));
        }
        waiting.entries.push_back(entry);
        drop(waiting);
        self.0.news.notify_one();
        Ok(())
    }

    /// A set-point, behind all that waits. Gives the older one that it supersedes. `saturates`: inputs out of range are
    /// clamped and not refused.
    pub(super) fn point(
        &self,
        point: SetPoint,
        saturates: bool,
    ) -> Result<Option<SetPoint>, NoRoom> {
        let sure = self.0.settable.surely_takes(&point, saturates);
        let most = WAITING_SET_POINTS.max(self.0.settable.len());
        let mut waiting = lock(&self.0.waiting);
        if waiting.ended {
            return Err(NoRoom::Ended);
        }
        let odd = waiting.entries.iter().filter(|entry| entry.is_odd());
        if !sure && odd.count() >= WAITING_ODD_POINTS {
            return Err(NoRoom::Full);
        }
        let entries = &mut waiting.entries;
        entries.push_back(Entry {
            task: Task::SetPoint(point),
            sure,
        });
        let superseded = superseded(entries, most).and_then(|at| entries.remove(at));
        drop(waiting);
        self.0.news.notify_one();
        Ok(superseded.and_then(|entry| match entry.task {
            Task::SetPoint(point) => Some(point),
            Task::Call { .. } => None,
        }))
    }
}

/// Which set-point the last entry makes superfluous: that of its variable behind the last request; if there is none and more
/// than `most` wait, the oldest that has a newer one, of its own variable if possible.
fn superseded(entries: &VecDeque<Entry>, most: usize) -> Option<usize> {
    let newest = entries.len().checked_sub(1)?;
    let variable = entries[newest].sets()?;
    let same = |at: &usize| entries[*at].sets() == Some(variable);
    let mut stretch = (0..newest).rev().take_while(|&at| !entries[at].is_call());
    let replaced = stretch.find(same);
    if replaced.is_some() || entries.iter().filter_map(Entry::sets).count() <= most {
        return replaced;
    }
    let has_newer = |at: &usize| {
        let own = entries[*at].sets();
        own.is_some() && entries.range(at + 1..).any(|later| later.sets() == own)
    };
    (0..newest)
        .find(same)
        .or_else(|| (0..newest).find(has_newer))
}

impl Taker {
    /// The first one; waits for it for so long.
    pub(super) fn take(&self, patience: Duration) -> Result<Task, RecvTimeoutError> {
        let waiting = lock(&self.0.waiting);
        let empty = |waiting: &mut Waiting| waiting.entries.is_empty() && !waiting.closed;
        let (mut waiting, _) = (self.0.news.wait_timeout_while(waiting, patience, empty))
            .unwrap_or_else(PoisonError::into_inner);
        match waiting.entries.pop_front() {
            Some(entry) => Ok(entry.task),
            None if waiting.closed => Err(RecvTimeoutError::Disconnected),
            None => Err(RecvTimeoutError::Timeout),
        }
    }

    /// How many wait now; none if nothing waits and nobody gives any more.
    pub(super) fn waiting(&self) -> Option<usize> {
        let waiting = lock(&self.0.waiting);
        let tasks = waiting.entries.len();
        (tasks > 0 || !waiting.closed).then_some(tasks)
    }

    /// All that wait now: what comes meanwhile is not waited for.
    pub(super) fn take_all(&self) -> impl Iterator<Item = Task> + use<> {
        let entries = std::mem::take(&mut lock(&self.0.waiting).entries);
        entries.into_iter().map(|entry| entry.task)
    }
}

impl Drop for Giver {
    fn drop(&mut self) {
        lock(&self.0.waiting).closed = true;
        self.0.news.notify_one();
    }
}

impl Drop for Taker {
    fn drop(&mut self) {
        lock(&self.0.waiting).ended = true;
        // Who still waits is answered as these are dropped.
        drop(self.take_all());
    }
}

#[cfg(test)]
mod tests;
