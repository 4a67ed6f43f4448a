//! How the log and the publications of an instance begin, and how they end.

use sandgate::component::{Causality, Component, Mode, Start, ValueKind};
use sandgate::fmi;
use sandgate::record::{RecordError, RecordOptions, Recorder};
use sandgate::wire::Unobserved;
use sandgate::wire::messages::AppliedEvent;

use super::network::{Network, Parting};
use super::{Journal, listener, told};
use crate::fault::Fault;

/// A log and publications that have begun and belong to no component yet.
#[derive(Default)]
pub(crate) struct Begun {
    log: Option<Recorder>,
    network: Option<Network>,
}

impl Journal {
    /// Initialisation is about to end, at `start` [s]: begins the log and opens the network, if there shall be any. Gives
    /// whether it did.
    pub(crate) fn open(&mut self, component: &Component, start: f64) -> Result<bool, Fault> {
        let settings = component.host_settings();
        let (logs, publishes) = (settings.logs(), settings.publishes());
        if !logs && !publishes {
            return Ok(false);
        }
        if publishes {
            let network = Some(self.connect(component)?);
            self.adopt(Begun { log: None, network });
        }
        if logs {
            match self.create(component, ("start", start)) {
                Ok(log) => self.log = Some(log),
                Err(fault) => {
                    self.discard();
                    return Err(fault);
                }
            }
        }
        self.tell_start(component)?;
        Ok(true)
    }

    /// What was set before anybody listened.
    fn tell_start(&mut self, component: &Component) -> Result<(), Fault> {
        let settable = component.variables().rows().iter().filter(|row| {
            matches!(row.causality, Causality::Parameter | Causality::Input)
                && row.kind != ValueKind::Text
                && !component.variables().is_for_host(row)
        });
        for row in settable {
            let mut now = vec![0.0; row.len()];
            component.get(&[row.reference], &mut now)?;
            // By bits: a zero of the other sign is another value.
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let starts = matches!(&row.start, Start::Exact(start) if bits(start) == bits(&now));
            if !starts {
                self.each(|one, source| one.on_input(component, &[row.reference], &now, source));
            }
        }
        for (reference, slope) in component.input_slopes() {
            self.each(|one, source| one.on_slopes(component, &[reference], &[slope], source));
        }
        Ok(())
    }

    fn connect(&self, component: &Component) -> Result<Network, Fault> {
        let name = match self.instance.as_str() {
            "" => component.scene().name.as_str(),
            own => own,
        };
        let text = &component.host_settings().zenoh_config;
        Network::open(component, text, name)
            .map_err(|why| Fault::Outside(format!("zenoh.config: {why}")))
    }

    fn create(
        &mut self,
        component: &Component,
        (reason, start): (&str, f64),
    ) -> Result<Recorder, Fault> {
        let settings = component.host_settings();
        // Importers change the directory as they like; the file stays where it is meant now.
        let path = std::path::absolute(&settings.log_path)
            .map_err(|why| Fault::Outside(format!("log.path {:?}: {why}", settings.log_path)))?;
        let mut options = RecordOptions {
            required: settings.log_required,
            reason: reason.to_owned(),
            begins: Some(start),
            ..RecordOptions::of(component)
        };
        if !self.instance.is_empty() {
            options.instance.clone_from(&self.instance);
        }
        if let Some(version) = self.version {
            let text = fmi::description(component, version).into_bytes();
            let name = "modelDescription.xml".to_owned();
            options.attachments = vec![(name, "application/xml".to_owned(), text)];
        }
        let jumps = match &self.before {
            Some((before, jumps)) if *before == path => *jumps,
            _ => 0,
        };
        let log = Recorder::create_after(&path, jumps, component, options).map_err(told)?;
        self.before = Some((path, log.next_epoch()));
        (self.complained, self.complaint) = (false, None);
        Ok(log)
    }

