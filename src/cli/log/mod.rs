//! `sandgate log`: what is in a log, its messages as text, the run again, a valid file from one that was cut, tables and
//! pictures for other programs, and the same messages on Zenoh once more. One verb a file.

mod cat;
mod export;
mod info;
mod parquet;
mod recover;
mod redrive;
#[cfg(feature = "bus")]
mod replay;
mod vtk;

use super::{CliError, quantity};
use crate::record::{Ending, Topics};
use std::path::Path;

/// What may be typed after `sandgate log`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    verb: Verb,
}

/// What can be done with a log.
#[derive(Debug, clap::Subcommand)]
enum Verb {
    /// Say what is in a log: run, times, channels with counts, what is missing, how it ended
    Info(info::Args),
    /// Print messages as text or JSON, by topic and time
    Cat(cat::Args),
    /// Run the scene within a log again with the inputs it recorded, and compare every bit
    Redrive(redrive::Args),
    /// Make a valid log of one that was cut short by a kill or a full disk
    Recover(recover::Args),
    /// Write gauges as CSV or Parquet, particles as VTK for ParaView
    Export(export::Args),
    /// Publish what a log holds on Zenoh again, at a speed or as fast as possible
    #[cfg(feature = "bus")]
    Replay(replay::Args),
}

/// Carries out `sandgate log`.
///
/// # Errors
/// [`CliError`]; [`CliError::Differs`] if `redrive --check` finds a difference.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    match &args.verb {
        Verb::Info(args) => info::run(args),
        Verb::Cat(args) => cat::run(args),
        Verb::Redrive(args) => redrive::run(args),
        Verb::Recover(args) => recover::run(args),
        Verb::Export(args) => export::run(args),
        #[cfg(feature = "bus")]
        Verb::Replay(args) => replay::run(args),
    }
}

/// Tells on standard error that a log is not whole. No error: what is there is of use.
pub(in crate::cli) fn warn_unless_complete(log: &Path, ending: &Ending) {
    if *ending != Ending::Complete {
        tell!("warning: {}: {ending}", log.display());
    }
}

/// Which messages are meant.
#[derive(Debug, clap::Args)]
struct Choice {
    /// Only these topics, whole or behind sandgate/v1/NAME/; * stands for one level, ** for any number; may be repeated
    #[arg(long, value_name = "PATTERN")]
    topic: Vec<String>,
    #[command(flatten)]
    window: Window,
}

/// Which times are meant.
#[derive(Debug, clap::Args)]
struct Window {
    /// Only from this simulated time, "2 s" or plain seconds
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Only to this simulated time
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    until: Option<f64>,
}

impl Window {
    /// First and last time [s].
    fn span(&self) -> (f64, f64) {
        (
            self.from.unwrap_or(f64::NEG_INFINITY),
            self.until.unwrap_or(f64::INFINITY),
        )
    }

    /// Whether a message's time is in the window; times are compared as the whole nanoseconds that logs have.
    fn has(&self, log_time: u64) -> bool {
        let (from, until) = self.span();
        let nanoseconds = |t: f64| (t * 1e9).round();
        (nanoseconds(from)..=nanoseconds(until)).contains(&(log_time as f64))
    }
}

impl Choice {
    fn topics(&self) -> Topics {
        Topics::new(&self.topic)
    }
}
