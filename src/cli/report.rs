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
    if is_of(&args.file, &args.output) {
        return Err(CliError::Usage(format!(
            "--output {} is the log itself or the name it gets when it is finished, which is not overwritten; give \
             another file",
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

/// Whether a page at `output` would be in the place of the log: also one that is called `.part` still.
fn is_of(log: &Path, output: &Path) -> bool {
    let (Some(log), Some(output)) = (real(log), real(output)) else {
        return false;
    };
    let mut unfinished = output.clone().into_os_string();
    unfinished.push(".part");
    log == output || log == Path::new(&unfinished)
}

/// The one way to name a file, also one that is not there yet.
fn real(path: &Path) -> Option<PathBuf> {
    std::fs::canonicalize(path).ok().or_else(|| {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
        let folder = std::fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
        Some(folder.join(path.file_name()?))
    })
}
