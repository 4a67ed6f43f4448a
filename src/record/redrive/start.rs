//! What a run starts from: everything that stands before the messages of a log, and how the log ends.

use super::outcome::{RedriveError, Redriven};
use super::{RedriveOptions, Run};
use crate::component::Component;
use crate::record::Recorder;
use crate::record::ending::Ending;
use crate::record::error::ReadError;
use crate::record::options::RecordOptions;
use crate::record::raw::{RawEntry, RawReader};
use crate::record::read::{Body, decode};
use crate::scene;
use crate::wire::convert;
use crate::wire::messages::AppliedEvent;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// What stands before the messages of a log, and its end.
#[derive(Default)]
pub(super) struct Start {
    pub(super) run: BTreeMap<String, String>,
    pub(super) end: Option<BTreeMap<String, String>>,
    scene: Option<String>,
    state: Option<Vec<u8>>,
    /// How often the log goes back to each saved state, by checksum.
    restored: HashMap<Vec<u8>, u64>,
}

impl Start {
    /// Of the log at `path`, of which nothing is read yet but to which states it goes back.
    pub(super) fn of(path: &Path) -> Result<Self, ReadError> {
        Ok(Self {
            restored: restored(path)?,
            ..Self::default()
        })
    }

    /// Takes a metadata record.
    pub(super) fn metadata(&mut self, name: String, values: BTreeMap<String, String>) {
        match name.as_str() {
            "run" => self.run = values,
            "end" => self.end = Some(values),
            _ => {}
        }
    }

    /// Takes an attachment.
    pub(super) fn attachment(&mut self, name: &str, data: Vec<u8>) {
        match name {
            "scene.toml" => self.scene = Some(String::from_utf8_lossy(&data).into_owned()),
            "start.state" => self.state = Some(data),
            _ => {}
        }
    }

    /// Whether the scene was read.
    pub(super) fn has_scene(&self) -> bool {
        self.scene.is_some()
    }

    /// The run that begins here, with its own log if one is wanted.
    pub(super) fn run(&self, path: &Path, options: &RedriveOptions) -> Result<Run, RedriveError> {
        let missing = |problem: &str| RedriveError::Missing {
            path: path.to_owned(),
            problem: problem.to_owned(),
        };
        let text = self.scene.as_ref();
        let text = text.ok_or_else(|| missing("it has no attachment scene.toml"))?;
        let scene = scene::parse("scene.toml", text)?;
        let mut component = Component::new(&scene)?;
        component.set_threads(options.threads);
        if let Some(state) = &self.state {
            component.restore(state)?;
        }
        let recorder = match &options.log {
            None => None,
            Some(log) => {
                let mut wanted = RecordOptions::of(&component);
                if let Some(instance) = self.run.get("instance") {
                    wanted.instance.clone_from(instance);
                }
                wanted.deterministic = self.run.get("deterministic").is_some_and(|d| d == "true");
                wanted.particles_every = options.particles_every.unwrap_or(wanted.particles_every);
                wanted.required = true;
                Some(Recorder::create(log, &component, wanted)?)
            }
        };
        Ok(Run {
            outputs: convert::outputs(component.variables())
                .into_iter()
                .map(|output| (output.name.clone(), output))
                .collect(),
            component,
            recorder,
            restored: self.restored.clone(),
            saved: HashMap::new(),
            report: None,
            sequences: HashMap::new(),
            done: Redriven {
                steps: 0,
                inputs: 0,
                restored: 0,
                compared: 0,
                difference: None,
                same_state: None,
                ending: Ending::Complete,
                version: String::new(),
            },
        })
    }
}

/// How often the log goes back to each saved state, by checksum: only these need to be kept.
fn restored(path: &Path) -> Result<HashMap<Vec<u8>, u64>, ReadError> {
    let mut restored = HashMap::new();
    for entry in RawReader::open(path)? {
        if let RawEntry::Message(message) = entry?
            && message.channel.schema.name == "sandgate.Applied"
            && let Body::Applied(applied) = decode(path, &message)?
            && applied.event() == AppliedEvent::Restore
            && !applied.state.is_empty()
        {
            *restored.entry(applied.state).or_default() += 1;
        }
    }
    Ok(restored)
}
