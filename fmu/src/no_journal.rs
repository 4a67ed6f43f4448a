//! Instead of `journal` where the library is built without the feature `record`: nothing is left behind, and a path for a
//! log is refused when it is set.

use sandgate::component::{Component, StepReport, Wish};
use sandgate::fmi::FmiVersion;

use crate::asked::{Asked, shown};
use crate::fault::Fault;

/// As `sandgate::wire::Moment`.
#[expect(dead_code, reason = "only a log reads it")]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) inputs: Vec<(Vec<u32>, Vec<f64>)>,
    pub(crate) wish: Wish,
}

/// Nothing that has begun.
#[derive(Default)]
pub(crate) struct Begun;

/// No log.
pub(crate) struct Journal;

impl Journal {
    pub(crate) fn new(_: Option<FmiVersion>, _: &str) -> Self {
        Self
    }

    pub(crate) fn check_text(&self, name: &str, text: &str) -> Result<(), Fault> {
        if text.is_empty() {
            return Ok(());
        }
        Err(Fault::border(format!(
            "{name}: found {:?}, allowed \"\": this library was built without logs and Zenoh",
            shown(name, text)
        )))
    }

    pub(crate) fn begin(&mut self, _: &'static str) {}

    pub(crate) fn asks_step(&mut self, _: &Component, _: f64, _: f64) {}

    pub(crate) fn asks_set(&mut self, _: &Component, _: &[u32], _: &[f64]) {}

    pub(crate) fn asks(&mut self, _: &Component, _: &Asked<'_>) {}

    pub(crate) fn refuses(&mut self, _: &Component, _: &Asked<'_>) {}

    pub(crate) fn moment(&mut self, _: &Component, _: &Moment) {}

    pub(crate) fn warning(&mut self, _: &Component, _: &str) {}

    pub(crate) fn reply(&mut self, _: &Component, _: Result<(), &Fault>) {}

    pub(crate) fn open(&mut self, _: &Component, _: f64) -> Result<bool, Fault> {
        Ok(false)
    }

    pub(crate) fn initialized(&mut self, _: &Component) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn discard(&mut self) {}

    pub(crate) fn set(&mut self, _: &Component, _: &[u32], _: &[f64]) {}

    pub(crate) fn slopes(&mut self, _: &Component, _: &[u32], _: &[f64]) {}

    pub(crate) fn take_event(&mut self) -> Option<String> {
        None
    }

    pub(crate) fn before_step(&mut self, _: &mut Component, _: (f64, f64)) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn listens(&self) -> bool {
        false
    }

    pub(crate) fn during_step(&mut self) {}

    pub(crate) fn step(
        &mut self,
        _: &Component,
        _: &StepReport,
        _: f64,
        _: f64,
    ) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn failed_step(&mut self) {}

    pub(crate) fn saved(&mut self, _: &Component, _: &[u8]) {}

    pub(crate) fn goes_on(&self) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn may_refuse(&self, _: &Component) -> bool {
        false
    }

    pub(crate) fn begin_late(&mut self, _: &Component) -> Result<Begun, Fault> {
        Ok(Begun)
    }

    pub(crate) fn adopt(&mut self, _: Begun) {}

    pub(crate) fn restored(&mut self, _: &Component, _: &[u8]) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn end(&mut self, _: &str) {}

    pub(crate) fn finish(&mut self, _: &Component, _: &str) -> Result<(), Fault> {
        Ok(())
    }

    pub(crate) fn take_complaint(&mut self) -> Option<String> {
        None
    }
}
