//! What an instance tells the world beside its importer: an MCAP log of all traffic, if its parameter `log.path` names a
//! file, and, where the library was built with the feature `bus`, publications on Zenoh, if `zenoh.config` is not blank.
//!
//! Both begin when initialisation ends and end with terminate, reset or free; they watch and never change a bit, but for
//! set-points that come over Zenoh. What they hold is the business of `sandgate::record` and `sandgate::bus`. Here they
//! are told what happens; `life` begins and ends them, `calls` tells who asked.

mod calls;
mod life;
#[cfg(feature = "bus")]
mod network;
#[cfg(not(feature = "bus"))]
#[path = "journal/no_network.rs"]
mod network;

use std::collections::BTreeSet;
use std::path::PathBuf;

use sandgate::component::{Component, Mode, StepReport, Wish, saved_checksum};
use sandgate::fmi::FmiVersion;
use sandgate::record::{RecordError, Recorder};
pub(crate) use sandgate::wire::Moment;
use sandgate::wire::{Observer, Unobserved, keys};

use crate::asked::shown;
use crate::fault::Fault;
use network::Network;

/// Longest name of an instance in topics.
const LONGEST_NAME: usize = 64;

/// Log and publications of one instance.
pub(crate) struct Journal {
    /// "fmi2", "fmi3" or "c".
    interface: &'static str,
    version: Option<FmiVersion>,
    /// As topics and keys have it.
    instance: String,
    /// The call that is running.
    call: &'static str,
    /// Whether its request is in the log.
    told: bool,
    log: Option<Recorder>,
    network: Option<Network>,
    /// File of the last log, and how often the component had jumped when it ended.
    before: Option<(PathBuf, u32)>,
    /// What the importer has set since the last step, while there is a network.
    owned: BTreeSet<u32>,
    /// Whether a failure has been told.
    complained: bool,
    complaint: Option<String>,
    /// Why a session is left open, though it should be closed.
    unclosed: Option<String>,
    /// Something to tell the importer.
    event: Option<String>,
}

impl Journal {
    /// For an instance that its importer calls `name`; without a version it is one of the plain C interface.
    pub(crate) fn new(version: Option<FmiVersion>, name: &str) -> Self {
        Self {
            interface: match version {
                Some(FmiVersion::V2) => "fmi2",
                Some(FmiVersion::V3) => "fmi3",
                None => "c",
            },
            version,
            instance: topic_name(name),
            call: "",
            told: false,
            log: None,
            network: None,
            before: None,
            owned: BTreeSet::new(),
            complained: false,
            complaint: None,
            unclosed: None,
            event: None,
        }
    }

    /// A text that this library can do nothing with is refused when it is set.
    pub(crate) fn check_text(&self, name: &str, text: &str) -> Result<(), Fault> {
        let remedy = match self.version {
            Some(_) => "pack the FMU with `sandgate fmu --zenoh` (fmu/README.md)",
            None => "link -lsandgate_fmu_zenoh (docs/c.md)",
        };
        match Network::REFUSAL {
            Some(why) if name == "zenoh.config" && !text.trim().is_empty() => {
                Err(Fault::border(format!(
                    "{name}: found {:?}, allowed \"\": {why}{remedy}",
                    shown(name, text)
                )))
            }
            _ => Ok(()),
        }
    }

    /// The component was initialised.
    pub(crate) fn initialized(&mut self, component: &Component) -> Result<(), Fault> {
        let (start, stop) = (component.time(), component.stop_time());
        self.each(|one, source| one.on_initialize(component, start, stop, source));
        self.watch()
    }

    /// Variables were set.
    pub(crate) fn set(&mut self, component: &Component, references: &[u32], values: &[f64]) {
        self.own(references);
        self.each(|one, source| one.on_input(component, references, values, source));
    }

    /// Inputs were given slopes.
    pub(crate) fn slopes(&mut self, component: &Component, references: &[u32], slopes: &[f64]) {
        self.own(references);
        self.each(|one, source| one.on_slopes(component, references, slopes, source));
    }

    fn own(&mut self, references: &[u32]) {
        if self.network.is_some() {
            self.owned.extend(references);
        }
    }

    /// Inside a step inputs were set, or an early end was asked for.
    pub(crate) fn moment(&mut self, component: &Component, moment: &Moment) {
        if moment.inputs.is_empty() && moment.wish == Wish::GoOn {
            return;
        }
        self.each(|one, source| one.on_moment(component, moment, source));
    }

