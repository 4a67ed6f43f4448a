//! Calls of FMI 3: the modes in which each is allowed, and what it is called with.

use std::ptr;

use super::*;

/// All functions of FMI 3.
mod fmi3 {
    pub(super) use crate::fmi3::absent::*;
    pub(super) use crate::fmi3::state::*;
    pub(super) use crate::fmi3::variables::*;
    pub(super) use crate::fmi3::*;
}

/// Functions that are never provided: all arguments NULL or 0.
macro_rules! never {
    ($($name:ident($($argument:tt)*);)*) => {
        vec![$((stringify!($name), NEVER, (|h: &Held, _: &Names| {
            ok(fmi3::$name(h.handle() $(, never!(@ $argument))*))
        }) as Call)),*]
    };
    (@ $argument:tt) => { none() };
}

pub(super) fn calls_of_fmi3() -> Vec<Row> {
    let tables = [
        modes_and_steps(),
        values(),
        states(),
        types_of_no_variable(),
        never_provided(),
    ];
    tables.concat()
}

/// From the start to the end.
#[rustfmt::skip]
fn modes_and_steps() -> Vec<Row> {
    calls! {
        "fmi3SetDebugLogging", ALL, |h, _| ok(fmi3::fmi3SetDebugLogging(h.handle(), 1, 0, none()));
        "fmi3EnterInitializationMode", START, |h, _| ok(fmi3::fmi3EnterInitializationMode(h.handle(), 0, 0.0, 0.0, 0, 0.0));
        "fmi3ExitInitializationMode", LEAVE_INIT, |h, _| ok(fmi3::fmi3ExitInitializationMode(h.handle()));
        "fmi3Terminate", END, |h, _| ok(fmi3::fmi3Terminate(h.handle()));
        "fmi3Reset", ALL, |h, _| ok(fmi3::fmi3Reset(h.handle()));
        "fmi3DoStep", STEP, |h, _| ok(fmi3::fmi3DoStep(h.handle(), h.time(), H, 1, none(), none(), none(), none()));
        "fmi3DoStep", NEVER, |h, _| ok(fmi3::fmi3DoStep(h.handle(), h.time(), f64::NAN, 1, none(), none(), none(), none()));
    }
}

/// Variables of the types that there are.
#[rustfmt::skip]
fn values() -> Vec<Row> {
    calls! {
        "fmi3GetFloat64", ALL, |h, n| ok(fmi3::fmi3GetFloat64(h.handle(), of(&[n.output]), 1, to(&mut [0.0]), 1));
        "fmi3GetFloat64", NEVER, |h, n| ok(fmi3::fmi3GetFloat64(h.handle(), of(&[n.output]), 1, to(&mut [0.0; 2]), 2));
        "fmi3GetFloat64", NEVER, |h, n| ok(fmi3::fmi3GetFloat64(h.handle(), of(&[n.steps]), 1, to(&mut [0.0]), 1));
        "fmi3GetInt64", ALL, |h, n| ok(fmi3::fmi3GetInt64(h.handle(), of(&[n.steps]), 1, to(&mut [0]), 1));
        "fmi3GetBoolean", ALL, |h, n| ok(fmi3::fmi3GetBoolean(h.handle(), of(&[n.saturate]), 1, to(&mut [0]), 1));
        "fmi3SetFloat64", SETTABLE, |h, n| ok(fmi3::fmi3SetFloat64(h.handle(), of(&[n.opening]), 1, of(&[0.5]), 1));
        "fmi3SetFloat64", BEFORE_STEPS, |h, n| ok(fmi3::fmi3SetFloat64(h.handle(), of(&[n.scale]), 1, of(&[0.9]), 1));
        "fmi3SetFloat64", NEVER, |h, n| ok(fmi3::fmi3SetFloat64(h.handle(), of(&[n.output]), 1, of(&[0.9]), 1));
        "fmi3SetInt64", SETTABLE, |h, n| ok(fmi3::fmi3SetInt64(h.handle(), of(&[n.threads]), 1, of(&[1]), 1));
        "fmi3SetBoolean", SETTABLE, |h, n| ok(fmi3::fmi3SetBoolean(h.handle(), of(&[n.saturate]), 1, of(&[1]), 1));
        "fmi3GetOutputDerivatives", AFTER_START, |h, n| ok(fmi3::fmi3GetOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[1]), to(&mut [0.0]), 1));
        "fmi3GetOutputDerivatives", NEVER, |h, n| ok(fmi3::fmi3GetOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[3]), to(&mut [0.0]), 1));
        "fmi3GetString", ALL, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.path]), 1, to(&mut [ptr::null()]), 1));
        "fmi3GetString", NEVER, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.path]), 1, to(&mut [ptr::null(); 2]), 2));
        "fmi3GetString", NEVER, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.output]), 1, to(&mut [ptr::null()]), 1));
        "fmi3SetString", BEFORE_STEPS, |h, n| ok(fmi3::fmi3SetString(h.handle(), of(&[n.path]), 1, of(&[text(c"x")]), 1));
        "fmi3SetString", NEVER, |h, n| ok(fmi3::fmi3SetString(h.handle(), of(&[n.path]), 1, of(&[text(c"x"), text(c"y")]), 2));
        "fmi3SetString", NEVER, |h, _| ok(fmi3::fmi3SetString(h.handle(), none(), 1, none(), 1));
    }
}

