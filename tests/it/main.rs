//! All integration tests of the package in one binary: one link instead of one for each file.

mod contract;
mod python;
#[path = "../contract/mod.rs"]
mod suite;
mod variables;
