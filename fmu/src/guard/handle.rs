//! Instances behind the pointer that callers hold, and the wall that panics and second calls run into.

use std::cell::{Cell, UnsafeCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicU8, Ordering};

use sandgate::math::panic_text;

use super::arithmetic::inside;
use crate::access::Values;
use crate::fault::{Fault, Status};
use crate::instance::Instance;
use crate::updates::Guest;

/// No call is running.
const FREE: u8 = 0;
/// A call is running.
const BUSY: u8 = 1;
/// A step is running and has called the importer, who may read and set variables.
const OPEN: u8 = 2;
/// It is doing so.
const VISITED: u8 = 3;

/// An instance, which call on it is running, and who may be visited while one is.
pub(crate) struct Slot {
    door: AtomicU8,
    instance: UnsafeCell<Instance>,
    /// A [`Guest`] while the door is OPEN or VISITED, else NULL.
    guest: Cell<*mut Guest<'static, 'static>>,
}

/// Lets the importer in while a step is running.
pub(crate) struct Door<'s>(&'s Slot);

impl Door<'_> {
    /// Calls the importer, who may read and set variables through the instance's pointer until `outside` returns.
    pub(crate) fn open<T>(&self, guest: &mut Guest<'_, '_>, outside: impl FnOnce() -> T) -> T {
        let slot = self.0;
        slot.guest.set(ptr::from_mut(guest).cast());
        slot.door.store(OPEN, Ordering::Release);
        let result = outside();
        while slot.close().is_err() {
            // A visit from another thread, which no standard allows, is over soon.
            std::hint::spin_loop();
        }
        slot.guest.set(ptr::null_mut());
        assert!(!guest.is_hurt, "an intermediate access broke down");
        result
    }
}

impl Slot {
    fn close(&self) -> Result<u8, u8> {
        let (acquire, relaxed) = (Ordering::Acquire, Ordering::Relaxed);
        self.door.compare_exchange(OPEN, BUSY, acquire, relaxed)
    }

    /// The guest, if the door is open and nobody else is with it; `None` otherwise.
    fn with_guest<T>(&self, work: impl FnOnce(&mut Guest<'_, '_>) -> T) -> Option<T> {
        let (acquire, relaxed) = (Ordering::Acquire, Ordering::Relaxed);
        self.door
            .compare_exchange(OPEN, VISITED, acquire, relaxed)
            .ok()?;
        let _reopen = Reopen(&self.door);
        // SAFETY: the door was OPEN, so `Door::open` has put a pointer to a living guest here and uses neither it nor
        // the pointer until the door is OPEN again; VISITED makes this the only reference.
        unsafe { self.guest.get().as_mut() }.map(work)
    }

    /// As [`Handle::call_with_door`].
    fn enter<T>(
        &self,
        call: &'static str,
        need: Need,
        work: impl FnOnce(&mut Instance, &Door<'_>) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let (acquire, relaxed) = (Ordering::Acquire, Ordering::Relaxed);
        let entered = self.door.compare_exchange(FREE, BUSY, acquire, relaxed);
        if entered.is_err() {
            let fault = Fault::border(
                "another call on this instance is running; an intermediate update may get and set numbers and get slopes of outputs only",
            );
            // The importer's logger is C; what panics here is ours.
            let _ = shield(|| self.with_guest(|guest| guest.report(call, &fault)));
            return Err(fault);
        }
        // SAFETY: the door was FREE and is BUSY now, so this is the only reference into the cell until it is FREE.
        let instance = unsafe { &mut *self.instance.get() };
        let result = guarded(instance, call, need, |instance| work(instance, &Door(self)));
        self.door.store(FREE, Ordering::Release);
        result
    }

    /// As [`Handle::visit`], while the door is open.
    fn visit<T>(
        &self,
        call: &'static str,
        work: impl FnOnce(&mut dyn Values) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let visited = self.with_guest(|guest| {
            let result = shield(|| work(guest)).unwrap_or_else(|how| {
                guest.is_hurt = true;
                Err(Fault::Broken(format!("broke down ({how})")))
            });
            if let Err(fault) = &result {
                guest.report(call, fault);
            }
            result
        });
        visited.unwrap_or_else(|| Err(Fault::border("another call on this instance is running")))
    }
}

/// Opens the door again when a visit is over, also by a panic: the step waits for it.
struct Reopen<'d>(&'d AtomicU8);

