//! The vocabulary of the wire, shared by log files (`record`) and Zenoh (`bus`): protobuf messages with their
//! schemas, keys, and the observer through which one adapter may listen to another.
//!
//! Data flow: a [`Component`](crate::component::Component) and the table of its variables go in, messages come out;
//! `record` writes them to files, `bus` publishes them. Nothing here opens a file, a socket or a clock.

#[macro_use]
mod describe;
pub mod convert;
pub mod foxglove;
pub mod json;
pub mod keys;
pub mod messages;
mod observer;
mod pending;
pub mod picture;
mod viewed;

pub use describe::{Described, DescribedEnum, Field, schema};
pub use observer::{Both, Observer, Unobserved};
pub use pending::{Moment, Pending};
