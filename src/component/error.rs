//! What can go wrong at the interface, and how errors are told. Every message says what was found, what is
//! allowed and what to do.

use super::Mode;

/// Errors of the component.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The scene could not be built.
    #[error("cannot build scene: {0}")]
    Setup(String),
    /// A call in the wrong mode.
    #[error("{call} is not allowed in mode {mode:?}; allowed in {allowed}{}", remedy(*mode))]
    NotAllowedNow {
        /// The call, with the variable if it is about one.
        call: String,
        /// The mode it came in.
        mode: Mode,
        /// Modes in which it is allowed.
        allowed: String,
    },
    /// An argument out of its range.
    #[error("{call}: {what}: found {found}, allowed {allowed}{}", then(remedy))]
    BadArgument {
        /// The call.
        call: &'static str,
        /// Which argument or variable.
        what: String,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
        /// What to do, where what is allowed does not say it; empty elsewhere.
        remedy: String,
    },
    /// The solver gave up: names particle, time and quantity.
    #[error("step failed: {0}")]
    Solver(String),
    /// Saved bytes that cannot be used.
    #[error("saved state refused: {0}")]
    Snapshot(String),
}

/// What to do, as the end of a sentence.
fn then(remedy: &str) -> String {
    match remedy {
        "" => String::new(),
        remedy => format!("; {remedy}"),
    }
}

/// How calls become possible again after a failed step; elsewhere the modes in which they are say it.
fn remedy(mode: Mode) -> &'static str {
    match mode {
        Mode::Failed => "; a step has failed: restore a saved state or reset",
        _ => "",
    }
}

impl Error {
    /// With the variable that a call in the wrong mode was about.
    pub(super) fn about(mut self, variable: &str) -> Self {
        if let Self::NotAllowedNow { call, .. } = &mut self {
            *call = format!("{call} ({variable})");
        }
        self
    }
}
