//! All integration tests of the package in one binary: one link instead of one for each file.

#![allow(
    clippy::unwrap_used,
    reason = "in a test, a failed unwrap is a failed test"
)]

mod architecture;
#[cfg(feature = "cli")]
mod bench;
#[cfg(all(feature = "bus", feature = "cli"))]
mod bus;
#[cfg(feature = "cli")]
mod cli;
mod component;
mod contract;
#[cfg(feature = "cli")]
mod cross;
#[cfg(feature = "cli")]
mod drivers;
mod faults;
mod fmi_page;
#[cfg(feature = "cli")]
mod fmu;
#[cfg(all(feature = "record", feature = "cli"))]
mod full_disk;
mod gauges;
#[cfg(feature = "record")]
mod host_process;
mod licenses;
#[cfg(all(feature = "record", feature = "cli"))]
mod logs;
mod physics;
mod python;
#[cfg(all(feature = "record", feature = "cli"))]
mod record;
#[cfg(feature = "cli")]
mod report;
mod scenes;
mod shared_library;
mod states;
#[cfg(feature = "cli")]
mod stress;
#[path = "../contract/mod.rs"]
mod suite;
#[cfg(feature = "cli")]
mod validate;
mod variables;
