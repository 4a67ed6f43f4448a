//! Every exported function in every mode: what is allowed answers OK; what is not answers Error within a second, with a
//! message that names the call, and leaves the saved state byte for byte as it was.
//!
//! The functions are called as Rust has them; their pointer arguments are made from Rust's here, as a C caller would.

use std::ffi::{CStr, c_char, c_void};
use std::mem::{transmute_copy, zeroed};
use std::ptr;
use std::time::{Duration, Instant};

use sandgate::component::{Component, Mode};
use sandgate::scene::{self, Scene};

use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out, StateHandle, StateSlot, Text};
use crate::instance::Instance;
use crate::log::{Log, Sink};
use crate::{capi, fmi2};

/// All functions of FMI 3.
mod fmi3 {
    pub(super) use crate::fmi3::absent::*;
    pub(super) use crate::fmi3::*;
}

/// A refusal that takes longer hangs an orchestrator.
const PATIENCE: Duration = Duration::from_secs(1);
const MODES: [Mode; 5] = [
    Mode::Instantiated,
    Mode::Initialization,
    Mode::Stepping,
    Mode::Terminated,
    Mode::Failed,
];
/// Communication step [s].
const H: f64 = 1.0 / 256.0;

/// An instance behind the pointer that a C caller holds.
struct Held(*mut c_void);

impl Held {
    fn handle(&self) -> Handle {
        // A handle is that pointer and nothing else.
        unsafe { transmute_copy(&self.0) }
    }

    fn with<T>(&self, work: impl FnOnce(&mut Instance) -> T) -> T {
        let done = self.handle().call("test", Need::Any, |i| Ok(work(i)));
        done.expect("no call is running")
    }

    fn time(&self) -> f64 {
        self.with(|i| i.component.time())
    }

    fn state(&self) -> Vec<u8> {
        self.with(|i| i.component.save().expect("it fits"))
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.handle().free();
    }
}

/// A scene whose grains fall out of their domain, so that its steps fail, beside a gate.
fn leaking() -> Scene {
    let text = include_str!("../../../tests/scenes/no_floor.toml");
    let text = text.replace("upper = [0.1, 0.1]", "upper = [0.2, 0.1]");
    let gate = "\n[gates.sluice]\nfrom = [0.15, 0.02]\nto = [0.15, 0.06]\n";
    scene::parse("leaking.toml", &(text + gate)).unwrap_or_else(|why| panic!("{why}"))
}

fn held(mode: Mode) -> Held {
    let scene = if mode == Mode::Failed {
        leaking()
    } else {
        super::scene()
    };
    let instance = Instance::new(&scene, Log::new(Sink::Nobody, true)).expect("it builds");
    let handle = Handle::new(instance);
    let held = Held(unsafe { transmute_copy(&handle) });
    held.with(|i| {
        let c = &mut i.component;
        if mode != Mode::Instantiated {
            c.enter_initialization(0.0, Some(100.0)).expect("allowed");
        }
        if matches!(mode, Mode::Stepping | Mode::Terminated | Mode::Failed) {
            c.exit_initialization().expect("allowed");
        }
        while mode == Mode::Failed && c.do_step(c.time(), 0.01).is_ok() {}
        if mode == Mode::Stepping || mode == Mode::Terminated {
            c.do_step(0.0, H).expect("it steps");
            c.do_step(H, H).expect("it steps");
        }
        if mode == Mode::Terminated {
            c.terminate().expect("allowed");
        }
        assert_eq!(c.mode(), mode);
    });
    held
}

fn of<T>(values: &[T]) -> In<T> {
    unsafe { transmute_copy(&values.as_ptr()) }
}

fn to<T>(values: &mut [T]) -> Out<T> {
    unsafe { transmute_copy(&values.as_mut_ptr()) }
}

fn text(text: &'static CStr) -> Text {
    unsafe { transmute_copy(&text.as_ptr()) }
}

/// NULL, 0: for arguments that do not matter.
fn none<T>() -> T {
    unsafe { zeroed() }
}

/// A state slot with a state of this instance, or nothing inside.
struct Place(*mut c_void);

