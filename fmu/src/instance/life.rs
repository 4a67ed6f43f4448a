//! What an instance goes through: initialisation, steps, reset, its end; each with what its log is told.

use sandgate::component::{Component, Error, Intermediate, Mode, StepReport, Wish};

use super::{Experiment, Instance};
use crate::asked::Asked;
use crate::fault::{Fault, Status};
use crate::guard::Door;
use crate::journal::Journal;
use crate::log::Category;

impl Instance {
    /// Leaves initialisation: the first gauges are there.
    pub(crate) fn exit_initialization(&mut self) -> Result<(), Fault> {
        let start = self.component.time();
        self.leave_initialization(
            (Mode::Initialization, start),
            Component::exit_initialization,
        )
    }

    /// Enters and leaves initialisation in one.
    pub(crate) fn initialize(&mut self, start: f64, stop: Option<f64>) -> Result<(), Fault> {
        let leave = |c: &mut Component| c.initialize(start, stop);
        let left = self.leave_initialization((Mode::Instantiated, start), leave);
        left.inspect_err(|_| self.refuses(&Asked::Times(start, stop)))
    }

    /// The log is opened before, so that a path that cannot be written is refused and nothing has happened. `start` is where
    /// the component is going to be then [s].
    fn leave_initialization(
        &mut self,
        (from, start): (Mode, f64),
        leave: impl FnOnce(&mut Component) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        let opened = self.component.mode() == from && {
            self.component.settle()?;
            self.journal.open(&self.component, start)?
        };
        let before = self.component.beginning();
        let left = leave(&mut self.component);
        if opened && left.is_err() {
            self.journal.discard();
        }
        left?;
        if opened {
            self.journal.asks(&self.component, &Asked::Nothing);
            if let Err(fault) = self.journal.initialized(&self.component) {
                self.journal.discard();
                self.component.take_back(before)?;
                return Err(fault);
            }
        }
        self.event(|| format!("initialised at t = {} s", self.component.time()));
        Ok(())
    }

    /// One communication step.
    pub(crate) fn step(&mut self, t: f64, h: f64) -> Result<StepReport, Fault> {
        self.step_with(t, h, |component, journal, t, h| {
            if !journal.listens() {
                return component.do_step(t, h);
            }
            component.do_step_watched(t, h, &mut |_| {
                journal.during_step();
                Wish::GoOn
            })
        })
    }

    /// One communication step with the importer's intermediate updates, if it wants any.
    pub(crate) fn step_with_updates(
        &mut self,
        t: f64,
        h: f64,
        door: &Door<'_>,
    ) -> Result<StepReport, Fault> {
        let Some(updates) = self.updates else {
            return self.step(t, h);
        };
        let log = self.log.clone();
        self.step_with(t, h, |component, journal, t, h| {
            let mut warned = false;
            let mut tell = |moment: &mut Intermediate<'_>| {
                journal.during_step();
                updates.tell(moment, &log, journal, door, &mut warned)
            };
            component.do_step_watched(t, h, &mut tell)
        })
    }

    fn step_with(
        &mut self,
        t: f64,
        h: f64,
        step: impl FnOnce(&mut Component, &mut Journal, f64, f64) -> Result<StepReport, Error>,
    ) -> Result<StepReport, Fault> {
        self.last_step = Status::Error;
        self.journal.asks_step(&self.component, t, h);
        self.journal.before_step(&mut self.component, (t, h))?;
        let done = step(&mut self.component, &mut self.journal, t, h)
            .inspect_err(|_| self.journal.failed_step());
        self.tell_notes();
        let report = done?;
        self.journal.step(&self.component, &report, t, h)?;
        self.last_step = Status::Ok;
        self.event(|| {
            format!(
                "step to t = {} s: {} internal steps, smallest {:e} s, bound by {:?}, {} iterations",
                report.time,
                report.substeps,
                report.smallest_step,
                report.bound_by,
                report.iterations
            )
        });
        Ok(report)
    }

    /// Back to start values. After a breakdown nothing of the old component is used again.
    pub(crate) fn reset(&mut self) -> Result<(), Fault> {
        self.journal.asks(&self.component, &Asked::Nothing);
        if self.broken.is_some() {
            self.component = self.component.anew()?;
            self.broken = None;
        } else {
            self.component.reset()?;
        }
        self.journal.reply(&self.component, Ok(()));
        self.journal.end("reset");
        self.experiment = Experiment::default();
        self.told_times = false;
        self.last_step = Status::Ok;
        self.event(|| "reset".to_owned());
        Ok(())
    }

    /// Stepping -> terminated, with the end of the log.
    pub(crate) fn terminate(&mut self) -> Result<(), Fault> {
        self.journal.asks(&self.component, &Asked::Nothing);
        self.component.terminate()?;
        self.journal.reply(&self.component, Ok(()));
        self.journal.finish(&self.component, "terminated")
    }

    /// The instance is at its end: so is its log. What fails now is told to the importer's logger.
    pub(crate) fn finish(mut self, reason: &str) {
        self.end_journal(reason);
        while let Some(complaint) = self.journal.take_complaint() {
            self.log.say(Category::Warning, Status::Warning, &complaint);
        }
    }

    fn end_journal(&mut self, reason: &str) {
        if self.broken.is_some() {
            self.journal.end("broken");
        } else if let Err(fault) = self.journal.finish(&self.component, reason) {
            let message = fault.to_string();
            self.log.say(Category::Error, Status::Error, &message);
        }
    }
}
