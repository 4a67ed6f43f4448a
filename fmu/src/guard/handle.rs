//! Instances behind the pointer that callers hold, and the wall that panics and second calls run into.

use std::any::Any;
use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::fault::{Fault, Status};
use crate::instance::Instance;

/// An instance and whether a call on it is running.
pub(crate) struct Slot {
    busy: AtomicBool,
    instance: UnsafeCell<Instance>,
}

/// What a call asks of an instance.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Need {
    /// One that no panic has left half-way.
    Sound,
    /// Any: the call puts things right (reset, set a state) or touches nothing.
    Any,
}

/// `fmi2Component`, `fmi3Instance`, `sandgate_instance*`: NULL, or what [`Handle::new`] gave.
#[repr(transparent)]
pub(crate) struct Handle(*mut Slot);

impl Handle {
    /// Hands an instance to the caller.
    pub(crate) fn new(instance: Instance) -> Self {
        Self(Box::into_raw(Box::new(Slot {
            busy: AtomicBool::new(false),
            instance: UnsafeCell::new(instance),
        })))
    }

    /// What a refused instantiation gives.
    pub(crate) fn null() -> Self {
        Self(ptr::null_mut())
    }

    /// Runs one call on the instance: no second call at the same time, no panic gets out, faults are reported.
    pub(crate) fn call<T>(
        &self,
        call: &str,
        need: Need,
        work: impl FnOnce(&mut Instance) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        // SAFETY: the caller promises NULL or a pointer from `new` that it has not freed.
        let Some(slot) = (unsafe { self.0.as_ref() }) else {
            return Err(Fault::border(format!("{call}: the instance is NULL")));
        };
        if slot.busy.swap(true, Ordering::Acquire) {
            return Err(Fault::border(format!(
                "{call}: another call on this instance is running"
            )));
        }
        // SAFETY: `busy` was false and is true now, so this is the only reference into the cell until it is false.
        let instance = unsafe { &mut *slot.instance.get() };
        let result = guarded(instance, call, need, work);
        slot.busy.store(false, Ordering::Release);
        result
    }

    /// Answers a call that a capability flag says is not there.
    pub(crate) fn not_provided(&self, call: &str, capability: &str) -> Status {
        self.call(call, Need::Any, |_| -> Result<(), Fault> {
            Err(Fault::border(format!(
                "not provided; see {capability} in modelDescription.xml"
            )))
        })
        .into()
    }

    /// Frees the instance. NULL is fine. An instance with a running call is left alone: freeing it would be worse.
    pub(crate) fn free(self) {
        // SAFETY: as in `call`.
        let Some(slot) = (unsafe { self.0.as_ref() }) else {
            return;
        };
        if !slot.busy.swap(true, Ordering::Acquire) {
            // SAFETY: `new` made it with Box::into_raw, and the caller promises not to use the pointer again.
            let slot = unsafe { Box::from_raw(self.0) };
            let _ = shield(move || drop(slot));
        }
    }
}

fn guarded<T>(
    instance: &mut Instance,
    call: &str,
    need: Need,
    work: impl FnOnce(&mut Instance) -> Result<T, Fault>,
) -> Result<T, Fault> {
    let result = match (need, instance.broken()) {
        (Need::Sound, Some(how)) => Err(Fault::Broken(format!(
            "an earlier call broke down ({how}); reset the instance or set a state"
        ))),
        _ => match shield(|| work(instance)) {
            Ok(result) => result,
            Err(how) => {
                instance.set_broken(&how);
                Err(Fault::Broken(format!(
                    "broke down ({how}); reset the instance or set a state"
                )))
            }
        },
    };
    if let Err(fault) = &result {
        // The importer's logger is C; what panics here is ours.
        let _ = shield(|| instance.report(call, fault));
    }
    result
}

/// Runs `work` and turns a panic into its message.
pub(crate) fn shield<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| message(payload.as_ref()))
}

fn message(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "panic".to_owned())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use sandgate::component::Mode;
    use sandgate::scene;

    use super::*;
    use crate::log::{Log, Sink};

    fn handle() -> Handle {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let scene = scene::load(&root.join("tests/scenes/small_silo.toml")).expect("it loads");
        Handle::new(Instance::new(&scene, Log::new(Sink::Nobody, false)).expect("it builds"))
    }

    fn mode(handle: &Handle) -> Result<Mode, Fault> {
        handle.call("mode", Need::Sound, |i| Ok(i.component.mode()))
    }

    fn break_down(handle: &Handle) {
        let broken: Result<(), Fault> = handle.call("break", Need::Sound, |_| panic!("on purpose"));
        assert!(matches!(broken, Err(Fault::Broken(how)) if how.contains("on purpose")));
    }

    #[test]
    fn a_panic_ends_at_the_wall_and_reset_or_a_state_puts_things_right() {
        let (one, other) = (handle(), handle());
        let saved = one.call("save", Need::Sound, |i| {
            i.component.initialize(0.0, None)?;
            i.save()
        });
        let saved = saved.expect("sound");
        break_down(&one);
        let refused = mode(&one).expect_err("broken").to_string();
        assert!(refused.contains("on purpose") && refused.contains("reset the instance"));
        assert_eq!(mode(&other).expect("not its panic"), Mode::Instantiated);

        let bad = one.call("set", Need::Any, |i| i.restore(b"rubbish", None));
        assert!(bad.is_err() && mode(&one).is_err());
        let set = one.call("set", Need::Any, |i| i.restore(&saved.bytes, None));
        assert!(set.is_ok());
        assert_eq!(mode(&one).expect("sound again"), Mode::Stepping);

        break_down(&one);
        assert!(one.call("reset", Need::Any, Instance::reset).is_ok());
        assert_eq!(mode(&one).expect("sound again"), Mode::Instantiated);
        one.free();
        other.free();
    }

    #[test]
    fn a_call_during_a_call_is_refused() {
        let one = handle();
        let inner = one.call("outer", Need::Sound, |_| Ok(mode(&one).is_err()));
        assert!(inner.expect("the outer call goes on"));
        assert!(mode(&one).is_ok());
        one.free();
        assert!(mode(&Handle::null()).is_err());
        Handle::null().free();
    }
}
