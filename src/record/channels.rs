//! Which channels a log has: one for each output of the variables table, and those of the run.

use super::file::{ChannelId, LogFile};
use crate::component::Component;
use crate::wire::convert::{self, Output};
use crate::wire::foxglove::{FrameTransform, Log, PointCloud, SceneUpdate};
use crate::wire::messages::{Applied, Command, CommandKind, Gauge, StepStats};
use crate::wire::{Described, keys, schema};
use std::collections::BTreeMap;

/// A channel and the number of messages on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    pub(super) id: ChannelId,
    pub(super) next: u64,
}

/// All channels of one file.
pub(super) struct Channels {
    pub(super) outputs: Vec<(Output, Channel)>,
    pub(super) applied: Channel,
    pub(super) stats: Channel,
    pub(super) log: Channel,
    pub(super) particles: Channel,
    pub(super) scene: Channel,
    pub(super) frames: Channel,
    commands: BTreeMap<String, Channel>,
    base: String,
    /// Where numbers go on from, by topic; 0 where nothing is said.
    numbers: BTreeMap<String, u64>,
}

impl Channels {
    /// Adds the channels of `component` to `file`, all topics below `base`.
    pub(super) fn add(
        file: &mut LogFile,
        component: &Component,
        base: &str,
        numbers: BTreeMap<String, u64>,
    ) -> Self {
        let numbered = |file: &mut LogFile, topic: &str, add: Adding| {
            let mut channel = add(file, topic, out());
            channel.next = numbers.get(topic).copied().unwrap_or(0);
            channel
        };
        let outputs = convert::outputs(component.variables())
            .into_iter()
            .map(|output| {
                let metadata = output_metadata(component, &output);
                let topic = keys::output(base, &output.name);
                let mut channel = add::<Gauge>(file, &topic, metadata);
                channel.next = numbers.get(&topic).copied().unwrap_or(0);
                (output, channel)
            })
            .collect();
        Self {
            outputs,
            applied: numbered(file, &keys::applied(base), add::<Applied>),
            stats: numbered(file, &keys::stats(base), add::<StepStats>),
            log: numbered(file, &keys::log(base), add::<Log>),
            particles: numbered(file, &keys::particles(base), add::<PointCloud>),
            scene: numbered(file, &keys::scene(base), add::<SceneUpdate>),
            frames: numbered(file, &keys::frames(base), add::<FrameTransform>),
            commands: BTreeMap::new(),
            base: base.to_owned(),
            numbers,
        }
    }

    /// The next number of each topic, for the file that follows.
    pub(super) fn numbers(&self) -> BTreeMap<String, u64> {
        let base = &self.base;
        let mut numbers = self.numbers.clone();
        numbers.extend(
            self.commands
                .iter()
                .map(|(topic, c)| (topic.clone(), c.next)),
        );
        let outputs = self.outputs.iter();
        numbers.extend(outputs.map(|(output, c)| (keys::output(base, &output.name), c.next)));
        numbers.extend([
            (keys::applied(base), self.applied.next),
            (keys::stats(base), self.stats.next),
            (keys::log(base), self.log.next),
            (keys::particles(base), self.particles.next),
            (keys::scene(base), self.scene.next),
            (keys::frames(base), self.frames.next),
        ]);
        numbers
    }

    /// The channel of a call, added when it is first used: `.../@rpc/step/request`.
    pub(super) fn command(&mut self, file: &mut LogFile, command: &Command) -> &mut Channel {
        let (direction, leaf) = match command.kind() {
            CommandKind::Request => ("in", "request"),
            CommandKind::Reply => ("out", "reply"),
        };
        let key = keys::logged_call(&self.base, &command.interface, &command.verb);
        let topic = format!("{key}/{leaf}");
        let first = self.numbers.get(&topic).copied().unwrap_or(0);
        self.commands.entry(topic.clone()).or_insert_with(|| {
            let metadata = BTreeMap::from([("direction".to_owned(), direction.to_owned())]);
            let channel = add::<Command>(file, &topic, metadata);
            Channel {
                next: first,
                ..channel
            }
        })
    }
}

/// How a channel is added: [`add`] for one kind of message.
type Adding = fn(&mut LogFile, &str, BTreeMap<String, String>) -> Channel;

fn out() -> BTreeMap<String, String> {
    BTreeMap::from([("direction".to_owned(), "out".to_owned())])
}

/// Adds one channel with the schema of `M`.
pub(super) fn add<M: Described>(
    file: &mut LogFile,
    topic: &str,
    mut metadata: BTreeMap<String, String>,
) -> Channel {
    metadata.insert(
        "encoding".to_owned(),
        format!("application/protobuf;{}", M::FULL_NAME),
    );
    Channel {
        id: file.channel(topic, (M::FULL_NAME, &schema::<M>()), &metadata),
        next: 0,
    }
}

fn output_metadata(component: &Component, output: &Output) -> BTreeMap<String, String> {
    let mut metadata = BTreeMap::from([
        ("direction".to_owned(), "out".to_owned()),
        ("causality".to_owned(), "output".to_owned()),
        ("variable".to_owned(), output.name.clone()),
        ("unit".to_owned(), output.unit.to_owned()),
        ("value_reference".to_owned(), output.reference.to_string()),
    ]);
    if let Some(variable) = component.variables().by_reference(output.reference) {
        metadata.insert("description".to_owned(), variable.description.clone());
    }
    metadata
}
