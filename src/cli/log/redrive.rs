//! `sandgate log redrive FILE`: the run again, compared bit for bit.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::cli::{CliError, quantity, say, threads};
use crate::record::{Ending, RedriveOptions, Redriven, redrive};

/// What may be typed after `sandgate log redrive`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// Log files; each is run from its own start
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// End with exit code 7 if anything differs
    #[arg(long)]
    check: bool,
    /// Log the new run to this file, which must not exist
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Particle snapshots in that log every so much simulated time [default: the scene's]
    #[arg(long, value_name = "TIME", value_parser = quantity::positive_time, allow_hyphen_values = true, requires = "log")]
    particles_every: Option<f64>,
    /// Threads to compute with; 0 means all cores; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads::parser())]
    threads: u16,
}

const AFTER_HELP: &str = "\
The scene (and the state, if the file starts from one) is taken from the log itself. Inputs are set and steps are made
with the bits that were recorded; then every output, figure, frame and snapshot is compared, and at the end the hash of
the state. Another processor may compute other bits where it adds or multiplies otherwise: compare on the same kind.";

/// Carries out `sandgate log redrive`.
///
/// # Errors
/// [`CliError::Redrive`] for files that cannot be run, after all others were; with `--check` [`CliError::Differs`], and [`CliError::Content`] if there is nothing to compare.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    if args.log.is_some() && args.files.len() > 1 {
        return Err(CliError::Usage(
            "--log takes the run of one file; found several, give one".to_owned(),
        ));
    }
    let options = RedriveOptions {
        threads: usize::from(args.threads),
        log: args.log.clone(),
        particles_every: args.particles_every,
    };
    let (mut different, mut said) = (Vec::new(), Ok(()));
    let (mut empty, mut refused) = (None, None::<CliError>);
    for file in &args.files {
        let mut told = Instant::now();
        let done = redrive(file, &options, &mut |time| {
            if told.elapsed() > Duration::from_secs(5) {
                told = Instant::now();
                tell!("{}  t = {time:.3} s", file.display());
            }
        });
        let done = match done {
            Ok(done) => done,
            Err(error) => {
                // The last one is told by who gets it.
                if let Some(earlier) = refused.replace(error.into()) {
                    tell!("{earlier}");
                }
                continue;
            }
        };
        let line = verdict(file, &done);
        if !done.has_compared() {
            empty.get_or_insert(file);
        }
        if !done.is_same() && args.check {
            different.push(line);
        } else {
            said = said.and(say(&line));
        }
    }
    if !different.is_empty() {
        if let Some(error) = refused {
            tell!("{error}");
        }
        return Err(CliError::Differs(different.join("\n")));
    }
    match (refused, empty) {
        (Some(error), _) => Err(error),
        (None, Some(file)) if args.check => Err(CliError::Content {
            path: file.clone(),
            problem: "nothing to compare: it holds no output, figure, frame or state hash"
                .to_owned(),
            remedy: "see what it holds with `sandgate log info`, and give a log that goes on",
        }),
        _ => said,
    }
}

fn verdict(file: &Path, done: &Redriven) -> String {
    let file = file.display();
    let Redriven {
        steps,
        inputs,
        compared,
        restored,
        ..
    } = done;
    if let Some(difference) = &done.difference {
        let version = if done.version == env!("CARGO_PKG_VERSION") {
            String::new()
        } else {
            format!(
                "; the log is of version {}, this is {}",
                done.version,
                env!("CARGO_PKG_VERSION")
            )
        };
        return format!("{file}: DIFFERS first at {difference}{version}");
    }
    let back = match restored {
        0 => String::new(),
        times => format!(", {times} times back to a saved state"),
    };
    let did = format!("{steps} steps with {inputs} inputs{back}, {compared} messages");
    if done.same_state == Some(false) {
        return format!("{file}: DIFFERS: {did} are equal, but the state at the end is another");
    }
    let state = match done.same_state {
        Some(_) => ", and the state at the end",
        None => "",
    };
    match &done.ending {
        _ if !done.has_compared() => format!("{file}: nothing to compare: {did}"),
        Ending::Complete => format!("{file}: same bits: {did}{state}"),
        Ending::Cut { damaged: false, .. } => {
            format!("{file}: same bits up to its cut: {did}; {}", done.ending)
        }
        Ending::Cut { .. } | Ending::Followed { .. } => format!(
            "{file}: DIFFERS: equal are {did}{state}, but it is {}",
            done.ending
        ),
    }
}
