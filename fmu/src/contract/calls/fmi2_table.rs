//! Calls of FMI 2: the modes in which each is allowed, and what it is called with.

use std::ptr;

use super::*;

/// All functions of FMI 2.
mod fmi2 {
    pub(super) use crate::fmi2::state::*;
    pub(super) use crate::fmi2::variables::*;
    pub(super) use crate::fmi2::*;
}

#[rustfmt::skip]
pub(super) fn calls_of_fmi2() -> Vec<Row> {
    calls! {
        "fmi2SetDebugLogging", ALL, |h, _| ok(fmi2::fmi2SetDebugLogging(h.handle(), 1, 0, none()));
        "fmi2SetupExperiment", START, |h, _| ok(fmi2::fmi2SetupExperiment(h.handle(), 0, 0.0, 0.0, 1, 100.0));
        "fmi2EnterInitializationMode", START, |h, _| ok(fmi2::fmi2EnterInitializationMode(h.handle()));
        "fmi2ExitInitializationMode", LEAVE_INIT, |h, _| ok(fmi2::fmi2ExitInitializationMode(h.handle()));
        "fmi2Terminate", END, |h, _| ok(fmi2::fmi2Terminate(h.handle()));
        "fmi2Reset", ALL, |h, _| ok(fmi2::fmi2Reset(h.handle()));
        "fmi2GetReal", ALL, |h, n| ok(fmi2::fmi2GetReal(h.handle(), of(&[n.output]), 1, to(&mut [0.0])));
        "fmi2GetInteger", ALL, |h, n| ok(fmi2::fmi2GetInteger(h.handle(), of(&[n.steps]), 1, to(&mut [0])));
        "fmi2GetBoolean", ALL, |h, n| ok(fmi2::fmi2GetBoolean(h.handle(), of(&[n.saturate]), 1, to(&mut [0])));
        "fmi2GetString", ALL, |h, n| ok(fmi2::fmi2GetString(h.handle(), of(&[n.path]), 1, to(&mut [ptr::null()])));
        "fmi2GetString", NEVER, |h, n| ok(fmi2::fmi2GetString(h.handle(), of(&[n.output]), 1, to(&mut [ptr::null()])));
        "fmi2SetReal", SETTABLE, |h, n| ok(fmi2::fmi2SetReal(h.handle(), of(&[n.opening]), 1, of(&[0.5])));
        "fmi2SetReal", BEFORE_STEPS, |h, n| ok(fmi2::fmi2SetReal(h.handle(), of(&[n.scale]), 1, of(&[0.9])));
        "fmi2SetReal", NEVER, |h, n| ok(fmi2::fmi2SetReal(h.handle(), of(&[n.output]), 1, of(&[0.9])));
        "fmi2SetInteger", SETTABLE, |h, n| ok(fmi2::fmi2SetInteger(h.handle(), of(&[n.threads]), 1, of(&[1])));
        "fmi2SetBoolean", SETTABLE, |h, n| ok(fmi2::fmi2SetBoolean(h.handle(), of(&[n.saturate]), 1, of(&[1])));
        "fmi2SetBoolean", NEVER, |h, n| ok(fmi2::fmi2SetBoolean(h.handle(), of(&[n.blocked]), 1, of(&[1])));
        "fmi2SetString", BEFORE_STEPS, |h, n| ok(fmi2::fmi2SetString(h.handle(), of(&[n.path]), 1, of(&[text(c"x")])));
        "fmi2SetString", NEVER, |h, n| ok(fmi2::fmi2SetString(h.handle(), of(&[n.output]), 1, of(&[text(c"x")])));
        "fmi2GetFMUstate", ALL, |h, _| { let mut p = Place(ptr::null_mut()); let s = fmi2::fmi2GetFMUstate(h.handle(), p.slot()); p.slot().free().expect("it is live or NULL"); ok(s) };
        "fmi2SetFMUstate", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2SetFMUstate(h.handle(), p.handle())));
        "fmi2SetFMUstate", NEVER, |h, _| ok(fmi2::fmi2SetFMUstate(h.handle(), none()));
        "fmi2FreeFMUstate", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2FreeFMUstate(h.handle(), p.slot())));
        "fmi2SerializedFMUstateSize", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2SerializedFMUstateSize(h.handle(), p.handle(), to(&mut [0]))));
        "fmi2SerializeFMUstate", ALL, |h, _| { let mut b = h.state(); ok(with_state(h, |p| fmi2::fmi2SerializeFMUstate(h.handle(), p.handle(), to(&mut b), b.len()))) };
        "fmi2SerializeFMUstate", NEVER, |h, _| ok(with_state(h, |p| fmi2::fmi2SerializeFMUstate(h.handle(), p.handle(), to(&mut [0; 8]), 8)));
        "fmi2DeSerializeFMUstate", ALL, |h, _| { let b = h.state(); let mut p = Place(ptr::null_mut()); let s = fmi2::fmi2DeSerializeFMUstate(h.handle(), of(&b), b.len(), p.slot()); p.slot().free().expect("it is live or NULL"); ok(s) };
        "fmi2DeSerializeFMUstate", NEVER, |h, _| { let mut p = Place(ptr::null_mut()); ok(fmi2::fmi2DeSerializeFMUstate(h.handle(), of(b"rubbish"), 7, p.slot())) };
        "fmi2GetDirectionalDerivative", NEVER, |h, _| ok(fmi2::fmi2GetDirectionalDerivative(h.handle(), none(), 0, none(), 0, none(), none()));
        "fmi2SetRealInputDerivatives", SETTABLE, |h, n| ok(fmi2::fmi2SetRealInputDerivatives(h.handle(), of(&[n.opening]), 1, of(&[1]), of(&[0.5])));
        "fmi2GetRealOutputDerivatives", AFTER_START, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[1]), to(&mut [0.0])));
        "fmi2GetRealOutputDerivatives", AFTER_START, |h, n| { let mut d = [7.0]; let s = fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[2]), to(&mut d)); assert!(s == Status::Error || d == [0.0]); ok(s) };
        "fmi2GetRealOutputDerivatives", NEVER, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[0]), to(&mut [0.0])));
        "fmi2GetRealOutputDerivatives", NEVER, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.opening]), 1, of(&[1]), to(&mut [0.0])));
        "fmi2DoStep", STEP, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time(), H, 1));
        "fmi2DoStep", NEVER, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time(), 0.0, 1));
        "fmi2DoStep", NEVER, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time() + 1.0, H, 1));
        "fmi2CancelStep", NEVER, |h, _| ok(fmi2::fmi2CancelStep(h.handle()));
        "fmi2GetStatus", ALL, |h, _| ok(fmi2::fmi2GetStatus(h.handle(), 0, to(&mut [0])));
        "fmi2GetStatus", NEVER, |h, _| discarded(fmi2::fmi2GetStatus(h.handle(), 1, to(&mut [0])));
        "fmi2GetRealStatus", NEVER, |h, _| discarded(fmi2::fmi2GetRealStatus(h.handle(), 0, to(&mut [0.0])));
        "fmi2GetBooleanStatus", NEVER, |h, _| discarded(fmi2::fmi2GetBooleanStatus(h.handle(), 2, to(&mut [0])));
        "fmi2GetRealStatus", ALL, |h, _| ok(fmi2::fmi2GetRealStatus(h.handle(), 2, to(&mut [0.0])));
        "fmi2GetIntegerStatus", NEVER, |h, _| discarded(fmi2::fmi2GetIntegerStatus(h.handle(), 0, to(&mut [0])));
        "fmi2GetBooleanStatus", ALL, |h, _| ok(fmi2::fmi2GetBooleanStatus(h.handle(), 3, to(&mut [0])));
        "fmi2GetStringStatus", NEVER, |h, _| discarded(fmi2::fmi2GetStringStatus(h.handle(), 1, none()));
    }
}
