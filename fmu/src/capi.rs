//! The plain C interface; its contract stands in include/sandgate.h, and a test compiles these against it.
//!
//! Here is the life of an instance, from create to free; `variables` has its values, `state` its saved states.

pub(crate) mod state;
pub(crate) mod variables;

use std::ffi::c_char;

use sandgate::component::Mode;
use sandgate::scene::{self, Scene, SceneErrors};

use crate::asked::Asked;
use crate::fault::Fault;
use crate::guard::{
    CLedger, CStepReport, Environment, Handle, Need, Out, PlainLogger, Text, inside, shield,
};
use crate::instance::Instance;
use crate::log::{Log, Sink};

const ABI_VERSION: u32 = 1;
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
        Err(Fault::Border(_) | Fault::NoStatus(_)) => 3,
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
        let name = name.get_or("name", "scene")?;
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
    let made = inside(|| {
        shield(|| {
            let scene = load()?.map_err(|errors| Fault::border(errors.to_string()))?;
            Instance::new(&scene, Log::new(Sink::Nobody, false))
        })
    });
    let reason = match made {
        Ok(Ok(mut instance)) => {
            instance.names = variables::names(&instance);
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
pub(crate) extern "C" fn sandgate_enter_initialization(
    instance: Handle,
    start: f64,
    stop: f64,
) -> i32 {
    code(
        instance.call("sandgate_enter_initialization", Need::Sound, |i| {
            let entered = i.component.enter_initialization(start, end(stop));
            Ok(entered.inspect_err(|_| {
                i.journal
                    .refuses(&i.component, &Asked::Times(start, end(stop)))
            })?)
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
        i.component.settle()?;
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
        i.set_threads(threads)
    }))
}
