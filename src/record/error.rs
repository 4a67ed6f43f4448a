//! What can go wrong with log files. Every message says what was found and what to do.

use super::ending::Ending;
use crate::component;
use crate::wire::keys::BadInstance;
use std::io::ErrorKind;
use std::path::PathBuf;

/// Errors of writing a log.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// A log or an unfinished log has that name.
    #[error(
        "log file {path} exists already and is not overwritten; choose another name or move it away"
    )]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A folder has that name.
    #[error("log file: found the folder {path}, allowed the name of a new file, such as {}", path.join("run.mcap").display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// The file cannot be created.
    #[error("cannot create log file {path}: {source}; {}", remedy(.source.kind()))]
    Create {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A log that nothing happened in cannot be taken away.
    #[error("cannot remove {path}: {source}; delete it by hand")]
    Remove {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A write failed, and the run said that its log is required.
    #[error(
        "{0}; the scene requires its log, so the run stops (log.required = false lets it go on)"
    )]
    Required(Failure),
    /// The finished file cannot get its name.
    #[error("log is complete in {part} but cannot be renamed to {path}: {why}; rename it by hand")]
    Rename {
        /// Where it is.
        part: PathBuf,
        /// Where it should be.
        path: PathBuf,
        /// Why it is not.
        why: String,
    },
    /// The instance's name cannot be used in topics.
    #[error(transparent)]
    Instance(#[from] BadInstance),
    /// The component refused to be read.
    #[error("cannot read the component for the log: {0}")]
    Component(#[from] component::Error),
}

/// What to do where a log cannot be created.
fn remedy(why: ErrorKind) -> &'static str {
    match why {
        ErrorKind::NotFound => "make the folder first, or choose one that there is",
        ErrorKind::NotADirectory => "what stands there is a file; choose a folder",
        ErrorKind::InvalidFilename => {
            "choose a shorter name; most file systems allow 255 bytes, .part included"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room or choose another folder",
        _ => "choose a folder that can be written",
    }
}

/// The first write that failed. After it nothing more is written, so that the file is a whole log up to a cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Simulated time of the last message given to the log [s]: when it was noticed.
    pub time: f64,
    /// Simulated time of the last message that is known to be written, if any is [s].
    pub written: Option<f64>,
    /// What the system said.
    pub cause: String,
    /// The file that holds what was written before, if there is one.
    pub file: Option<PathBuf>,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.written {
            Some(written) => write!(
                f,
                "log stopped at simulated time {} s, what is known to be written reaches {written} s: {}",
                self.time, self.cause
            ),
            None => write!(
                f,
                "log stopped at simulated time {} s, before which nothing is known to be written: {}",
                self.time, self.cause
            ),
        }?;
        if let Some(file) = &self.file {
            write!(
                f,
                "; what was written before is in {}, make room and run again for a whole log",
                file.display()
            )?;
        }
        Ok(())
    }
}

/// Logs to give instead of the folder that they are in.
fn one_of(logs: &[PathBuf]) -> String {
    const SHOWN: usize = 5;
    if logs.is_empty() {
        return "a log that a run, an FMU or a component on the bus wrote; there is none in it"
            .to_owned();
    }
    let named: Vec<_> = logs
        .iter()
        .take(SHOWN)
        .map(|l| l.display().to_string())
        .collect();
    let more = match logs.len().saturating_sub(SHOWN) {
        0 => String::new(),
        n => format!(" or one of {n} more"),
    };
    named.join(" or ") + &more
}

/// Errors of reading a log. A log that was cut short is not an error: see [`Ending`](super::Ending).
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("cannot read log {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is a folder, which may hold logs.
    #[error(
        "cannot read log {path}: found a folder, allowed a file; give {}",
        one_of(logs)
    )]
    Folder {
        /// What was given.
        path: PathBuf,
        /// Logs in it, in order of their names.
        logs: Vec<PathBuf>,
    },
    /// It is no file whose end can be looked at first.
    #[error(
        "cannot read log {path}: found a pipe or device, allowed a file, which is read from both ends; write what comes \
         through a pipe to a file first (`cat > run.mcap`) and give that"
    )]
    NotAFile {
        /// What was given.
        path: PathBuf,
    },
    /// The file is something else.
    #[error(
        "{path} is not an MCAP file: {why}; give a log that a run, an FMU or a component on the bus wrote, such as run.mcap"
    )]
    NotALog {
        /// The file.
        path: PathBuf,
        /// What it lacks.
        why: &'static str,
    },
    /// It was cut before what all that follows is read by.
    #[error(
        "log {path} ends before its scene, by which its figures have their names and without which it cannot be run again: {ending}"
    )]
    BeforeScene {
        /// The file.
        path: PathBuf,
        /// How it ends.
        ending: Ending,
    },
    /// Its chunks are compressed; this program writes and reads logs as they are.
    #[error(
        "log {path} is compressed with {with}: viewers open it, these commands read logs that are not compressed; \
         make one of it with `mcap decompress {path} -o FILE`"
    )]
    Compressed {
        /// The file.
        path: PathBuf,
        /// Name of the method: `zstd`, `lz4`.
        with: String,
    },
    /// A message is not what its channel says.
    #[error(
        "log {path}: message {sequence} of {topic} is not a {schema}: {why}; \
         the file is damaged or of another version"
    )]
    Message {
        /// The file.
        path: PathBuf,
        /// Its topic.
        topic: String,
        /// Its number on the channel.
        sequence: u32,
        /// What it should be.
        schema: String,
        /// What the decoder said.
        why: String,
    },
}
