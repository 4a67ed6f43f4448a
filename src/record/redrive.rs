//! Runs a log again: builds its scene, sets what was set, steps as it stepped, and compares everything that came out
//! bit for bit with what the log says.
//!
//! Compared are all messages that a component makes (outputs, figures with the account of mass, frames, particles,
//! scene) and the hash of the final state. What is not compared: what people and clients said (calls, lines), and
//! wall-clock times.

use super::compare::{differ, different_figure, different_particle, disagree, same};
use super::error::ReadError;
use super::json::hex;
use super::options::RecordOptions;
use super::raw::{Ending, RawEntry, RawMessage, RawReader};
use super::read::{Body, decode};
use super::{RecordError, Recorder};
use crate::component::{self, Component, Mode, StepReport, Wish, saved_checksum};
use crate::scene;
use crate::wire::convert::{self, Output};
use crate::wire::messages::{Applied, AppliedEvent, AppliedInput, AppliedMoment, Gauge};
use crate::wire::{Moment, picture};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

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

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Redriven {
    /// Steps done.
    pub steps: u64,
    /// Inputs set.
    pub inputs: u64,
    /// How often it went back to a state that had been saved.
    pub restored: u64,
    /// Messages compared.
    pub compared: u64,
    /// The first difference, at which the run stopped.
    pub difference: Option<Difference>,
    /// Whether the final state has the hash that the log says; none if it says none.
    pub same_state: Option<bool>,
    /// How the log ends.
    pub ending: Ending,
    /// Version that wrote the log.
    pub version: String,
}

impl Redriven {
    /// Whether the log held anything to compare.
    #[must_use]
    pub fn has_compared(&self) -> bool {
        self.compared > 0 || self.same_state.is_some() || self.difference.is_some()
    }

    /// Whether nothing differs and no byte of the log was changed. True also for a log that was cut short, as far as it
    /// goes; [`Redriven::ending`] tells.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.difference.is_none()
            && self.same_state != Some(false)
            && !matches!(self.ending, Ending::Cut { damaged: true, .. })
    }
}

/// Where a run first differs from its log.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Communication step.
    pub step: u64,
    /// Simulated time [s].
    pub time: f64,
    /// Variable, or figure of the solver.
    pub variable: String,
    /// What the log says and what was computed.
    pub what: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "step {} at t = {} s: {}: {}",
            self.step, self.time, self.variable, self.what
        )
    }
}

