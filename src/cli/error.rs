//! What can go wrong in the program, and the exit code of each. Messages say what was found and what to do.

use std::path::{Path, PathBuf};

use crate::bench;
#[cfg(feature = "bus")]
use crate::bus::BusError;
use crate::component;
use crate::fmi;
use crate::record::{ReadError, RecordError, RecoverError, RedriveError, TableError};
use crate::report::ReportError;
use crate::scene::SceneErrors;
use crate::stress;
use crate::validate;

/// The exit codes, as `--help` shows them. [`CliError::exit_code`] is the same table in code.
pub(super) const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a defect of this program: a call that should not have been made was refused
  2    wrong use of the command line
  3    the scene was refused or cannot be built
  4    a step failed; what was computed before it is kept
  5    a file could not be read or written, or a saved state does not fit
  6    the bus could not be opened or closed
  7    a check found a difference
  130  run, validate, bench precision or stress stopped by Ctrl-C, SIGTERM or SIGHUP, after saving; serve and log
       replay, which have no end of their own, end so with 0; other benchmarks keep nothing and end by the signal";

/// Errors of the program.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The arguments contradict each other or what is on disk.
    #[error("error: {0}")]
    Usage(String),
    /// The scene file was refused; lists every problem.
    #[error("{0}")]
    Scene(#[from] SceneErrors),
    /// The component refused a call or a step failed.
    #[error("error: {0}")]
    Component(#[from] component::Error),
    /// The scene of this file could not be built.
    #[error("error: {}: {source}", path.display())]
    Build {
        /// The scene file.
        path: PathBuf,
        /// What stands in the way.
        source: Box<component::Error>,
    },
    /// The FMU could not be packed.
    #[error("error: {0}")]
    Fmu(#[from] fmi::Error),
    /// A validation study could not be run or written.
    #[error("error: {0}")]
    Validate(#[from] validate::Error),
    /// A benchmark could not be run, kept or read.
    #[error("error: {0}")]
    Bench(#[from] bench::Error),
    /// The log cannot be written, and the scene requires it.
    #[error("error: {0}")]
    Log(#[from] RecordError),
    /// A log cannot be read.
    #[error("error: {0}{remedy}", remedy = where_logs_are(.0))]
    Read(#[from] ReadError),
    /// A log cannot be recovered.
    #[error("error: {0}")]
    Recover(#[from] RecoverError),
    /// A log cannot be run again.
    #[error("error: {0}{remedy}", remedy = where_logs_are(.0))]
    Redrive(#[from] RedriveError),
    /// The scalars of a log cannot be read.
    #[error("error: {0}{remedy}", remedy = where_logs_are(.0))]
    Table(#[from] TableError),
    /// A page cannot be made of a log.
    #[error("error: {0}")]
    Report(#[from] ReportError),
    /// What was tried could not be kept.
    #[error("error: {0}")]
    Stress(#[from] stress::Error),
    /// A check found a difference; the text says where.
    #[error("{0}")]
    Differs(String),
    /// The bus could not be opened, or not be closed.
    #[cfg(feature = "bus")]
    #[error("error: {0}")]
    Bus(#[from] BusError),
    /// A file could not be read or written.
    #[error("error: cannot {action} {}: {source}; {remedy}", path.display())]
    File {
        /// What was tried, as a verb phrase.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// What to do.
        remedy: &'static str,
    },
    /// A file is there but does not hold what it should.
    #[error("error: {}: {problem}; {remedy}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// Ctrl-C: everything is saved; the text says how to go on.
    #[error("{0}")]
    Interrupted(String),
    /// Nobody reads our output any more: not an error.
    #[error("the reader of the output has gone")]
    ReaderGone,
}

/// What to do about a log that is not there; nothing if it is.
fn where_logs_are(error: &(dyn std::error::Error + 'static)) -> &'static str {
    let mut causes = std::iter::successors(Some(error), |error| error.source());
    let is_missing = |error: &(dyn std::error::Error + 'static)| {
        let system = error.downcast_ref::<std::io::Error>();
        system.is_some_and(|error| error.kind() == std::io::ErrorKind::NotFound)
    };
    match causes.any(is_missing) {
        true => "; give the path of a log, for example out/silo_gate/run.mcap",
        false => "",
    }
}

impl CliError {
    /// The message as it stands in a warning.
    pub(super) fn as_warning(&self) -> String {
        let text = self.to_string();
        text.strip_prefix("error: ").unwrap_or(&text).to_owned()
    }

    /// The same, with the scene's file where it says that the scene cannot be built.
    pub(super) fn of_scene(self, path: &Path) -> Self {
        match self {
            Self::Component(source @ component::Error::Setup(_))
            | Self::Fmu(fmi::Error::Component(source @ component::Error::Setup(_))) => {
                Self::Build {
                    path: path.to_owned(),
                    source: Box::new(source),
                }
            }
            other => other,
        }
    }

    /// The exit code, 0 to 255.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Scene(_) => 3,
            Self::Component(error) | Self::Fmu(fmi::Error::Component(error)) => {
                error.status().exit_code
            }
            Self::Build { source, .. } => source.status().exit_code,
            Self::Fmu(fmi::Error::SceneTooLong { .. }) => 3,
            Self::Fmu(_) | Self::Validate(validate::Error::File { .. }) => 5,
            Self::Bench(bench::Error::Scene { .. }) => 1,
            Self::Bench(_) => 5,
            Self::Validate(_) => 1,
            Self::Redrive(RedriveError::Scene(_)) | Self::Table(TableError::Scene(_)) => 3,
            Self::Report(ReportError::Table(TableError::Scene(_))) => 3,
            Self::Report(_) => 5,
            Self::Redrive(RedriveError::Component(error)) => error.status().exit_code,
            Self::Log(_) | Self::Read(_) | Self::Recover(_) | Self::Redrive(_) | Self::Table(_) => {
                5
            }
            Self::File { .. } | Self::Content { .. } | Self::Stress(_) => 5,
            Self::Differs(_) => 7,
            Self::Interrupted(_) => 130,
            #[cfg(feature = "bus")]
            Self::Bus(error) => match error {
                BusError::Instance(_) | BusError::Endpoint(_) | BusError::Config { .. } => 2,
                BusError::Component(_) => 3,
                BusError::Zenoh { .. }
                | BusError::LeftOpen { .. }
                | BusError::Taken { .. }
                | BusError::Forked
                | BusError::Thread(_) => 6,
            },
            Self::ReaderGone => 0,
        }
    }
}
