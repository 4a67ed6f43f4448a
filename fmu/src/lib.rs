//! Sandgate's shared library: FMI 2.0 and FMI 3.0 for co-simulation, and the plain C interface `sandgate_*`.
//!
//! Each exported function guards its arguments, makes one call on the component and turns the answer into a status.
//! Physics, lifecycle and variables live in the package `sandgate`; everything that needs `unsafe` lives in `guard`.
#![allow(non_snake_case, reason = "the standards name the functions")]

mod access;
mod asked;
mod capi;
#[cfg(test)]
mod contract;
mod fault;
mod fmi2;
mod fmi3;
mod guard;
mod instance;
#[cfg(feature = "record")]
mod journal;
#[cfg(not(feature = "record"))]
#[path = "no_journal.rs"]
mod journal;
mod log;
mod updates;
