//! Publications of an instance on Zenoh: what `sandgate::bus` does beside an importer.

use std::collections::BTreeSet;

use sandgate::bus::{Beside, ServeOptions, ZenohConfig};
use sandgate::component::Component;
use sandgate::wire::Observer;

/// Closes a session, within seconds.
pub(super) type Parting = Box<dyn FnOnce() -> Result<(), String>>;

/// An open session.
pub(super) struct Network(Beside);

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
        Ok(Self(beside))
    }

    /// Where it is found.
    pub(super) fn announcement(&self) -> String {
        format!(
            "publishing sandgate/v1/{}, {}",
            self.0.instance(),
            self.0.reach()
        )
    }

    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        &mut self.0
    }

    /// Sets what set-points ask for, but what the importer has set itself.
    pub(super) fn apply(
        &mut self,
        component: &mut Component,
        owned: &BTreeSet<u32>,
        log: &mut dyn Observer,
    ) {
        self.0.apply(component, owned, log);
    }

    /// The importer's step begins.
    pub(super) fn tell_step(&self, interface: &str) {
        self.0.tell_step(interface);
    }

    pub(super) fn tell_trouble(&self, trouble: Option<String>) {
        self.0.tell_trouble(trouble);
    }

    /// What was asked and answered meanwhile.
    pub(super) fn tell_notes(&mut self, log: &mut dyn Observer) {
        self.0.tell_notes(log);
    }

    /// Nobody gets in any more, and what waits is published; the log hears what was asked to the last.
    pub(super) fn leave(self, log: &mut dyn Observer) -> Parting {
        let leaving = self.0.leave(log);
        Box::new(move || leaving.close().map_err(|error| error.to_string()))
    }
}
