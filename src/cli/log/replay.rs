//! `sandgate log replay FILE`: the recorded messages on Zenoh again, byte for byte, at their simulated times.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

use super::Choice;
use crate::bus::{Advice, Outlet, ServeOptions, ZenohConfig};
use crate::cli::{CliError, quantity, say, stop};
use crate::record::{RawEntry, RawMessage, RawReader, Survey, Topics, below_base};
use crate::wire::foxglove::FrameTransform;
use crate::wire::keys;
use prost::Message as _;

/// How long a wait may last without looking whether Ctrl-C was pressed.
const LOOK_UP: Duration = Duration::from_millis(50);

/// What may be typed after `sandgate log replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// A log file
    file: PathBuf,
    /// Simulated over wall time, or inf for as fast as possible
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = quantity::speed, allow_hyphen_values = true)]
    speed: f64,
    /// Begin again at the end, until Ctrl-C
    #[arg(long = "loop")]
    again: bool,
    #[command(flatten)]
    choice: Choice,
    /// Name in keys [default: that of metadata.sandgate in --zenoh-config, else that of the log]
    #[arg(long, value_name = "NAME")]
    instance: Option<String>,
    /// Publish although a live component has that name
    #[arg(long)]
    force: bool,
    /// Wait until somebody subscribes
    #[arg(long)]
    wait: bool,
    /// Listen on tcp/HOST:PORT, port 0 for a free one; may be given more than once [default: tcp/127.0.0.1:0, or nowhere
    /// with --connect]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,
    /// Join a router or peer at tcp/HOST:PORT, where subscribers find it then; may be given more than once
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// A configuration file of Zenoh (JSON5); scouting and admin space stay off whatever it says
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    /// Let other machines reach a listener
    #[arg(long)]
    allow_open_listener: bool,
}

const AFTER_HELP: &str = "\
Published is what was published before: out/** (choose fewer with --topic). Calls are in the log, too, but nobody is
asked again. With --from, the last scene and the last of each frame before it come first, so that viewers have walls and
gates. Where a log goes back in time, it is published in its order.";

/// Carries out `sandgate log replay`.
///
/// # Errors
/// [`CliError::Read`], [`CliError::Bus`]; [`CliError::Content`] if nothing is there to publish.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let survey = Survey::of(&args.file)?;
    let outputs = Topics::new(&["out/**".to_owned()]);
    let wanted = args.choice.topics();
    let wants = |topic: &str| outputs.has(topic) && wanted.has(topic);
    let mut topics = survey
        .channels
        .iter()
        .filter(|(t, c)| wants(t) && c.messages > 0);
    let Some((topic, _)) = topics.next() else {
        return Err(CliError::Content {
            path: args.file.clone(),
            problem: "no message has such a topic below out/".to_owned(),
            remedy: "see its topics with `sandgate log info`",
        });
    };
    let options = args.publishing(topic)?;
    let stop = stop::on_interrupt("stopping after this message")?;
    let outlet = Outlet::open(&options, args.force)?;
    say(&format!(
        "replaying {} as sandgate/v1/{}",
        args.file.display(),
        options.instance
    ))?;
    for line in outlet.reach().lines() {
        say(&line)?;
    }
    if args.wait {
        outlet.wait_for_subscriber(&stop)?;
    }
    let base = keys::base(keys::ROOT, &options.instance).map_err(crate::bus::BusError::from)?;
    let mut player = Player {
        outlet,
        base,
        args,
        stop: &stop,
        published: 0,
        latest: Duration::ZERO,
        last: Duration::ZERO,
    };
    let began = Instant::now();
    loop {
        player.play(&wants)?;
        if !args.again || stop.load(Relaxed) {
            break;
        }
    }
    player.finish(began)
}

impl Args {
    /// How and as whom it is published: unless told otherwise, as the component whose log has this topic.
    fn publishing(&self, topic: &str) -> Result<ServeOptions, CliError> {
        let own = topic.split('/').nth(2).unwrap_or_default();
        let mut options = ServeOptions {
            instance: own.to_owned(),
            listen: self.listen.clone(),
            connect: self.connect.clone(),
            config: self.zenoh_config.clone().map(ZenohConfig::File),
            allow_open_listener: self.allow_open_listener,
            realtime_factor: None,
            lost: None,
            advice: Advice::CommandLine,
        }
        .with_metadata()?;
        if let Some(name) = &self.instance {
            options.instance.clone_from(name);
        }
        Ok(options)
    }
}

