//! Stress: scenes made at random (with a seed) that try to break the scheme, checks that no run may fail, and a smaller
//! scene of each that fails.
//!
//! [`generate`] makes a [`Case`] of a kind and a seed: the text of a scene and how it is driven. [`run`] steps it through
//! the [`crate::component::Component`], as every adapter does, and holds it against the [`checks`]. [`shrink`] looks for
//! a smaller case that fails the same check, [`campaign`] does many, [`limits`] asks where single settings break, and
//! [`page`] writes docs/stability.md from what was kept.
//!
//! It prints nothing: `cli` shows progress.

mod balance;
pub mod campaign;
pub mod case;
pub mod checks;
mod dice;
mod forces;
pub mod generate;
pub mod limits;
mod others;
pub mod page;
mod refusals;
mod ride;
pub mod run;
pub mod shrink;
pub mod store;
mod walls;
mod witness;

pub use campaign::{Campaign, Tried};
pub use case::{Case, Drive, Expect};
pub use checks::{Check, Failure};
pub use run::{Bounds, Figures, Outcome};

/// What can go wrong beside cases that fail.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// What was tried, as a verb phrase.
        action: &'static str,
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file that is not what it should be.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}
