//! Makes a valid log of one that was cut short (`kill -9`, a full disk): all of its metadata, attachments, channels and
//! whole messages, in their order and with their bytes, then an end and a summary.
//!
//! Two readings. The first passes on what stands in whole chunks with the right checksum. The second looks, only if the
//! file just ends, for whole messages in the piece of a chunk that the first left out. After changed bytes nothing is
//! taken over: what comes behind them cannot be told from noise.

use super::ending::Ending;
use super::error::{ReadError, RecordError};
use super::file::{ChannelId, LogFile, Pace};
use super::place::Place;
use super::preamble::owned;
use super::raw::{Check, RawChannel, RawEntry, RawReader};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What was taken over.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// How the damaged file ends.
    pub ending: Ending,
    /// Messages taken over.
    pub messages: u64,
    /// Of these, messages of a chunk that was cut: whole, but without a checksum.
    pub unchecked: u64,
    /// Metadata records taken over.
    pub metadata: u64,
    /// Attachments taken over.
    pub attachments: u64,
    /// Simulated time of the last message [ns].
    pub last: Option<u64>,
    /// The file made.
    pub path: PathBuf,
}

/// Errors of [`recover`].
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The damaged file cannot be read at all.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The new one cannot be written to its end.
    #[error(
        "cannot write the recovered log: {0}; make room or choose another folder, and run again"
    )]
    Unfinished(String),
    /// The new one cannot be written.
    #[error(transparent)]
    Write(#[from] RecordError),
}

/// Writes what is whole of `from` to the new file `to`. A complete file is copied, too.
///
/// # Errors
/// [`RecoverError::Read`] if `from` is no log, [`RecoverError::Write`] if `to` exists or cannot be written.
pub fn recover(from: &Path, to: &Path) -> Result<Recovered, RecoverError> {
    let source = RawReader::checking(from, Check::Before)?;
    let place = Place {
        // `run.mcap.part` may be what is recovered to `run.mcap`.
        unfinished: ".recovering",
        ..Place::alone(to)
    };
    let sink = Box::new(place.create()?);
    let copy = Copy {
        file: LogFile::start(sink, Some(place.part()), Pace::Caller),
        channels: HashMap::new(),
        entries: 0,
        recovered: Recovered {
            ending: Ending::Complete,
            messages: 0,
            unchecked: 0,
            metadata: 0,
            attachments: 0,
            last: None,
            path: to.to_owned(),
        },
    };
    match copy.make(from, source) {
        Ok(recovered) => {
            place.rename()?;
            Ok(recovered)
        }
        Err(error) => {
            // The same command can be given again.
            let _ = std::fs::remove_file(place.part());
            Err(error)
        }
    }
}

struct Copy {
    file: LogFile,
    channels: HashMap<Arc<RawChannel>, ChannelId>,
    entries: usize,
    recovered: Recovered,
}

impl Copy {
    /// Everything whole of `from`, of which `source` is the first reading, and the end.
    fn make(mut self, from: &Path, mut source: RawReader) -> Result<Recovered, RecoverError> {
        for entry in source.by_ref() {
            self.add(&entry?);
        }
        let mut ending = source.ending().cloned().unwrap_or(Ending::Complete);
        if matches!(ending, Ending::Cut { damaged: false, .. }) {
            let (seen, checked) = (self.entries, self.recovered.messages);
            let mut rest = RawReader::checking(from, Check::Not)?;
            for entry in rest.by_ref().skip(seen) {
                self.add(&entry?);
            }
            // It came further.
            ending = rest.ending().cloned().unwrap_or(ending);
            self.recovered.unchecked = self.recovered.messages - checked;
        }
        self.recovered.ending = ending;
        self.finish(from)
    }

    fn add(&mut self, entry: &RawEntry) {
        self.entries += 1;
        match entry {
            RawEntry::Metadata { name, values } => {
                self.recovered.metadata += 1;
                self.file.metadata(name, values.clone());
            }
            RawEntry::Attachment {
                name,
                media_type,
                log_time,
                data,
            } => {
                self.recovered.attachments += 1;
                self.file.attachment(name, media_type, *log_time, data);
            }
            RawEntry::Channel(channel) => drop(self.channel(channel)),
            RawEntry::Message(message) => {
                self.recovered.messages += 1;
                self.recovered.last = Some(message.log_time);
                let id = self.channel(&message.channel);
                let times = (message.log_time, message.publish_time);
                let seconds = message.log_time as f64 / 1e9;
                self.file
                    .message(seconds, id, message.sequence, times, &message.data);
            }
        }
    }

    fn channel(&mut self, channel: &Arc<RawChannel>) -> ChannelId {
        if let Some(id) = self.channels.get(channel) {
            return *id;
        }
        let id = self.file.raw_channel(channel);
        self.channels.insert(channel.clone(), id);
        id
    }

    /// Says in the file what was done, and closes it.
    fn finish(mut self, from: &Path) -> Result<Recovered, RecoverError> {
        let done = &self.recovered;
        if done.ending != Ending::Complete {
            let name = from.file_name().unwrap_or_default().to_string_lossy();
            let note = owned([
                ("from", name.into_owned()),
                ("ending", done.ending.to_string()),
                ("messages", done.messages.to_string()),
                ("unchecked", done.unchecked.to_string()),
            ]);
            self.file.metadata("recovered", note);
        }
        match self.file.finish().1 {
            Some(failure) => Err(RecoverError::Unfinished(failure.cause)),
            None => Ok(self.recovered),
        }
    }
}
