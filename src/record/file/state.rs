//! What is known of a file that is being written, shared by the calls and the thread that brings bytes to the system.

use super::{Counts, Mcap};
use crate::math::launch;
use crate::record::error::Failure;
use crate::record::sink::{Passed, Syncer};
use mcap::records::MessageHeader;
use std::path::PathBuf;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Age of the oldest message in memory at which it is written.
const FLUSH_AFTER: Duration = Duration::from_millis(500);
/// How often the thread looks.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// The state, and how to tell the thread to stop.
pub(super) struct Shared {
    state: Mutex<State>,
    stop: Condvar,
}

impl Shared {
    pub(super) fn new(state: State) -> Self {
        Self {
            state: Mutex::new(state),
            stop: Condvar::new(),
        }
    }

    /// The state, for as long as the guard lives.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        // State is consistent between statements, so a panic elsewhere does not spoil it.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the thread that it is not needed any more.
    pub(super) fn stop(&self) {
        self.lock().stopped = true;
        self.stop.notify_all();
    }
}

/// The open file, what became of its messages, and the latch of the first failure.
pub(super) struct State {
    mcap: Option<Mcap>,
    failure: Option<Failure>,
    written: u64,
    /// Bytes of all messages so far.
    bytes: u64,
    dropped: u64,
    /// Messages of the open chunk, which is in memory.
    unflushed: u64,
    /// Bytes that the system has taken.
    passed: Passed,
    sync: Option<Syncer>,
    dirty_since: Option<Instant>,
    /// Simulated time of the last message [s].
    time: f64,
    /// That of the last one known to be written, if any is [s].
    written_to: Option<f64>,
    stopped: bool,
}

impl State {
    /// Of a file that was begun, or could not be. `sync` brings every flush to the disk itself.
    pub(super) fn new(
        begun: mcap::McapResult<Mcap>,
        passed: Passed,
        sync: Option<Syncer>,
        path: Option<&PathBuf>,
    ) -> Self {
        let mut state = Self {
            mcap: None,
            failure: None,
            written: 0,
            bytes: 0,
            dropped: 0,
            unflushed: 0,
            passed,
            sync,
            dirty_since: None,
            time: 0.0,
            written_to: None,
            stopped: false,
        };
        match begun {
            Ok(mcap) => state.mcap = Some(mcap),
            Err(error) => state.fail(&error, path),
        }
        state
    }

    /// In a process that was forked from the one that writes, after a message of a simulated time [s]: writes nothing.
    pub(super) fn left_to_parent(time: f64, path: Option<&PathBuf>) -> Self {
        let error = std::io::Error::other(
            "this process was forked from the one that writes the log; reset the instance, or make one here",
        );
        let mut state = Self::new(Err(error.into()), Passed::default(), None, path);
        state.time = time;
        if let Some(failure) = &mut state.failure {
            failure.time = time;
        }
        state
    }

    /// Writes, unless an earlier write failed; none if it did, or this one does.
    pub(super) fn with<T>(
        &mut self,
        path: Option<&PathBuf>,
        write: impl FnOnce(&mut Mcap) -> mcap::McapResult<T>,
    ) -> Option<T> {
        match write(self.mcap.as_mut()?) {
            Ok(value) => Some(value),
            Err(error) => {
                self.fail(&error, path);
                None
            }
        }
    }

    /// Adds a message of a simulated time [s].
    pub(super) fn message(
        &mut self,
        path: Option<&PathBuf>,
        time: f64,
        header: &MessageHeader,
        data: &[u8],
    ) {
        let earlier = std::mem::replace(&mut self.time, time);
        if self.mcap.is_none() {
            self.dropped += 1;
            return;
        }
        self.written += 1;
        self.bytes += data.len() as u64;
        self.unflushed += 1;
        self.dirty_since.get_or_insert_with(Instant::now);
        let before = self.passed.load(Relaxed);
        let written = self.with(path, |mcap| mcap.write_to_known_channel(header, data));
        // Only the end of a chunk, which is larger than the buffer, brings bytes to the system here; this message is the
        // first of the next one.
        if written.is_some() && self.passed.load(Relaxed) != before {
            self.unflushed = 1;
            self.written_to = (self.written > 1).then_some(earlier);
        }
    }

    /// Closes the chunk and hands all bytes to the system.
    pub(super) fn flush(&mut self, path: Option<&PathBuf>) {
        if self.with(path, mcap::Writer::flush).is_none() {
            return;
        }
        if let Some(sync) = &mut self.sync
            && let Err(error) = sync()
        {
            self.fail(&error.into(), path);
            return;
        }
        self.unflushed = 0;
        self.dirty_since = None;
        self.written_to = (self.written > 0).then_some(self.time);
    }

    /// Writes the summary, brings everything to the disk and closes the file.
    pub(super) fn close(&mut self, path: Option<&PathBuf>) {
        self.flush(path);
        self.with(path, |mcap| mcap.finish().map(drop));
        if let Some(mcap) = self.mcap.take() {
            let buffered = mcap.into_inner().into_inner();
            let closed = buffered
                .into_inner()
                .map_err(std::io::IntoInnerError::into_error)
                .and_then(|mut latch| latch.sync());
            if let Err(error) = closed {
                self.fail(&error.into(), path);
            }
        }
    }

    /// Latches the first failure. Messages that were only in memory count as dropped.
    pub(super) fn fail(&mut self, error: &mcap::McapError, path: Option<&PathBuf>) {
        if let Some(mcap) = self.mcap.take() {
            // Taken apart rather than dropped: dropping would try to write a summary.
            drop(mcap.into_inner());
        }
        self.dropped += self.unflushed;
        self.written -= self.unflushed;
        self.unflushed = 0;
        self.dirty_since = None;
        let cause = match error {
            mcap::McapError::Io(io) => io.to_string(),
            other => other.to_string(),
        };
        self.failure.get_or_insert(Failure {
            time: self.time,
            written: self.written_to,
            cause,
            file: path.cloned(),
        });
    }

    /// Bytes of all messages so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The first failure, if there was one.
    pub(super) fn failure(&self) -> Option<Failure> {
        self.failure.clone()
    }

    /// What became of the messages so far.
    pub(super) fn counts(&self) -> Counts {
        Counts {
            written: self.written,
            dropped: self.dropped,
        }
    }
}

/// None if the system has no thread to give: the log is then written by chunks only, which is still a log.
pub(super) fn spawn_flusher(shared: Arc<Shared>, path: Option<PathBuf>) -> Option<JoinHandle<()>> {
    let flush_until_stopped = move || {
        let mut state = shared.lock();
        while !state.stopped {
            state = shared
                .stop
                .wait_timeout(state, LOOK_EVERY)
                .unwrap_or_else(PoisonError::into_inner)
                .0;
            if state
                .dirty_since
                .is_some_and(|since| since.elapsed() >= FLUSH_AFTER)
            {
                state.flush(path.as_ref());
            }
        }
    };
    let thread = std::thread::Builder::new().name("sandgate-log".to_owned());
    launch(|| thread.spawn(flush_until_stopped).ok())?
}
