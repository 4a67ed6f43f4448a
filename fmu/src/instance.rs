//! One instance: a component, its caller's logger, and what has to be remembered between calls.

mod life;
mod state;

use std::ffi::CString;

use sandgate::component::{Causality, Component, VariableTable};
use sandgate::fmi::library::BUILT_FROM;
use sandgate::fmi::{self, FmiVersion};
use sandgate::scene::{self, Scene};

use crate::access::Values;
use crate::asked::Asked;
use crate::fault::{Fault, Status};
use crate::guard::{Handle, Text, embedded_scene, inside, shield, spare_callers_thread};
use crate::journal::Journal;
use crate::log::{Category, Log, text};
use crate::updates::Updates;

/// FMI 2's setupExperiment: importers may leave it out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Experiment {
    /// Start time [s].
    pub(crate) start: f64,
    /// No step may end later [s].
    pub(crate) stop: Option<f64>,
}

/// Builds an instance and hands it to the caller; a refusal goes to the log, as there is no instance to tell it later.
pub(crate) fn create(
    call: &str,
    log: Log,
    build: impl FnOnce(Log) -> Result<Instance, Fault>,
) -> Handle {
    inside(|| {
        let result = shield(|| build(log.clone())).unwrap_or_else(|how| Err(Fault::Broken(how)));
        match result {
            Ok(instance) => Handle::new(instance),
            Err(fault) => {
                log.say(Category::Error, Status::Error, &format!("{call}: {fault}"));
                Handle::null()
            }
        }
    })
}

/// An instance's name: it stands in messages and topics, so white space alone is none.
pub(crate) fn checked_name(name: &str) -> Result<&str, Fault> {
    if name.trim().is_empty() {
        return Err(Fault::border(format!(
            "instanceName: found {name:?}, allowed a name with a visible character"
        )));
    }
    Ok(name)
}

impl Values for Instance {
    fn table(&self) -> &VariableTable {
        self.component.variables()
    }

    fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        if self.component.is_unsettled() {
            let table = self.component.variables();
            let mut rows = references.iter().filter_map(|r| table.by_reference(*r));
            if rows.any(|row| row.causality == Causality::Output) {
                self.component.settle()?;
            }
        }
        Ok(self.component.get(references, values)?)
    }

    fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), Fault> {
        self.journal.asks_set(&self.component, references, values);
        self.component.set(references, values)?;
        self.journal.set(&self.component, references, values);
        self.tell_notes();
        Ok(())
    }

    fn slopes(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        Ok(self.component.output_derivatives(references, values)?)
    }

    fn refused(&mut self, references: &[u32]) {
        self.refuses(&Asked::Variables(references));
    }
}

/// What a handle points to.
pub(crate) struct Instance {
    pub(crate) component: Component,
    pub(crate) log: Log,
    /// Its MCAP log.
    pub(crate) journal: Journal,
    pub(crate) experiment: Experiment,
    /// Whether the importer gave these times since the instance was made or reset, so that those of a state do not count.
    pub(crate) told_times: bool,
    /// Status of the last doStep, for fmi2GetStatus.
    pub(crate) last_step: Status,
    /// FMI 3: whom to call during steps.
    pub(crate) updates: Option<Updates>,
    /// Message of the last refused or failed call, for sandgate_last_error.
    pub(crate) last_error: CString,
    /// Texts that were read last, as C has them.
    pub(crate) texts: Vec<CString>,
    /// Text of the variables with zero bytes behind it, for sandgate_variable_info.
    pub(crate) names: Vec<[CString; 4]>,
    broken: Option<String>,
}

impl Instance {
    /// Builds a component. Library users want one thread unless they ask for more: importers run instances beside
    /// each other, and results do not depend on it.
    pub(crate) fn new(scene: &Scene, log: Log) -> Result<Self, Fault> {
        spare_callers_thread();
        let mut component = Component::new(scene)?;
        component.set_threads(1);
        Ok(Self {
            component,
            log,
            journal: Journal::new(None, &scene.name),
            experiment: Experiment::default(),
            told_times: false,
            last_step: Status::Ok,
            updates: None,
            last_error: CString::default(),
            texts: Vec::new(),
            names: Vec::new(),
            broken: None,
        })
    }