impl Place {
    fn slot(&mut self) -> StateSlot {
        let place: *mut *mut c_void = &raw mut self.0;
        unsafe { transmute_copy(&place) }
    }

    fn handle(&self) -> StateHandle {
        unsafe { transmute_copy(&self.0) }
    }
}

fn with_state(held: &Held, work: impl FnOnce(&mut Place) -> Status) -> Status {
    let mut place = Place(ptr::null_mut());
    let mut slot = place.slot();
    held.handle()
        .call("test", Need::Any, |i| slot.put(i.save()?))
        .expect("it can be saved");
    let status = work(&mut place);
    place.slot().free();
    status
}

/// References of some variables of the scene in use.
struct Names {
    opening: u32,
    scale: u32,
    threads: u32,
    saturate: u32,
    steps: u32,
    output: u32,
    blocked: u32,
    path: u32,
}

fn names(component: &Component) -> Names {
    let table = component.variables();
    let find = |name: &str| table.by_name(name).map_or(9999, |row| row.reference);
    let ends = |end: &str| {
        let row = table.rows().iter().find(|row| row.name.ends_with(end));
        row.map_or(9999, |row| row.reference)
    };
    Names {
        opening: ends(".opening"),
        scale: find("solver.resolution_scale"),
        threads: find("solver.threads"),
        saturate: find("saturate_inputs"),
        steps: find("solver.steps"),
        output: find("energy.kinetic"),
        blocked: ends(".blocked"),
        path: find("log.path"),
    }
}

/// What a call answers: whether it did what it was asked.
type Call = fn(&Held, &Names) -> bool;

fn ok(status: Status) -> bool {
    assert!(
        status == Status::Ok || status == Status::Error,
        "{status:?}"
    );
    status == Status::Ok
}

fn code(code: i32) -> bool {
    assert!((0..=7).contains(&code), "{code}");
    code == 0
}

/// Modes in which a call is allowed, in the order of [`MODES`].
type Allowed = [bool; 5];
const ALL: Allowed = [true; 5];
const NEVER: Allowed = [false; 5];
const START: Allowed = [true, false, false, false, false];
const LEAVE_INIT: Allowed = [false, true, false, false, false];
const BEFORE_STEPS: Allowed = [true, true, false, false, false];
const SETTABLE: Allowed = [true, true, true, false, false];
const STEP: Allowed = [false, false, true, false, false];
const END: Allowed = [false, false, true, false, true];
const AFTER_START: Allowed = [false, false, true, true, true];

