//! The safe half of FMI: from the table of variables to an archive that any FMI importer can load.
//!
//! `description` writes modelDescription.xml, `slot` puts the scene into a copy of the shared library, `pack` makes the
//! archive with its icon and `terminals`, its documentation (`page`, `picture`) and what an importer should get
//! (`reference`); `library` finds (or builds) that shared library, `cross` builds it for other machines. The C interface itself is the package in `fmu/`; no
//! function pointer and no C type is known here.

pub mod capabilities;
pub mod cross;
mod description;
mod error;
pub mod library;
mod pack;
mod page;
mod picture;
mod platform;
mod reference;
pub mod slot;
mod terminals;
mod unit;
mod v2;
mod v3;
mod xml;

pub use description::{description, identifier, token};
pub use error::Error;
pub use pack::{Packed, Packing, pack, pack_with};
pub use platform::Platform;
pub use reference::Extent;

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FmiVersion {
    /// FMI 2.0, co-simulation.
    V2,
    /// FMI 3.0, co-simulation.
    V3,
}

impl FmiVersion {
    /// As `fmiVersion` of modelDescription.xml spells it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::V2 => "2.0",
            Self::V3 => "3.0",
        }
    }
}

/// Categories of log messages and what they hold; the only list. The last one is no category of messages: switching it
/// switches all others, as importers ask for that do not read this list.
pub const LOG_CATEGORIES: [(&str, &str); 4] = [
    (
        "logStatusError",
        "Calls that were refused or failed: what was found, what is allowed, what to do.",
    ),
    (
        "logStatusWarning",
        "Inputs that were clamped to their range because saturate_inputs is true; a log that broke off.",
    ),
    (
        "logEvents",
        "Instantiation, initialisation, reset, restored states, and the internal steps of each communication step.",
    ),
    ("logAll", "All categories."),
];
