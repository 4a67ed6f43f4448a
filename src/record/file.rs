//! One MCAP file being written: channels, messages, flushing, and the latch of the first failure.
//!
//! It knows messages as bytes only; what they say is the business of `write`.
//!
//! Loss: with [`Pace::WallClock`] a thread brings everything to the system within `FLUSH_AFTER` plus `LOOK_EVERY` of `state`,
//! also while a step takes minutes; with [`Pace::Caller`] whatever came before the last [`LogFile::flush`] is safe and
//! the bytes do not depend on any clock.
//!
//! A process that is forked from the one that writes has the file and its lock, but no thread that would let go of the lock
//! if it held it then: in it nothing that threads share is touched.

mod state;

use super::error::Failure;
use super::raw::RawChannel;
use super::sink::{Latch, Sink};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use state::{Shared, State, spawn_flusher};
use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::PathBuf;
use std::sync::{Arc, MutexGuard, OnceLock};
use std::thread::JoinHandle;

/// Bytes of a chunk at which it is closed without waiting for a flush; also the memory a log takes.
const CHUNK_BYTES: u64 = 1 << 20;

type Mcap = mcap::Writer<NoSeek<BufWriter<Latch>>>;

/// Who decides when chunks are closed and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// A thread, by the clock.
    WallClock,
    /// Calls of [`LogFile::flush`].
    Caller,
}

/// How bytes are brought to the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Writing {
    /// Who decides when.
    pub(super) pace: Pace,
    /// Whether every flush goes to the disk itself.
    pub(super) sync_every_flush: bool,
}

impl From<Pace> for Writing {
    fn from(pace: Pace) -> Self {
        Self {
            pace,
            sync_every_flush: false,
        }
    }
}

/// A channel's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChannelId(u16);

pub(super) struct LogFile {
    shared: Arc<Shared>,
    flusher: Option<JoinHandle<()>>,
    path: Option<PathBuf>,
    /// The process that writes.
    process: u32,
    /// Takes the place of `shared` in a process that was forked from it.
    forked: OnceLock<Shared>,
    /// Simulated time of the last message [s].
    time: f64,
}

/// What became of the messages of a file. Of the chunk at which a write failed a part may be there, and can be read: all of it
/// counts as dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    /// Messages in the file.
    pub(super) written: u64,
    /// Messages that are not, because a write failed.
    pub(super) dropped: u64,
}