/// What viewers need of the time before the first message: the newest scene, and the newest place of each frame.
#[derive(Default)]
struct Before(Vec<RawMessage>);

impl Before {
    fn keep(&mut self, message: RawMessage) {
        let leaf = below_base(&message.channel.topic);
        if !matches!(leaf, "out/scene" | "out/frames") {
            return;
        }
        let like = |kept: &RawMessage| {
            kept.channel.topic == message.channel.topic && frame(kept) == frame(&message)
        };
        self.0.retain(|kept| !like(kept));
        self.0.push(message);
    }
}

/// The frame that a message places; none if it places none.
fn frame(message: &RawMessage) -> Option<String> {
    let places = below_base(&message.channel.topic) == "out/frames";
    let read = places.then(|| FrameTransform::decode(message.data.as_slice()));
    Some(read?.ok()?.child_frame_id)
}

struct Player<'a> {
    outlet: Outlet,
    base: String,
    args: &'a Args,
    stop: &'a AtomicBool,
    published: u64,
    /// How late a message was at most.
    latest: Duration,
    /// How late the last one was: the drift of the whole replay.
    last: Duration,
}

impl Player<'_> {
    /// The file once, all of it: where a run went back to a state that it had saved, so do its times.
    fn play(&mut self, wants: &dyn Fn(&str) -> bool) -> Result<(), CliError> {
        let window = &self.args.choice.window;
        let mut before = Before::default();
        // When the first message went out, its time, and the time of the last one.
        let mut began: Option<(Instant, u64, u64)> = None;
        for entry in RawReader::open(&self.args.file)? {
            let RawEntry::Message(message) = entry? else {
                continue;
            };
            if self.stop.load(Relaxed) {
                return Ok(());
            }
            if !wants(&message.channel.topic) {
                continue;
            }
            if !window.has(message.log_time) {
                if began.is_none() {
                    before.keep(message);
                }
                continue;
            }
            let (start, first) = match began {
                Some((start, first, last)) if message.log_time >= last => (start, first),
                None => {
                    for message in std::mem::take(&mut before).0 {
                        self.publish(message)?;
                    }
                    (Instant::now(), message.log_time)
                }
                // It went back: its clock goes on from there.
                Some(_) => (Instant::now(), message.log_time),
            };
            began = Some((start, first, message.log_time));
            self.pace(start, message.log_time - first);
            self.publish(message)?;
        }
        if began.is_none() {
            return Err(CliError::Content {
                path: self.args.file.clone(),
                problem: "no message of these topics lies between --from and --until".to_owned(),
                remedy: "see its times with `sandgate log info`",
            });
        }
        Ok(())
    }

    /// Waits until `after` nanoseconds of simulated time have passed since `start`.
    fn pace(&mut self, start: Instant, after: u64) {
        let due = after as f64 * 1e-9 / self.args.speed;
        if due == 0.0 {
            return;
        }
        // Longer than any clock: such a replay never gets there.
        let due = start + Duration::try_from_secs_f64(due).unwrap_or(Duration::from_secs(1 << 32));
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() || self.stop.load(Relaxed) {
                break;
            }
            std::thread::sleep(left.min(LOOK_UP));
        }
        self.last = due.elapsed();
        self.latest = self.latest.max(self.last);
    }

    fn publish(&mut self, message: RawMessage) -> Result<(), CliError> {
        let key = match frame(&message) {
            Some(name) => keys::frame(&self.base, &name),
            None => format!("{}/{}", self.base, below_base(&message.channel.topic)),
        };
        let schema = &message.channel.schema.name;
        self.outlet.publish(&key, schema, message.data)?;
        self.published += 1;
        Ok(())
    }

    /// Says what was published since it began, and waits until subscribers have it.
    fn finish(self, began: Instant) -> Result<(), CliError> {
        say(&format!(
            "published {} messages in {:.3} s, at most {:.3} ms late, the last one {:.3} ms",
            self.published,
            began.elapsed().as_secs_f64(),
            self.latest.as_secs_f64() * 1e3,
            self.last.as_secs_f64() * 1e3
        ))?;
        let left = self.outlet.wait_until_taken(self.stop);
        if left > 0 {
            tell!(
                "warning: subscribers have not taken the last {left} bytes and more of it, which are lost to them"
            );
        }
        if let Err(open) = self.outlet.close() {
            tell!("warning: {open}");
        }
        Ok(())
    }
}
