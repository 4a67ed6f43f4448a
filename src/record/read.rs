//! Reads a log back, from start to end, in bounded memory. A log that was cut short (a killed process, a full disk)
//! reads up to its cut; [`LogReader::ending`] says so afterwards.

use super::error::ReadError;
use crate::wire::Described;
use crate::wire::foxglove::{FrameTransform, Log, PointCloud, SceneUpdate};
use crate::wire::messages::{Applied, Command, Gauge, StepStats};
use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use prost::Message;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

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

/// How a log ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// With summary and magic bytes: the writer finished it.
    Complete,
    /// Short of that.
    Cut {
        /// Bytes of the file that were used.
        byte: u64,
        /// Simulated time of the last message before the cut, if there is one [ns].
        last: Option<u64>,
        /// What the reader met there.
        why: String,
    },
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Ending::Complete => write!(f, "complete"),
            Ending::Cut { byte, last, why } => {
                write!(f, "cut short near byte {byte} ({why})")?;
                if let Some(last) = last {
                    write!(f, ", last message at {} s", *last as f64 * 1e-9)?;
                }
                write!(
                    f,
                    ": the writer was stopped or its disk was full; all before the cut was read"
                )
            }
        }
    }
}

/// Iterates over a log. Ends at the end or at a cut; see [`LogReader::ending`].
pub struct LogReader {
    path: PathBuf,
    source: BufReader<File>,
    reader: LinearReader,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, (String, u16)>,
    bytes: u64,
    last: Option<u64>,
    in_summary: bool,
    ending: Option<Ending>,
}

impl LogReader {
    /// Opens a log.
    ///
    /// # Errors
    /// [`ReadError::Io`]; [`ReadError::NotALog`] if it does not begin like one.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let io = |source| ReadError::Io {
            path: path.to_owned(),
            source,
        };
        let file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        let mut source = BufReader::with_capacity(1 << 16, file);
        let mut magic = Vec::new();
        let expected = mcap::MAGIC;
        (&mut source)
            .take(expected.len() as u64)
            .read_to_end(&mut magic)
            .map_err(io)?;
        if magic != expected {
            return Err(ReadError::NotALog {
                path: path.to_owned(),
            });
        }
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_validate_chunk_crcs(true)
            // A damaged length must not ask for more memory than the file has bytes.
            .with_record_length_limit(usize::try_from(size).unwrap_or(usize::MAX));
        Ok(Self {
            path: path.to_owned(),
            source,
            reader: LinearReader::new_with_options(options),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            bytes: expected.len() as u64,
            last: None,
            in_summary: false,
            ending: None,
        })
    }

    /// How the log ends; None before all entries have been read.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    fn cut(&mut self, why: &McapError) {
        self.ending = Some(Ending::Cut {
            byte: self.bytes,
            last: self.last,
            why: match why {
                McapError::UnexpectedEof => "the file ends within a record".to_owned(),
                other => other.to_string(),
            },
        });
    }

    /// The next entry; None at the end.
    fn advance(&mut self) -> Result<Option<Entry>, ReadError> {
        while self.ending.is_none() {
            let record = match self.reader.next_event() {
                None => {
                    self.ending = Some(Ending::Complete);
                    break;
                }
                Some(Err(error)) => {
                    self.cut(&error);
                    break;
                }
                Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                    let read = self.source.read(self.reader.insert(need));
                    let read = read.map_err(|source| ReadError::Io {
                        path: self.path.clone(),
                        source,
                    })?;
                    self.reader.notify_read(read);
                    self.bytes += read as u64;
                    continue;
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    mcap::parse_record(opcode, data).map(Record::into_owned)
                }
            };
            match record {
                Err(error) => self.cut(&error),
                Ok(record) => {
                    if let Some(entry) = self.entry(record)? {
                        return Ok(Some(entry));
                    }
                }
            }
        }
        Ok(None)
    }

    fn entry(&mut self, record: Record<'static>) -> Result<Option<Entry>, ReadError> {
        match record {
            // What follows repeats what was read.
            Record::DataEnd(_) => self.in_summary = true,
            _ if self.in_summary => {}
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                self.channels
                    .insert(channel.id, (channel.topic, channel.schema_id));
            }
            Record::Metadata(metadata) => {
                return Ok(Some(Entry::Metadata {
                    name: metadata.name,
                    values: metadata.metadata,
                }));
            }
            Record::Attachment { header, data, .. } => {
                return Ok(Some(Entry::Attachment {
                    name: header.name,
                    media_type: header.media_type,
                    data: data.into_owned(),
                }));
            }
            Record::Message { header, data } => {
                let Some((topic, schema)) = self.channels.get(&header.channel_id) else {
                    self.cut(&McapError::UnknownChannel(
                        header.sequence,
                        header.channel_id,
                    ));
                    return Ok(None);
                };
                let schema = self.schemas.get(schema).map_or("", String::as_str);
                let body = decode(schema, &data).map_err(|error| ReadError::Message {
                    path: self.path.clone(),
                    topic: topic.clone(),
                    sequence: header.sequence,
                    schema: schema.to_owned(),
                    why: error.to_string(),
                })?;
                self.last = Some(header.log_time);
                return Ok(Some(Entry::Message {
                    topic: topic.clone(),
                    sequence: header.sequence,
                    log_time: header.log_time,
                    body,
                }));
            }
            _ => {}
        }
        Ok(None)
    }
}

impl Iterator for LogReader {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}

fn decode(schema: &str, data: &[u8]) -> Result<Body, prost::DecodeError> {
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
