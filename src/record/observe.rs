//! The recorder as an observer of another adapter. A failed write is latched in the recorder
//! ([`Recorder::failure`]); the observed adapter goes on and asks for it when it likes.

use super::Recorder;
use crate::component::{Component, StepReport, ValueReference};
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::{AppliedEvent, Command};
use crate::wire::{Moment, Observer};

impl Observer for Recorder {
    fn on_initialize(
        &mut self,
        component: &Component,
        start: f64,
        stop: Option<f64>,
        source: &str,
    ) {
        let written = self.record_initialization(component, start, stop, source);
        self.keep(written);
    }

    fn on_input(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.record_inputs(component, references, values, source);
    }

    fn on_step(
        &mut self,
        component: &Component,
        report: &StepReport,
        t: f64,
        h: f64,
        source: &str,
    ) {
        let written = self.record_step(component, report, t, h, source);
        self.keep(written);
    }

    fn on_slopes(&mut self, c: &Component, inputs: &[ValueReference], slopes: &[f64], who: &str) {
        self.record_slopes(c, inputs, slopes, who);
    }

    fn on_moment(&mut self, component: &Component, moment: &Moment, source: &str) {
        self.record_moment(component, moment, source);
    }

    fn on_failed_step(&mut self) {
        self.record_failed_step();
    }

    fn on_save(&mut self, component: &Component, state: &[u8; 32], source: &str) {
        let written = self.record_save(component, state, source);
        self.keep(written);
    }

    fn on_restore(&mut self, component: &Component, state: &[u8; 32], source: &str) {
        let written = self.record_restore(component, state, source);
        self.keep(written);
    }

    fn on_command(&mut self, command: &Command) {
        let written = self.record_command(command);
        self.keep(written);
    }

    fn on_reply(&mut self, reply: &Command) {
        let written = self.record_command(reply);
        self.keep(written);
    }

    fn on_jump(&mut self, component: &Component, event: AppliedEvent, source: &str) {
        let written = self.record_jump(component, event, source);
        self.keep(written);
    }

    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str) {
        let written = self.log(time, level, name, message);
        self.keep(written);
    }

    fn trouble(&self) -> Option<String> {
        self.failure().map(|failure| failure.to_string())
    }
}
