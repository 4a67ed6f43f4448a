//! What runs cost: the solver's sweeps and whole scenes timed, stored with the machine, and docs/performance.md.
//!
//! [`speed`] asks where the time goes: [`kernels`] times sweeps alone against their plain forms and a [`roofline`],
//! [`scenes`] whole components. A [`SpeedRun`] keeps all of it; [`page`] says what was asked and what came out.
//!
//! [`precision`] asks what accuracy costs: error against CPU time, and docs/precision.md.
//!
//! [`phases`] asks what several phases cost a scene without them, and docs/phases.md.
//!
//! [`units`] times each part of a step and of what surrounds it, so that two commits can be compared.
//!
//! It prints nothing: `cli` shows progress. Times are CPU times wherever they can be, medians of repetitions, and what is
//! compared is timed in turns, so that others on the machine disturb both alike.

pub mod clock;
pub mod kernels;
pub mod machine;
pub mod page;
pub mod phases;
pub mod precision;
pub mod roofline;
pub mod scenes;
pub mod speed;
pub mod units;

pub use machine::Machine;
pub use speed::{Choices, SpeedRun};

use std::path::{Path, PathBuf};

/// What can go wrong while something is timed or kept.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A scene was refused or a step failed: nothing that a user typed, so a defect.
    #[error("bench scene {scene}: {why}")]
    Scene {
        /// The scene.
        scene: String,
        /// What it said.
        why: String,
    },
    /// A file could not be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// What was tried, as a verb phrase.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A stored run that this program cannot read.
    #[error("{} is no stored run of this program: {why}; run `sandgate bench` anew", path.display())]
    Stored {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Writes a run to a file; folders are made.
///
/// # Errors
/// [`Error::File`].
pub fn store<T: serde::Serialize>(path: &Path, run: &T) -> Result<(), Error> {
    let failed = |action| {
        move |source| Error::File {
            action,
            path: path.to_path_buf(),
            source,
        }
    };
    let mut text = serde_json::to_string_pretty(run).map_err(|e| failed("encode")(e.into()))?;
    text.push('\n');
    write(path, &text)
}

/// Reads a stored run.
///
/// # Errors
/// [`Error::File`], [`Error::Stored`].
pub fn stored<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Error> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::File {
        action: "read",
        path: path.to_path_buf(),
        source,
    })?;
    serde_json::from_str(&text).map_err(|why| Error::Stored {
        path: path.to_path_buf(),
        why: why.to_string(),
    })
}

/// Writes a text to a file; folders are made.
///
/// # Errors
/// [`Error::File`].
pub fn write(path: &Path, text: &str) -> Result<(), Error> {
    let failed = |source| Error::File {
        action: "write",
        path: path.to_path_buf(),
        source,
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    crate::whole_file::replace(path, text.as_bytes()).map_err(failed)
}
