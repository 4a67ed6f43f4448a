//! FMI 3.0: all 75 functions. Co-simulation is provided; what belongs to model exchange, scheduled execution, events,
//! clocks and structural parameters is there and answers Error with a message (`absent`). Here is the life of an instance;
//! `variables` has its values, `state` its saved states.
//!
//! Names and order of arguments are the standard's (fmi3Functions.h); a test compiles them against that header.

pub(crate) mod absent;
pub(crate) mod state;
pub(crate) mod variables;

use std::ffi::c_char;

use sandgate::fmi::FmiVersion;

use crate::fault::{Fault, Status};
use crate::guard::{
    Environment, Handle, In, IntermediateUpdate3, Logger3, Need, Out, Text, UnusedCallback,
};
use crate::instance::{Instance, checked_name, create};
use crate::log::{Log, Sink};
use crate::updates::Updates;

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetDebugLogging(
    c: Handle,
    on: u8,
    n: usize,
    categories: In<Text>,
) -> Status {
    c.call("fmi3SetDebugLogging", Need::Any, |i| {
        i.switch_log(on != 0, categories.slice(n, "categories")?)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3InstantiateModelExchange(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: u8,
    logging: u8,
    environment: Environment,
    log: Logger3,
) -> Handle {
    refuse_kind("fmi3InstantiateModelExchange", logging, environment, log)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3InstantiateScheduledExecution(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: u8,
    logging: u8,
    environment: Environment,
    log: Logger3,
    _clock_update: UnusedCallback,
    _lock: UnusedCallback,
    _unlock: UnusedCallback,
) -> Handle {
    refuse_kind(
        "fmi3InstantiateScheduledExecution",
        logging,
        environment,
        log,
    )
}

fn refuse_kind(call: &str, logging: u8, environment: Environment, log: Logger3) -> Handle {
    create(
        call,
        Log::new(Sink::Fmi3(log, environment), logging != 0),
        |_| {
            Err(Fault::border(
                "this FMU is for co-simulation; use fmi3InstantiateCoSimulation",
            ))
        },
    )
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3InstantiateCoSimulation(
    name: Text,
    token: Text,
    _resources: Text,
    _visible: u8,
    logging: u8,
    event_mode_used: u8,
    early_return_allowed: u8,
    intermediate: In<u32>,
    n_intermediate: usize,
    environment: Environment,
    log: Logger3,
    callback: IntermediateUpdate3,
) -> Handle {
    let log = Log::new(Sink::Fmi3(log, environment), logging != 0);
    create("fmi3InstantiateCoSimulation", log, |log| {
        let name = checked_name(name.get("instanceName")?)?;
        if event_mode_used != 0 {
            return Err(Fault::border(
                "eventModeUsed: found true, allowed false (hasEventMode is false)",
            ));
        }
        let required = intermediate.slice(n_intermediate, "requiredIntermediateVariables")?;
        let mut instance =
            Instance::of_fmu(FmiVersion::V3, name, token.get("instantiationToken")?, log)?;
        let sets_inputs = instance.sets_inputs(required)?;
        let early_return_allowed = early_return_allowed != 0;
        // A callback that may neither read, set nor return early has nothing to do.
        if callback.is_given() && (early_return_allowed || !required.is_empty()) {
            instance.updates = Some(Updates {
                callback,
                environment,
                sets_inputs,
                early_return_allowed,
            });
        }
        Ok(instance)
    })
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3FreeInstance(c: Handle) {
    c.free();
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3EnterInitializationMode(
    c: Handle,
    _tolerance_defined: u8,
    _tolerance: f64,
    start: f64,
    stop_defined: u8,
    stop: f64,
) -> Status {
    c.call("fmi3EnterInitializationMode", Need::Sound, |i| {
        let stop = (stop_defined != 0).then_some(stop);
        Ok(i.component.enter_initialization(start, stop)?)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3ExitInitializationMode(c: Handle) -> Status {
    c.call("fmi3ExitInitializationMode", Need::Sound, |i| {
        i.exit_initialization()
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3Terminate(c: Handle) -> Status {
    c.call("fmi3Terminate", Need::Sound, |i| i.terminate())
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3Reset(c: Handle) -> Status {
    c.call("fmi3Reset", Need::Any, Instance::reset).into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3DoStep(
    c: Handle,
    t: f64,
    h: f64,
    _no_set_state: u8,
    mut event_needed: Out<u8>,
    mut terminate: Out<u8>,
    mut early_return: Out<u8>,
    mut last_time: Out<f64>,
) -> Status {
    c.call_with_door("fmi3DoStep", Need::Sound, |i, door| {
        let result = i.step_with_updates(t, h, door);
        let returned_early = result.as_ref().is_ok_and(|report| report.ended_early);
        for flag in [&mut event_needed, &mut terminate] {
            flag.write_if_wanted(0);
        }
        early_return.write_if_wanted(u8::from(returned_early));
        last_time.write_if_wanted(i.component.time());
        result.map(drop)
    })
    .into()
}
