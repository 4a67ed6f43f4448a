//! Validation: runs of the component compared with published data and exact solutions, and pages that say how it went.
//!
//! A [`Study`] is a list of [`Member`]s (scene text, what to record) and an analysis that turns their [`Recording`]s into
//! a [`Report`] of metrics, tables and figures. [`Store`] keeps recordings by a key of scene, plan and sources, so that a
//! finished member is never run twice; [`queue`] runs what is missing on several threads and stops at any time; [`page`]
//! writes docs/validation. The studies themselves are in [`studies`], one a file.
//!
//! It talks to the [`crate::component::Component`] only, as every adapter does, and prints nothing: `cli` shows progress.

pub mod bagnold;
pub mod chart;
pub mod csv;
pub mod member;
pub mod page;
pub mod picture;
pub mod queue;
pub mod recording;
pub mod report;
pub mod statistics;
pub mod store;
pub mod studies;
pub mod study;
pub mod template;
#[cfg(test)]
mod tests;

pub use member::Progress;
pub use recording::{Outcome, Recording, Snapshot};
pub use report::{Figure, Metric, Report, Rule, Table, Verdict};
pub use store::Store;
pub use study::{Effort, Member, Results, Study};

/// Hash of all sources that can change a result, lower-case hexadecimal (made by build.rs).
pub const SOURCES: &str = env!("SANDGATE_SOURCES");

/// What can go wrong while a study is run or written.
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
    /// A template, an edit or a reference file inside the program does not fit: a defect of the study.
    #[error("study {study}, member {member}: {problem}")]
    Defect {
        /// The study.
        study: String,
        /// The member, or what was being made.
        member: String,
        /// What is wrong.
        problem: String,
    },
    /// A figure could not be drawn.
    #[error("figure {name}: {problem}")]
    Figure {
        /// The figure.
        name: String,
        /// What the drawing library said.
        problem: String,
    },
}