/// Errors of [`redrive`]: the run could not be made. That it differs is not an error but a result.
#[derive(Debug, thiserror::Error)]
pub enum RedriveError {
    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The log does not carry what a run needs.
    #[error(
        "log {path}: {problem}; only logs of sandgate run, serve and log redrive, of FMUs and of the C library can be run again"
    )]
    Missing {
        /// The file.
        path: PathBuf,
        /// What is missing.
        problem: String,
    },
    /// The scene within the log is refused by this version.
    #[error("the scene within the log is refused by this version: {0}")]
    Scene(#[from] scene::SceneErrors),
    /// The component cannot be built or restored.
    #[error("cannot build what the log starts from: {0}")]
    Component(#[from] component::Error),
    /// The log of the new run cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
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
    let mut start = Start {
        restored: restored(path)?,
        ..Start::default()
    };
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
        None => start.run(path, options)?,
    };
    run.done.ending = source.ending().cloned().unwrap_or(Ending::Complete);
    run.done.version = start.run.get("version").cloned().unwrap_or_default();
    run.finish(start.end.as_ref())
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

/// What stands before the messages of a log, and its end.
#[derive(Default)]
struct Start {
    run: BTreeMap<String, String>,
    end: Option<BTreeMap<String, String>>,
    scene: Option<String>,
    state: Option<Vec<u8>>,
    restored: HashMap<Vec<u8>, u64>,
}

impl Start {
    fn metadata(&mut self, name: String, values: BTreeMap<String, String>) {
        match name.as_str() {
            "run" => self.run = values,
            "end" => self.end = Some(values),
            _ => {}
        }
    }

    fn attachment(&mut self, name: &str, data: Vec<u8>) {
        match name {
            "scene.toml" => self.scene = Some(String::from_utf8_lossy(&data).into_owned()),
            "start.state" => self.state = Some(data),
            _ => {}
        }
    }

    fn run(&self, path: &Path, options: &RedriveOptions) -> Result<Run, RedriveError> {
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
                let own = convert::gate_frames(component)?;
                let same = own.contains(&frame);
                (!same).then(|| (frame.child_frame_id, "it is elsewhere now".to_owned()))
            }
            Body::Particles(cloud) => {
                self.done.compared += 1;
                different_particle(&cloud, &convert::point_cloud(component))
            }
            Body::Scene(update) => {
                self.done.compared += 1;
                let mut own = picture::scene_update(component.scene(), component.time());
                if component.mode() == Mode::Instantiated {
                    // Drawn at the start time, which this component is told of next.
                    for (own, logged) in own.entities.iter_mut().zip(&update.entities) {
                        own.timestamp.clone_from(&logged.timestamp);
                    }
                }
                (own != update).then(|| ("scene".to_owned(), "it is drawn otherwise".to_owned()))
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

    /// Does what was done then. What is refused now was accepted then, so it is a difference.
    fn apply(&mut self, applied: &Applied) -> Result<Option<(String, String)>, RedriveError> {
        for input in &applied.inputs {
            self.done.inputs += 1;
            if let Some(different) = self.set(input, &applied.source) {
                return Ok(Some(different));
            }
        }
        let (t, h) = (
            f64::from_bits(applied.t_bits),
            f64::from_bits(applied.h_bits),
        );
        if t.to_bits() != applied.t.to_bits() || (h.to_bits() != applied.h.to_bits()) {
            return Ok(Some((
                "time".to_owned(),
                disagree(&[t, h], &[applied.t, applied.h]),
            )));
        }
        let refused = |call: &str, error: String| {
            let what = format!("{call} was done then and is refused now: {error}");
            Some(("time".to_owned(), what))
        };
        match applied.event() {
            AppliedEvent::Initialize => {
                let stop = h.is_finite().then_some(h);
                if let Err(error) = self.component.initialize(t, stop) {
                    return Ok(refused("initialize", error.to_string()));
                }
                if let Some(recorder) = &mut self.recorder {
                    recorder.record_initialization(&self.component, t, stop, &applied.source)?;
                }
            }
            AppliedEvent::Step => {
                let report = match self.step(t, h, &applied.moments, &applied.source) {
                    Ok(report) => report,
                    Err(error) => return Ok(refused("this step", error)),
                };
                self.done.steps += 1;
                self.report = Some(report);
                if let Some(recorder) = &mut self.recorder {
                    recorder.record_step(&self.component, &report, t, h, &applied.source)?;
                }
            }
            AppliedEvent::Reset => self.component.reset()?,
            AppliedEvent::Save => return self.save(applied),
            AppliedEvent::Restore if !applied.state.is_empty() => return self.restore(applied),
            // The state it was restored to is the one that the file starts from.
            AppliedEvent::Restore | AppliedEvent::Set => {}
        }
        Ok(None)
    }

    /// The step, with what was done inside it then.
    fn step(
        &mut self,
        t: f64,
        h: f64,
        moments: &[AppliedMoment],
        source: &str,
    ) -> Result<StepReport, String> {
        if moments.is_empty() {
            let done = self.component.do_step(t, h);
            return done.map_err(|error| error.to_string());
        }
        let mut left = moments.iter().peekable();
        let mut done = Vec::new();
        let mut refused = None;
        let report = self.component.do_step_watched(t, h, &mut |moment| {
            let now = moment.time().to_bits();
            let Some(applied) = left.next_if(|first| first.t_bits == now) else {
                return Wish::GoOn;
            };
            let mut inputs = Vec::new();
            for input in &applied.inputs {
                let values: Vec<f64> = input.bits.iter().map(|&b| f64::from_bits(b)).collect();
                if let Err(error) = moment.set(&[input.reference], &values) {
                    refused.get_or_insert(error);
                }
                inputs.push((vec![input.reference], values));
            }
            let wish = match applied.ends {
                true => Wish::EndAt(f64::from_bits(applied.end_bits)),
                false => Wish::GoOn,
            };
            done.push(Moment {
                time: moment.time(),
                inputs,
                wish,
            });
            wish
        });
        let report = report.map_err(|error| error.to_string())?;
        if let Some(error) = refused {
            return Err(error.to_string());
        }
        if let Some(applied) = left.next() {
            let time = f64::from_bits(applied.t_bits);
            return Err(format!("no internal step ends at t = {time:?} s"));
        }
        if let Some(recorder) = &mut self.recorder {
            for moment in &done {
                recorder.record_moment(&self.component, moment, source);
            }
        }
        Ok(report)
    }

    /// A state was saved then: the same one now?
    fn save(&mut self, applied: &Applied) -> Result<Option<(String, String)>, RedriveError> {
        let bytes = self.component.save()?;
        let own = saved_checksum(&bytes).unwrap_or_default();
        if applied.state != own {
            let what = format!(
                "the log says checksum {}, computed {}",
                hex(&applied.state),
                hex(&own)
            );
            return Ok(Some(("saved state".to_owned(), what)));
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.record_save(&self.component, &own, &applied.source)?;
        }
        if self.restored.contains_key(&applied.state) {
            self.saved.insert(applied.state.clone(), bytes);
        }
        Ok(None)
    }

    /// The component was brought back to a state then.
    fn restore(&mut self, applied: &Applied) -> Result<Option<(String, String)>, RedriveError> {
        let Some(bytes) = self.saved.get(&applied.state) else {
            let what = format!("no state {} was saved before", hex(&applied.state));
            return Ok(Some(("restored state".to_owned(), what)));
        };
        self.component.restore(bytes)?;
        if let Some(left) = self.restored.get_mut(&applied.state) {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.restored.remove(&applied.state);
                self.saved.remove(&applied.state);
            }
        }
        self.done.restored += 1;
        self.report = None;
        let state = <[u8; 32]>::try_from(applied.state.as_slice()).unwrap_or_default();
        if let Some(recorder) = &mut self.recorder {
            recorder.record_restore(&self.component, &state, &applied.source)?;
        }
        Ok(None)
    }

    fn set(&mut self, input: &AppliedInput, source: &str) -> Option<(String, String)> {
        let values: Vec<f64> = input
            .bits
            .iter()
            .map(|&bits| f64::from_bits(bits))
            .collect();
        if !same(&values, &input.values) {
            let what = format!("input {}", disagree(&values, &input.values));
            return Some((input.name.clone(), what));
        }
        let known = self.component.variables().by_name(&input.name);
        let Some(reference) = known.map(|row| row.reference) else {
            return Some((input.name.clone(), "no such variable now".to_owned()));
        };
        let done = if input.slope {
            self.component.set_input_derivatives(&[reference], &values)
        } else {
            self.component.set(&[reference], &values)
        };
        if let Err(error) = done {
            let what = format!("was set then and is refused now: {error}");
            return Some((input.name.clone(), what));
        }
        if let Some(recorder) = &mut self.recorder {
            let by = if input.source.is_empty() {
                source
            } else {
                &input.source
            };
            if input.slope {
                recorder.record_slopes(&self.component, &[reference], &values, by);
            } else {
                recorder.record_inputs(&self.component, &[reference], &values, by);
            }
        }
        None
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
        } else if logged.time.to_bits() != own.time.to_bits() {
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
            if mode == "Terminated" && self.component.mode() == Mode::Stepping {
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
