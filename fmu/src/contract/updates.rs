//! Intermediate updates of FMI 3: what the importer may see and do while a step is running.

use std::ffi::{c_char, c_void};
use std::ptr;
use std::sync::Mutex;

use sandgate::component::VariableTable;
use sandgate::fmi::FmiVersion;
use sandgate::scene::Scene;

use super::{Update, note, pack};

type Logger = extern "C" fn(*mut c_void, i32, *const c_char, *const c_char);

unsafe extern "C" {
    fn fmi3InstantiateCoSimulation(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: bool,
        logging: bool,
        events: bool,
        early: bool,
        variables: *const u32,
        count: usize,
        environment: *mut c_void,
        logger: Logger,
        update: Option<Update>,
    ) -> *mut c_void;
    fn fmi3FreeInstance(c: *mut c_void);
    fn fmi3EnterInitializationMode(
        c: *mut c_void,
        tol: bool,
        tolerance: f64,
        start: f64,
        has: bool,
        stop: f64,
    ) -> i32;
    fn fmi3ExitInitializationMode(c: *mut c_void) -> i32;
    fn fmi3GetFloat64(c: *mut c_void, r: *const u32, n: usize, v: *mut f64, m: usize) -> i32;
    fn fmi3SetFloat64(c: *mut c_void, r: *const u32, n: usize, v: *const f64, m: usize) -> i32;
    fn fmi3GetOutputDerivatives(
        c: *mut c_void,
        r: *const u32,
        n: usize,
        orders: *const i32,
        v: *mut f64,
        m: usize,
    ) -> i32;
    fn fmi3Reset(c: *mut c_void) -> i32;
    fn fmi3DoStep(
        c: *mut c_void,
        t: f64,
        h: f64,
        no_set: bool,
        event: *mut bool,
        terminate: *mut bool,
        early: *mut bool,
        last: *mut f64,
    ) -> i32;
}

/// What the importer does in its callback.
#[derive(Clone, Copy, Default)]
struct Plan {
    /// Reads these.
    depth: u32,
    /// Sets this input to the value.
    set: Option<(u32, f64)>,
    /// Asks to end the step at this time.
    end_at: Option<f64>,
    /// Calls what is forbidden there.
    misbehaves: bool,
    /// Sets an input, though none was asked for.
    sets_unasked: bool,
}

/// One call of the callback.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    time: f64,
    flags: [bool; 4],
    read: [f64; 2],
    /// Slope of the depth.
    slope: f64,
}

/// What the environment pointer points to.
struct World {
    instance: *mut c_void,
    gate: u32,
    plan: Plan,
    seen: Vec<Seen>,
    messages: Mutex<Vec<String>>,
}

extern "C" fn logger(environment: *mut c_void, _: i32, _: *const c_char, text: *const c_char) {
    let world = unsafe { &*environment.cast::<World>() };
    note((&raw const world.messages).cast_mut().cast(), text);
}

extern "C" fn update(
    environment: *mut c_void,
    time: f64,
    set_requested: bool,
    get_allowed: bool,
    step_finished: bool,
    can_return_early: bool,
    early: *mut bool,
    early_time: *mut f64,
) {
    let world = unsafe { &mut *environment.cast::<World>() };
    let (instance, plan) = (world.instance, world.plan);
    let mut read = [f64::NAN; 2];
    let references = [0, plan.depth];
    let status = unsafe { fmi3GetFloat64(instance, references.as_ptr(), 2, read.as_mut_ptr(), 2) };
    assert_eq!(status, 0, "{:?}", world.messages);
    let slope = slope(instance, plan.depth);
    if let Some((reference, value)) = plan.set {
        let status =
            unsafe { fmi3SetFloat64(instance, &raw const reference, 1, &raw const value, 1) };
        assert_eq!(status, 0, "{:?}", world.messages);
    }
    if plan.sets_unasked {
        let (gate, shut) = (world.gate, 0.0);
        let status = unsafe { fmi3SetFloat64(instance, &raw const gate, 1, &raw const shut, 1) };
        assert_eq!(status, 3);
    }
    if plan.misbehaves {
        let (flag, last) = (ptr::null_mut(), ptr::null_mut());
        let h = 0.001;
        let step = unsafe { fmi3DoStep(instance, time, h, true, flag, flag, flag, last) };
        let reset = unsafe { fmi3Reset(instance) };
        let scale = 3_u32; // solver.resolution_scale comes fourth.
        let fixed = unsafe { fmi3SetFloat64(instance, &raw const scale, 1, &raw const h, 1) };
        assert_eq!([step, reset, fixed], [3; 3]);
    }
    if let Some(end) = plan.end_at {
        unsafe {
            *early = true;
            *early_time = end;
        }
    }
    world.seen.push(Seen {
        time,
        flags: [set_requested, get_allowed, step_finished, can_return_early],
        read,
        slope,
    });
}

