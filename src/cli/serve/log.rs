//! The log of a served component: the recorder, and what happens when it fails.

use std::path::Path;

use crate::cli::CliError;
use crate::component::{Component, StepReport, ValueReference};
use crate::record::{RecordOptions, Recorder};
use crate::wire::Observer;
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::{AppliedEvent, Command};

/// A recorder that says once when it fails, and that nothing goes on without it if the scene says that the log is required.
pub(super) struct Log {
    recorder: Recorder,
    required: bool,
    failed: bool,
}

impl Log {
    /// A new file.
    ///
    /// # Errors
    /// [`CliError::Log`].
    pub(super) fn create(
        file: &Path,
        component: &Component,
        instance: &str,
    ) -> Result<Self, CliError> {
        let options = RecordOptions {
            instance: instance.to_owned(),
            ..RecordOptions::of(component)
        };
        Ok(Self {
            required: options.required,
            recorder: Recorder::create(file, component, options)?,
            failed: false,
        })
    }

    /// Closes the file; the line says where it is.
    ///
    /// # Errors
    /// [`CliError::Log`]: the log is not whole although the scene requires it, or could not be renamed.
    pub(super) fn finish(mut self, component: &Component, why: &str) -> Result<String, CliError> {
        let trouble = self.recorder.take_trouble();
        let finished = self.recorder.finish(component, why)?;
        if let Some(trouble) = trouble {
            return Err(trouble.into());
        }
        Ok(finished.path.map_or_else(String::new, |path| {
            format!("log {}: {} messages", path.display(), finished.messages)
        }))
    }

    /// Removes the file of a component that could not be served.
    pub(super) fn discard(self) {
        if let Err(error) = self.recorder.discard() {
            tell!("warning: the begun log stays: {error}");
        }
    }

    fn watch(&mut self) {
        if self.failed {
            return;
        }
        if let Some(failure) = self.recorder.failure() {
            self.failed = true;
            // Of one that is required `finish` tells.
            if !self.required {
                tell!("warning: {failure}; the component goes on without its log");
            }
        }
    }
}

impl Observer for Log {
    fn on_initialize(&mut self, c: &Component, start: f64, stop: Option<f64>, source: &str) {
        self.recorder.on_initialize(c, start, stop, source);
        self.watch();
    }
    fn on_input(&mut self, c: &Component, refs: &[ValueReference], values: &[f64], source: &str) {
        self.recorder.on_input(c, refs, values, source);
    }
    fn on_step(&mut self, c: &Component, report: &StepReport, t: f64, h: f64, source: &str) {
        self.recorder.on_step(c, report, t, h, source);
        self.watch();
    }
    fn on_command(&mut self, command: &Command) {
        self.recorder.on_command(command);
        self.watch();
    }
    fn on_reply(&mut self, reply: &Command) {
        self.recorder.on_reply(reply);
        self.watch();
    }
    fn on_jump(&mut self, c: &Component, event: AppliedEvent, source: &str) {
        self.recorder.on_jump(c, event, source);
        self.watch();
    }
    fn trouble(&self) -> Option<String> {
        self.recorder.trouble()
    }
    fn ends(&self) -> bool {
        self.required && self.recorder.failure().is_some()
    }
    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str) {
        self.recorder.on_log(time, level, name, message);
        self.watch();
    }
}
