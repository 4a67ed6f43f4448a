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
}

impl Channels {
    /// Adds the channels of `component` to `file`, all topics below `base`.
    pub(super) fn add(file: &mut LogFile, component: &Component, base: &str) -> Self {
        let outputs = convert::outputs(component.variables())
            .into_iter()
            .map(|output| {
                let metadata = output_metadata(component, &output);
                let channel = add::<Gauge>(file, &keys::output(base, &output.name), metadata);
                (output, channel)
            })
            .collect();
        let out = || BTreeMap::from([("direction".to_owned(), "out".to_owned())]);
        Self {
            outputs,
            applied: add::<Applied>(file, &keys::applied(base), out()),
            stats: add::<StepStats>(file, &keys::stats(base), out()),
            log: add::<Log>(file, &keys::log(base), out()),
            particles: add::<PointCloud>(file, &keys::particles(base), out()),
            scene: add::<SceneUpdate>(file, &keys::scene(base), out()),
            frames: add::<FrameTransform>(file, &keys::frames(base), out()),
            commands: BTreeMap::new(),
            base: base.to_owned(),
        }
    }

    /// The channel of a call, added when it is first used: `.../@rpc/step/request`.
    pub(super) fn command(&mut self, file: &mut LogFile, command: &Command) -> &mut Channel {
        let (direction, leaf) = match command.kind() {
            CommandKind::Request => ("in", "request"),
            CommandKind::Reply => ("out", "reply"),
        };
        let key = keys::control(&self.base, &command.interface, &command.verb);
        let topic = format!("{key}/{leaf}");
        self.commands.entry(topic.clone()).or_insert_with(|| {
            let metadata = BTreeMap::from([("direction".to_owned(), direction.to_owned())]);
            add::<Command>(file, &topic, metadata)
        })
    }
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
