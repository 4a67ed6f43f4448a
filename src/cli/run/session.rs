//! A run in progress: sets the scheduled inputs, steps, samples, logs and saves.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::ending::Outcome;
use super::folder::{CHECKPOINT, Folder};
use super::log::RunLog;
use super::progress::Progress;
use super::series::Series;
use super::summary;
use crate::cli::CliError;
use crate::cli::clock::{Stopwatch, cores};
use crate::component::{self, Component, Mode, StepReport, Wish, next_point};
use crate::scene::Scene;

/// A run as it is meant.
pub(super) struct Plan {
    /// End [s].
    pub(super) until: f64,
    /// Communication step [s].
    pub(super) step: f64,
    /// Threads, 0 for all cores.
    pub(super) threads: usize,
    /// Simulated time between checkpoints [s].
    pub(super) checkpoint_every: Option<f64>,
    /// The command that goes on with this run, without `--resume FILE`.
    pub(super) go_on: String,
    /// Whether to write a log.
    pub(super) log: bool,
}

/// Figures of this part of a run (a resumed run has several parts).
pub(super) struct Part {
    /// Simulated time it began at [s].
    pub(super) from: f64,
    /// Wall and CPU time since then.
    pub(super) watch: Stopwatch,
    /// Smallest internal step [s].
    pub(super) smallest_step: f64,
    /// Communication steps by what bound their smallest internal step.
    pub(super) bound_by: BTreeMap<&'static str, u64>,
}

/// A run in progress.
pub(super) struct Session {
    pub(super) plan: Plan,
    pub(super) component: Component,
    pub(super) folder: Folder,
    pub(super) series: Series,
    pub(super) part: Part,
    pub(super) case: String,
    pub(super) log: RunLog,
    pub(super) progress: Progress,
    next_checkpoint: f64,
    /// Time of the last state that this part saved [s].
    pub(super) saved: Option<f64>,
    /// Whether it has been told that a checkpoint could not be written.
    warned: bool,
}

/// A component ready to be initialised, or at the state that a file of these bytes holds.
///
/// # Errors
/// [`CliError::Component`]; [`CliError::Content`] if the file holds no state of this scene; [`CliError::Usage`] if that is
/// already at or past the end.
pub(super) fn ready(
    scene: &Scene,
    saved: Option<(&Path, &[u8])>,
    plan: &Plan,
) -> Result<Component, CliError> {
    let mut component = Component::new(scene)?;
    component.set_threads(plan.threads);
    let Some((file, bytes)) = saved else {
        return Ok(component);
    };
    component.restore(bytes).map_err(|error| match error {
        component::Error::Snapshot(_) => CliError::Content {
            path: file.to_owned(),
            problem: error.to_string(),
            remedy: "give the checkpoint.state of a run of this scene",
        },
        other => other.into(),
    })?;
    if component.mode() != Mode::Stepping {
        return Err(CliError::Usage(format!(
            "the saved state is in mode {:?}, allowed Stepping; give the checkpoint.state of a run",
            component.mode()
        )));
    }
    let time = component.time();
    if next_point(time, plan.step, plan.until).is_none() {
        return Err(CliError::Usage(format!(
            "the saved state is at t = {time} s and the run ends at {} s; give a later end with --until",
            plan.until
        )));
    }
    Ok(component)
}

impl Session {
    /// Opens the files of the folder and, unless it was restored, initialises the component.
    ///
    /// # Errors
    /// [`CliError::File`], [`CliError::Content`], [`CliError::Log`], [`CliError::Component`].
    pub(super) fn open(
        plan: Plan,
        mut component: Component,
        folder: Folder,
        case: &Path,
    ) -> Result<Self, CliError> {
        let resumed = component.mode() == Mode::Stepping;
        // A table that does not fit the saved state is refused before anything is written.
        let from = component.time();
        let keep = folder.earlier.is_some().then_some(from);
        let mut series = Series::open(&folder.file("gauges.csv"), &component, keep)?;
        if let Some(warning) = keep.and_then(|from| series.missing_before(from)) {
            tell!("{warning}");
        }
        let mut log = if plan.log {
            RunLog::start(&folder, &component, resumed)?
        } else {
            RunLog::none()
        };
        if !resumed {
            component.initialize(0.0, None)?;
            log.initialized(&component, 0.0)?;
        }
        if series.span.is_none_or(|(_, last)| last != from)
            && let Some(warning) = series.sample(&component)?
        {
            tell!("{warning}");
        }
        let mut session = Self {
            progress: Progress::start(&component.scene().name, from, plan.until),
            next_checkpoint: plan.checkpoint_every.map_or(f64::INFINITY, |every| {
                next_point(from, every, f64::INFINITY).unwrap_or(f64::INFINITY)
            }),
            part: Part {
                from,
                watch: Stopwatch::start(),
                smallest_step: f64::INFINITY,
                bound_by: BTreeMap::new(),
            },
            case: case.display().to_string(),
            plan,
            component,
            folder,
            series,
            log,
            saved: None,
            warned: false,
        };
        session.write_summary("running", None)?;
        session.announce()?;
        session.progress.show(&session.component);
        Ok(session)
    }

