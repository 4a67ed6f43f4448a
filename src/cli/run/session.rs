//! A run in progress: sets the scheduled inputs, steps, samples, logs, saves; and closes everything in good order
//! whether it ended, was interrupted or failed.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::folder::{CHECKPOINT, Folder};
use super::log::RunLog;
use super::progress::Progress;
use super::series::Series;
use super::{plot, shell_word, summary};
use crate::cli::clock::{Stopwatch, cores};
use crate::cli::{CliError, say};
use crate::component::{Component, Mode, StepReport, Wish, next_point};
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

/// How the stepping ended.
pub(super) enum Outcome {
    /// At the end time.
    Finished,
    /// By Ctrl-C, at a communication point.
    Interrupted,
    /// By an error; everything before it stands.
    Failed(CliError),
}

impl Outcome {
    /// The status in `summary.json` and in the log's end, and the error's text.
    fn words(&self) -> (&'static str, Option<String>) {
        match self {
            Self::Finished => ("finished", None),
            Self::Interrupted => ("interrupted", None),
            Self::Failed(error) => ("failed", Some(error.as_warning())),
        }
    }

    /// What could not be done at the end is the error of a run that had none, and else a warning.
    fn fails_by(&mut self, done: Result<(), CliError>) {
        match (done, &self) {
            (Ok(()), _) => {}
            (Err(error), Self::Failed(_)) => tell!("warning: {}", error.as_warning()),
            (Err(error), _) => *self = Self::Failed(error),
        }
    }
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
    progress: Progress,
    next_checkpoint: f64,
    /// Time of the last state that this part saved [s].
    saved: Option<f64>,
    /// Whether it has been told that a checkpoint could not be written.
    warned: bool,
}