    /// A log that is required and has failed lets nothing go on, neither by a step nor to another state.
    pub(crate) fn goes_on(&self) -> Result<(), Fault> {
        match &self.log {
            Some(log) if log.is_required() => match log.failure() {
                Some(failure) => Err(told(RecordError::Required(failure))),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// Before a step from `t` over `h` [s]: it may not go on; set-points are taken. A step that is refused changes nothing.
    pub(crate) fn before_step(
        &mut self,
        component: &mut Component,
        (t, h): (f64, f64),
    ) -> Result<(), Fault> {
        self.goes_on()?;
        component.check_step(t, h)?;
        if let Some(network) = &mut self.network {
            network.apply(
                component,
                &self.owned,
                listener(&mut self.log, &mut Unobserved),
            );
            network.tell_step(self.interface);
        }
        Ok(())
    }

    /// A session has no threads in a process that was forked: it stays with the one that opened it.
    fn forget_lost_session(&mut self) {
        if let Some(network) = self.network.take_if(|network| network.is_lost()) {
            network.abandon();
            self.complaint = Some(
                "the Zenoh session stays with the process that this one was forked from".to_owned(),
            );
        }
    }

    /// Whether something may come in while a step runs.
    pub(crate) fn listens(&self) -> bool {
        self.network.is_some()
    }

    /// Between internal steps: what was asked over the network meanwhile goes into the log.
    pub(crate) fn during_step(&mut self) {
        if let Some(network) = &mut self.network {
            network.tell_notes(listener(&mut self.log, &mut Unobserved));
        }
    }

    /// A step was done from `t` over `h` [s].
    pub(crate) fn step(
        &mut self,
        component: &Component,
        report: &StepReport,
        t: f64,
        h: f64,
    ) -> Result<(), Fault> {
        self.owned.clear();
        self.each(|one, source| one.on_step(component, report, t, h, source));
        self.watch()
    }

    /// A step was refused or failed.
    pub(crate) fn failed_step(&mut self) {
        self.each(|one, _| one.on_failed_step());
    }

    /// The state was saved. That needs no log: where a required one fails, the step that follows says so, and the state
    /// is what can be rescued.
    pub(crate) fn saved(&mut self, component: &Component, bytes: &[u8]) {
        if let Some(state) = saved_checksum(bytes) {
            self.each(|one, source| one.on_save(component, &state, source));
        }
        if self.goes_on().is_ok()
            && let Err(fault) = self.watch()
        {
            self.complaint = Some(fault.to_string());
        }
    }

    /// The component has gone to a saved state.
    pub(crate) fn restored(&mut self, component: &Component, bytes: &[u8]) -> Result<(), Fault> {
        if matches!(component.mode(), Mode::Instantiated | Mode::Initialization) {
            self.end("restored");
            return Ok(());
        }
        let state = saved_checksum(bytes).unwrap_or_default();
        self.each(|one, source| one.on_restore(component, &state, source));
        self.watch()
    }

    /// A failure that keeps nothing from going on, once: of a log that is not required, of a session's end.
    pub(crate) fn take_complaint(&mut self) -> Option<String> {
        let Some(complaint) = self.complaint.take() else {
            return self.unclosed.take();
        };
        self.complained = true;
        Some(format!("{complaint}; the component goes on without it"))
    }

    /// Something that happened here.
    pub(crate) fn take_event(&mut self) -> Option<String> {
        self.event.take()
    }

    /// Tells log and network, with the name of the interface.
    fn each(&mut self, mut tell: impl FnMut(&mut dyn Observer, &str)) {
        if let Some(log) = &mut self.log {
            tell(log, self.interface);
        }
        if let Some(network) = &mut self.network {
            tell(network.observer(), self.interface);
        }
    }

    /// Looks how the log took what it was told.
    fn watch(&mut self) -> Result<(), Fault> {
        let Some(log) = &mut self.log else {
            return Ok(());
        };
        let trouble = log.take_trouble();
        if let Some(network) = &self.network {
            network.tell_trouble(log.failure().map(|failure| failure.to_string()));
        }
        if log.is_required() {
            return trouble.map_or(Ok(()), |error| Err(told(error)));
        }
        if !self.complained {
            let failure = log.failure().map(|failure| failure.to_string());
            self.complaint = failure.or_else(|| trouble.map(|error| error.to_string()));
        }
        Ok(())
    }
}

/// The log, or nobody.
fn listener<'a>(log: &'a mut Option<Recorder>, nobody: &'a mut Unobserved) -> &'a mut dyn Observer {
    match log {
        Some(log) => log,
        None => nobody,
    }
}

fn told(error: RecordError) -> Fault {
    match error {
        RecordError::Required(failure) => Fault::Outside(format!(
            "{failure}; the log is required, so nothing goes on; states can be saved, and after a reset with \
             another log.path, or with log.required = false, gone on from"
        )),
        other => Fault::Outside(format!("log.path: {other}")),
    }
}

/// A name that topics can have: lower case, anything but letters, digits, `_` and `-` replaced; empty if nothing is left.
fn topic_name(name: &str) -> String {
    let allowed = |c: char| match c.to_ascii_lowercase() {
        c @ ('a'..='z' | '0'..='9' | '_' | '-') => c,
        _ => '_',
    };
    let name: String = name.chars().map(allowed).take(LONGEST_NAME).collect();
    match keys::base(keys::ROOT, &name) {
        Ok(_) => name,
        Err(_) => String::new(),
    }
}