/// `name, modes, |held, names| answer`.
macro_rules! calls {
    ($($name:literal, $modes:ident, $call:expr;)*) => {
        vec![$(($name, $modes, $call as Call)),*]
    };
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

#[rustfmt::skip]
fn calls_of_fmi2() -> Vec<(&'static str, Allowed, Call)> {
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
        "fmi2GetFMUstate", ALL, |h, _| { let mut p = Place(ptr::null_mut()); let s = fmi2::fmi2GetFMUstate(h.handle(), p.slot()); p.slot().free(); ok(s) };
        "fmi2SetFMUstate", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2SetFMUstate(h.handle(), p.handle())));
        "fmi2SetFMUstate", NEVER, |h, _| ok(fmi2::fmi2SetFMUstate(h.handle(), none()));
        "fmi2FreeFMUstate", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2FreeFMUstate(h.handle(), p.slot())));
        "fmi2SerializedFMUstateSize", ALL, |h, _| ok(with_state(h, |p| fmi2::fmi2SerializedFMUstateSize(h.handle(), p.handle(), to(&mut [0]))));
        "fmi2SerializeFMUstate", ALL, |h, _| { let mut b = h.state(); ok(with_state(h, |p| fmi2::fmi2SerializeFMUstate(h.handle(), p.handle(), to(&mut b), b.len()))) };
        "fmi2SerializeFMUstate", NEVER, |h, _| ok(with_state(h, |p| fmi2::fmi2SerializeFMUstate(h.handle(), p.handle(), to(&mut [0; 8]), 8)));
        "fmi2DeSerializeFMUstate", ALL, |h, _| { let b = h.state(); let mut p = Place(ptr::null_mut()); let s = fmi2::fmi2DeSerializeFMUstate(h.handle(), of(&b), b.len(), p.slot()); p.slot().free(); ok(s) };
        "fmi2DeSerializeFMUstate", NEVER, |h, _| { let mut p = Place(ptr::null_mut()); ok(fmi2::fmi2DeSerializeFMUstate(h.handle(), of(b"rubbish"), 7, p.slot())) };
        "fmi2GetDirectionalDerivative", NEVER, |h, _| ok(fmi2::fmi2GetDirectionalDerivative(h.handle(), none(), 0, none(), 0, none(), none()));
        "fmi2SetRealInputDerivatives", SETTABLE, |h, n| ok(fmi2::fmi2SetRealInputDerivatives(h.handle(), of(&[n.opening]), 1, of(&[1]), of(&[0.5])));
        "fmi2GetRealOutputDerivatives", AFTER_START, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[1]), to(&mut [0.0])));
        "fmi2GetRealOutputDerivatives", NEVER, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[2]), to(&mut [0.0])));
        "fmi2GetRealOutputDerivatives", NEVER, |h, n| ok(fmi2::fmi2GetRealOutputDerivatives(h.handle(), of(&[n.opening]), 1, of(&[1]), to(&mut [0.0])));
        "fmi2DoStep", STEP, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time(), H, 1));
        "fmi2DoStep", NEVER, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time(), 0.0, 1));
        "fmi2DoStep", NEVER, |h, _| ok(fmi2::fmi2DoStep(h.handle(), h.time() + 1.0, H, 1));
        "fmi2CancelStep", NEVER, |h, _| ok(fmi2::fmi2CancelStep(h.handle()));
        "fmi2GetStatus", ALL, |h, _| ok(fmi2::fmi2GetStatus(h.handle(), 0, to(&mut [0])));
        "fmi2GetStatus", NEVER, |h, _| ok(fmi2::fmi2GetStatus(h.handle(), 1, to(&mut [0])));
        "fmi2GetRealStatus", ALL, |h, _| ok(fmi2::fmi2GetRealStatus(h.handle(), 2, to(&mut [0.0])));
        "fmi2GetIntegerStatus", NEVER, |h, _| ok(fmi2::fmi2GetIntegerStatus(h.handle(), 0, to(&mut [0])));
        "fmi2GetBooleanStatus", ALL, |h, _| ok(fmi2::fmi2GetBooleanStatus(h.handle(), 3, to(&mut [0])));
        "fmi2GetStringStatus", NEVER, |h, _| ok(fmi2::fmi2GetStringStatus(h.handle(), 1, none()));
    }
}