impl LogFile {
    /// Starts a file: magic and header. `path` is for messages to people.
    pub(super) fn start(
        sink: Box<dyn Sink>,
        path: Option<PathBuf>,
        writing: impl Into<Writing>,
    ) -> Self {
        let Writing {
            pace,
            sync_every_flush,
        } = writing.into();
        let sync = if sync_every_flush {
            sink.syncer()
        } else {
            None
        };
        let latch = Latch::new(sink);
        let passed = latch.passed();
        let buffered = BufWriter::with_capacity(1 << 16, latch);
        let created = mcap::WriteOptions::new()
            .compression(None)
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true)
            .profile("")
            .library(concat!("sandgate ", env!("CARGO_PKG_VERSION")))
            .create(NoSeek::new(buffered));
        let state = State::new(created, passed, sync, path.as_ref());
        let shared = Arc::new(Shared::new(state));
        let flusher = (pace == Pace::WallClock)
            .then(|| spawn_flusher(Arc::clone(&shared), path.clone()))
            .flatten();
        Self {
            shared,
            flusher,
            path,
            process: std::process::id(),
            forked: OnceLock::new(),
            time: 0.0,
        }
    }

    /// Writes a metadata record; it stands before all later messages.
    pub(super) fn metadata(&mut self, name: &str, values: BTreeMap<String, String>) {
        let record = Metadata {
            name: name.to_owned(),
            metadata: values,
        };
        self.with(|mcap| mcap.write_metadata(&record));
    }

    /// Writes an attachment; `time` is simulated time in ns.
    pub(super) fn attachment(&mut self, name: &str, media_type: &str, time: u64, data: &[u8]) {
        let attachment = mcap::Attachment {
            log_time: time,
            create_time: time,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: data.into(),
        };
        self.with(|mcap| mcap.attach(&attachment));
    }

    /// Adds a channel. After a failure the number means nothing and is not used.
    pub(super) fn channel(
        &mut self,
        topic: &str,
        (schema, descriptors): (&str, &[u8]),
        metadata: &BTreeMap<String, String>,
    ) -> ChannelId {
        let added = self.with(|mcap| {
            let schema = mcap.add_schema(schema, "protobuf", descriptors)?;
            mcap.add_channel(schema, topic, "protobuf", metadata)
        });
        ChannelId(added.unwrap_or(0))
    }

    /// Adds a channel as another file has it.
    pub(super) fn raw_channel(&mut self, channel: &RawChannel) -> ChannelId {
        let added = self.with(|mcap| {
            let schema = match channel.schema.name.as_str() {
                "" => 0,
                name => mcap.add_schema(name, &channel.schema.encoding, &channel.schema.data)?,
            };
            mcap.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)
        });
        ChannelId(added.unwrap_or(0))
    }

    /// Adds a message. `time` is simulated time [s], the others as in MCAP.
    pub(super) fn message(
        &mut self,
        time: f64,
        channel: ChannelId,
        sequence: u32,
        (log_time, publish_time): (u64, u64),
        data: &[u8],
    ) {
        let header = MessageHeader {
            channel_id: channel.0,
            sequence,
            log_time,
            publish_time,
        };
        let path = self.path.as_ref();
        self.lock().message(path, time, &header, data);
        self.time = time;
    }

    /// Closes the chunk and hands all bytes to the system.
    pub(super) fn flush(&mut self) {
        self.lock().flush(self.path.as_ref());
    }

    /// Writes the summary, brings everything to the disk and closes the file.
    pub(super) fn finish(&mut self) -> (Counts, Option<Failure>) {
        self.stop_flusher();
        let mut state = self.lock();
        state.close(self.path.as_ref());
        (state.counts(), state.failure())
    }

    /// Bytes of all messages so far, without what MCAP adds.
    pub(super) fn bytes(&self) -> u64 {
        self.lock().bytes()
    }

    /// Writes nothing more, as if a write had failed for this reason.
    pub(super) fn give_up(&mut self, cause: &str) {
        let path = self.path.clone();
        let error = mcap::McapError::Io(std::io::Error::other(cause.to_owned()));
        self.lock().fail(&error, path.as_ref());
    }

    /// The first failure, if there was one.
    pub(super) fn failure(&self) -> Option<Failure> {
        self.lock().failure()
    }

    /// What became of the messages so far.
    pub(super) fn counts(&self) -> Counts {
        self.lock().counts()
    }

    fn with<T>(&mut self, write: impl FnOnce(&mut Mcap) -> mcap::McapResult<T>) -> Option<T> {
        let path = self.path.clone();
        self.lock().with(path.as_ref(), write)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        if !self.is_forked() {
            return self.shared.lock();
        }
        let forked = || Shared::new(State::left_to_parent(self.time, self.path.as_ref()));
        self.forked.get_or_init(forked).lock()
    }

    /// Whether this process was forked from the one that writes, and has no thread that brings bytes to the system.
    fn is_forked(&self) -> bool {
        self.process != std::process::id()
    }

    fn stop_flusher(&mut self) {
        if let Some(flusher) = self.flusher.take() {
            if self.is_forked() {
                // It stayed in the other process: nobody to wait for.
                std::mem::forget(flusher);
                return;
            }
            self.shared.stop();
            // The thread does not panic; if it did, its failure is latched in the state already.
            let _ = flusher.join();
        }
    }
}

impl Drop for LogFile {
    /// A file that was not finished (a panic, an early return) still gets its summary, but keeps its unfinished name.
    fn drop(&mut self) {
        self.stop_flusher();
        if self.is_forked() {
            // One owner too many, so that the file is never dropped here: that would write what is in memory twice.
            std::mem::forget(Arc::clone(&self.shared));
        }
    }
}

#[cfg(test)]
mod tests;
