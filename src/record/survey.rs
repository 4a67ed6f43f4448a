//! What is in a log: one reading from start to end.

use super::ending::Ending;
use super::error::ReadError;
use super::raw::{RawEntry, RawMessage, RawReader};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What is in a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// The file.
    pub path: PathBuf,
    /// Its size [bytes].
    pub bytes: u64,
    /// Metadata records in their order: "run", "segment", "end", "recovered" and those of others.
    pub metadata: Vec<(String, BTreeMap<String, String>)>,
    /// Attachments: name, type, size [bytes].
    pub attachments: Vec<(String, String, u64)>,
    /// Channels by topic; those without messages as well.
    pub channels: BTreeMap<String, ChannelSurvey>,
    /// How it ends.
    pub ending: Ending,
}

/// What is on one channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelSurvey {
    /// Name of the message.
    pub schema: String,
    /// Messages.
    pub messages: u64,
    /// Bytes of these, without what MCAP adds.
    pub bytes: u64,
    /// Simulated time of the first and of the last [ns].
    pub times: Option<(u64, u64)>,
    /// Wall clock of the first and of the last [ns since 1970].
    pub published: Option<(u64, u64)>,
    /// Messages that are missing between those that are there, by their numbers.
    pub missing: u64,
    next: Option<u32>,
}

impl ChannelSurvey {
    fn add(&mut self, message: &RawMessage) {
        self.messages += 1;
        self.bytes += message.data.len() as u64;
        let expected = self.next.unwrap_or(message.sequence);
        // Numbers may come round after 32 bits. One that goes back is another writer's, not a gap.
        let ahead = message.sequence.wrapping_sub(expected);
        if ahead < u32::MAX / 2 {
            self.missing += u64::from(ahead);
        }
        self.next = Some(message.sequence.wrapping_add(1));
        self.times = extended(self.times, message.log_time);
        self.published = extended(self.published, message.publish_time);
    }
}

fn extended(span: Option<(u64, u64)>, time: u64) -> Option<(u64, u64)> {
    let (first, last) = span.unwrap_or((time, time));
    Some((first.min(time), last.max(time)))
}

impl Survey {
    /// Reads `path`.
    ///
    /// # Errors
    /// Those of [`RawReader`].
    pub fn of(path: &Path) -> Result<Self, ReadError> {
        let mut reader = RawReader::open(path)?;
        let mut survey = Self {
            path: path.to_owned(),
            bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
            metadata: Vec::new(),
            attachments: Vec::new(),
            channels: BTreeMap::new(),
            ending: Ending::Complete,
        };
        for entry in reader.by_ref() {
            match entry? {
                RawEntry::Metadata { name, values } => survey.metadata.push((name, values)),
                RawEntry::Attachment {
                    name,
                    media_type,
                    data,
                    ..
                } => survey
                    .attachments
                    .push((name, media_type, data.len() as u64)),
                RawEntry::Channel(channel) => {
                    let known = survey.channels.entry(channel.topic.clone()).or_default();
                    known.schema.clone_from(&channel.schema.name);
                }
                RawEntry::Message(message) => survey
                    .channels
                    .entry(message.channel.topic.clone())
                    .or_default()
                    .add(&message),
            }
        }
        if let Some(ending) = reader.ending() {
            survey.ending = ending.clone();
        }
        Ok(survey)
    }

    /// The last metadata record of that name.
    #[must_use]
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        let mut records = self.metadata.iter().rev();
        records
            .find(|(own, _)| own == name)
            .map(|(_, values)| values)
    }

    /// All messages.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.channels.values().map(|c| c.messages).sum()
    }

    /// Simulated time of the first and of the last message [ns].
    #[must_use]
    pub fn times(&self) -> Option<(u64, u64)> {
        span(self.channels.values().filter_map(|c| c.times))
    }

    /// Wall clock of the first and of the last message [ns since 1970].
    #[must_use]
    pub fn published(&self) -> Option<(u64, u64)> {
        span(self.channels.values().filter_map(|c| c.published))
    }
}

fn span(spans: impl Iterator<Item = (u64, u64)>) -> Option<(u64, u64)> {
    spans.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))
}
