//! Log files: a component's whole traffic as MCAP, readable by Foxglove, Rerun and the `mcap` tools.
//!
//! Data flow: the program (or the bus, through [`Observer`](crate::wire::Observer)) tells a [`Recorder`] what was set,
//! stepped, asked and answered; it reads the outputs from the component and writes messages of
//! [`wire`](crate::wire). [`LogReader`] gives them back, [`check_mass`] proves the account of mass of a file.
//!
//! What it does not do: it never changes a component, opens no network, and does not step anything again.

mod channels;
mod error;
mod file;
mod mass;
mod observe;
mod options;
mod place;
mod preamble;
mod read;
mod sink;
#[cfg(test)]
mod tests;
mod write;

pub use error::{Failure, ReadError, RecordError};
pub use mass::{MassCheck, WrongLine, check_mass};
pub use options::{Finished, RecordOptions};
pub use read::{Body, Ending, Entry, LogReader};
pub use write::Recorder;