    /// Initialisation was refused after all.
    pub(crate) fn discard(&mut self) {
        if let Some(log) = self.log.take() {
            if let Err(error) = log.discard() {
                self.complaint = Some(error.to_string());
            }
            // The name is free again.
            if let Some((_, jumps)) = &mut self.before {
                *jumps = jumps.saturating_sub(1);
            }
        }
        let parting = self.leave();
        self.close(parting);
    }

    /// The network's part in the end of the log: it hears what was asked to the last. Closing the session comes after the
    /// log's end, because it may take a while.
    fn leave(&mut self) -> Option<Parting> {
        self.forget_lost_session();
        self.owned.clear();
        let network = self.network.take()?;
        Some(network.leave(listener(&mut self.log, &mut Unobserved)))
    }

    fn close(&mut self, parting: Option<Parting>) {
        if let Some(parting) = parting {
            self.unclosed = parting().err();
        }
    }

    /// Whether a state may be refused because of what begins there: parameters ask for what has not begun, and it is
    /// required.
    pub(crate) fn may_refuse(&self, component: &Component) -> bool {
        let settings = component.host_settings();
        let logs = self.log.is_none() && settings.logs();
        let publishes = self.network.is_none() && settings.publishes();
        settings.log_required && (logs || publishes)
    }

    /// An instance that was not initialised here goes to a state, `there`: what its parameters ask for begins; if it is
    /// required all of it or, with an error, nothing.
    pub(crate) fn begin_late(&mut self, there: &Component) -> Result<Begun, Fault> {
        let settings = there.host_settings();
        let mut begun = Begun::default();
        if there.mode() != Mode::Stepping {
            return Ok(begun);
        }
        let mut faults = Vec::new();
        if self.network.is_none() && settings.publishes() {
            match self.connect(there) {
                Ok(mut network) => {
                    network
                        .observer()
                        .on_jump(there, AppliedEvent::Restore, self.interface);
                    begun.network = Some(network);
                }
                Err(fault) if settings.log_required => return Err(fault),
                Err(fault) => faults.push(fault.to_string()),
            }
        }
        if self.log.is_none() && settings.logs() {
            match self.create(there, ("restored", there.time())) {
                Ok(log) => begun.log = Some(log),
                Err(fault) if settings.log_required => {
                    if let Some(network) = begun.network {
                        // Nobody has seen it yet; why the state is refused is what counts.
                        let _ = network.leave(&mut Unobserved)();
                    }
                    return Err(fault);
                }
                Err(fault) => faults.push(fault.to_string()),
            }
        }
        if !faults.is_empty() {
            self.complaint = Some(faults.join("; "));
        }
        Ok(begun)
    }

    /// The component has come to where they began.
    pub(crate) fn adopt(&mut self, begun: Begun) {
        if let Some(network) = begun.network {
            self.event = Some(network.announcement());
            self.network = Some(network);
        }
        if let Some(log) = begun.log {
            self.log = Some(log);
        }
    }

    /// The component was reset, or is no longer what it was: nothing more is told.
    pub(crate) fn end(&mut self, reason: &str) {
        let parting = self.leave();
        if let Some(log) = self.take()
            && let Err(error) = log.end(reason)
        {
            // Its own words end with what a required log keeps from going on: nothing of it goes on here.
            self.complaint = Some(match error {
                RecordError::Required(failure) => failure.to_string(),
                other => other.to_string(),
            });
        }
        self.close(parting);
    }

    /// The log, and remembers how often its component has jumped.
    fn take(&mut self) -> Option<Recorder> {
        let log = self.log.take()?;
        if let Some((_, jumps)) = &mut self.before {
            *jumps = log.next_epoch();
        }
        Some(log)
    }

    /// The component has come to its end: so do log and publications.
    pub(crate) fn finish(&mut self, component: &Component, reason: &str) -> Result<(), Fault> {
        let parting = self.leave();
        let finished = self.take().map(|log| log.finish(component, reason));
        self.close(parting);
        let Some(finished) = finished else {
            return Ok(());
        };
        let finished = finished.map_err(told)?;
        if let Some(failure) = finished.failure
            && !self.complained
        {
            self.complaint = Some(failure.to_string());
        }
        Ok(())
    }
}
