//! FMI 2.0 for co-simulation: all 34 functions of the common and co-simulation part. Here is the life of an instance;
//! `variables` has its values, `state` its saved states.
//!
//! Names and order of arguments are the standard's (fmi2Functions.h); a test compiles them against that header.

pub(crate) mod state;
pub(crate) mod variables;

use std::ffi::c_char;

use sandgate::component::{Error, Mode};
use sandgate::fmi::FmiVersion;

use crate::fault::{Fault, Status};
use crate::guard::{Callbacks2, Handle, In, Need, Out, Text};
use crate::instance::{Experiment, Instance, checked_name, create};
use crate::log::{Log, Sink, text};

const CO_SIMULATION: i32 = 1;
/// fmi2StatusKind.
const DO_STEP_STATUS: i32 = 0;
const LAST_SUCCESSFUL_TIME: i32 = 2;
const TERMINATED: i32 = 3;

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetDebugLogging(
    c: Handle,
    on: i32,
    n: usize,
    categories: In<Text>,
) -> Status {
    c.call("fmi2SetDebugLogging", Need::Any, |i| {
        i.switch_log(on != 0, categories.slice(n, "categories")?)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2Instantiate(
    name: Text,
    kind: i32,
    guid: Text,
    _resources: Text,
    functions: In<Callbacks2>,
    _visible: i32,
    logging: i32,
) -> Handle {
    let named = name.get("instanceName").unwrap_or("?");
    let sink = match functions.copied() {
        Some(callbacks) => Sink::Fmi2(callbacks, text(named)),
        None => Sink::Nobody,
    };
    create("fmi2Instantiate", Log::new(sink, logging != 0), |log| {
        checked_name(name.get("instanceName")?)?;
        if kind != CO_SIMULATION {
            return Err(Fault::border(format!(
                "fmuType: found {kind}, allowed 1 (fmi2CoSimulation)"
            )));
        }
        Instance::of_fmu(FmiVersion::V2, named, guid.get("fmuGUID")?, log)
    })
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2FreeInstance(c: Handle) {
    c.free();
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetupExperiment(
    c: Handle,
    _tolerance_defined: i32,
    _tolerance: f64,
    start: f64,
    stop_defined: i32,
    stop: f64,
) -> Status {
    c.call("fmi2SetupExperiment", Need::Sound, |i| {
        i.expect_mode("fmi2SetupExperiment", Mode::Instantiated)?;
        let stop = (stop_defined != 0).then_some(stop);
        i.component.check_times("setup_experiment", start, stop)?;
        i.experiment = Experiment { start, stop };
        i.told_times = true;
        Ok(())
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2EnterInitializationMode(c: Handle) -> Status {
    c.call("fmi2EnterInitializationMode", Need::Sound, |i| {
        let Experiment { start, stop } = i.experiment;
        Ok(i.component.enter_initialization(start, stop)?)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2ExitInitializationMode(c: Handle) -> Status {
    c.call("fmi2ExitInitializationMode", Need::Sound, |i| {
        i.exit_initialization()
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2Terminate(c: Handle) -> Status {
    c.call("fmi2Terminate", Need::Sound, |i| i.terminate())
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2Reset(c: Handle) -> Status {
    c.call("fmi2Reset", Need::Any, Instance::reset).into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2DoStep(c: Handle, t: f64, h: f64, _no_set_state: i32) -> Status {
    c.call("fmi2DoStep", Need::Sound, |i| i.step(t, h).map(drop))
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2CancelStep(c: Handle) -> Status {
    c.not_provided("fmi2CancelStep", "canRunAsynchronuously")
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetStatus(c: Handle, kind: i32, mut value: Out<i32>) -> Status {
    c.call("fmi2GetStatus", Need::Any, |i| {
        expect_kind(kind, DO_STEP_STATUS, "0 (fmi2DoStepStatus)")?;
        value.write(&[i.last_step as i32], "value")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetRealStatus(c: Handle, kind: i32, mut value: Out<f64>) -> Status {
    c.call("fmi2GetRealStatus", Need::Sound, |i| {
        expect_kind(kind, LAST_SUCCESSFUL_TIME, "2 (fmi2LastSuccessfulTime)")?;
        value.write(&[i.component.time()], "value")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetIntegerStatus(c: Handle, _kind: i32, _value: Out<i32>) -> Status {
    c.call("fmi2GetIntegerStatus", Need::Any, |_| {
        Err(no_status("FMI 2 has no integer status"))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetBooleanStatus(c: Handle, kind: i32, mut value: Out<i32>) -> Status {
    c.call("fmi2GetBooleanStatus", Need::Any, |_| {
        expect_kind(kind, TERMINATED, "3 (fmi2Terminated)")?;
        // The component never asks to end the simulation.
        value.write(&[0], "value")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetStringStatus(
    c: Handle,
    _kind: i32,
    _value: Out<*const c_char>,
) -> Status {
    c.call("fmi2GetStringStatus", Need::Any, |_| {
        Err(no_status(
            "no step is ever pending; see canRunAsynchronuously in modelDescription.xml",
        ))
    })
    .into()
}

/// What cannot be given is discarded, says FMI 2.0.4, section 4.2.3.
fn no_status(why: &str) -> Fault {
    Fault::NoStatus(why.to_owned())
}

fn expect_kind(found: i32, allowed: i32, name: &str) -> Result<(), Fault> {
    if found == allowed {
        return Ok(());
    }
    Err(no_status(&format!(
        "status kind: found {found}, allowed {name}"
    )))
}

impl Instance {
    /// Calls that FMI has in one mode only and the component does not know.
    fn expect_mode(&self, call: &'static str, wanted: Mode) -> Result<(), Fault> {
        let mode = self.component.mode();
        if mode == wanted {
            return Ok(());
        }
        Err(Fault::Component(Error::NotAllowedNow {
            call: call.to_owned(),
            mode,
            allowed: format!("{wanted:?}"),
        }))
    }
}
