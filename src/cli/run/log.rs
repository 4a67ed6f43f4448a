//! The run's log segment: what is told to the recorder, and what is said when a log cannot be written.

use super::folder::Folder;
use crate::cli::CliError;
use crate::component::{Component, StepReport, ValueReference};
use crate::record::{RecordOptions, Recorder};
use crate::wire::foxglove::LogLevel;

/// Who sets inputs and steps, as the log names it.
const SOURCE: &str = "run";

/// A log segment, or none if the run shall have none.
pub(super) struct RunLog {
    recorder: Option<Recorder>,
    /// File name in the run's folder.
    pub(super) name: Option<String>,
    /// Why the log is not whole, if it is not.
    pub(super) failure: Option<String>,
    warned: bool,
}

impl RunLog {
    /// No log.
    pub(super) fn none() -> Self {
        Self {
            recorder: None,
            name: None,
            failure: None,
            warned: false,
        }
    }

    /// Starts the next free segment of the folder. The component is not yet initialised, or restored.
    ///
    /// # Errors
    /// [`CliError::Log`] if it cannot be created.
    pub(super) fn start(
        folder: &Folder,
        component: &Component,
        resumed: bool,
    ) -> Result<Self, CliError> {
        let name = folder.next_log();
        let mut options = RecordOptions::of(component);
        if resumed {
            options.reason = "resumed".to_owned();
        }
        let recorder = Recorder::create(&folder.file(&name), component, options)?;
        Ok(Self {
            recorder: Some(recorder),
            name: Some(name),
            failure: None,
            warned: false,
        })
    }

    /// The component was initialised at `start` [s] without a stop time.
    ///
    /// # Errors
    /// [`CliError::Log`] if the scene requires its log and it cannot be written.
    pub(super) fn initialized(
        &mut self,
        component: &Component,
        start: f64,
    ) -> Result<(), CliError> {
        match &mut self.recorder {
            Some(recorder) => Ok(recorder.record_initialization(component, start, None, SOURCE)?),
            None => Ok(()),
        }
    }

    /// A line for people.
    ///
    /// # Errors
    /// As [`RunLog::initialized`].
    pub(super) fn say(&mut self, component: &Component, text: &str) -> Result<(), CliError> {
        self.line(component, LogLevel::Info, text)
    }

    /// Inputs were set and accepted.
    pub(super) fn inputs(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
    ) {
        if let Some(recorder) = &mut self.recorder {
            recorder.record_inputs(component, references, values, SOURCE);
        }
    }

    /// Inputs were given slopes and accepted.
    pub(super) fn slopes(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        slopes: &[f64],
    ) {
        if let Some(recorder) = &mut self.recorder {
            recorder.record_slopes(component, references, slopes, SOURCE);
        }
    }

    /// A step was done from `t` over `h` [s]. A warning that the log goes no further comes back once.
    ///
    /// # Errors
    /// As [`RunLog::initialized`].
    pub(super) fn step(
        &mut self,
        component: &Component,
        report: &StepReport,
        t: f64,
        h: f64,
    ) -> Result<Option<String>, CliError> {
        let Some(recorder) = &mut self.recorder else {
            return Ok(None);
        };
        let recorded = recorder.record_step(component, report, t, h, SOURCE);
        if self.failure.is_none() {
            self.failure = recorder.failure().map(|failure| failure.to_string());
        }
        recorded?;
        if let (false, Some(failure)) = (self.warned, &self.failure) {
            self.warned = true;
            return Ok(Some(format!(
                "warning: {failure}; the run goes on without its log"
            )));
        }
        Ok(None)
    }

    /// Ends the segment: "finished", "interrupted" or "failed" with the error.
    ///
    /// # Errors
    /// As [`RunLog::initialized`]; also if the finished file cannot get its name.
    pub(super) fn finish(
        &mut self,
        component: &Component,
        status: &str,
        error: Option<&str>,
    ) -> Result<(), CliError> {
        if let Some(error) = error {
            self.line(component, LogLevel::Error, error)?;
        }
        let Some(recorder) = self.recorder.take() else {
            return Ok(());
        };
        // A short run meets a full disk only here, when the last bytes are written.
        let finished = recorder.finish(component, status).inspect_err(|error| {
            self.failure.get_or_insert(error.to_string());
        })?;
        if let Some(failure) = finished.failure {
            let missing = format!("up to {} messages are not in the log", finished.dropped);
            if self.warned {
                tell!("warning: {missing}");
            } else {
                tell!("warning: {failure}; {missing}");
            }
            self.failure = Some(format!("{failure}; {missing}"));
        }
        Ok(())
    }

    fn line(&mut self, component: &Component, level: LogLevel, text: &str) -> Result<(), CliError> {
        match &mut self.recorder {
            Some(recorder) => Ok(recorder.log(component.time(), level, SOURCE, text)?),
            None => Ok(()),
        }
    }
}
