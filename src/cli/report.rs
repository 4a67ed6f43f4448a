//! `sandgate report FILE`: a log as one page for a browser.

use std::path::{Path, PathBuf};

use super::{CliError, log, say};
use crate::report::report;
use crate::whole_file;

/// What may be typed after `sandgate report`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// A log file, also one that was cut
    file: PathBuf,
    /// The page to write; replaced if it is there
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
    /// Most megabytes that particles may take in the page; beyond that snapshots are left out evenly
    #[arg(long, value_name = "MB", default_value_t = 24, value_parser = clap::value_parser!(u16).range(1..))]
    particles_mb: u16,
}

/// Carries out `sandgate report`.
///
/// # Errors
/// [`CliError::Report`], [`CliError::File`]; [`CliError::Usage`] if the page would replace the log. A cut is told on
/// standard error and is no error.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    if real(&args.output).is_some_and(|output| real(&args.file) == Some(output)) {
        return Err(CliError::Usage(format!(
            "--output {} is the log itself, which is not overwritten; give another file",
            args.output.display()
        )));
    }
    let page = report(&args.file, usize::from(args.particles_mb) * 1_000_000)?;
    whole_file::replace(&args.output, page.html.as_bytes()).map_err(|source| CliError::File {
        action: "write",
        path: args.output.clone(),
        source,
        remedy: "choose a folder that can be written with --output",
    })?;
    say(&format!(
        "{}: {:.1} MB, {} communication points, {} of {} snapshots; open it in a browser",
        args.output.display(),
        page.html.len() as f64 * 1e-6,
        page.rows,
        page.snapshots,
        page.snapshots_in_log
    ))?;
    log::warn_unless_complete(&args.file, &page.ending);
    Ok(())
}
