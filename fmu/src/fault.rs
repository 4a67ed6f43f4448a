//! Why a call did not do what it was asked, and the numbers that say so in each interface.

use std::fmt;

use sandgate::component::Error;

/// A call that was refused or failed.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The component said no.
    Component(Error),
    /// The arguments or the instance do not allow the call at all.
    Border(String),
    /// FMI 2: a status was asked for that this library does not have.
    NoStatus(String),
    /// The log or the Zenoh session that parameters ask for cannot be opened or written.
    #[cfg_attr(
        not(feature = "record"),
        expect(dead_code, reason = "only logs and Zenoh are outside")
    )]
    Outside(String),
    /// An earlier call broke down in the middle, or this one did: the instance must be reset or given a state.
    Broken(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Component(error) => error.fmt(f),
            Self::Border(text)
            | Self::NoStatus(text)
            | Self::Outside(text)
            | Self::Broken(text) => f.write_str(text),
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Component(error)
    }
}

impl Fault {
    /// As replies in a log call it.
    #[cfg(feature = "record")]
    pub(crate) fn code(&self) -> &'static str {
        match self {
            Self::Component(error) => error.status().reply,
            Self::Border(_) | Self::NoStatus(_) => "bad_request",
            Self::Outside(_) => "outside",
            Self::Broken(_) => "internal",
        }
    }

    /// What the call answers in FMI 2 and FMI 3.
    pub(crate) fn status(&self) -> Status {
        match self {
            Self::NoStatus(_) => Status::Discard,
            _ => Status::Error,
        }
    }

    pub(crate) fn border(text: impl Into<String>) -> Self {
        Self::Border(text.into())
    }
}

/// Status of FMI 2 and FMI 3: the numbers are the same. Warning goes to loggers only, Discard is what FMI 2 asks for where a status
/// cannot be given, and no step answers either: importers take them for failures or repeat the step for ever. Fatal is never
/// given: no memory is corrupt after a caught panic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Status {
    Ok = 0,
    /// For log messages; no call answers it.
    Warning = 1,
    /// Of fmi2GetStatus and its like only.
    Discard = 2,
    Error = 3,
}

impl From<Result<(), Fault>> for Status {
    fn from(result: Result<(), Fault>) -> Self {
        match result {
            Ok(()) => Self::Ok,
            Err(fault) => fault.status(),
        }
    }
}
