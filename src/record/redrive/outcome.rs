//! What comes of running a log again: the [`Redriven`] summary, the first [`Difference`], and why no run was made.

use crate::component;
use crate::record::RecordError;
use crate::record::ending::Ending;
use crate::record::error::ReadError;
use crate::scene;
use std::path::PathBuf;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Redriven {
    /// Steps done.
    pub steps: u64,
    /// Inputs set.
    pub inputs: u64,
    /// How often it went back to a state that had been saved.
    pub restored: u64,
    /// Messages compared.
    pub compared: u64,
    /// The first difference, at which the run stopped.
    pub difference: Option<Difference>,
    /// Whether the final state has the hash that the log says; none if it says none.
    pub same_state: Option<bool>,
    /// How the log ends.
    pub ending: Ending,
    /// Version that wrote the log.
    pub version: String,
}

impl Redriven {
    /// Whether the log held anything to compare.
    #[must_use]
    pub fn has_compared(&self) -> bool {
        self.compared > 0 || self.same_state.is_some() || self.difference.is_some()
    }

    /// Whether nothing differs and no byte of the log was changed or added. True also for a log that was cut short, as far as it
    /// goes; [`Redriven::ending`] tells.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.difference.is_none()
            && self.same_state != Some(false)
            && !matches!(
                self.ending,
                Ending::Cut { damaged: true, .. } | Ending::Followed { .. }
            )
    }
}

/// Where a run first differs from its log.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Communication step.
    pub step: u64,
    /// Simulated time [s].
    pub time: f64,
    /// Variable, or figure of the solver.
    pub variable: String,
    /// What the log says and what was computed.
    pub what: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "step {} at t = {} s: {}: {}",
            self.step, self.time, self.variable, self.what
        )
    }
}

/// Errors of [`redrive`]: the run could not be made. That it differs is not an error but a result.
#[derive(Debug, thiserror::Error)]
pub enum RedriveError {
    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The log does not carry what a run needs.
    #[error(
        "log {path}: {problem}; only logs of sandgate run, serve and log redrive, of FMUs and of the C library can be run again"
    )]
    Missing {
        /// The file.
        path: PathBuf,
        /// What is missing.
        problem: String,
    },
    /// The scene within the log is refused by this version.
    #[error("the scene within the log is refused by this version: {0}")]
    Scene(#[from] scene::SceneErrors),
    /// The component cannot be built or restored.
    #[error("cannot build what the log starts from: {0}")]
    Component(#[from] component::Error),
    /// The log of the new run cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
}