#[rustfmt::skip]
fn calls_of_fmi3() -> Vec<(&'static str, Allowed, Call)> {
    let mut list = calls! {
        "fmi3SetDebugLogging", ALL, |h, _| ok(fmi3::fmi3SetDebugLogging(h.handle(), 1, 0, none()));
        "fmi3EnterInitializationMode", START, |h, _| ok(fmi3::fmi3EnterInitializationMode(h.handle(), 0, 0.0, 0.0, 0, 0.0));
        "fmi3ExitInitializationMode", LEAVE_INIT, |h, _| ok(fmi3::fmi3ExitInitializationMode(h.handle()));
        "fmi3Terminate", END, |h, _| ok(fmi3::fmi3Terminate(h.handle()));
        "fmi3Reset", ALL, |h, _| ok(fmi3::fmi3Reset(h.handle()));
        "fmi3DoStep", STEP, |h, _| ok(fmi3::fmi3DoStep(h.handle(), h.time(), H, 1, none(), none(), none(), none()));
        "fmi3DoStep", NEVER, |h, _| ok(fmi3::fmi3DoStep(h.handle(), h.time(), f64::NAN, 1, none(), none(), none(), none()));
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
        "fmi3GetFMUState", ALL, |h, _| { let mut p = Place(ptr::null_mut()); let s = fmi3::fmi3GetFMUState(h.handle(), p.slot()); p.slot().free(); ok(s) };
        "fmi3SetFMUState", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3SetFMUState(h.handle(), p.handle())));
        "fmi3SetFMUState", NEVER, |h, _| ok(fmi3::fmi3SetFMUState(h.handle(), none()));
        "fmi3FreeFMUState", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3FreeFMUState(h.handle(), p.slot())));
        "fmi3SerializedFMUStateSize", ALL, |h, _| ok(with_state(h, |p| fmi3::fmi3SerializedFMUStateSize(h.handle(), p.handle(), to(&mut [0]))));
        "fmi3SerializeFMUState", ALL, |h, _| { let mut b = h.state(); ok(with_state(h, |p| fmi3::fmi3SerializeFMUState(h.handle(), p.handle(), to(&mut b), b.len()))) };
        "fmi3DeserializeFMUState", ALL, |h, _| { let b = h.state(); let mut p = Place(ptr::null_mut()); let s = fmi3::fmi3DeserializeFMUState(h.handle(), of(&b), b.len(), p.slot()); p.slot().free(); ok(s) };
        "fmi3DeserializeFMUState", NEVER, |h, _| { let mut p = Place(ptr::null_mut()); ok(fmi3::fmi3DeserializeFMUState(h.handle(), of(b"rubbish"), 7, p.slot())) };
        "fmi3GetOutputDerivatives", AFTER_START, |h, n| ok(fmi3::fmi3GetOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[1]), to(&mut [0.0]), 1));
        "fmi3GetOutputDerivatives", NEVER, |h, n| ok(fmi3::fmi3GetOutputDerivatives(h.handle(), of(&[n.output]), 1, of(&[3]), to(&mut [0.0]), 1));
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
        "fmi3GetString", ALL, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.path]), 1, to(&mut [ptr::null()]), 1));
        "fmi3GetString", NEVER, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.path]), 1, to(&mut [ptr::null(); 2]), 2));
        "fmi3GetString", NEVER, |h, n| ok(fmi3::fmi3GetString(h.handle(), of(&[n.output]), 1, to(&mut [ptr::null()]), 1));
        "fmi3SetString", BEFORE_STEPS, |h, n| ok(fmi3::fmi3SetString(h.handle(), of(&[n.path]), 1, of(&[text(c"x")]), 1));
        "fmi3SetString", NEVER, |h, n| ok(fmi3::fmi3SetString(h.handle(), of(&[n.path]), 1, of(&[text(c"x"), text(c"y")]), 2));
        "fmi3SetString", NEVER, |h, _| ok(fmi3::fmi3SetString(h.handle(), none(), 1, none(), 1));
        "fmi3GetBinary", NEVER, |h, _| ok(fmi3::fmi3GetBinary(h.handle(), none(), 1, none(), none(), 1));
        "fmi3SetBinary", NEVER, |h, _| ok(fmi3::fmi3SetBinary(h.handle(), none(), 1, none(), none(), 1));
        "fmi3GetClock", NEVER, |h, _| ok(fmi3::fmi3GetClock(h.handle(), none(), 1, none()));
        "fmi3SetClock", NEVER, |h, _| ok(fmi3::fmi3SetClock(h.handle(), none(), 1, none()));
    };
    // One dot for each argument after the instance.
    list.extend(never! {
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
    });
    list
}

