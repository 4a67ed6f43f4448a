//! The end of a run: everything is closed in good order whether it got there, was interrupted or failed.

use super::folder::CHECKPOINT;
use super::session::Session;
use super::{plot, shell_word, summary};
use crate::cli::{CliError, say};
use crate::component::Mode;

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

impl Session {
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
        let scene = self.component.scene();
        let title = match scene.title.trim() {
            "" => &scene.name,
            title => title,
        };
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

    fn finish_log(&mut self, outcome: &Outcome) -> Result<(), CliError> {
        let (status, error) = outcome.words();
        self.log.finish(&self.component, status, error.as_deref())
    }
}
