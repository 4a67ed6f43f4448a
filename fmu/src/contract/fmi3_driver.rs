//! A driver over `fmi3*`.

use std::ffi::{CStr, c_char, c_void};
use std::ptr;
use std::sync::Mutex;

use sandgate::component::{ValueKind, VariableTable};
use sandgate::fmi::FmiVersion;
use sandgate::scene::Scene;

use super::suite::{Driver, Outcome, Refusal};
use super::{Messages, Update, groups, note, outcome, pack};

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
    fn fmi3Terminate(c: *mut c_void) -> i32;
    fn fmi3Reset(c: *mut c_void) -> i32;
    fn fmi3GetFloat64(c: *mut c_void, r: *const u32, n: usize, v: *mut f64, m: usize) -> i32;
    fn fmi3GetInt64(c: *mut c_void, r: *const u32, n: usize, v: *mut i64, m: usize) -> i32;
    fn fmi3GetBoolean(c: *mut c_void, r: *const u32, n: usize, v: *mut bool, m: usize) -> i32;
    fn fmi3SetFloat64(c: *mut c_void, r: *const u32, n: usize, v: *const f64, m: usize) -> i32;
    fn fmi3SetInt64(c: *mut c_void, r: *const u32, n: usize, v: *const i64, m: usize) -> i32;
    fn fmi3SetBoolean(c: *mut c_void, r: *const u32, n: usize, v: *const bool, m: usize) -> i32;
    fn fmi3GetFMUState(c: *mut c_void, state: *mut *mut c_void) -> i32;
    fn fmi3SetFMUState(c: *mut c_void, state: *mut c_void) -> i32;
    fn fmi3FreeFMUState(c: *mut c_void, state: *mut *mut c_void) -> i32;
    fn fmi3SerializedFMUStateSize(c: *mut c_void, state: *mut c_void, size: *mut usize) -> i32;
    fn fmi3SerializeFMUState(
        c: *mut c_void,
        state: *mut c_void,
        bytes: *mut u8,
        size: usize,
    ) -> i32;
    fn fmi3DeserializeFMUState(
        c: *mut c_void,
        bytes: *const u8,
        size: usize,
        state: *mut *mut c_void,
    ) -> i32;
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

extern "C" fn logger(
    environment: *mut c_void,
    _status: i32,
    _category: *const c_char,
    text: *const c_char,
) {
    note(environment, text);
}

pub(super) struct Fmi3 {
    instance: *mut c_void,
    messages: Messages,
    table: VariableTable,
}

impl Fmi3 {
    pub(super) fn new(scene: &Scene) -> Self {
        let token = pack(scene, FmiVersion::V3);
        let messages: Messages = Box::default();
        let environment = (&raw const *messages).cast_mut().cast();
        let instance = unsafe {
            fmi3InstantiateCoSimulation(
                c"instance".as_ptr(),
                token.as_ptr(),
                ptr::null(),
                false,
                true,
                false,
                false,
                ptr::null(),
                0,
                environment,
                logger,
                None,
            )
        };
        assert!(!instance.is_null(), "{messages:?}");
        let made = Self {
            instance,
            messages,
            table: VariableTable::of(scene),
        };
        // Only refusals are to be looked at.
        made.messages.lock().expect("no panic inside").clear();
        made
    }

    fn outcome(&self, status: i32) -> Outcome<()> {
        outcome(status, &self.messages)
    }

    fn set_group(&self, kind: ValueKind, references: &[u32], values: &[f64]) -> Outcome<()> {
        let (c, r, n, m) = (
            self.instance,
            references.as_ptr(),
            references.len(),
            values.len(),
        );
        let whole = values.iter().all(|v| v.fract() == 0.0);
        let status = match kind {
            ValueKind::Real => unsafe { fmi3SetFloat64(c, r, n, values.as_ptr(), m) },
            _ if !whole => return Err(Refusal::Inexpressible),
            ValueKind::Integer => {
                let values: Vec<i64> = values.iter().map(|v| *v as i64).collect();
                unsafe { fmi3SetInt64(c, r, n, values.as_ptr(), m) }
            }
            ValueKind::Text => return Err(Refusal::Inexpressible),
            ValueKind::Boolean => {
                let values: Vec<bool> = values.iter().map(|v| *v != 0.0).collect();
                unsafe { fmi3SetBoolean(c, r, n, values.as_ptr(), m) }
            }
        };
        self.outcome(status)
    }

    fn get_group(&self, kind: ValueKind, references: &[u32], count: usize) -> Outcome<Vec<f64>> {
        let (c, r, n) = (self.instance, references.as_ptr(), references.len());
        match kind {
            ValueKind::Real => {
                let mut values = vec![f64::NAN; count];
                self.outcome(unsafe { fmi3GetFloat64(c, r, n, values.as_mut_ptr(), count) })?;
                Ok(values)
            }
            ValueKind::Integer => {
                let mut values = vec![-1; count];
                self.outcome(unsafe { fmi3GetInt64(c, r, n, values.as_mut_ptr(), count) })?;
                Ok(values.into_iter().map(|v| v as f64).collect())
            }
            ValueKind::Text => Err(Refusal::Inexpressible),
            ValueKind::Boolean => {
                let mut values = vec![false; count];
                self.outcome(unsafe { fmi3GetBoolean(c, r, n, values.as_mut_ptr(), count) })?;
                Ok(values.into_iter().map(f64::from).collect())
            }
        }
    }
}

