//! Every exported function in every mode: what is allowed answers OK; what is not answers Error within a second, with a
//! message that names the call, and leaves the saved state byte for byte as it was.
//!
//! The functions are called as Rust has them; their pointer arguments are made from Rust's in `held`, as a C caller would.

use std::ffi::c_char;
use std::time::{Duration, Instant};

use sandgate::component::Mode;

use crate::fault::Status;
use crate::guard::Handle;
use crate::{capi, fmi2, fmi3};
use c_table::calls_of_c;
use fmi2_table::calls_of_fmi2;
use fmi3_table::calls_of_fmi3;
use held::*;

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

/// What a call answers: whether it did what it was asked.
type Call = fn(&Held, &Names) -> bool;

/// Of a status that FMI 2 has no value for.
fn discarded(status: Status) -> bool {
    assert_eq!(status, Status::Discard);
    false
}

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

/// A row of the tables: name, modes in which it is allowed, and the call.
type Row = (&'static str, Allowed, Call);

/// `name, modes, |held, names| answer`.
macro_rules! calls {
    ($($name:literal, $modes:ident, $call:expr;)*) => {
        vec![$(($name, $modes, $call as Call)),*]
    };
}

// Below the macro, which their tables are written with.
mod c_table;
mod fmi2_table;
mod fmi3_table;
mod held;

fn check(calls: &[Row]) {
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
fn missing(calls: &[Row], source: &str) -> Vec<String> {
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
        missing(
            &calls,
            concat!(
                include_str!("../fmi2.rs"),
                include_str!("../fmi2/state.rs"),
                include_str!("../fmi2/variables.rs")
            )
        ),
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
                include_str!("../fmi3/absent.rs"),
                include_str!("../fmi3/state.rs"),
                include_str!("../fmi3/variables.rs")
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
        missing(
            &calls,
            concat!(
                include_str!("../capi.rs"),
                include_str!("../capi/state.rs"),
                include_str!("../capi/variables.rs")
            )
        ),
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
    assert!(!ok(fmi3::variables::fmi3GetFloat64(
        null(),
        none(),
        0,
        none(),
        0
    )));
    assert!(!code(capi::sandgate_reset(null())));
    let name: *const c_char = capi::sandgate_last_error(null());
    assert!(!name.is_null());
    fmi3::fmi3FreeInstance(null());
}