    /// An FMU's instance, from the scene inside the library, if `token` belongs to it.
    pub(crate) fn of_fmu(
        version: FmiVersion,
        name: &str,
        token: &str,
        log: Log,
    ) -> Result<Self, Fault> {
        let source = embedded_scene().map_err(|error| Fault::border(error.to_string()))?;
        let scene = scene::parse("resources/scene.toml", &source)
            .map_err(|errors| Fault::border(errors.to_string()))?;
        let mut instance = Self::new(&scene, log)?;
        instance.journal = Journal::new(Some(version), name);
        let expected = fmi::token(&instance.component, version);
        if token != expected {
            return Err(Fault::border(format!(
                "instantiation token: found {token}, expected {expected}: modelDescription.xml and library are not \
                 from the same FMU; {BUILT_FROM}pack it again with `sandgate fmu`"
            )));
        }
        instance.event(|| format!("instantiated scene {}", scene.name));
        Ok(instance)
    }

    /// FMI 3: whether inputs are among the variables that the importer wants to reach during steps.
    pub(crate) fn sets_inputs(&self, required: &[u32]) -> Result<bool, Fault> {
        let table = self.component.variables();
        let mut inputs = false;
        for reference in required {
            let row = table.by_reference(*reference).ok_or_else(|| {
                Fault::border(format!(
                    "requiredIntermediateVariables: found value reference {reference}, allowed 0 to {}",
                    table.rows().len() - 1
                ))
            })?;
            inputs |= row.causality == Causality::Input;
        }
        Ok(inputs)
    }

    /// How an earlier call broke down, if one did.
    pub(crate) fn broken(&self) -> Option<&str> {
        self.broken.as_deref()
    }

    pub(crate) fn set_broken(&mut self, how: &str) {
        self.broken = Some(how.to_owned());
    }

    /// A call is over: keeps the message of a fault and passes it on, and tells the log.
    pub(crate) fn answered(&mut self, call: &str, fault: Option<&Fault>) {
        if let Some(fault) = fault {
            let message = format!("{call}: {fault}");
            self.last_error = text(&message);
            self.log.say(Category::Error, fault.status(), &message);
        }
        self.journal
            .reply(&self.component, fault.map_or(Ok(()), Err));
        while let Some(complaint) = self.journal.take_complaint() {
            self.log.say(Category::Warning, Status::Warning, &complaint);
        }
        if let Some(event) = self.journal.take_event() {
            self.event(|| event);
        }
    }

    /// Passes on which inputs were clamped.
    fn tell_notes(&mut self) {
        for note in self.component.take_notes() {
            self.log.say(Category::Warning, Status::Warning, &note);
            self.journal.warning(&self.component, &note);
        }
    }

    /// The call that is running is going to be refused: its log has what was asked.
    pub(crate) fn refuses(&mut self, asked: &Asked<'_>) {
        self.journal.refuses(&self.component, asked);
    }

    /// Sets texts, all or none.
    pub(crate) fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Result<(), Fault> {
        let asked = Asked::Texts(references, texts);
        self.journal.asks(&self.component, &asked);
        for (reference, text) in references.iter().zip(texts) {
            if let Some(row) = self.component.variables().by_reference(*reference) {
                self.journal.check_text(&row.name, text)?;
            }
        }
        Ok(self.component.set_texts(references, texts)?)
    }

    /// Slopes of inputs for the next step.
    pub(crate) fn set_slopes(&mut self, references: &[u32], slopes: &[f64]) -> Result<(), Fault> {
        self.journal.asks_set(&self.component, references, slopes);
        // No slope has no sign: one of -0 would stand in states, and not among the slopes that a log begins with.
        let slopes: Vec<f64> = slopes.iter().map(|slope| slope + 0.0).collect();
        self.component.set_input_derivatives(references, &slopes)?;
        self.journal.slopes(&self.component, references, &slopes);
        Ok(())
    }

    /// Logs what happened; the text is made only if somebody wants it.
    pub(crate) fn event(&self, what: impl FnOnce() -> String) {
        if self.log.wants(Category::Event) {
            self.log.say(Category::Event, Status::Ok, &what());
        }
    }

    /// Threads of the sweeps; 0 means all cores. Results do not depend on it.
    ///
    /// # Errors
    /// More than a scene may ask for.
    pub(crate) fn set_threads(&mut self, threads: u32) -> Result<(), Fault> {
        let asked = Asked::Threads(threads);
        self.journal.asks(&self.component, &asked);
        let most = u32::from(Component::MOST_THREADS);
        if threads > most {
            return Err(Fault::border(format!(
                "found {threads} threads, allowed 0 (all cores) to {most}"
            )));
        }
        self.component.set_threads(threads as usize);
        Ok(())
    }

    /// Switches log categories by their names.
    pub(crate) fn switch_log(&mut self, on: bool, names: &[Text]) -> Result<(), Fault> {
        let names: Result<Vec<&str>, Fault> = names.iter().map(|n| n.get("category")).collect();
        self.log.switch(on, &names?)
    }
}