#[rustfmt::skip]
fn calls_of_c() -> Vec<(&'static str, Allowed, Call)> {
    calls! {
        "sandgate_variable_info", NEVER, |h, _| code(capi::sandgate_variable_info(h.handle(), 9999, none()));
        "sandgate_variable_by_name", ALL, |h, _| code(capi::sandgate_variable_by_name(h.handle(), text(c"time"), to(&mut [0])));
        "sandgate_variable_by_name", NEVER, |h, _| code(capi::sandgate_variable_by_name(h.handle(), text(c"nothing"), to(&mut [0])));
        "sandgate_enter_initialization", START, |h, _| code(capi::sandgate_enter_initialization(h.handle(), 0.0, 100.0));
        "sandgate_exit_initialization", LEAVE_INIT, |h, _| code(capi::sandgate_exit_initialization(h.handle()));
        "sandgate_initialize", START, |h, _| code(capi::sandgate_initialize(h.handle(), 0.0, 100.0));
        "sandgate_set", SETTABLE, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.saturate]), 2, of(&[1.0, 1.0]), 2));
        "sandgate_set", BEFORE_STEPS, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.scale]), 2, of(&[1.0, 0.9]), 2));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.output]), 2, of(&[1.0, 0.9]), 2));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads]), 1, of(&[f64::NAN]), 1));
        "sandgate_get", ALL, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.threads, n.output]), 2, to(&mut [0.0; 2]), 2));
        "sandgate_get", NEVER, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.output]), 1, to(&mut [0.0; 2]), 2));
        "sandgate_get", NEVER, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.output]), 1, none(), 1));
        "sandgate_set_text", BEFORE_STEPS, |h, n| code(capi::sandgate_set_text(h.handle(), n.path, text(c"x")));
        "sandgate_set_text", NEVER, |h, n| code(capi::sandgate_set_text(h.handle(), n.output, text(c"x")));
        "sandgate_set_text", NEVER, |h, n| code(capi::sandgate_set_text(h.handle(), n.path, none()));
        "sandgate_get_text", ALL, |h, n| code(capi::sandgate_get_text(h.handle(), n.path, to(&mut [ptr::null()])));
        "sandgate_get_text", NEVER, |h, n| code(capi::sandgate_get_text(h.handle(), n.output, to(&mut [ptr::null()])));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.path]), 1, of(&[1.0]), 1));
        "sandgate_step", STEP, |h, _| code(capi::sandgate_step(h.handle(), h.time(), H, none()));
        "sandgate_step", NEVER, |h, _| code(capi::sandgate_step(h.handle(), h.time(), -H, none()));
        "sandgate_step", NEVER, |h, _| code(capi::sandgate_step(h.handle(), f64::NAN, H, none()));
        "sandgate_time", ALL, |h, _| code(capi::sandgate_time(h.handle(), to(&mut [0.0])));
        "sandgate_get_mode", ALL, |h, _| code(capi::sandgate_get_mode(h.handle(), to(&mut [0])));
        "sandgate_get_ledger", NEVER, |h, _| code(capi::sandgate_get_ledger(h.handle(), none()));
        "sandgate_save_size", ALL, |h, _| code(capi::sandgate_save_size(h.handle(), to(&mut [0])));
        "sandgate_save", ALL, |h, _| { let mut b = h.state(); code(capi::sandgate_save(h.handle(), to(&mut b), b.len(), to(&mut [0]))) };
        "sandgate_save", NEVER, |h, _| code(capi::sandgate_save(h.handle(), to(&mut [0]), 1, to(&mut [0])));
        "sandgate_restore", ALL, |h, _| { let b = h.state(); code(capi::sandgate_restore(h.handle(), of(&b), b.len())) };
        "sandgate_restore", NEVER, |h, _| code(capi::sandgate_restore(h.handle(), of(b"rubbish"), 7));
        "sandgate_reset", ALL, |h, _| code(capi::sandgate_reset(h.handle()));
        "sandgate_terminate", END, |h, _| code(capi::sandgate_terminate(h.handle()));
        "sandgate_set_threads", ALL, |h, _| code(capi::sandgate_set_threads(h.handle(), 1));
        "sandgate_set_logger", ALL, |h, _| code(capi::sandgate_set_logger(h.handle(), none(), none()));
        "sandgate_state_hash", ALL, |h, _| code(capi::sandgate_state_hash(h.handle(), to(&mut [0; 65])));
    }
}

