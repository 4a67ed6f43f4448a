//! Log files: a component's whole traffic as MCAP, readable by Foxglove, Rerun and the `mcap` tools.
//!
//! Data flow: the program (or the bus, through [`Observer`](crate::wire::Observer)) tells a [`Recorder`] what was set,
//! stepped, asked and answered; it reads the outputs from the component and writes messages of
//! [`wire`](crate::wire). [`LogReader`] gives them back, [`check_mass`] proves the account of mass of a file.
//! [`Survey`] says what is in a file, [`Standing`] what of it was not taken back, [`Table`] puts its scalars side by side, [`recover`](recover()) makes a valid file
//! of one that was cut, and [`redrive`](redrive()) runs a file again and compares every bit.
//!
//! What it does not do: recording never changes a component, and nothing here opens a network.

mod channels;
mod compare;
mod ending;
mod error;
mod file;
mod json;
mod mass;
mod observe;
mod options;
mod place;
mod preamble;
mod raw;
mod read;
mod recover;
mod redrive;
mod sink;
mod standing;
mod survey;
mod table;
#[cfg(test)]
mod tests;
mod topics;
mod write;

pub use ending::Ending;
pub use error::{Failure, ReadError, RecordError};
pub use json::JsonReader;
pub use mass::{MassCheck, WrongLine, check_mass};
pub use options::{Finished, RecordOptions};
pub use raw::{RawChannel, RawEntry, RawMessage, RawReader, Schema};
pub use read::{Body, Entry, LogReader};
pub use recover::{RecoverError, Recovered, recover};
pub use redrive::{Difference, RedriveError, RedriveOptions, Redriven, redrive};
pub use standing::Standing;
pub use survey::{ChannelSurvey, Survey};
pub use table::{Column, Table, TableError};
pub use topics::{Topics, below_base};
pub use write::Recorder;