/// First derivative of an output.
fn slope(c: *mut c_void, reference: u32) -> f64 {
    let (order, mut value) = (1, f64::NAN);
    let (r, o, v) = (&raw const reference, &raw const order, &raw mut value);
    let status = unsafe { fmi3GetOutputDerivatives(c, r, 1, o, v, 1) };
    assert_eq!(status, 0);
    value
}

/// An instance between steps with its gate told to open, its environment, and its gate's reference.
struct Rig {
    world: Box<World>,
    gate: u32,
    depth: u32,
    h: f64,
}

impl Rig {
    fn new(scene: &Scene, plan: Plan, early: bool, required: &[&str], callback: bool) -> Self {
        let token = pack(scene, FmiVersion::V3);
        let table = VariableTable::of(scene);
        let find = |name: &str| table.by_name(name).expect("it is there").reference;
        let (gate, depth) = (find("gate.sluice.opening"), find("gauge.depth.depth"));
        let required: Vec<u32> = required.iter().map(|name| find(name)).collect();
        let mut world = Box::new(World {
            instance: ptr::null_mut(),
            gate,
            plan: Plan { depth, ..plan },
            seen: Vec::new(),
            messages: Mutex::default(),
        });
        world.instance = unsafe {
            fmi3InstantiateCoSimulation(
                c"instance".as_ptr(),
                token.as_ptr(),
                ptr::null(),
                false,
                true,
                false,
                early,
                required.as_ptr(),
                required.len(),
                (&raw mut *world).cast(),
                logger,
                callback.then_some(update as Update),
            )
        };
        assert!(!world.instance.is_null(), "{:?}", world.messages);
        let (c, open) = (world.instance, 1.0);
        unsafe {
            assert_eq!(
                fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0),
                0
            );
            assert_eq!(fmi3ExitInitializationMode(c), 0);
            assert_eq!(fmi3SetFloat64(c, &raw const gate, 1, &raw const open, 1), 0);
        }
        let h = scene.run.step;
        Self {
            world,
            gate,
            depth,
            h,
        }
    }

    /// One step: early return and last successful time.
    fn step(&mut self, t: f64, h: f64) -> (bool, f64) {
        let (mut flags, mut last) = ([true; 3], f64::NAN);
        let [event, terminate, early] = &mut flags;
        let status = unsafe {
            fmi3DoStep(
                self.world.instance,
                t,
                h,
                true,
                event,
                terminate,
                early,
                &raw mut last,
            )
        };
        assert_eq!(status, 0, "{:?}", self.world.messages);
        assert!(!flags[0] && !flags[1]);
        assert_eq!(last.to_bits(), self.get(0).to_bits());
        (flags[2], last)
    }

    fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        let c = self.world.instance;
        let status = unsafe { fmi3GetFloat64(c, &raw const reference, 1, &raw mut value, 1) };
        assert_eq!(status, 0, "{:?}", self.world.messages);
        value
    }

    /// How many messages have this in them.
    fn told(&self, part: &str) -> usize {
        let messages = self.world.messages.lock().expect("no panic inside");
        messages.iter().filter(|m| m.contains(part)).count()
    }

    /// Whether a message has this in it.
    fn was_told(&self, part: &str) {
        let messages = self.world.messages.lock().expect("no panic inside");
        assert!(messages.iter().any(|m| m.contains(part)), "{messages:?}");
    }

    fn state(&self) -> Vec<u8> {
        let handle: crate::guard::Handle =
            unsafe { std::mem::transmute_copy(&self.world.instance) };
        let saved = handle.call("test", crate::guard::Need::Any, |i| {
            Ok(i.component.save()?)
        });
        saved.expect("it can be saved")
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        unsafe { fmi3FreeInstance(self.world.instance) }
    }
}

const READS: [&str; 2] = ["time", "gauge.depth.depth"];

#[test]
fn updates_come_after_internal_steps_and_watching_changes_no_bit() {
    let scene = super::scene();
    let mut watched = Rig::new(&scene, Plan::default(), false, &READS, true);
    let mut alone = Rig::new(&scene, Plan::default(), false, &[], false);
    for k in 0..4 {
        let t = f64::from(k) * watched.h;
        watched.world.seen.clear();
        let before = watched.get(watched.depth);
        for rig in [&mut watched, &mut alone] {
            let h = rig.h;
            let (early, last) = rig.step(t, h);
            assert!(!early);
            assert_eq!(last.to_bits(), (t + h).to_bits());
        }
        let seen = &watched.world.seen;
        assert!(seen.len() > 1, "{seen:?}");
        assert!(seen.windows(2).all(|pair| pair[0].time < pair[1].time));
        assert!(seen.iter().all(|s| s.flags == [false, true, true, false]));
        assert!(seen.iter().all(|s| s.read[0].to_bits() == s.time.to_bits()));
        let end = seen[seen.len() - 1];
        assert_eq!(end.time.to_bits(), (t + watched.h).to_bits());
        let depth = watched.get(watched.depth);
        assert_eq!(end.read[1].to_bits(), depth.to_bits());
        assert_eq!(end.slope, slope(watched.world.instance, watched.depth));
        assert_eq!(end.slope, (depth - before) / (end.time - t));
        let first = seen[0];
        assert_eq!(first.slope, (first.read[1] - before) / (first.time - t));
        assert!(watched.state() == alone.state());
    }
    assert!(alone.world.seen.is_empty());
}

