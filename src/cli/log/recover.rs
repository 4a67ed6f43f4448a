//! `sandgate log recover IN OUT`: a valid log of one that was cut short.

use std::path::PathBuf;

use crate::cli::{CliError, say};
use crate::record::{Ending, recover};

/// What may be typed after `sandgate log recover`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The log that was cut: run.mcap.part
    from: PathBuf,
    /// The log to make; never overwritten
    to: PathBuf,
}

/// Carries out `sandgate log recover`.
///
/// # Errors
/// [`CliError::Recover`].
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let done = recover(&args.from, &args.to)?;
    let until = done.last.map_or(String::new(), |last| {
        format!(" up to t = {} s", last as f64 / 1e9)
    });
    say(&format!(
        "{}: {}\n{}: {} messages{until}, {} metadata records, {} attachments",
        args.from.display(),
        done.ending,
        args.to.display(),
        done.messages,
        done.metadata,
        done.attachments
    ))?;
    if done.unchecked > 0 {
        say(&format!(
            "{} of the messages are whole but stood in a chunk that was cut, so that no checksum covers them",
            done.unchecked
        ))?;
    }
    if let Ending::Followed { more, .. } = done.ending {
        say(&format!(
            "all of the log is in it; the {more} bytes that follow its end are not"
        ))?;
    }
    if done.ending == Ending::Complete {
        say("there was nothing to recover; it holds all that the first one does")?;
    }
    Ok(())
}
