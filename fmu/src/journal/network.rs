//! Publications of an instance on Zenoh: what `sandgate::bus` does beside an importer.

use std::collections::BTreeSet;

use sandgate::bus::{Beside, ServeOptions, ZenohConfig};
use sandgate::component::Component;
use sandgate::wire::Observer;

/// Closes a session, within seconds.
pub(super) type Parting = Box<dyn FnOnce() -> Result<(), String>>;

/// An open session, and the process that opened it.
pub(super) struct Network {
    beside: Beside,
    process: u32,
}

impl Network {
    /// Nothing is in the way.
    pub(super) const REFUSAL: Option<&'static str> = None;

    /// Opens a session by the parameter's text.
    pub(super) fn open(component: &Component, text: &str, name: &str) -> Result<Self, String> {
        let options = ServeOptions {
            instance: name.to_owned(),
            config: ZenohConfig::read(text),
            ..ServeOptions::default()
        };
        let beside = Beside::open(component, &options).map_err(|error| error.to_string())?;
        Ok(Self {
            beside,
            process: std::process::id(),
        })
    }

    /// Whether this process was forked from the one that has its threads.
    pub(super) fn is_lost(&self) -> bool {
        self.process != std::process::id()
    }

    /// Leaves it to that process: closing it would wait for these threads.
    pub(super) fn abandon(self) {
        std::mem::forget(self);
    }

    /// Where it is found.
    pub(super) fn announcement(&self) -> String {
        format!(
            "publishing sandgate/v1/{}, {}",
            self.beside.instance(),
            self.beside.reach()
        )
    }

    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        &mut self.beside
    }

    /// Sets what set-points ask for, but what the importer has set itself.
    pub(super) fn apply(
        &mut self,
        component: &mut Component,
        owned: &BTreeSet<u32>,
        log: &mut dyn Observer,
    ) {
        self.beside.apply(component, owned, log);
    }

    /// The importer's step begins.
    pub(super) fn tell_step(&self, interface: &str) {
        self.beside.tell_step(interface);
    }

    pub(super) fn tell_trouble(&self, trouble: Option<String>) {
        self.beside.tell_trouble(trouble);
    }

    /// What was asked and answered meanwhile.
    pub(super) fn tell_notes(&mut self, log: &mut dyn Observer) {
        self.beside.tell_notes(log);
    }

    /// Nobody gets in any more, and what waits is published; the log hears what was asked to the last.
    pub(super) fn leave(self, log: &mut dyn Observer) -> Parting {
        let leaving = self.beside.leave(log);
        Box::new(move || leaving.close().map_err(|error| error.to_string()))
    }
}