/// States kept by the importer.
#[rustfmt::skip]
fn states() -> Vec<Row> {
    calls! {
        "fmi3GetFMUState", ALL, |h, _| { let mut p = Place(ptr::null_mut()); let s = fmi3::fmi3GetFMUState(h.handle(), p.slot()); p.slot().free().expect("it is live or NULL"); ok(s) };
        "fmi3SetFMUState", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3SetFMUState(h.handle(), p.handle())));
        "fmi3SetFMUState", NEVER, |h, _| ok(fmi3::fmi3SetFMUState(h.handle(), none()));
        "fmi3FreeFMUState", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3FreeFMUState(h.handle(), p.slot())));
        "fmi3SerializedFMUStateSize", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3SerializedFMUStateSize(h.handle(), p.handle(), to(&mut [0]))));
        "fmi3SerializeFMUState", ALL, |h, _| { let mut b = h.state(); ok(with_state(h, |p| fmi3::fmi3SerializeFMUState(h.handle(), p.handle(), to(&mut b), b.len()))) };
        "fmi3DeserializeFMUState", ALL, |h, _| { let b = h.state(); let mut p = Place(ptr::null_mut()); let s = fmi3::fmi3DeserializeFMUState(h.handle(), of(&b), b.len(), p.slot()); p.slot().free().expect("it is live or NULL"); ok(s) };
        "fmi3DeserializeFMUState", NEVER, |h, _| { let mut p = Place(ptr::null_mut()); ok(fmi3::fmi3DeserializeFMUState(h.handle(), of(b"rubbish"), 7, p.slot())) };
    }
}