fn check(calls: &[(&'static str, Allowed, Call)]) {
    for (place, mode) in MODES.into_iter().enumerate() {
        let mut instance = held(mode);
        let names = instance.with(|i| names(&i.component));
        for (row, (name, allowed, call)) in calls.iter().enumerate() {
            let case = format!("{name} (row {row}) in mode {mode:?}");
            let before = instance.state();
            instance.with(|i| i.last_error = c"nothing yet".into());
            let begin = Instant::now();
            let done = call(&instance, &names);
            let took = begin.elapsed();
            let message = instance.with(|i| i.last_error.to_string_lossy().into_owned());
            assert_eq!(done, allowed[place], "{case}: {message}");
            if done {
                // It may have moved on.
                instance = held(mode);
                continue;
            }
            assert!(took < PATIENCE, "{case} took {took:?}");
            assert!(
                message.starts_with(&format!("{name}: ")),
                "{case}: {message}"
            );
            assert!(instance.state() == before, "{case} left a trace: {message}");
        }
    }
}

/// Functions of this version that the table above has no row for: they take no instance, or free it.
fn missing(calls: &[(&'static str, Allowed, Call)], source: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (before, after) in [
        ("extern \"C\" fn ", "("),
        ("\": fmi3", "("),
        ("\n    fmi3", ","),
    ] {
        for part in source.split(before).skip(1) {
            let name = part.split(after).next().unwrap_or_default();
            let prefix = if before.ends_with("fmi3") { "fmi3" } else { "" };
            let name = format!("{prefix}{name}");
            if name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                names.push(name);
            }
        }
    }
    names.retain(|name| !calls.iter().any(|(known, ..)| known == name));
    names.sort();
    names
}

#[test]
fn every_call_of_fmi_2_in_every_mode() {
    let calls = calls_of_fmi2();
    assert_eq!(
        missing(&calls, include_str!("../fmi2.rs")),
        [
            "fmi2FreeInstance",
            "fmi2GetTypesPlatform",
            "fmi2GetVersion",
            "fmi2Instantiate"
        ]
    );
    check(&calls);
}

#[test]
fn every_call_of_fmi_3_in_every_mode() {
    let calls = calls_of_fmi3();
    assert_eq!(
        missing(
            &calls,
            concat!(
                include_str!("../fmi3.rs"),
                include_str!("../fmi3/absent.rs")
            )
        ),
        [
            "fmi3FreeInstance",
            "fmi3GetVersion",
            "fmi3InstantiateCoSimulation",
            "fmi3InstantiateModelExchange",
            "fmi3InstantiateScheduledExecution"
        ]
    );
    check(&calls);
}

#[test]
fn every_call_of_the_c_interface_in_every_mode() {
    let calls = calls_of_c();
    assert_eq!(
        missing(&calls, include_str!("../capi.rs")),
        [
            "sandgate_abi_version",
            "sandgate_capabilities",
            "sandgate_create",
            "sandgate_create_from_file",
            "sandgate_free",
            "sandgate_last_error",
            "sandgate_variable_count",
            "sandgate_version"
        ]
    );
    check(&calls);
}

#[test]
fn fmi_2_refuses_times_where_they_are_given() {
    let held = held(Mode::Instantiated);
    let set_up = |start, stop| fmi2::fmi2SetupExperiment(held.handle(), 0, 0.0, start, 1, stop);
    for (start, stop, expected) in [
        (1e12, 2e12, "count time from a later origin"),
        (
            f64::NAN,
            1.0,
            "start time: found NaN s, allowed a finite time",
        ),
        (
            2.0,
            1.0,
            "stop time: found 1 s, allowed a finite time from 2 s",
        ),
    ] {
        assert!(!ok(set_up(start, stop)));
        let message = held.with(|i| i.last_error.to_string_lossy().into_owned());
        assert!(
            message.contains("setup_experiment") && message.contains(expected),
            "{message}"
        );
    }
    assert!(ok(set_up(1.0, 2.0)));
    assert!(ok(fmi2::fmi2EnterInitializationMode(held.handle())));
    assert_eq!(held.time(), 1.0);
}

#[test]
fn null_instances_are_refused_without_harm() {
    let null = || Handle::null();
    assert!(!ok(fmi2::fmi2DoStep(null(), 0.0, H, 1)));
    assert!(!ok(fmi3::fmi3GetFloat64(null(), none(), 0, none(), 0)));
    assert!(!code(capi::sandgate_reset(null())));
    let name: *const c_char = capi::sandgate_last_error(null());
    assert!(!name.is_null());
    fmi3::fmi3FreeInstance(null());
}
