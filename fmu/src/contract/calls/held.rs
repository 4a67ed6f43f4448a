//! What calls are made with: an instance in a wanted mode, its variables, and arguments as a C caller makes them.

use std::ffi::{CStr, c_void};
use std::mem::{transmute_copy, zeroed};
use std::ptr;

use sandgate::component::{Component, Mode};
use sandgate::scene::{self, Scene};

use super::H;
use crate::contract;
use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out, StateHandle, StateSlot, Text};
use crate::instance::Instance;
use crate::log::{Log, Sink};

/// An instance behind the pointer that a C caller holds.
pub(super) struct Held(*mut c_void);

impl Held {
    pub(super) fn handle(&self) -> Handle {
        // A handle is that pointer and nothing else.
        unsafe { transmute_copy(&self.0) }
    }

    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Instance) -> T) -> T {
        let done = self.handle().call("test", Need::Any, |i| Ok(work(i)));
        done.expect("no call is running")
    }

    pub(super) fn time(&self) -> f64 {
        self.with(|i| i.component.time())
    }

    pub(super) fn state(&self) -> Vec<u8> {
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
    let text = include_str!("../../../../tests/scenes/no_floor.toml");
    let text = text.replace("upper = [0.1, 0.1]", "upper = [0.2, 0.1]");
    let gate = "\n[gates.sluice]\nfrom = [0.15, 0.02]\nto = [0.15, 0.06]\n";
    scene::parse("leaking.toml", &(text + gate)).unwrap_or_else(|why| panic!("{why}"))
}

pub(super) fn held(mode: Mode) -> Held {
    let scene = if mode == Mode::Failed {
        leaking()
    } else {
        contract::scene()
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

pub(super) fn of<T>(values: &[T]) -> In<T> {
    unsafe { transmute_copy(&values.as_ptr()) }
}

pub(super) fn to<T>(values: &mut [T]) -> Out<T> {
    unsafe { transmute_copy(&values.as_mut_ptr()) }
}

pub(super) fn text(text: &'static CStr) -> Text {
    unsafe { transmute_copy(&text.as_ptr()) }
}

/// NULL, 0: for arguments that do not matter.
pub(super) fn none<T>() -> T {
    unsafe { zeroed() }
}

/// A state slot with a state of this instance, or nothing inside.
pub(super) struct Place(pub(super) *mut c_void);

impl Place {
    pub(super) fn slot(&mut self) -> StateSlot {
        let place: *mut *mut c_void = &raw mut self.0;
        unsafe { transmute_copy(&place) }
    }

    pub(super) fn handle(&self) -> StateHandle {
        unsafe { transmute_copy(&self.0) }
    }
}

pub(super) fn with_state(held: &Held, work: impl FnOnce(&mut Place) -> Status) -> Status {
    let mut place = Place(ptr::null_mut());
    let mut slot = place.slot();
    held.handle()
        .call("test", Need::Any, |i| slot.put(i.save()?))
        .expect("it can be saved");
    let status = work(&mut place);
    place.slot().free().expect("it is live or NULL");
    status
}

/// References of some variables of the scene in use.
pub(super) struct Names {
    pub(super) opening: u32,
    pub(super) scale: u32,
    pub(super) threads: u32,
    pub(super) saturate: u32,
    pub(super) steps: u32,
    pub(super) output: u32,
    pub(super) blocked: u32,
    pub(super) path: u32,
}

pub(super) fn names(component: &Component) -> Names {
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