impl Drop for Reopen<'_> {
    fn drop(&mut self) {
        self.0.store(OPEN, Ordering::Release);
    }
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
            door: AtomicU8::new(FREE),
            instance: UnsafeCell::new(instance),
            guest: Cell::new(ptr::null_mut()),
        })))
    }

    /// What a refused instantiation gives.
    pub(crate) fn null() -> Self {
        Self(ptr::null_mut())
    }

    /// Runs one call on the instance: no second call at the same time, no panic gets out, faults are reported.
    pub(crate) fn call<T>(
        &self,
        call: &'static str,
        need: Need,
        work: impl FnOnce(&mut Instance) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        self.call_with_door(call, need, |instance, _| work(instance))
    }

    /// As [`Handle::call`], for a step, which may open the door to the importer.
    pub(crate) fn call_with_door<T>(
        &self,
        call: &'static str,
        need: Need,
        work: impl FnOnce(&mut Instance, &Door<'_>) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let slot = self.slot(call)?;
        inside(|| slot.enter(call, need, work))
    }

    /// Runs one call that gets or sets numbers: between other calls, or while a step has the door open.
    pub(crate) fn visit<T>(
        &self,
        call: &'static str,
        work: impl FnOnce(&mut dyn Values) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let slot = self.slot(call)?;
        if slot.door.load(Ordering::Acquire) != OPEN {
            return self.call(call, Need::Sound, |instance| work(instance));
        }
        inside(|| slot.visit(call, work))
    }

    fn slot(&self, call: &str) -> Result<&Slot, Fault> {
        // SAFETY: the caller promises NULL or a pointer from `new` that it has not freed.
        unsafe { self.0.as_ref() }
            .ok_or_else(|| Fault::border(format!("{call}: the instance is NULL")))
    }

    /// Answers a call that a capability flag says is not there.
    pub(crate) fn not_provided(&self, call: &'static str, capability: &str) -> Status {
        self.call(call, Need::Any, |_| -> Result<(), Fault> {
            Err(Fault::border(format!(
                "not provided; see {capability} in modelDescription.xml"
            )))
        })
        .into()
    }

    /// Frees the instance. NULL is fine. An instance with a running call is left alone: freeing it would be worse.
    pub(crate) fn free(self) {
        let Ok(slot) = self.slot("free") else {
            return;
        };
        let (acquire, relaxed) = (Ordering::Acquire, Ordering::Relaxed);
        let entered = slot.door.compare_exchange(FREE, BUSY, acquire, relaxed);
        if entered.is_ok() {
            // SAFETY: `new` made it with Box::into_raw, and the caller promises not to use the pointer again.
            let slot = unsafe { Box::from_raw(self.0) };
            let _ = inside(|| shield(move || slot.instance.into_inner().finish("freed")));
        }
    }
}

fn guarded<T>(
    instance: &mut Instance,
    call: &'static str,
    need: Need,
    work: impl FnOnce(&mut Instance) -> Result<T, Fault>,
) -> Result<T, Fault> {
    instance.journal.begin(call);
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
    // The importer's logger is C; what panics here is ours.
    let _ = shield(|| instance.answered(call, result.as_ref().err()));
    result
}

/// Runs `work` and turns a panic into its message.
pub(crate) fn shield<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| panic_text(payload.as_ref()))
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

    /// `solver.threads`, set before if one is wanted.
    fn threads(handle: &Handle, wanted: Option<f64>) -> f64 {
        let now = handle.call("threads", Need::Sound, |i| {
            let row = i.component.variables().by_name("solver.threads");
            let reference = [row.expect("every scene has it").reference];
            if let Some(wanted) = wanted {
                i.component.set(&reference, &[wanted])?;
            }
            let mut now = [0.0];
            i.component.get(&reference, &mut now)?;
            Ok(now[0])
        });
        now.expect("sound")
    }

    fn break_down(handle: &Handle) {
        let broken: Result<(), Fault> = handle.call("break", Need::Sound, |_| panic!("on purpose"));
        assert!(matches!(broken, Err(Fault::Broken(how)) if how.contains("on purpose")));
    }

    #[test]
    fn a_panic_ends_at_the_wall_and_reset_or_a_state_puts_things_right() {
        let (one, other) = (handle(), handle());
        let saved = one.call("save", Need::Sound, |i| {
            i.component.initialize(0.0, Some(9.0))?;
            i.save()
        });
        let saved = saved.expect("sound");
        threads(&one, Some(2.0));
        break_down(&one);
        let refused = mode(&one).expect_err("broken").to_string();
        assert!(refused.contains("on purpose") && refused.contains("reset the instance"));
        assert_eq!(mode(&other).expect("not its panic"), Mode::Instantiated);

        let bad = one.call("set", Need::Any, |i| i.restore(b"rubbish", None));
        assert!(bad.is_err() && mode(&one).is_err());
        let set = one.call("set", Need::Any, |i| i.restore(&saved.bytes, None));
        assert!(set.is_ok());
        assert_eq!(mode(&one).expect("sound again"), Mode::Stepping);
        assert_eq!(threads(&one, None), 2.0);
        let stop = one.call("stop", Need::Sound, |i| Ok(i.component.stop_time()));
        assert_eq!(stop.expect("sound"), Some(9.0));

        break_down(&one);
        assert!(one.call("reset", Need::Any, Instance::reset).is_ok());
        assert_eq!(mode(&one).expect("sound again"), Mode::Instantiated);
        assert_eq!(threads(&one, None), 1.0);
        one.free();
        other.free();
    }

    #[test]
    fn a_panic_of_a_visitor_opens_the_door_again() {
        let door = AtomicU8::new(VISITED);
        let visit = shield(|| {
            let _reopen = Reopen(&door);
            panic!("on purpose");
        });
        assert!(visit.is_err_and(|how: String| how.contains("on purpose")));
        assert_eq!(door.load(Ordering::Acquire), OPEN);
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
