//! A log as one page for a browser: gauges and inputs over time, account of mass, figures of the solver, validity, and
//! the particles with a time slider. The page holds everything and asks no network.
//!
//! Data flow: [`record`](crate::record) reads the log, `gather` keeps what the page shows but for
//! what was taken back, `shots` knows its snapshots, `pack` makes snapshots small, and this file puts data, style and scripts (`page/`) into one text.
//! Knows no terminal and runs nothing.

mod gather;
mod pack;
mod shots;
#[cfg(test)]
mod tests;

use crate::record::{Ending, ReadError, TableError};
use gather::Gathered;
use std::path::Path;

/// A report, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The page (HTML, UTF-8).
    pub html: String,
    /// Particle snapshots in it.
    pub snapshots: usize,
    /// Particle snapshots in the log but for those of steps that were taken back.
    pub snapshots_in_log: usize,
    /// Communication points in it.
    pub rows: usize,
    /// How the log ends.
    pub ending: Ending,
}

/// Errors of [`report`].
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its scalars cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// The page of a log. Particles take at most about `most_bytes`; beyond that snapshots are left out evenly.
///
/// # Errors
/// [`ReportError`].
pub fn report(log: &Path, most_bytes: usize) -> Result<Report, ReportError> {
    let gathered = Gathered::read(log, most_bytes)?;
    let data = gathered.json();
    let html = include_str!("page/page.html")
        .replace("__STYLE__", include_str!("page/style.css"))
        .replace(
            "__SCRIPT__",
            concat!(
                include_str!("page/charts.js"),
                include_str!("page/player.js"),
                include_str!("page/page.js")
            ),
        )
        // Last, so that nothing in the data is taken for a place to fill. `<` would end the script that holds it.
        .replace("__DATA__", &data.to_string().replace('<', "\\u003c"));
    Ok(Report {
        html,
        snapshots: gathered.snapshots.len(),
        snapshots_in_log: gathered.snapshots_in_log(),
        rows: gathered.rows(),
        ending: gathered.ending().clone(),
    })
}
