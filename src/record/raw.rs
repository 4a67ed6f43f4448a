//! Reads an MCAP file from start to end, in bounded memory, and gives what stands in it as it stands there: messages
//! as bytes with their channel. [`LogReader`](super::LogReader) says what they mean.
//!
//! A file that was cut short (a killed process, a full disk) reads up to its cut; [`RawReader::ending`] says so
//! afterwards.

use super::ending::Ending;
use super::error::ReadError;
use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What the messages of a channel are.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Schema {
    /// Full name of the message: `sandgate.Gauge`.
    pub name: String,
    /// How `data` is written: `protobuf`.
    pub encoding: String,
    /// The description: for protobuf a serialised `FileDescriptorSet`.
    pub data: Vec<u8>,
}

/// A channel of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct RawChannel {
    /// Topic, which is the Zenoh key.
    pub topic: String,
    /// How messages are written: `protobuf`.
    pub encoding: String,
    /// What they are; empty if the file does not say.
    pub schema: Arc<Schema>,
    /// Direction, unit, value reference, ...
    pub metadata: BTreeMap<String, String>,
}

/// A message as it stands in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawMessage {
    /// Its channel.
    pub channel: Arc<RawChannel>,
    /// Number on its channel.
    pub sequence: u32,
    /// Simulated time [ns].
    pub log_time: u64,
    /// Wall clock [ns since 1970], or `log_time` in deterministic logs.
    pub publish_time: u64,
    /// The bytes.
    pub data: Vec<u8>,
}

/// One thing that stands in a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RawEntry {
    /// A metadata record.
    Metadata {
        /// Its name.
        name: String,
        /// What it says.
        values: BTreeMap<String, String>,
    },
    /// A file within the log.
    Attachment {
        /// Its name.
        name: String,
        /// Its type.
        media_type: String,
        /// Simulated time [ns].
        log_time: u64,
        /// Its bytes.
        data: Vec<u8>,
    },
    /// A channel, before its first message.
    Channel(Arc<RawChannel>),
    /// A message.
    Message(RawMessage),
}

/// How carefully chunks are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Check {
    /// Messages come as they are read; a wrong checksum is told at the chunk's end.
    AtTheEnd,
    /// No message of a chunk comes before its checksum was found right: a chunk cut short gives none.
    Before,
    /// Not at all: what a cut chunk holds.
    Not,
}

/// Iterates over a log. Ends at the end or at a cut; see [`RawReader::ending`].
pub struct RawReader {
    path: PathBuf,
    size: u64,
    source: BufReader<File>,
    reader: LinearReader,
    schemas: HashMap<u16, Arc<Schema>>,
    channels: HashMap<u16, Arc<RawChannel>>,
    bytes: u64,
    last: Option<u64>,
    in_summary: bool,
    /// Whether the file ends as a finished one does.
    finished: bool,
    ending: Option<Ending>,
}

