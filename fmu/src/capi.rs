//! The plain C interface; its contract stands in include/sandgate.h, and a test compiles these against it.

use std::ffi::{CString, c_char};

use sandgate::component::{Causality, Mode, Start, ValueKind, Variability, Variable};
use sandgate::scene::{self, Scene, SceneErrors};

use crate::access::{Values, get_texts};
use crate::fault::Fault;
use crate::guard::{
    CLedger, CStepReport, CVariable, Environment, Handle, In, Need, Out, PlainLogger, Text, shield,
};
use crate::instance::Instance;
use crate::log::{Log, Sink, text};

const ABI_VERSION: u32 = 1;
/// Digits of a hash.
const HASH: usize = 64;
/// What `solver.threads` allows too.
const MOST_THREADS: u32 = 256;

/// `sandgate_capability`: bits of what this library can do. The first five are always there.
const CAPABILITIES: u32 = 0b1_1111 | RECORD | PUBLISH;
/// Whether it writes logs.
const RECORD: u32 = if cfg!(feature = "record") { 1 << 5 } else { 0 };
/// Whether it publishes on Zenoh.
const PUBLISH: u32 = if cfg!(feature = "bus") { 1 << 6 } else { 0 };

/// `sandgate_status`: the component's own numbers, and two for what never reaches it.
fn code(result: Result<(), Fault>) -> i32 {
    match result {
        Ok(()) => 0,
        Err(Fault::Component(error)) => error.status().c_code,
        Err(Fault::Border(_)) => 3,
        Err(Fault::Broken(_)) => 6,
        Err(Fault::Outside(_)) => 7,
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_abi_version() -> u32 {
    ABI_VERSION
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_capabilities() -> u32 {
    CAPABILITIES
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_create(
    scene_text: Text,
    name: Text,
    mut error: Out<u8>,
    error_size: usize,
) -> Handle {
    create(&mut error, error_size, || {
        let name = name.get("name").unwrap_or("scene");
        Ok(scene::parse(name, scene_text.get("scene_text")?))
    })
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_create_from_file(
    path: Text,
    mut error: Out<u8>,
    error_size: usize,
) -> Handle {
    create(&mut error, error_size, || {
        Ok(scene::load(path.get("path")?.as_ref()))
    })
}

fn create(
    error: &mut Out<u8>,
    error_size: usize,
    load: impl FnOnce() -> Result<Result<Scene, SceneErrors>, Fault>,
) -> Handle {
    let made = shield(|| {
        let scene = load()?.map_err(|errors| Fault::border(errors.to_string()))?;
        Instance::new(&scene, Log::new(Sink::Nobody, false))
    });
    let reason = match made {
        Ok(Ok(mut instance)) => {
            instance.names = names(&instance);
            return Handle::new(instance);
        }
        Ok(Err(fault)) => fault.to_string(),
        Err(how) => format!("broke down ({how})"),
    };
    if error_size > 0 {
        let reason = reason.replace('\0', " ");
        // Not in the middle of a character.
        let mut end = reason.len().min(error_size - 1);
        while !reason.is_char_boundary(end) {
            end -= 1;
        }
        let mut bytes = reason.as_bytes()[..end].to_vec();
        bytes.push(0);
        // NULL with a size is a caller's mistake, but there is nobody else to tell.
        let _ = error.write(&bytes, "error");
    }
    Handle::null()
}

fn names(instance: &Instance) -> Vec<[CString; 4]> {
    let rows = instance.component.variables().rows().iter();
    rows.map(|row| {
        let shown = row.display_unit.map_or("", |(name, _)| name);
        [&row.name, &row.description, row.unit, shown].map(text)
    })
    .collect()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_free(instance: Handle) {
    instance.free();
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_last_error(instance: Handle) -> *const c_char {
    instance
        .call("sandgate_last_error", Need::Any, |i| {
            Ok(i.last_error.as_ptr())
        })
        .unwrap_or(c"the instance is NULL or in use".as_ptr())
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set_logger(
    instance: Handle,
    logger: PlainLogger,
    user: Environment,
) -> i32 {
    code(instance.call("sandgate_set_logger", Need::Any, |i| {
        i.log = if logger.is_given() {
            Log::new(Sink::Plain(logger, user), true)
        } else {
            Log::new(Sink::Nobody, false)
        };
        Ok(())
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_count(instance: Handle) -> u32 {
    instance
        .call("sandgate_variable_count", Need::Any, |i| {
            Ok(u32::try_from(i.names.len()).unwrap_or(u32::MAX))
        })
        .unwrap_or(0)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_info(
    instance: Handle,
    reference: u32,
    mut variable: Out<CVariable>,
) -> i32 {
    code(instance.call("sandgate_variable_info", Need::Any, |i| {
        let row = i.component.variables().by_reference(reference);
        match (row, i.names.get(reference as usize)) {
            (Some(row), Some(names)) => variable.write(&[info(row, names)], "variable"),
            _ => Err(Fault::border(format!(
                "value reference {reference} is unknown; the table has {} rows",
                i.names.len()
            ))),
        }
    }))
}

fn info(row: &Variable, names: &[CString; 4]) -> CVariable {
    let [name, description, unit, display_unit] = names;
    let (minimum, maximum) = row.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let (element_of, place) = row.element_of.unwrap_or_default();
    CVariable {
        name: name.as_ptr(),
        description: description.as_ptr(),
        unit: unit.as_ptr(),
        display_unit: display_unit.as_ptr(),
        display_factor: row.display_unit.map_or(1.0, |(_, factor)| factor),
        minimum,
        maximum,
        length: row.len() as u64,
        reference: row.reference,
        causality: match row.causality {
            Causality::Independent => 0,
            Causality::Parameter => 1,
            Causality::Input => 2,
            Causality::Output => 3,
        },
        variability: match row.variability {
            Variability::Fixed => 0,
            Variability::Tunable => 1,
            Variability::Discrete => 2,
            Variability::Continuous => 3,
        },
        kind: match row.kind {
            ValueKind::Real => 0,
            ValueKind::Integer => 1,
            ValueKind::Boolean => 2,
            ValueKind::Text => 3,
        },
        has_start: i32::from(row.start != Start::Calculated),
        is_element: i32::from(row.element_of.is_some()),
        element_of,
        element_index: u32::try_from(place).unwrap_or(u32::MAX),
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_by_name(
    instance: Handle,
    name: Text,
    mut reference: Out<u32>,
) -> i32 {
    code(instance.call("sandgate_variable_by_name", Need::Any, |i| {
        let name = name.get("name")?;
        match i.component.variables().by_name(name) {
            Some(row) => reference.write(&[row.reference], "reference"),
            None => Err(Fault::border(format!(
                "no variable is called {name}; ask sandgate_variable_info for the names"
            ))),
        }
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_enter_initialization(
    instance: Handle,
    start: f64,
    stop: f64,
) -> i32 {
    code(
        instance.call("sandgate_enter_initialization", Need::Sound, |i| {
            Ok(i.component.enter_initialization(start, end(stop))?)
        }),
    )
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_exit_initialization(instance: Handle) -> i32 {
    code(
        instance.call("sandgate_exit_initialization", Need::Sound, |i| {
            i.exit_initialization()
        }),
    )
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_initialize(instance: Handle, start: f64, stop: f64) -> i32 {
    code(instance.call("sandgate_initialize", Need::Sound, |i| {
        i.initialize(start, end(stop))
    }))
}

fn end(stop: f64) -> Option<f64> {
    (stop != f64::INFINITY).then_some(stop)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set(
    instance: Handle,
    references: In<u32>,
    reference_count: usize,
    values: In<f64>,
    value_count: usize,
) -> i32 {
    code(instance.call("sandgate_set", Need::Sound, |i| {
        let references = references.slice(reference_count, "references")?;
        let values = values.slice(value_count, "values")?;
        i.set(references, values)
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get(
    instance: Handle,
    references: In<u32>,
    reference_count: usize,
    mut values: Out<f64>,
    value_count: usize,
) -> i32 {
    code(instance.call("sandgate_get", Need::Sound, |i| {
        let references = references.slice(reference_count, "references")?;
        values.check(value_count, "values")?;
        i.table().check_length("get", references, value_count)?;
        let mut found = vec![0.0; value_count];
        i.get(references, &mut found)?;
        values.write(&found, "values")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set_text(instance: Handle, reference: u32, value: Text) -> i32 {
    code(instance.call("sandgate_set_text", Need::Sound, |i| {
        i.set_texts(&[reference], &[value.get("value")?])
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get_text(
    instance: Handle,
    reference: u32,
    mut value: Out<*const c_char>,
) -> i32 {
    code(instance.call("sandgate_get_text", Need::Sound, |i| {
        get_texts(i, &[reference], &mut value, 1)
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_step(
    instance: Handle,
    t: f64,
    h: f64,
    mut report: Out<CStepReport>,
) -> i32 {
    code(instance.call("sandgate_step", Need::Sound, |i| {
        let done = i.step(t, h)?;
        let saturated = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        report.write_if_wanted(CStepReport {
            time: done.time,
            smallest_step: done.smallest_step,
            substeps: saturated(done.substeps),
            iterations: saturated(done.iterations),
        });
        Ok(())
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_time(instance: Handle, mut time: Out<f64>) -> i32 {
    code(instance.call("sandgate_time", Need::Sound, |i| {
        time.write(&[i.component.time()], "time")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get_mode(instance: Handle, mut mode: Out<i32>) -> i32 {
    code(instance.call("sandgate_get_mode", Need::Sound, |i| {
        let number = match i.component.mode() {
            Mode::Instantiated => 0,
            Mode::Initialization => 1,
            Mode::Stepping => 2,
            Mode::Terminated => 3,
            Mode::Failed => 4,
        };
        mode.write(&[number], "mode")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get_ledger(instance: Handle, mut ledger: Out<CLedger>) -> i32 {
    code(instance.call("sandgate_get_ledger", Need::Sound, |i| {
        let now = i.component.ledger();
        let now = CLedger {
            initial: now.initial,
            inflow: now.inflow,
            outflow: now.outflow,
            present: now.present,
        };
        ledger.write(&[now], "ledger")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_save_size(instance: Handle, mut size: Out<usize>) -> i32 {
    code(instance.call("sandgate_save_size", Need::Sound, |i| {
        size.write(&[i.component.save()?.len()], "size")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_save(
    instance: Handle,
    mut bytes: Out<u8>,
    capacity: usize,
    mut size: Out<usize>,
) -> i32 {
    code(instance.call("sandgate_save", Need::Sound, |i| {
        let state = i.save_if(|needed| {
            if needed > capacity {
                return Err(Fault::border(format!(
                    "found room for {capacity} bytes, the state has {needed}"
                )));
            }
            size.check(1, "size")?;
            bytes.check(needed, "bytes")
        })?;
        bytes.write(&state.bytes, "bytes")?;
        size.write(&[state.bytes.len()], "size")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_restore(instance: Handle, bytes: In<u8>, size: usize) -> i32 {
    code(instance.call("sandgate_restore", Need::Any, |i| {
        i.restore(bytes.slice(size, "bytes")?, None)
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_reset(instance: Handle) -> i32 {
    code(instance.call("sandgate_reset", Need::Any, Instance::reset))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_terminate(instance: Handle) -> i32 {
    code(instance.call("sandgate_terminate", Need::Sound, |i| i.terminate()))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set_threads(instance: Handle, threads: u32) -> i32 {
    code(instance.call("sandgate_set_threads", Need::Sound, |i| {
        if threads > MOST_THREADS {
            return Err(Fault::border(format!(
                "found {threads} threads, allowed 0 (all cores) to {MOST_THREADS}"
            )));
        }
        i.set_threads(threads as usize);
        Ok(())
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_state_hash(instance: Handle, mut hash: Out<u8>) -> i32 {
    code(instance.call("sandgate_state_hash", Need::Sound, |i| {
        let text = text(&i.component.state_hash());
        if text.as_bytes().len() != HASH {
            // The caller's buffer holds a hash and no more.
            return Err(Fault::border(text.to_string_lossy().into_owned()));
        }
        hash.write(text.as_bytes_with_nul(), "hash")
    }))
}