impl Drop for Fmi3 {
    fn drop(&mut self) {
        unsafe { fmi3FreeInstance(self.instance) }
    }
}

impl Driver for Fmi3 {
    fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Outcome<()> {
        let (has, stop) = (stop.is_some(), stop.unwrap_or_default());
        self.outcome(unsafe {
            fmi3EnterInitializationMode(self.instance, false, 0.0, start, has, stop)
        })
    }

    fn exit_initialization(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi3ExitInitializationMode(self.instance) })
    }

    fn set(&mut self, references: &[u32], values: &[f64]) -> Outcome<()> {
        let groups = groups(&self.table, references);
        if let [one] = groups.as_slice() {
            return self.set_group(one.kind, references, values);
        }
        // One call is all or nothing; several are made so by going back.
        let before = self.save()?;
        for group in groups {
            let mine: Vec<f64> = group
                .places
                .iter()
                .flat_map(|p| values[p.clone()].to_vec())
                .collect();
            if let Err(refusal) = self.set_group(group.kind, &group.references, &mine) {
                self.restore(&before)?;
                return Err(refusal);
            }
        }
        Ok(())
    }

    fn get(&mut self, references: &[u32], count: usize) -> Outcome<Vec<f64>> {
        let groups = groups(&self.table, references);
        if let [one] = groups.as_slice() {
            return self.get_group(one.kind, references, count);
        }
        let mut values = vec![f64::NAN; count];
        for group in groups {
            let count = group.places.iter().map(ExactSizeIterator::len).sum();
            let mut found = self
                .get_group(group.kind, &group.references, count)?
                .into_iter();
            for place in group.places.into_iter().flatten() {
                values[place] = found.next().expect("as many as asked for");
            }
        }
        Ok(values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Outcome<()> {
        let (mut flags, mut last) = ([true; 3], f64::NAN);
        let [event, terminate, early] = &mut flags;
        let status = unsafe {
            fmi3DoStep(
                self.instance,
                t,
                h,
                true,
                event,
                terminate,
                early,
                &raw mut last,
            )
        };
        let done = self.outcome(status);
        assert_eq!(flags, [false; 3]);
        let time = self.get_group(ValueKind::Real, &[0], 1)?[0];
        assert_eq!(last.to_bits(), time.to_bits());
        done
    }

    fn save(&mut self) -> Outcome<Vec<u8>> {
        let mut state = ptr::null_mut();
        let mut size = 0;
        self.outcome(unsafe { fmi3GetFMUState(self.instance, &raw mut state) })?;
        self.outcome(unsafe { fmi3SerializedFMUStateSize(self.instance, state, &raw mut size) })?;
        let mut bytes = vec![0; size];
        self.outcome(unsafe {
            fmi3SerializeFMUState(self.instance, state, bytes.as_mut_ptr(), size)
        })?;
        self.outcome(unsafe { fmi3FreeFMUState(self.instance, &raw mut state) })?;
        assert!(state.is_null());
        Ok(bytes)
    }

    fn restore(&mut self, bytes: &[u8]) -> Outcome<()> {
        let mut state = ptr::null_mut();
        let status = unsafe {
            fmi3DeserializeFMUState(self.instance, bytes.as_ptr(), bytes.len(), &raw mut state)
        };
        self.outcome(status)?;
        self.outcome(unsafe { fmi3SetFMUState(self.instance, state) })?;
        self.outcome(unsafe { fmi3FreeFMUState(self.instance, &raw mut state) })
    }

    fn reset(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi3Reset(self.instance) })
    }

    fn terminate(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi3Terminate(self.instance) })
    }
}

#[test]
fn a_wrong_name_token_kind_or_event_mode_is_refused_with_a_message() {
    let scene = super::scene();
    let token = pack(&scene, FmiVersion::V3);
    let messages: Mutex<Vec<String>> = Mutex::default();
    let environment = (&raw const messages).cast_mut().cast();
    let make = |name: &CStr, token: *const c_char, events: bool| unsafe {
        fmi3InstantiateCoSimulation(
            name.as_ptr(),
            token,
            ptr::null(),
            false,
            true,
            events,
            false,
            ptr::null(),
            0,
            environment,
            logger,
            None,
        )
    };
    for (name, token, events, expected) in [
        (
            c" \t",
            token.as_ptr(),
            false,
            "instanceName: found \" \\t\", allowed a name with a visible character",
        ),
        (
            c"instance",
            c"{another}".as_ptr(),
            false,
            "instantiation token: found {another}, expected {",
        ),
        (
            c"instance",
            ptr::null(),
            false,
            "instantiationToken: found NULL",
        ),
        (
            c"instance",
            token.as_ptr(),
            true,
            "eventModeUsed: found true, allowed false",
        ),
    ] {
        assert!(make(name, token, events).is_null());
        let told = messages
            .lock()
            .expect("no panic inside")
            .pop()
            .expect("a message");
        assert!(told.contains(expected), "{told}");
    }
    let instance = make(c"instance", token.as_ptr(), false);
    assert!(!instance.is_null());
    unsafe { fmi3FreeInstance(instance) }
}