impl RawReader {
    /// Opens a log.
    ///
    /// # Errors
    /// [`ReadError::Io`]; [`ReadError::NotALog`] if it does not begin like one.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::checking(path, Check::AtTheEnd)
    }

    pub(super) fn checking(path: &Path, check: Check) -> Result<Self, ReadError> {
        let io = |source| ReadError::Io {
            path: path.to_owned(),
            source,
        };
        let file = File::open(path).map_err(io)?;
        let metadata = file.metadata().map_err(io)?;
        if metadata.is_dir() {
            return Err(ReadError::Folder {
                path: path.to_owned(),
                logs: logs_in(path),
            });
        }
        if !metadata.is_file() {
            return Err(ReadError::NotAFile {
                path: path.to_owned(),
            });
        }
        let size = metadata.len();
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
                why: match magic.as_slice() {
                    [] => "it is empty",
                    part if expected.starts_with(part) => {
                        "it ends within the magic bytes that it begins with"
                    }
                    _ => "it does not begin with the magic bytes \\x89MCAP0",
                },
            });
        }
        let mut last = Vec::new();
        if size >= 2 * expected.len() as u64 {
            let back = -(expected.len() as i64);
            source.seek(SeekFrom::End(back)).map_err(io)?;
            source.read_to_end(&mut last).map_err(io)?;
        }
        // Read once more: the checksum of all records begins with the magic bytes.
        source.rewind().map_err(io)?;
        let options = LinearReaderOptions::default()
            .with_validate_data_section_crc(check != Check::Not)
            .with_validate_summary_section_crc(check != Check::Not)
            .with_validate_chunk_crcs(check == Check::AtTheEnd)
            .with_prevalidate_chunk_crcs(check == Check::Before)
            // A damaged length must not ask for more memory than the file has bytes.
            .with_record_length_limit(usize::try_from(size).unwrap_or(usize::MAX));
        Ok(Self {
            path: path.to_owned(),
            size,
            source,
            reader: LinearReader::new_with_options(options),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            bytes: 0,
            last: None,
            in_summary: false,
            finished: last == expected,
            ending: None,
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How the log ends; None before all entries have been read.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// How it was cut, if it was.
    pub(super) fn how_cut(&self) -> Option<Ending> {
        let cut = |ending: &&Ending| matches!(ending, Ending::Cut { .. });
        self.ending.as_ref().filter(cut).cloned()
    }

    fn cut(&mut self, why: &McapError) {
        // Longer than the file: its end is missing or a length was changed. A file that ends as finished ones do lacks
        // nothing.
        let beyond = matches!(
            why,
            McapError::UnexpectedEof
                | McapError::RecordTooLarge { .. }
                | McapError::ChunkTooLarge(_)
        );
        self.ending = Some(Ending::Cut {
            byte: self.bytes,
            last: self.last,
            why: match why {
                _ if beyond && self.finished => "a record does not end where it says".to_owned(),
                _ if beyond => "the file ends within a record".to_owned(),
                other => other.to_string(),
            },
            damaged: self.finished || !beyond,
        });
    }

    /// What comes behind the magic bytes at the end; the reader asks for no byte beyond them.
    fn end(&mut self) -> Result<Ending, ReadError> {
        if self.bytes >= self.size {
            return Ok(Ending::Complete);
        }
        let mut next = Vec::new();
        let expected = mcap::MAGIC;
        (&mut self.source)
            .take(expected.len() as u64)
            .read_to_end(&mut next)
            .map_err(|source| ReadError::Io {
                path: self.path.clone(),
                source,
            })?;
        Ok(Ending::Followed {
            byte: self.bytes,
            more: self.size - self.bytes,
            is_log: next == expected,
            path: self.path.clone(),
        })
    }

    /// The next entry; None at the end.
    fn advance(&mut self) -> Result<Option<RawEntry>, ReadError> {
        while self.ending.is_none() {
            let record = match self.reader.next_event() {
                None => {
                    self.ending = Some(self.end()?);
                    break;
                }
                Some(Err(McapError::UnsupportedCompression(with))) => {
                    // Asked again it has no more to say.
                    self.ending = Some(Ending::Complete);
                    let path = self.path.clone();
                    return Err(ReadError::Compressed { path, with });
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
                    if let Some(entry) = self.entry(record) {
                        return Ok(Some(entry));
                    }
                }
            }
        }
        Ok(None)
    }

    fn entry(&mut self, record: Record<'static>) -> Option<RawEntry> {
        match record {
            // What follows repeats what was read.
            Record::DataEnd(_) => self.in_summary = true,
            _ if self.in_summary => {}
            Record::Schema { header, data } => {
                let schema = Schema {
                    name: header.name,
                    encoding: header.encoding,
                    data: data.into_owned(),
                };
                self.schemas.insert(header.id, schema.into());
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned();
                let known = Arc::new(RawChannel {
                    topic: channel.topic,
                    encoding: channel.message_encoding,
                    schema: schema.unwrap_or_default(),
                    metadata: channel.metadata,
                });
                let old = self.channels.insert(channel.id, known.clone());
                // Each chunk may say again which channels it has.
                return (old.as_ref() != Some(&known)).then_some(RawEntry::Channel(known));
            }
            Record::Metadata(metadata) => {
                return Some(RawEntry::Metadata {
                    name: metadata.name,
                    values: metadata.metadata,
                });
            }
            Record::Attachment { header, data, .. } => {
                return Some(RawEntry::Attachment {
                    name: header.name,
                    media_type: header.media_type,
                    log_time: header.log_time,
                    data: data.into_owned(),
                });
            }
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(&header.channel_id) else {
                    self.cut(&McapError::UnknownChannel(
                        header.sequence,
                        header.channel_id,
                    ));
                    return None;
                };
                self.last = Some(header.log_time);
                return Some(RawEntry::Message(RawMessage {
                    channel: channel.clone(),
                    sequence: header.sequence,
                    log_time: header.log_time,
                    publish_time: header.publish_time,
                    data: data.into_owned(),
                }));
            }
            _ => {}
        }
        None
    }
}

/// Logs in a folder, finished or not, in order of their names; none if it cannot be looked into.
fn logs_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_log = |path: &PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".mcap") || name.ends_with(".mcap.part")
    };
    let mut logs: Vec<_> = entries.map(|e| e.path()).filter(is_log).collect();
    logs.sort();
    logs
}

impl Iterator for RawReader {
    type Item = Result<RawEntry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