    fn announce(&mut self) -> Result<(), CliError> {
        let what = format!(
            "{} particles, communication step {} s, to t = {} s",
            self.component.statistics().particles,
            self.plan.step,
            self.plan.until
        );
        let (threads, folder) = (self.threads(), self.folder.path().display());
        tell!(
            "{}: {what}, {threads} threads, results in {folder}",
            self.case
        );
        // Without path and threads: results do not depend on them, nor do the bytes of a deterministic log.
        let name = &self.component.scene().name;
        self.log.say(&self.component, &format!("{name}: {what}"))
    }

    /// Threads in use.
    pub(super) fn threads(&self) -> usize {
        match self.plan.threads {
            0 => cores(),
            n => n,
        }
    }

    /// Steps to the end, to Ctrl-C or to the first error.
    pub(super) fn advance(&mut self, stop: &AtomicBool) -> Outcome {
        while let Some(next) = next_point(self.component.time(), self.plan.step, self.plan.until) {
            if stop.load(Ordering::SeqCst) {
                return Outcome::Interrupted;
            }
            if let Err(error) = self.step_to(next) {
                return Outcome::Failed(error);
            }
        }
        Outcome::Finished
    }

    fn step_to(&mut self, next: f64) -> Result<(), CliError> {
        let time = self.component.time();
        self.component.keep();
        let set = self.component.follow_schedules(time, next)?;
        self.log
            .inputs(&self.component, &set.references, &set.values);
        if !set.sloped.is_empty() {
            self.log.slopes(&self.component, &set.sloped, &set.slopes);
        }
        let progress = &mut self.progress;
        let report = self
            .component
            .do_step_watched(time, next - time, &mut |moment| {
                progress.show_within(moment);
                Wish::GoOn
            })?;
        self.count(&report);
        let of_log = self.log.step(&self.component, &report, time, next - time)?;
        let of_table = self.series.sample(&self.component)?;
        for warning in of_log.into_iter().chain(of_table) {
            self.progress.tell(&warning);
        }
        self.progress.show(&self.component);
        if self.component.time() >= self.next_checkpoint {
            match self.checkpoint() {
                // The checkpoint before it is still there.
                Err(error @ CliError::File { .. }) => {
                    if !std::mem::replace(&mut self.warned, true) {
                        let text = error.as_warning();
                        let text =
                            format!("warning: {text}; the run goes on without new checkpoints");
                        self.progress.tell(&text);
                    }
                    self.plan_checkpoint();
                }
                other => other?,
            }
        }
        Ok(())
    }

    fn count(&mut self, report: &StepReport) {
        self.part.smallest_step = self.part.smallest_step.min(report.smallest_step);
        *self
            .part
            .bound_by
            .entry(report.bound_by.name())
            .or_default() += 1;
    }

    /// Saves the state; the table is on disk first, so that a resumed run finds its rows.
    pub(super) fn checkpoint(&mut self) -> Result<(), CliError> {
        self.series.sync()?;
        self.folder.replace(CHECKPOINT, &self.component.save()?)?;
        self.saved = Some(self.component.time());
        self.write_summary("running", None)?;
        self.plan_checkpoint();
        Ok(())
    }

    fn plan_checkpoint(&mut self) {
        if let Some(every) = self.plan.checkpoint_every {
            let time = self.component.time();
            self.next_checkpoint = next_point(time, every, f64::INFINITY).unwrap_or(f64::INFINITY);
        }
    }

    pub(super) fn write_summary(&self, status: &str, error: Option<&str>) -> Result<(), CliError> {
        let text = summary::json(self, status, error)?;
        self.folder.replace("summary.json", text.as_bytes())
    }
}
