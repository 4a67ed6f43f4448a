//! `sandgate serve CASE`: the scene's component on Zenoh, stepped by clients or by itself, until Ctrl-C or until a
//! client sends `terminate`.

mod log;

use std::io::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use super::{CliError, component_of, load_scene, quantity, say, stop, threads};
use crate::bus::{Advice, Lost, ServeOptions, Server, WhenLost, ZenohConfig};
use crate::component::Mode;
use crate::wire::{Observer, Unobserved};
use log::Log;

/// What may be typed after `sandgate serve`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// The scene file, for example cases/silo_gate.toml
    case: PathBuf,
    /// Name in keys, 1 to 64 of a-z 0-9 _ - [default: that of metadata.sandgate in --zenoh-config, else the
    /// scene's]
    #[arg(long, value_name = "NAME")]
    instance: Option<String>,
    /// Listen on tcp/HOST:PORT, port 0 for a free one; may be given more than once [default: tcp/127.0.0.1:0, or nowhere
    /// with --connect]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,
    /// Join a router or peer at tcp/HOST:PORT, where clients find it then; may be given more than once
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// A configuration file of Zenoh (JSON5); scouting and admin space stay off whatever it says
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    /// Let other machines reach a listener: everybody who reaches it can move gates, step and read states
    #[arg(long)]
    allow_open_listener: bool,
    /// Step without being asked: simulated over wall time, such as 1, or inf for as fast as possible
    #[arg(long, value_name = "FACTOR", value_parser = quantity::speed, allow_hyphen_values = true)]
    realtime_factor: Option<f64>,
    /// Count whoever steps it as lost after so long without a request, "10 s" or plain seconds
    #[arg(long, value_name = "TIME", value_parser = quantity::positive_time, allow_hyphen_values = true)]
    lost_after: Option<f64>,
    /// What to do then
    #[arg(long, value_enum, default_value = "hold", requires = "lost_after")]
    when_lost: Then,
    /// Log all traffic to a new MCAP file; a reset or restore goes on in FILE-1-0000, ...
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Threads to compute with; 0 means all cores; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads::parser())]
    threads: u16,
}

/// What to do without an orchestrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Then {
    /// wait as it is
    Hold,
    /// step by itself at real time until somebody sends pause
    Continue,
    /// end the component and the program
    Terminate,
}

const AFTER_HELP: &str = "\
Keys (docs/zenoh.md has them all), below sandgate/v1/NAME:
  @rpc/VERB        requests: describe status get set step run pause reset save restore log terminate
  in/VARIABLE      set-points, JSON
  out/gauge/NAME   gauges as they are computed, protobuf
  @alive           liveliness token

Unless told otherwise it listens on this machine only, looks for nobody and waits for `step` requests.
Schedules of the scene are for `sandgate run`: here clients set the inputs.";

/// Serves until it is ended.
///
/// # Errors
/// [`CliError::Scene`], [`CliError::Bus`], [`CliError::Log`], [`CliError::Build`].
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let scene = load_scene(&args.case)?;
    let mut options = ServeOptions {
        instance: scene.name.clone(),
        listen: args.listen.clone(),
        connect: args.connect.clone(),
        config: args.zenoh_config.clone().map(ZenohConfig::File),
        allow_open_listener: args.allow_open_listener,
        realtime_factor: args.realtime_factor,
        lost: args.lost_after.map(|seconds| Lost {
            // Longer than any clock is never.
            after: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX),
            then: match args.when_lost {
                Then::Hold => WhenLost::Hold,
                Then::Continue => WhenLost::Continue,
                Then::Terminate => WhenLost::Terminate,
            },
        }),
        advice: Advice::CommandLine,
    }
    .with_metadata()?;
    if let Some(name) = &args.instance {
        options.instance.clone_from(name);
    }
    let mut component = component_of(&scene, &args.case)?;
    component.set_threads(usize::from(args.threads));
    let stop = stop::on_interrupt("stopping after this step")?;
    let mut log = match &args.log {
        Some(file) => Some(Log::create(file, &component, &options.instance)?),
        None => None,
    };
    let mut nobody = Unobserved;
    let observer: &mut dyn Observer = match &mut log {
        Some(log) => log,
        None => &mut nobody,
    };
    let server = match Server::open(component, &options, observer) {
        Ok(server) => server,
        Err(error) => {
            // Nothing was served that it could tell, and the same command shall find its name free.
            if let Some(log) = log {
                log.discard();
            }
            return Err(error.into());
        }
    };
    announce(&server, &options)?;
    let (component, session) = server.run(observer, &stop);
    let why = match component.mode() {
        Mode::Terminated if args.when_lost == Then::Terminate => "terminated",
        Mode::Terminated => "terminated by a client",
        _ => "stopped",
    };
    // Before the session is closed, which may take a while.
    let logged = log.map_or(Ok(String::new()), |log| log.finish(&component, why));
    if let Err(open) = session.close() {
        tell!("warning: {open}");
    }
    say(&format!(
        "{why} at t = {} s after {} communication steps",
        component.time(),
        component.communication_steps()
    ))?;
    let logged = logged?;
    if !logged.is_empty() {
        say(&logged)?;
    }
    Ok(())
}

/// Where clients find it, one place a line, for people and programs.
fn announce(server: &Server, options: &ServeOptions) -> Result<(), CliError> {
    say(&format!("serving sandgate/v1/{}", options.instance))?;
    for line in server.reach().lines() {
        say(&line)?;
    }
    say(match options.realtime_factor {
        None => "waiting for step requests (Ctrl-C ends)",
        Some(_) => "running (Ctrl-C ends)",
    })?;
    // Programs that started this one read these lines through a pipe.
    let _ = std::io::stdout().flush();
    Ok(())
}