/// A component ready to be initialised, or at the saved state.
///
/// # Errors
/// [`CliError::Component`]; [`CliError::Usage`] if the saved state is already at or past the end.
pub(super) fn ready(
    scene: &Scene,
    saved: Option<&[u8]>,
    plan: &Plan,
) -> Result<Component, CliError> {
    let mut component = Component::new(scene)?;
    component.set_threads(plan.threads);
    let Some(bytes) = saved else {
        return Ok(component);
    };
    component.restore(bytes)?;
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
        let mut log = if plan.log {
            RunLog::start(&folder, &component, resumed)?
        } else {
            RunLog::none()
        };
        if !resumed {
            component.initialize(0.0, None)?;
            log.initialized(&component, 0.0)?;
        }
        if series.span.is_none_or(|(_, last)| last != from) {
            series.sample(&component)?;
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
        let (references, values) = self.component.scheduled(time);
        self.component.set(&references, &values)?;
        self.log.inputs(&self.component, &references, &values);
        let progress = &mut self.progress;
        let report = self
            .component
            .do_step_watched(time, next - time, &mut |moment| {
                progress.show_within(moment);
                Wish::GoOn
            })?;
        self.count(&report);
        self.log.step(&self.component, &report, time, next - time)?;
        self.series.sample(&self.component)?;
        self.progress.show(&self.component);
        if self.component.time() >= self.next_checkpoint {
            match self.checkpoint() {
                // The checkpoint before it is still there.
                Err(error @ CliError::File { .. }) => {
                    if !std::mem::replace(&mut self.warned, true) {
                        let text = error.as_warning();
                        tell!("warning: {text}; the run goes on without new checkpoints");
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
    fn checkpoint(&mut self) -> Result<(), CliError> {
        self.series.flush()?;
        self.folder.replace(CHECKPOINT, &self.component.save()?)?;
        self.saved = Some(self.component.time());
        self.write_summary("running", None)?;
        self.plan_checkpoint();
        Ok(())
    }

    /// Saves the state that the run ends with, for the last time. That of a failed step is none to go on from: the one before
    /// it is saved in its place, and what then stands in the summary is of that one, too. Answers its time [s], if so.
    fn last_checkpoint(&mut self, outcome: &mut Outcome) -> Option<f64> {
        let went_back = self.component.mode() == Mode::Failed && self.component.back_to_kept();
        let now = self.component.time();
        let saved = match self.component.mode() {
            Mode::Stepping => self.checkpoint(),
            _ => self.series.flush(),
        };
        if saved.is_err() && self.saved != Some(now) {
            let before = match self.saved {
                Some(time) => format!("the last that was is that of t = {time} s"),
                None => "none was in this run".to_owned(),
            };
            tell!("warning: the state at t = {now} s is not saved; {before}");
        }
        let time = (went_back && saved.is_ok()).then_some(now);
        outcome.fails_by(saved);
        time
    }

    fn plan_checkpoint(&mut self) {
        if let Some(every) = self.plan.checkpoint_every {
            let time = self.component.time();
            self.next_checkpoint = next_point(time, every, f64::INFINITY).unwrap_or(f64::INFINITY);
        }
    }

    fn write_summary(&self, status: &str, error: Option<&str>) -> Result<(), CliError> {
        let text = summary::json(self, status, error)?;
        self.folder.replace("summary.json", text.as_bytes())
    }

    /// The last summary. Where there is no room for it the one that says "running" is written over, without the variables.
    fn write_last_summary(&self, status: &str, error: Option<&str>) -> Result<(), CliError> {
        let written = self.write_summary(status, error);
        if written.is_err() {
            let text = summary::json(self, status, error)?;
            let short = serde_json::from_str(&text).map(|mut all: serde_json::Value| {
                all["variables"] = serde_json::json!({});
                all.to_string()
            });
            if let Ok(short) = short {
                self.folder.write_over("summary.json", short.as_bytes());
            }
        }
        written
    }

    /// Finishes every file, prints the table and says how to go on. A file that cannot be written does not keep the others
    /// from being written, and does not hide what ended the run: the first error is the run's, the others are told.
    ///
    /// # Errors
    /// The error that ended the run; [`CliError::Interrupted`] with the command to go on; [`CliError::File`],
    /// [`CliError::Log`].
    pub(super) fn close(mut self, mut outcome: Outcome) -> Result<(), CliError> {
        self.progress.finish();
        match self.finish_log(&outcome) {
            // Told already: it is the log that ended the run.
            Err(_) if matches!(outcome, Outcome::Failed(CliError::Log(_))) => {}
            finished => outcome.fails_by(finished),
        }
        let before_failure = self.last_checkpoint(&mut outcome);
        self.series.end_with_whole_row();
        let title = &self.component.scene().title;
        match plot::svg(title, &self.series) {
            Ok(svg) => outcome.fails_by(self.folder.replace("gauges.svg", svg.as_bytes())),
            Err(error) => tell!("warning: gauges.svg could not be drawn: {error}"),
        }
        let (status, error) = outcome.words();
        let summary = self.write_last_summary(status, error.as_deref());
        outcome.fails_by(summary);
        let said = say(&summary::table(&self, outcome.words().0));
        outcome.fails_by(said);
        let checkpoint = self.folder.file(CHECKPOINT);
        if let Some(time) = before_failure {
            tell!(
                "saved in {}: the state at t = {time} s, before the step that failed. With the same scene, inputs and steps it \
                 fails there again",
                checkpoint.display()
            );
        }
        match outcome {
            Outcome::Finished => Ok(()),
            Outcome::Interrupted => Err(CliError::Interrupted(format!(
                "interrupted at t = {} s; everything is saved. Go on with:\n  {} --resume {}",
                self.component.time(),
                self.plan.go_on,
                shell_word(&checkpoint)
            ))),
            Outcome::Failed(error) => Err(error),
        }
    }

    fn finish_log(&mut self, outcome: &Outcome) -> Result<(), CliError> {
        let (status, error) = outcome.words();
        self.log.finish(&self.component, status, error.as_deref())
    }
}
