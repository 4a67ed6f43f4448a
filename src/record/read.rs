//! Reads a log back and says what its messages mean. A log that was cut short reads up to its cut;
//! [`LogReader::ending`] says so afterwards.

use super::ending::Ending;
use super::error::ReadError;
use super::raw::{RawEntry, RawMessage, RawReader};
use crate::wire::Described;
use crate::wire::foxglove::{FrameTransform, Log, PointCloud, SceneUpdate};
use crate::wire::messages::{Applied, Command, Gauge, StepStats};
use prost::Message;
use std::collections::BTreeMap;
use std::path::Path;

/// One thing that stands in a log.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A metadata record: "run", "segment" or "end".
    Metadata {
        /// Its name.
        name: String,
        /// What it says.
        values: BTreeMap<String, String>,
    },
    /// A file within the log: `scene.toml`, `start.state`, ...
    Attachment {
        /// Its name.
        name: String,
        /// Its type.
        media_type: String,
        /// Its bytes.
        data: Vec<u8>,
    },
    /// A message.
    Message {
        /// Topic, which is the Zenoh key.
        topic: String,
        /// Number on its channel.
        sequence: u32,
        /// Simulated time [ns].
        log_time: u64,
        /// What it says.
        body: Body,
    },
}

/// A message by its schema.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// An output.
    Gauge(Gauge),
    /// What drove the component.
    Applied(Applied),
    /// A call or its reply.
    Command(Command),
    /// Figures of a step, with the account of mass.
    Stats(StepStats),
    /// A line for people.
    Log(Log),
    /// Particles.
    Particles(PointCloud),
    /// Walls and gates.
    Scene(SceneUpdate),
    /// Where a gate's frame is.
    Frame(FrameTransform),
    /// A schema of another program or version, undecoded.
    Other {
        /// Name of the schema, empty if it has none.
        schema: String,
        /// The bytes.
        data: Vec<u8>,
    },
}

/// Iterates over a log. Ends at the end or at a cut; see [`LogReader::ending`].
pub struct LogReader {
    raw: RawReader,
}

impl LogReader {
    /// Opens a log.
    ///
    /// # Errors
    /// [`ReadError::Io`]; [`ReadError::NotALog`] if it does not begin like one.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Ok(Self {
            raw: RawReader::open(path)?,
        })
    }

    /// How the log ends; None before all entries have been read.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.raw.ending()
    }
}

impl Iterator for LogReader {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            return Some(match self.raw.next()? {
                Err(error) => Err(error),
                Ok(RawEntry::Channel(_)) => continue,
                Ok(RawEntry::Metadata { name, values }) => Ok(Entry::Metadata { name, values }),
                Ok(RawEntry::Attachment {
                    name,
                    media_type,
                    data,
                    ..
                }) => Ok(Entry::Attachment {
                    name,
                    media_type,
                    data,
                }),
                Ok(RawEntry::Message(message)) => {
                    decode(self.raw.path(), &message).map(|body| Entry::Message {
                        topic: message.channel.topic.clone(),
                        sequence: message.sequence,
                        log_time: message.log_time,
                        body,
                    })
                }
            });
        }
    }
}

/// What a message says.
///
/// # Errors
/// [`ReadError::Message`] if it is not what its channel says.
pub(super) fn decode(path: &Path, message: &RawMessage) -> Result<Body, ReadError> {
    let schema = message.channel.schema.name.as_str();
    body(schema, &message.data).map_err(|error| ReadError::Message {
        path: path.to_owned(),
        topic: message.channel.topic.clone(),
        sequence: message.sequence,
        schema: schema.to_owned(),
        why: error.to_string(),
    })
}

fn body(schema: &str, data: &[u8]) -> Result<Body, prost::DecodeError> {
    Ok(match schema {
        Gauge::FULL_NAME => Body::Gauge(Gauge::decode(data)?),
        Applied::FULL_NAME => Body::Applied(Applied::decode(data)?),
        Command::FULL_NAME => Body::Command(Command::decode(data)?),
        StepStats::FULL_NAME => Body::Stats(StepStats::decode(data)?),
        Log::FULL_NAME => Body::Log(Log::decode(data)?),
        PointCloud::FULL_NAME => Body::Particles(PointCloud::decode(data)?),
        SceneUpdate::FULL_NAME => Body::Scene(SceneUpdate::decode(data)?),
        FrameTransform::FULL_NAME => Body::Frame(FrameTransform::decode(data)?),
        other => Body::Other {
            schema: other.to_owned(),
            data: data.to_vec(),
        },
    })
}
