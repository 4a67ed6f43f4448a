//! Runs a log again: builds its scene, sets what was set, steps as it stepped, and compares everything that came out
//! bit for bit with what the log says.
//!
//! Compared are all messages that a component makes (outputs, figures with the account of mass, frames, particles,
//! scene) and the hash of the final state. What is not compared: what people and clients said (calls, lines), and
//! wall-clock times.

use super::compare::{differ, different_figure, different_particle, disagree, same};
use super::error::ReadError;
use super::options::RecordOptions;
use super::raw::{Ending, RawEntry, RawMessage, RawReader};
use super::read::{Body, decode};
use super::{RecordError, Recorder};
use crate::component::{self, Component, Mode, StepReport};
use crate::scene;
use crate::wire::convert::{self, Output};
use crate::wire::messages::{Applied, AppliedEvent, AppliedInput, Gauge};
use crate::wire::picture;
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
        "log {path}: {problem}; only logs of sandgate run, serve and log redrive can be run again"
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
    let mut start = Start::default();
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

/// What stands before the messages of a log, and its end.
#[derive(Default)]
struct Start {
    run: BTreeMap<String, String>,
    end: Option<BTreeMap<String, String>>,
    scene: Option<String>,
    state: Option<Vec<u8>>,
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
            report: None,
            done: Redriven {
                steps: 0,
                inputs: 0,
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
    report: Option<StepReport>,
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
        let (mut step, mut time) = (component.statistics().communication_steps, component.time());
        let found = match decode(path, message)? {
            Body::Applied(applied) => {
                let found = self.apply(&applied)?;
                (step, time) = (applied.step, self.component.time());
                progress(time);
                found
            }
            Body::Gauge(gauge) => {
                self.done.compared += 1;
                self.gauge(&gauge)?
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
                let own = picture::scene_update(component.scene(), component.time());
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
        let refused = |call: &str, error: component::Error| {
            let what = format!("{call} was done then and is refused now: {error}");
            Some(("time".to_owned(), what))
        };
        match applied.event() {
            AppliedEvent::Initialize => {
                let stop = h.is_finite().then_some(h);
                if let Err(error) = self.component.initialize(t, stop) {
                    return Ok(refused("initialize", error));
                }
                if let Some(recorder) = &mut self.recorder {
                    recorder.record_initialization(&self.component, t, stop, &applied.source)?;
                }
            }
            AppliedEvent::Step => {
                let report = match self.component.do_step(t, h) {
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
            // The state it was restored to is the one that the file starts from.
            AppliedEvent::Restore | AppliedEvent::Set => {}
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
        if let Err(error) = self.component.set(&[reference], &values) {
            let what = format!("was set then and is refused now: {error}");
            return Some((input.name.clone(), what));
        }
        if let Some(recorder) = &mut self.recorder {
            let by = if input.source.is_empty() {
                source
            } else {
                &input.source
            };
            recorder.record_inputs(&self.component, &[reference], &values, by);
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
            // A step that failed left a state that no recorded call leads to.
            self.done.same_state = (mode != "Failed").then(|| self.component.state_hash() == *hash);
        }
        if let Some(recorder) = self.recorder.take() {
            recorder.finish(&self.component, "redriven")?;
        }
        Ok(self.done)
    }
}
