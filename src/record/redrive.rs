//! Runs a log again: builds its scene, sets what was set, steps as it stepped, and compares everything that came out
//! bit for bit with what the log says.
//!
//! Compared are all messages that a component makes (outputs, figures with the account of mass, frames, particles,
//! scene) and the hash of the final state. What is not compared: what people and clients said (calls, lines), and
//! wall-clock times.

mod applied;
mod outcome;
mod start;

use super::Recorder;
use super::compare::{differ, different_figure, different_particle, same, same_alone};
use super::ending::Ending;
use super::error::ReadError;
use super::raw::{RawEntry, RawMessage, RawReader};
use super::read::{Body, decode};
use crate::component::{Component, Mode, StepReport};
use crate::wire::convert::{self, Output};
use crate::wire::foxglove::SceneUpdate;
use crate::wire::messages::Gauge;
use crate::wire::picture;
use start::Start;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

pub use outcome::{Difference, RedriveError, Redriven};

/// How to run a log again.
#[derive(Clone, Debug, Default)]
pub struct RedriveOptions {
    /// Threads of the sweeps, 0 for all cores; results do not depend on it.
    pub threads: usize,
    /// A log of the new run.
    pub log: Option<PathBuf>,
    /// Particles in that log, every so many seconds of simulated time; none: as the scene says [s].
    pub particles_every: Option<f64>,
}

/// Runs `path` again. `progress` hears the simulated time after each step [s].
///
/// # Errors
/// [`RedriveError`].
pub fn redrive(
    path: &Path,
    options: &RedriveOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Redriven, RedriveError> {
    let mut source = RawReader::open(path)?;
    let mut start = Start::of(path)?;
    let mut run: Option<Run> = None;
    for entry in source.by_ref() {
        match entry? {
            RawEntry::Metadata { name, values } => start.metadata(name, values),
            RawEntry::Attachment { name, data, .. } => start.attachment(&name, data),
            RawEntry::Channel(_) => {}
            RawEntry::Message(message) => {
                let run = match &mut run {
                    Some(run) => run,
                    none => none.insert(start.run(path, options)?),
                };
                run.follow(path, &message, progress)?;
                if run.done.difference.is_some() {
                    break;
                }
            }
        }
    }
    let mut run = match run {
        Some(run) => run,
        None => {
            if let (false, Some(ending)) = (start.has_scene(), source.how_cut()) {
                let path = path.to_owned();
                return Err(ReadError::BeforeScene { path, ending }.into());
            }
            start.run(path, options)?
        }
    };
    run.done.ending = source.ending().cloned().unwrap_or(Ending::Complete);
    run.done.version = start.run.get("version").cloned().unwrap_or_default();
    run.finish(start.end.as_ref())
}

/// A run that follows a log.
struct Run {
    component: Component,
    outputs: HashMap<String, Output>,
    recorder: Option<Recorder>,
    /// How often the log goes back to each state from here on, by checksum.
    restored: HashMap<Vec<u8>, u64>,
    /// States that it will go back to.
    saved: HashMap<Vec<u8>, Vec<u8>>,
    report: Option<StepReport>,
    /// Number of the last message of each output.
    sequences: HashMap<String, u64>,
    done: Redriven,
}

impl Run {
    fn follow(
        &mut self,
        path: &Path,
        message: &RawMessage,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), RedriveError> {
        let component = &self.component;
        let (mut step, mut time) = (component.communication_steps(), component.time());
        let found = match decode(path, message)? {
            Body::Applied(applied) => {
                let found = self.apply(&applied)?;
                (step, time) = (applied.step, self.component.time());
                progress(time);
                found
            }
            Body::Gauge(gauge) => {
                self.done.compared += 1;
                let earlier = self.sequences.insert(gauge.name.clone(), gauge.sequence);
                match earlier.map_or(0, |n| gauge.sequence.saturating_sub(n + 1)) {
                    0 => self.gauge(&gauge)?,
                    lost => {
                        let what = format!("{lost} of its messages before this one are missing");
                        Some((gauge.name, what))
                    }
                }
            }
            Body::Stats(stats) => {
                self.done.compared += 1;
                let own = convert::step_stats(component, self.report.as_ref(), stats.sequence);
                different_figure(&stats, &own)
            }
            Body::Frame(frame) => {
                self.done.compared += 1;
                let own = convert::frames(component)?;
                let same = own.contains(&frame);
                (!same).then(|| (frame.child_frame_id, "it is elsewhere now".to_owned()))
            }
            Body::Particles(cloud) => {
                self.done.compared += 1;
                different_particle(&cloud, &convert::point_cloud(component))
            }
            Body::Scene(update) => {
                self.done.compared += 1;
                drawn_otherwise(&update, component)
            }
            Body::Command(_) | Body::Log(_) | Body::Other { .. } => None,
        };
        if let Some((variable, what)) = found {
            self.done.difference.get_or_insert(Difference {
                step,
                time,
                variable,
                what,
            });
        }
        Ok(())
    }

    fn gauge(&self, logged: &Gauge) -> Result<Option<(String, String)>, RedriveError> {
        let Some(output) = self.outputs.get(&logged.name) else {
            return Ok(Some((logged.name.clone(), "no such output now".to_owned())));
        };
        let own = convert::gauge(&self.component, output, logged.step, logged.sequence)?;
        let name = logged.name.clone();
        Ok(if !same(&logged.values, &own.values) {
            Some((name, differ(&logged.values, &own.values)))
        } else if logged.validity != own.validity {
            let (then, now) = (logged.validity(), own.validity());
            Some((name, format!("log says {then:?}, computed {now:?}")))
        } else if !same_alone(logged.time, own.time) {
            Some((name, differ(&[logged.time], &[own.time])))
        } else {
            None
        })
    }

    fn finish(mut self, end: Option<&BTreeMap<String, String>>) -> Result<Redriven, RedriveError> {
        let value = |key: &str| end.and_then(|end| end.get(key));
        if self.done.difference.is_none()
            && let Some(hash) = value("state_hash")
        {
            let mode = value("mode").map_or("", String::as_str);
            // A file may begin from the state of a failed component, which can be terminated, too.
            let ends = matches!(self.component.mode(), Mode::Stepping | Mode::Failed);
            if mode == "Terminated" && ends {
                self.component.terminate()?;
            }
            // A step that failed left a state that no recorded call leads to; logs of old have its hash all the same.
            self.done.same_state = (mode != "Failed").then(|| self.component.state_hash() == *hash);
        }
        if let Some(recorder) = self.recorder.take() {
            recorder.finish(&self.component, "redriven")?;
        }
        Ok(self.done)
    }
}

fn drawn_otherwise(logged: &SceneUpdate, component: &Component) -> Option<(String, String)> {
    let mut own = picture::scene_update(component.scene(), component.time());
    if component.mode() == Mode::Instantiated {
        // Drawn at the start time, which this component is told of next.
        for (own, logged) in own.entities.iter_mut().zip(&logged.entities) {
            own.timestamp.clone_from(&logged.timestamp);
        }
    }
    (own != *logged).then(|| ("scene".to_owned(), "it is drawn otherwise".to_owned()))
}
