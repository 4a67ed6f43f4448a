//! What a component's errors are outside: FMI status, C code, exit code of the program, code of a bus reply. Errors that
//! an adapter has of its own (a file, a pointer, a request that is not JSON) are numbered there.

use super::{Error, Severity};

/// An error as the outside world numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// Whether the component goes on.
    pub severity: Severity,
    /// `fmi2Status` and `fmi3Status`: always 3, Error. Never Warning or Discard: drivers mistake these for other
    /// things; Fatal is for the library's own use.
    pub fmi: i32,
    /// What `sandgate_*` functions return; 0 is success.
    pub c_code: i32,
    /// Exit code of the program.
    pub exit_code: u8,
    /// Code in an error reply on the bus.
    pub reply: &'static str,
}

impl Error {
    /// Its numbers.
    #[must_use]
    pub fn status(&self) -> Status {
        let refused = Severity::Refused;
        let (severity, c_code, exit_code, reply) = match self {
            Error::Setup(_) => (refused, 1, 3, "internal"),
            Error::NotAllowedNow { .. } => (refused, 2, 1, "state"),
            Error::BadArgument { .. } => (refused, 3, 2, "range"),
            Error::Solver(_) => (Severity::Failed, 4, 4, "diverged"),
            Error::Snapshot(_) => (refused, 5, 5, "bad_request"),
        };
        Status {
            severity,
            fmi: 3,
            c_code,
            exit_code,
            reply,
        }
    }

    /// Whether the component goes on after it.
    #[must_use]
    pub fn severity(&self) -> Severity {
        self.status().severity
    }
}
