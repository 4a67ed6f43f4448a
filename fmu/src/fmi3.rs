//! FMI 3.0: all 75 functions. Co-simulation is provided; what belongs to model exchange, scheduled execution, events,
//! clocks and structural parameters is there and answers Error with a message.
//!
//! Names and order of arguments are the standard's (fmi3Functions.h); a test compiles them against that header.

use std::ffi::c_char;

use sandgate::fmi::FmiVersion;

use crate::access::{
    Flag, get, get_texts, no_variable_of_type, output_derivatives, set, set_texts,
};
use crate::fault::{Fault, Status};
use crate::guard::{
    Environment, Handle, In, IntermediateUpdate3, Logger3, Need, Out, StateHandle, StateSlot, Text,
    UnusedCallback,
};
use crate::instance::{Instance, Updates, create};
use crate::log::{Log, Sink};

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
        let name = name.get("instanceName")?;
        if name.is_empty() {
            return Err(Fault::border("instanceName is empty, expected a name"));
        }
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

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetFMUState(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi3GetFMUState", Need::Sound, |i| state.put(i.save()?))
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetFMUState(c: Handle, state: StateHandle) -> Status {
    c.call("fmi3SetFMUState", Need::Any, |i| {
        let state = state.get()?;
        i.restore(&state.bytes, state.experiment)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3FreeFMUState(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi3FreeFMUState", Need::Any, |_| {
        state.free();
        Ok(())
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SerializedFMUStateSize(
    c: Handle,
    state: StateHandle,
    mut size: Out<usize>,
) -> Status {
    c.call("fmi3SerializedFMUStateSize", Need::Any, |_| {
        size.write(&[state.get()?.bytes.len()], "size")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SerializeFMUState(
    c: Handle,
    state: StateHandle,
    mut bytes: Out<u8>,
    size: usize,
) -> Status {
    c.call("fmi3SerializeFMUState", Need::Any, |_| {
        bytes.write(state.get()?.sized(size)?, "serializedState")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3DeserializeFMUState(
    c: Handle,
    bytes: In<u8>,
    size: usize,
    mut state: StateSlot,
) -> Status {
    c.call("fmi3DeserializeFMUState", Need::Any, |i| {
        state.put(i.deserialize(bytes.slice(size, "serializedState")?)?)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetFloat64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetFloat64", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            |v: f64| v,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetInt64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<i64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetInt64", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            |v: i64| v,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<u8>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetBoolean", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            Flag::number,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetFloat64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetFloat64", |i| {
        set::<f64, _>(
            i,
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values")?,
            Ok,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetInt64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<i64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetInt64", |i| {
        set::<i64, _>(
            i,
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values")?,
            Ok,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<u8>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetBoolean", |i| {
        let (vr, values) = (
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values")?,
        );
        set(i, vr, values, |v| Flag::from_number(v.into()))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<*const c_char>,
    n_values: usize,
) -> Status {
    c.call("fmi3GetString", Need::Sound, |i| {
        get_texts(i, vr.slice(n, "valueReferences")?, &mut values, n_values)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<Text>,
    n_values: usize,
) -> Status {
    c.call("fmi3SetString", Need::Sound, |i| {
        let references = vr.slice(n, "valueReferences")?;
        set_texts(i, references, values.slice(n_values, "values")?)
    })
    .into()
}

/// Getters and setters of types that no variable has.
macro_rules! no_variables {
    ($($name:ident, $values:ty, $kind:literal;)*) => {$(
        #[unsafe(no_mangle)]
        pub(crate) extern "C" fn $name(
            c: Handle,
            _vr: In<u32>,
            n: usize,
            _values: $values,
            _n_values: usize,
        ) -> Status {
            c.call(stringify!($name), Need::Sound, |_| no_variable_of_type($kind, n))
                .into()
        }
    )*};
}

no_variables! {
    fmi3GetFloat32, Out<f32>, "Float32";
    fmi3SetFloat32, In<f32>, "Float32";
    fmi3GetInt8, Out<i8>, "Int8";
    fmi3SetInt8, In<i8>, "Int8";
    fmi3GetUInt8, Out<u8>, "UInt8";
    fmi3SetUInt8, In<u8>, "UInt8";
    fmi3GetInt16, Out<i16>, "Int16";
    fmi3SetInt16, In<i16>, "Int16";
    fmi3GetUInt16, Out<u16>, "UInt16";
    fmi3SetUInt16, In<u16>, "UInt16";
    fmi3GetInt32, Out<i32>, "Int32";
    fmi3SetInt32, In<i32>, "Int32";
    fmi3GetUInt32, Out<u32>, "UInt32";
    fmi3SetUInt32, In<u32>, "UInt32";
    fmi3GetUInt64, Out<u64>, "UInt64";
    fmi3SetUInt64, In<u64>, "UInt64";
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetBinary(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _sizes: Out<usize>,
    _values: Out<*const u8>,
    _n_values: usize,
) -> Status {
    c.call("fmi3GetBinary", Need::Sound, |_| {
        no_variable_of_type("Binary", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetBinary(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _sizes: In<usize>,
    _values: In<*const u8>,
    _n_values: usize,
) -> Status {
    c.call("fmi3SetBinary", Need::Sound, |_| {
        no_variable_of_type("Binary", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetClock(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _values: Out<u8>,
) -> Status {
    c.call("fmi3GetClock", Need::Sound, |_| {
        no_variable_of_type("Clock", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetClock(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _values: In<u8>,
) -> Status {
    c.call("fmi3SetClock", Need::Sound, |_| {
        no_variable_of_type("Clock", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetOutputDerivatives(
    c: Handle,
    vr: In<u32>,
    n: usize,
    orders: In<i32>,
    mut values: Out<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetOutputDerivatives", |i| {
        let (vr, orders) = (vr.slice(n, "valueReferences")?, orders.slice(n, "orders")?);
        output_derivatives(i, vr, orders, &mut values, n_values)
    })
    .into()
}

/// Functions behind a capability that modelDescription.xml does not claim.
macro_rules! not_provided {
    ($($capability:literal: $name:ident($($argument:ty),*);)*) => {$(
        #[unsafe(no_mangle)]
        pub(crate) extern "C" fn $name(c: Handle, $(_: $argument),*) -> Status {
            c.not_provided(stringify!($name), $capability)
        }
    )*};
}

not_provided! {
    "providesPerElementDependencies": fmi3GetNumberOfVariableDependencies(u32, Out<usize>);
    "providesPerElementDependencies": fmi3GetVariableDependencies(
        u32, Out<usize>, Out<u32>, Out<usize>, Out<i32>, usize);
    "providesDirectionalDerivatives": fmi3GetDirectionalDerivative(
        In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    "providesAdjointDerivatives": fmi3GetAdjointDerivative(
        In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    "ModelVariables (no structural parameters)": fmi3EnterConfigurationMode();
    "ModelVariables (no structural parameters)": fmi3ExitConfigurationMode();
    "hasEventMode": fmi3EnterEventMode();
    "hasEventMode": fmi3EnterStepMode();
    "providesEvaluateDiscreteStates": fmi3EvaluateDiscreteStates();
    "hasEventMode": fmi3UpdateDiscreteStates(
        Out<u8>, Out<u8>, Out<u8>, Out<u8>, Out<u8>, Out<f64>);
    "ModelVariables (no clocks)": fmi3GetIntervalDecimal(In<u32>, usize, Out<f64>, Out<i32>);
    "ModelVariables (no clocks)": fmi3GetIntervalFraction(
        In<u32>, usize, Out<u64>, Out<u64>, Out<i32>);
    "ModelVariables (no clocks)": fmi3GetShiftDecimal(In<u32>, usize, Out<f64>);
    "ModelVariables (no clocks)": fmi3GetShiftFraction(In<u32>, usize, Out<u64>, Out<u64>);
    "ModelVariables (no clocks)": fmi3SetIntervalDecimal(In<u32>, usize, In<f64>);
    "ModelVariables (no clocks)": fmi3SetIntervalFraction(In<u32>, usize, In<u64>, In<u64>);
    "ModelVariables (no clocks)": fmi3SetShiftDecimal(In<u32>, usize, In<f64>);
    "ModelVariables (no clocks)": fmi3SetShiftFraction(In<u32>, usize, In<u64>, In<u64>);
    "CoSimulation (no model exchange)": fmi3EnterContinuousTimeMode();
    "CoSimulation (no model exchange)": fmi3CompletedIntegratorStep(u8, Out<u8>, Out<u8>);
    "CoSimulation (no model exchange)": fmi3SetTime(f64);
    "CoSimulation (no model exchange)": fmi3SetContinuousStates(In<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetContinuousStateDerivatives(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetEventIndicators(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetContinuousStates(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetNominalsOfContinuousStates(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetNumberOfEventIndicators(Out<usize>);
    "CoSimulation (no model exchange)": fmi3GetNumberOfContinuousStates(Out<usize>);
    "CoSimulation (no scheduled execution)": fmi3ActivateModelPartition(u32, f64);
}
