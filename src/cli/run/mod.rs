//! `sandgate run CASE`: the scene's component from start to end, stepped at the scene's communication step with
//! the scene's schedules as inputs.
//!
//! `session` steps, `log` records, `folder` decides where files go, `lock` keeps other runs out of there, `series` writes scalars over time to `table` and keeps a `curve` of each that `plot` draws,
//! `summary` holds the final figures, `progress` shows how far it is. What the component computes does not depend
//! on anything here but communication steps and inputs.

mod columns;
mod curve;
mod ending;
mod folder;
mod lock;
mod log;
mod notes;
mod plot;
mod profile;
mod progress;
mod series;
mod session;
mod summary;
mod table;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::{CliError, load_scene, quantity, stop, tell_if_large, threads};
use crate::component::read_saved;
use session::Session;

pub(super) use summary::{bound_name, short};

/// What may be typed after `sandgate run`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// The scene file, for example cases/silo_gate.toml
    pub(super) case: PathBuf,
    /// End at this simulated time, "2 s" or plain seconds [default: the scene's run.until]
    #[arg(long, value_name = "TIME", value_parser = quantity::positive_time, allow_hyphen_values = true)]
    until: Option<f64>,
    /// Folder for the results [default: out/<case>, or the next free out/<case>-2, -3, ...]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run in the folder given with --out
    #[arg(long, requires = "out")]
    force: bool,
    /// Threads to compute with; 0 means all cores; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads::parser())]
    threads: u16,
    /// Communication step, "10 ms" or plain seconds [default: the scene's run.step]
    #[arg(long, value_name = "TIME", value_parser = quantity::positive_time, allow_hyphen_values = true)]
    step: Option<f64>,
    /// Save checkpoint.state every so much simulated time, also for runs that are killed (it is saved at the end and at
    /// Ctrl-C in any case, and when a step fails as it was before that step)
    #[arg(long, value_name = "TIME", value_parser = quantity::positive_time, allow_hyphen_values = true)]
    checkpoint_every: Option<f64>,
    /// Go on from a saved state; in its folder if a run made that, unless --out names another
    #[arg(long, value_name = "FILE", conflicts_with = "force")]
    resume: Option<PathBuf>,
    /// Write no run.mcap
    #[arg(long)]
    no_log: bool,
}

const AFTER_HELP: &str = "\
The folder then holds:
  run.mcap          everything that went in and out, and particles (Foxglove, Rerun); a resumed run adds run-2.mcap, ...
  gauges.csv        time and all scalar inputs and outputs, a row each communication point, SI, exact decimals
  gauges.svg        gauges, devices and inputs over time, and profiles at some moments
  summary.json      every final figure, extremes, steps, CPU and wall time, mass account, state hash
  checkpoint.state  the state to go on from: the last one, or that before a step that failed

One run at a time writes to a folder: sandgate.lock is locked there until the end.
Ctrl-C finishes the communication step, saves all of these and prints the command to go on with.
A resumed run ends with the same bits as an unbroken one.";

/// Carries out `sandgate run`.
///
/// # Errors
/// [`CliError`]; what was computed before a failed step or Ctrl-C is saved.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let scene = load_scene(&args.case)?;
    let plan = session::Plan {
        until: args.until.unwrap_or(scene.run.until),
        step: args.step.unwrap_or(scene.run.step),
        threads: usize::from(args.threads),
        checkpoint_every: args.checkpoint_every,
        go_on: go_on_command(args),
        log: !args.no_log,
    };
    check_times(&plan, args.step.is_some())?;
    let resume = args.resume.as_deref();
    let continued = match resume.filter(|file| folder::goes_on(file, args.out.as_deref())) {
        Some(file) => Some(folder::Folder::of_checkpoint(file)?),
        None => None,
    };
    let resumed = match &args.resume {
        Some(file) => {
            let read = std::fs::File::open(file).and_then(read_saved);
            Some(read.map_err(|source| CliError::File {
                action: "read saved state",
                path: file.clone(),
                remedy: match source.kind() {
                    ErrorKind::NotFound if folder::holds_checkpoint(file) => {
                        "that folder has a checkpoint.state: give that"
                    }
                    ErrorKind::NotFound if folder::holds_run(file) => {
                        "the run there left none: --checkpoint-every saves them on the way; start it again, with --out and \
                         --force in the same folder"
                    }
                    _ => "give the checkpoint.state of an earlier run",
                },
                source,
            })?)
        }
        None => None,
    };
    let saved = args.resume.as_deref().zip(resumed.as_deref());
    tell_if_large(&scene, &args.case);
    let component =
        session::ready(&scene, saved, &plan).map_err(|error| error.of_scene(&args.case))?;
    // Until now there was nothing to save: a signal ended the program.
    let stop = stop::on_interrupt("stopping after this communication step and saving")?;
    let folder = match (continued, &args.out) {
        (Some(folder), _) => folder,
        (None, Some(path)) => folder::Folder::named(path, args.force)?,
        (None, None) => folder::Folder::next_free(&scene.name)?,
    };
    let mut session = Session::open(plan, component, folder, &args.case)?;
    let outcome = session.advance(&stop);
    session.close(outcome)
}

/// The rules that scene files have for these, since the command line may give others.
fn check_times(plan: &session::Plan, step_given: bool) -> Result<(), CliError> {
    const MOST: f64 = crate::scene::Run::MOST_STEPS;
    let (step, until) = (plan.step, plan.until);
    if step_given && step > until {
        return Err(CliError::Usage(format!(
            "found a communication step of {step} s and an end at {until} s, allowed a step up to the end; give a shorter \
             --step or a later --until"
        )));
    }
    if until / step > MOST {
        return Err(CliError::Usage(format!(
            "found {:.3e} communication steps of {step} s until {until} s, allowed {MOST:.0e}; give a longer --step or an \
             earlier --until",
            until / step
        )));
    }
    Ok(())
}

/// A path as a shell takes it for one word.
fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    if !path.is_empty() && path.chars().all(plain) {
        return path;
    }
    format!("'{}'", path.replace('\'', r"'\''"))
}

/// The command that goes on with this run, without the checkpoint's path.
fn go_on_command(args: &Args) -> String {
    let mut command = format!("sandgate run {}", shell_word(&args.case));
    let mut option = |name: &str, value: Option<f64>| {
        if let Some(value) = value {
            command.push_str(&format!(" {name} {value}"));
        }
    };
    option("--until", args.until);
    option("--step", args.step);
    option("--checkpoint-every", args.checkpoint_every);
    if args.threads > 0 {
        command.push_str(&format!(" --threads {}", args.threads));
    }
    if args.no_log {
        command.push_str(" --no-log");
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_one_word_for_a_shell() {
        let word = |text: &str| shell_word(Path::new(text));
        assert_eq!(
            word("out/silo-2/checkpoint.state"),
            "out/silo-2/checkpoint.state"
        );
        assert_eq!(word("my out/it's.state"), r"'my out/it'\''s.state'");
        assert_eq!(word("$HOME"), "'$HOME'");
    }
}
