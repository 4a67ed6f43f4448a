//! The program `sandgate`: what was typed becomes a plan, the plan is carried out through
//! [`crate::component::Component`] like any other adapter does it.
//!
//! One subcommand a file, each with an `Args` (as typed, clap) and a `run(&Args)`. Printing is allowed here and
//! nowhere else in the library. No physics, no list of variables and no rule about lifecycles lives here.

/// A line on standard error. Where nobody can read it any more it is lost, and what the program does goes on.
macro_rules! tell {
    ($($text:tt)*) => {
        $crate::cli::tell_line(&format!($($text)*))
    };
}

mod bench;
mod clock;
mod error;
mod fmu;
mod info;
mod log;
mod quantity;
mod remarks;
mod report;
mod run;
mod schema;
#[cfg(feature = "bus")]
mod serve;
mod stop;
mod stress;
mod threads;
mod validate;

use std::borrow::Cow;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

pub use error::CliError;

use crate::component::Component;
use crate::scene::Scene;

/// Granular flow (SPH) as a co-simulation component.
#[derive(Debug, Parser)]
#[command(name = "sandgate", version, about, after_help = error::EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// The subcommands; each is one file of this folder.
#[derive(Debug, Subcommand)]
enum Command {
    /// Run a case to its end and leave a log, figures, a table and a picture
    Run(run::Args),
    /// Say what a case holds, what bounds its steps, what a run costs and what it leaves out
    Info(info::Args),
    /// Pack a case into an FMU (FMI 2.0 or 3.0, co-simulation)
    Fmu(fmu::Args),
    /// Serve a case on Zenoh: gauges out, set-points and requests in
    #[cfg(feature = "bus")]
    Serve(serve::Args),
    /// Look into logs, run them again, replay, recover and export them
    Log(log::Args),
    /// Make one page for a browser of a log: gauges, mass, solver, particles
    Report(report::Args),
    /// Compare runs with published data and exact solutions, and write docs/validation
    Validate(validate::Args),
    /// Time the solver and whole scenes, and write docs/performance.md
    Bench(bench::Args),
    /// Try to break the scheme with random scenes, and run kept cases again
    Stress(stress::Args),
    /// Print the JSON Schema of scene files
    Schema(schema::Args),
}

/// Reads the command line, does what it says and returns the exit code (see `sandgate --help`).
#[must_use]
pub fn main() -> ExitCode {
    #[cfg(unix)]
    stop::hear_file_limits();
    let typed = take_negative_values(Cli::command()).try_get_matches();
    let done = match typed.and_then(|typed| Cli::from_arg_matches(&typed)) {
        Ok(cli) => dispatch(&cli.command),
        // Help and version come this way too, on standard output and with exit code 0.
        Err(help) if !help.use_stderr() => help.print().map_err(cannot_print),
        Err(error) => {
            // Nothing can be done if even this cannot be printed.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(CliError::ReaderGone) => ExitCode::SUCCESS,
        Err(error) => {
            tell!("{error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// Has options take numbers below 0, of which each then says what it allows; they would be taken for unknown options.
fn take_negative_values(command: clap::Command) -> clap::Command {
    let with_values = |arg: clap::Arg| {
        let takes = arg.get_action().takes_values() && !arg.is_positional();
        arg.allow_negative_numbers(takes)
    };
    command
        .mut_args(with_values)
        .mut_subcommands(take_negative_values)
}

fn dispatch(command: &Command) -> Result<(), CliError> {
    match command {
        Command::Run(args) => run::run(args),
        Command::Info(args) => info::run(args),
        Command::Fmu(args) => fmu::run(args),
        #[cfg(feature = "bus")]
        Command::Serve(args) => serve::run(args),
        Command::Log(args) => log::run(args),
        Command::Report(args) => report::run(args),
        Command::Validate(args) => validate::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Stress(args) => stress::run(args),
        Command::Schema(args) => schema::run(args),
    }
}

/// Reads and checks a scene file.
///
/// # Errors
/// [`CliError::File`] if there is no readable file, [`CliError::Scene`] with every problem of the scene.
fn load_scene(path: &Path) -> Result<Scene, CliError> {
    std::fs::File::open(path).map_err(|source| CliError::File {
        action: "open scene file",
        path: path.to_path_buf(),
        source,
        remedy: "give the path of a scene file, for example cases/silo_gate.toml",
    })?;
    Ok(crate::scene::load(path)?)
}

/// The component of a scene that was read from `path`.
///
/// # Errors
/// [`CliError::Build`] if it cannot be built.
fn component_of(scene: &Scene, path: &Path) -> Result<Component, CliError> {
    tell_if_large(scene, path);
    Component::new(scene).map_err(|error| CliError::from(error).of_scene(path))
}

/// Says how large a scene is that takes a while to build, before it does.
fn tell_if_large(scene: &Scene, path: &Path) {
    /// Built in a few seconds.
    const SOON: f64 = 5e4;
    let particles = scene.about_particles();
    if particles > SOON {
        tell!(
            "{}: building about {particles:.0} particles (Ctrl-C ends)",
            path.display()
        );
    }
}

/// Prints text to standard output. That its reader has gone away (`| head`) is no error and ends nothing: what else the
/// command does, and its exit code, are the same.
fn say(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    let done = out
        .write_all(printable(text).as_bytes())
        .and_then(|()| out.write_all(b"\n"))
        .and_then(|()| out.flush());
    match done.map_err(cannot_print) {
        Err(CliError::ReaderGone) => Ok(()),
        done => done,
    }
}

/// See `tell!`.
fn tell_line(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(text));
}

/// Text without what would steer the terminal: titles, names and messages may be those of somebody else's scene or log. Lines and tabs stay.
pub(in crate::cli) fn printable(text: &str) -> Cow<'_, str> {
    let steers = |c: char| {
        c.is_control() && !matches!(c, '\n' | '\t')
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if text.contains(steers) {
        Cow::Owned(text.replace(steers, "\u{fffd}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// What a failed write to standard output means.
fn cannot_print(source: std::io::Error) -> CliError {
    match source.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ReaderGone,
        _ => CliError::File {
            action: "write to",
            path: "standard output".into(),
            source,
            remedy: "see where the output of this command goes",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn what_would_steer_the_terminal_is_not_printed() {
        let title = "\u{1b}[2JSilo\u{7}, \u{202e}olis\r\nline\ttab";
        assert_eq!(
            printable(title),
            "\u{fffd}[2JSilo\u{fffd}, \u{fffd}olis\u{fffd}\nline\ttab"
        );
        assert_eq!(printable("µ(I), 5 °"), "µ(I), 5 °");
    }
}
