//! One instance: a component, its caller's logger, and what has to be remembered between calls.

use std::ffi::CString;

use sandgate::component::{Component, StepReport};
use sandgate::fmi::{self, FmiVersion};
use sandgate::scene::{self, Scene};

use crate::fault::{Fault, Status};
use crate::guard::{Handle, SavedState, Text, embedded_scene, shield};
use crate::log::{Category, Log, text};

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
    let result = shield(|| build(log.clone())).unwrap_or_else(|how| Err(Fault::Broken(how)));
    match result {
        Ok(instance) => Handle::new(instance),
        Err(fault) => {
            log.say(Category::Error, Status::Error, &format!("{call}: {fault}"));
            Handle::null()
        }
    }
}

/// What a handle points to.
pub(crate) struct Instance {
    pub(crate) component: Component,
    pub(crate) log: Log,
    pub(crate) experiment: Experiment,
    /// Status of the last doStep, for fmi2GetStatus.
    pub(crate) last_step: Status,
    /// Scratch for values on their way through the border.
    pub(crate) values: Vec<f64>,
    /// Message of the last refused or failed call, for sandgate_last_error.
    pub(crate) last_error: CString,
    /// Text of the variables with zero bytes behind it, for sandgate_variable_info.
    pub(crate) names: Vec<[CString; 4]>,
    threads: usize,
    broken: Option<String>,
}

impl Instance {
    /// Builds a component. Library users want one thread unless they ask for more: importers run instances beside
    /// each other, and results do not depend on it.
    pub(crate) fn new(scene: &Scene, log: Log) -> Result<Self, Fault> {
        let mut component = Component::new(scene)?;
        component.set_threads(1);
        Ok(Self {
            component,
            log,
            experiment: Experiment::default(),
            last_step: Status::Ok,
            values: Vec::new(),
            last_error: CString::default(),
            names: Vec::new(),
            threads: 1,
            broken: None,
        })
    }

    /// An FMU's instance, from the scene inside the library, if `token` belongs to it.
    pub(crate) fn of_fmu(version: FmiVersion, token: &str, log: Log) -> Result<Self, Fault> {
        let source = embedded_scene().map_err(|error| Fault::border(error.to_string()))?;
        let scene = scene::parse("resources/scene.toml", &source)
            .map_err(|errors| Fault::border(errors.to_string()))?;
        let instance = Self::new(&scene, log)?;
        let expected = fmi::token(&instance.component, version);
        if token != expected {
            return Err(Fault::border(format!(
                "instantiation token: found {token}, expected {expected}: modelDescription.xml and library are not \
                 from the same FMU; pack it again with `sandgate fmu`"
            )));
        }
        instance.event(|| format!("instantiated scene {}", scene.name));
        Ok(instance)
    }

    /// How an earlier call broke down, if one did.
    pub(crate) fn broken(&self) -> Option<&str> {
        self.broken.as_deref()
    }

    pub(crate) fn set_broken(&mut self, how: &str) {
        self.broken = Some(how.to_owned());
    }

    /// Keeps the message of a fault and passes it on.
    pub(crate) fn report(&mut self, call: &str, fault: &Fault) {
        let message = format!("{call}: {fault}");
        self.last_error = text(&message);
        self.log.say(Category::Error, Status::Error, &message);
    }

    /// Logs what happened; the text is made only if somebody wants it.
    pub(crate) fn event(&self, what: impl FnOnce() -> String) {
        if self.log.wants(Category::Event) {
            self.log.say(Category::Event, Status::Ok, &what());
        }
    }

    /// One communication step.
    pub(crate) fn step(&mut self, t: f64, h: f64) -> Result<StepReport, Fault> {
        self.last_step = Status::Error;
        let report = self.component.do_step(t, h)?;
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
        if self.broken.is_some() {
            self.renew()?;
        } else {
            self.component.reset()?;
        }
        self.experiment = Experiment::default();
        self.last_step = Status::Ok;
        self.event(|| "reset".to_owned());
        Ok(())
    }

    /// Everything, as bytes.
    pub(crate) fn save(&self) -> Result<SavedState, Fault> {
        Ok(SavedState {
            bytes: self.component.save()?,
            experiment: Some(self.experiment),
        })
    }

    /// Goes to a saved state; a refused one changes nothing.
    pub(crate) fn restore(
        &mut self,
        bytes: &[u8],
        experiment: Option<Experiment>,
    ) -> Result<(), Fault> {
        if self.broken.is_some() {
            let mut fresh = self.fresh()?;
            fresh.restore(bytes)?;
            self.component = fresh;
            self.broken = None;
        } else {
            self.component.restore(bytes)?;
        }
        if let Some(experiment) = experiment {
            self.experiment = experiment;
        }
        self.event(|| format!("state of t = {} s restored", self.component.time()));
        Ok(())
    }

    /// Threads of the sweeps; 0 means all cores. Results do not depend on it.
    pub(crate) fn set_threads(&mut self, threads: usize) {
        self.threads = threads;
        self.component.set_threads(threads);
    }

    /// Bytes as a state, if this instance could go to it: a bad blob is refused here, not when it is set.
    pub(crate) fn deserialize(&self, bytes: &[u8]) -> Result<SavedState, Fault> {
        self.fresh()?.restore(bytes)?;
        Ok(SavedState {
            bytes: bytes.to_vec(),
            experiment: None,
        })
    }

    /// Leaves initialisation: the first gauges are there.
    pub(crate) fn exit_initialization(&mut self) -> Result<(), Fault> {
        self.component.exit_initialization()?;
        self.event(|| format!("initialised at t = {} s", self.component.time()));
        Ok(())
    }

    /// Switches log categories by their names.
    pub(crate) fn switch_log(&mut self, on: bool, names: &[Text]) -> Result<(), Fault> {
        let names: Result<Vec<&str>, Fault> = names.iter().map(|n| n.get("category")).collect();
        self.log.switch(on, &names?)
    }

    fn renew(&mut self) -> Result<(), Fault> {
        self.component = self.fresh()?;
        self.broken = None;
        Ok(())
    }

    fn fresh(&self) -> Result<Component, Fault> {
        let mut fresh = Component::new(self.component.scene())?;
        fresh.set_threads(self.threads);
        Ok(fresh)
    }
}
