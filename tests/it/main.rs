//! All integration tests of the package in one binary: one link instead of one for each file.

mod python;
mod variables;