/// Variables of types that no variable has.
#[rustfmt::skip]
fn types_of_no_variable() -> Vec<Row> {
    calls! {
        "fmi3GetFloat32", NEVER, |h, _| ok(fmi3::fmi3GetFloat32(h.handle(), none(), 1, none(), 1));
        "fmi3SetFloat32", NEVER, |h, _| ok(fmi3::fmi3SetFloat32(h.handle(), none(), 1, none(), 1));
        "fmi3GetInt8", NEVER, |h, _| ok(fmi3::fmi3GetInt8(h.handle(), none(), 1, none(), 1));
        "fmi3SetInt8", NEVER, |h, _| ok(fmi3::fmi3SetInt8(h.handle(), none(), 1, none(), 1));
        "fmi3GetUInt8", NEVER, |h, _| ok(fmi3::fmi3GetUInt8(h.handle(), none(), 1, none(), 1));
        "fmi3SetUInt8", NEVER, |h, _| ok(fmi3::fmi3SetUInt8(h.handle(), none(), 1, none(), 1));
        "fmi3GetInt16", NEVER, |h, _| ok(fmi3::fmi3GetInt16(h.handle(), none(), 1, none(), 1));
        "fmi3SetInt16", NEVER, |h, _| ok(fmi3::fmi3SetInt16(h.handle(), none(), 1, none(), 1));
        "fmi3GetUInt16", NEVER, |h, _| ok(fmi3::fmi3GetUInt16(h.handle(), none(), 1, none(), 1));
        "fmi3SetUInt16", NEVER, |h, _| ok(fmi3::fmi3SetUInt16(h.handle(), none(), 1, none(), 1));
        "fmi3GetInt32", NEVER, |h, _| ok(fmi3::fmi3GetInt32(h.handle(), none(), 1, none(), 1));
        "fmi3SetInt32", NEVER, |h, _| ok(fmi3::fmi3SetInt32(h.handle(), none(), 1, none(), 1));
        "fmi3GetUInt32", NEVER, |h, _| ok(fmi3::fmi3GetUInt32(h.handle(), none(), 1, none(), 1));
        "fmi3SetUInt32", NEVER, |h, _| ok(fmi3::fmi3SetUInt32(h.handle(), none(), 1, none(), 1));
        "fmi3GetUInt64", NEVER, |h, _| ok(fmi3::fmi3GetUInt64(h.handle(), none(), 1, none(), 1));
        "fmi3SetUInt64", NEVER, |h, _| ok(fmi3::fmi3SetUInt64(h.handle(), none(), 1, none(), 1));
        "fmi3GetBinary", NEVER, |h, _| ok(fmi3::fmi3GetBinary(h.handle(), none(), 1, none(), none(), 1));
        "fmi3SetBinary", NEVER, |h, _| ok(fmi3::fmi3SetBinary(h.handle(), none(), 1, none(), none(), 1));
        "fmi3GetClock", NEVER, |h, _| ok(fmi3::fmi3GetClock(h.handle(), none(), 1, none()));
        "fmi3SetClock", NEVER, |h, _| ok(fmi3::fmi3SetClock(h.handle(), none(), 1, none()));
    }
}

/// Event mode, model exchange, clocks.
#[rustfmt::skip]
fn never_provided() -> Vec<Row> {
    // One dot for each argument after the instance.
    never! {
        fmi3GetNumberOfVariableDependencies(. .);
        fmi3GetVariableDependencies(. . . . . .);
        fmi3GetDirectionalDerivative(. . . . . . . .);
        fmi3GetAdjointDerivative(. . . . . . . .);
        fmi3EnterConfigurationMode();
        fmi3ExitConfigurationMode();
        fmi3EnterEventMode();
        fmi3EnterStepMode();
        fmi3EvaluateDiscreteStates();
        fmi3UpdateDiscreteStates(. . . . . .);
        fmi3GetIntervalDecimal(. . . .);
        fmi3GetIntervalFraction(. . . . .);
        fmi3GetShiftDecimal(. . .);
        fmi3GetShiftFraction(. . . .);
        fmi3SetIntervalDecimal(. . .);
        fmi3SetIntervalFraction(. . . .);
        fmi3SetShiftDecimal(. . .);
        fmi3SetShiftFraction(. . . .);
        fmi3EnterContinuousTimeMode();
        fmi3CompletedIntegratorStep(. . .);
        fmi3SetTime(.);
        fmi3SetContinuousStates(. .);
        fmi3GetContinuousStateDerivatives(. .);
        fmi3GetEventIndicators(. .);
        fmi3GetContinuousStates(. .);
        fmi3GetNominalsOfContinuousStates(. .);
        fmi3GetNumberOfEventIndicators(.);
        fmi3GetNumberOfContinuousStates(.);
        fmi3ActivateModelPartition(. .);
    }
}