#[test]
fn a_callback_with_nothing_to_do_is_not_called() {
    let mut rig = Rig::new(&super::scene(), Plan::default(), false, &[], true);
    rig.step(0.0, rig.h);
    assert!(rig.world.seen.is_empty());
}

#[test]
fn a_step_ends_early_only_if_allowed_and_then_exactly_there() {
    let scene = super::scene();
    let wish = |end: f64| Plan {
        end_at: Some(end),
        ..Plan::default()
    };
    let mut forbidden = Rig::new(&scene, wish(0.0), false, &READS, true);
    let h = forbidden.h;
    assert_eq!(forbidden.step(0.0, h), (false, h));

    // At once: after the first internal step.
    let mut at_once = Rig::new(&scene, wish(f64::NAN), true, &[], true);
    let (early, first) = at_once.step(0.0, h);
    assert!(early && first > 0.0 && first < h);
    at_once.was_told("earlyReturnTime: found NaN s, allowed 0 s to");
    assert_eq!(at_once.world.seen.len(), 1);
    assert_eq!(at_once.world.seen[0].time.to_bits(), first.to_bits());
    assert!(at_once.world.seen[0].flags[3]);
    // Going on from there is allowed.
    at_once.world.plan.end_at = None;
    assert!(!at_once.step(first, h - first).0);

    // At a time inside, met to the bit, as a step of that length.
    let inside = 0.7 * h;
    let mut exact = Rig::new(&scene, wish(inside), true, &[], true);
    assert_eq!(exact.step(0.0, h), (true, inside));

    // Beyond the end: the step's own end.
    let mut beyond = Rig::new(&scene, wish(2.0 * h), true, &[], true);
    assert_eq!(beyond.step(0.0, h), (false, h));
    beyond.was_told(&format!("the step; it ends at {h} s"));
    // Once a step, however many internal steps it has.
    for (k, t) in [(1, h), (2, 2.0 * h)] {
        let seen = beyond.world.seen.len();
        assert!(seen > k, "{seen} internal steps in {k}");
        assert_eq!(beyond.told("earlyReturnTime"), k);
        beyond.world.plan.end_at = Some(t + 2.0 * h);
        beyond.step(t, h);
    }
}

#[test]
fn inputs_are_set_inside_a_step_only_if_that_was_asked_for() {
    let scene = super::scene();
    let mut plain = Rig::new(&scene, Plan::default(), false, &[], false);
    let plan = Plan {
        sets_unasked: true,
        ..Plan::default()
    };
    let mut rig = Rig::new(&scene, plan, false, &READS, true);
    let h = rig.h;
    rig.step(0.0, h);
    plain.step(0.0, h);
    assert!(rig.world.seen.iter().all(|seen| !seen.flags[0]));
    rig.was_told("fmi3SetFloat64: intermediateVariableSetRequested is false");
    assert!(rig.state() == plain.state());
}

#[test]
fn inputs_set_inside_a_step_count_from_there() {
    let scene = super::scene();
    let mut plain = Rig::new(&scene, Plan::default(), false, &[], false);
    let mut shut = Rig::new(
        &scene,
        Plan {
            set: Some((plain.gate, 0.0)),
            ..Plan::default()
        },
        false,
        &["gate.sluice.opening"],
        true,
    );
    let h = plain.h;
    let opening = VariableTable::of(&scene);
    let opening = opening
        .by_name("gate.sluice.actual_opening")
        .expect("it is there");
    plain.step(0.0, h);
    shut.step(0.0, h);
    assert!(shut.world.seen.iter().all(|s| s.flags[0]));
    assert_eq!(shut.get(shut.gate), 0.0);
    assert!(shut.get(opening.reference) < plain.get(opening.reference));
}

#[test]
fn other_calls_inside_an_update_are_refused_with_a_message() {
    let scene = super::scene();
    let plan = Plan {
        misbehaves: true,
        ..Plan::default()
    };
    let mut rude = Rig::new(&scene, plan, false, &["gate.sluice.opening"], true);
    let mut plain = Rig::new(&scene, Plan::default(), false, &[], false);
    let h = rude.h;
    rude.step(0.0, h);
    plain.step(0.0, h);
    assert!(rude.state() == plain.state());
    let messages = rude.world.messages.lock().expect("no panic inside");
    for part in [
        "fmi3DoStep: another call on this instance is running",
        "fmi3Reset: another call on this instance is running",
        "solver.resolution_scale: found a parameter, allowed inputs, while a step is running",
    ] {
        assert!(
            messages.iter().any(|m| m.contains(part)),
            "{part}: {messages:?}"
        );
    }
}
