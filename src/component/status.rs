//! What a component's errors are outside: C code, exit code of the program, code of a bus reply. In FMI all are Error. Errors that
//! an adapter has of its own (a file, a pointer, a request that is not JSON) are numbered there.

use super::Error;

/// An error as the outside world numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
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
        let (c_code, exit_code, reply) = match self {
            Error::Setup(_) => (1, 3, "internal"),
            Error::NotAllowedNow { .. } => (2, 1, "state"),
            Error::BadArgument { .. } => (3, 2, "range"),
            Error::Solver(_) => (4, 4, "diverged"),
            Error::Snapshot(_) => (5, 5, "bad_request"),
        };
        Status {
            c_code,
            exit_code,
            reply,
        }
    }
}
