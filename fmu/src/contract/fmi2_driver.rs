//! A driver over `fmi2*`. FMI 2 has no arrays: an array row is read by its elements.

use std::ffi::{c_char, c_void};
use std::ptr;
use std::sync::Mutex;

use sandgate::component::{ValueKind, VariableTable};
use sandgate::fmi::FmiVersion;
use sandgate::scene::Scene;

use super::suite::{Driver, Outcome, Refusal};
use super::{Messages, groups, note, outcome, pack};

type Logger = extern "C" fn(*mut c_void, *const c_char, i32, *const c_char, *const c_char);

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: Logger,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

unsafe extern "C" {
    fn fmi2Instantiate(
        name: *const c_char,
        kind: i32,
        guid: *const c_char,
        resources: *const c_char,
        functions: *const Callbacks,
        visible: i32,
        logging: i32,
    ) -> *mut c_void;
    fn fmi2FreeInstance(c: *mut c_void);
    fn fmi2SetupExperiment(
        c: *mut c_void,
        tol: i32,
        tolerance: f64,
        start: f64,
        has: i32,
        stop: f64,
    ) -> i32;
    fn fmi2EnterInitializationMode(c: *mut c_void) -> i32;
    fn fmi2ExitInitializationMode(c: *mut c_void) -> i32;
    fn fmi2Terminate(c: *mut c_void) -> i32;
    fn fmi2Reset(c: *mut c_void) -> i32;
    fn fmi2GetReal(c: *mut c_void, r: *const u32, n: usize, v: *mut f64) -> i32;
    fn fmi2GetInteger(c: *mut c_void, r: *const u32, n: usize, v: *mut i32) -> i32;
    fn fmi2GetBoolean(c: *mut c_void, r: *const u32, n: usize, v: *mut i32) -> i32;
    fn fmi2SetReal(c: *mut c_void, r: *const u32, n: usize, v: *const f64) -> i32;
    fn fmi2SetInteger(c: *mut c_void, r: *const u32, n: usize, v: *const i32) -> i32;
    fn fmi2SetBoolean(c: *mut c_void, r: *const u32, n: usize, v: *const i32) -> i32;
    fn fmi2GetFMUstate(c: *mut c_void, state: *mut *mut c_void) -> i32;
    fn fmi2SetFMUstate(c: *mut c_void, state: *mut c_void) -> i32;
    fn fmi2FreeFMUstate(c: *mut c_void, state: *mut *mut c_void) -> i32;
    fn fmi2SerializedFMUstateSize(c: *mut c_void, state: *mut c_void, size: *mut usize) -> i32;
    fn fmi2SerializeFMUstate(
        c: *mut c_void,
        state: *mut c_void,
        bytes: *mut u8,
        size: usize,
    ) -> i32;
    fn fmi2DeSerializeFMUstate(
        c: *mut c_void,
        bytes: *const u8,
        size: usize,
        state: *mut *mut c_void,
    ) -> i32;
    fn fmi2DoStep(c: *mut c_void, t: f64, h: f64, no_set: i32) -> i32;
    fn fmi2GetRealStatus(c: *mut c_void, kind: i32, value: *mut f64) -> i32;
}

extern "C" fn logger(
    environment: *mut c_void,
    _name: *const c_char,
    _status: i32,
    _category: *const c_char,
    text: *const c_char,
) {
    note(environment, text);
}

pub(super) struct Fmi2 {
    instance: *mut c_void,
    messages: Messages,
    table: VariableTable,
}

impl Fmi2 {
    pub(super) fn new(scene: &Scene) -> Self {
        let token = pack(scene, FmiVersion::V2);
        let messages: Messages = Box::default();
        let environment = (&raw const *messages).cast_mut().cast();
        // A callback with fixed arguments takes the call of a variadic one that passes no others.
        let callbacks = Callbacks {
            logger,
            allocate: ptr::null(),
            free: ptr::null(),
            finished: ptr::null(),
            environment,
        };
        let (name, resources) = (c"instance".as_ptr(), c"file:///nowhere".as_ptr());
        let instance = unsafe {
            fmi2Instantiate(
                name,
                1,
                token.as_ptr(),
                resources,
                &raw const callbacks,
                0,
                1,
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
        let (c, r, n) = (self.instance, references.as_ptr(), references.len());
        let whole = values.iter().all(|v| v.fract() == 0.0);
        if n != values.len() || (kind != ValueKind::Real && !whole) {
            return Err(Refusal::Inexpressible);
        }
        let numbers: Vec<i32> = values.iter().map(|v| *v as i32).collect();
        self.outcome(match kind {
            ValueKind::Real => unsafe { fmi2SetReal(c, r, n, values.as_ptr()) },
            ValueKind::Integer => unsafe { fmi2SetInteger(c, r, n, numbers.as_ptr()) },
            ValueKind::Text => return Err(Refusal::Inexpressible),
            ValueKind::Boolean => unsafe { fmi2SetBoolean(c, r, n, numbers.as_ptr()) },
        })
    }

    fn get_group(&self, kind: ValueKind, references: &[u32]) -> Outcome<Vec<f64>> {
        let (c, r, n) = (self.instance, references.as_ptr(), references.len());
        let mut values = vec![f64::NAN; n];
        let mut numbers = vec![-1; n];
        self.outcome(match kind {
            ValueKind::Real => unsafe { fmi2GetReal(c, r, n, values.as_mut_ptr()) },
            ValueKind::Integer => unsafe { fmi2GetInteger(c, r, n, numbers.as_mut_ptr()) },
            ValueKind::Text => return Err(Refusal::Inexpressible),
            ValueKind::Boolean => unsafe { fmi2GetBoolean(c, r, n, numbers.as_mut_ptr()) },
        })?;
        if kind != ValueKind::Real {
            values = numbers.into_iter().map(f64::from).collect();
        }
        Ok(values)
    }

    /// Scalars in place of arrays.
    fn scalars(&self, references: &[u32]) -> Vec<u32> {
        let elements = |reference: &u32| {
            let rows = self.table.rows().iter();
            let mine =
                rows.filter(|row| row.element_of.is_some_and(|(array, _)| array == *reference));
            let mine: Vec<u32> = mine.map(|row| row.reference).collect();
            if mine.is_empty() {
                vec![*reference]
            } else {
                mine
            }
        };
        references.iter().flat_map(elements).collect()
    }
}

impl Drop for Fmi2 {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.instance) }
    }
}

impl Driver for Fmi2 {
    fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Outcome<()> {
        let (has, stop) = (i32::from(stop.is_some()), stop.unwrap_or_default());
        let set_up =
            self.outcome(unsafe { fmi2SetupExperiment(self.instance, 0, 0.0, start, has, stop) });
        match set_up {
            // In a wrong mode both calls are refused, and the second says what the suite looks for.
            Err(Refusal::Message(text)) if !text.contains("is not allowed in mode") => {
                Err(Refusal::Message(text))
            }
            _ => self.outcome(unsafe { fmi2EnterInitializationMode(self.instance) }),
        }
    }

    fn exit_initialization(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi2ExitInitializationMode(self.instance) })
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
        let references = self.scalars(references);
        if references.len() != count {
            return Err(Refusal::Inexpressible);
        }
        let mut values = vec![f64::NAN; count];
        for group in groups(&self.table, &references) {
            let mut found = self.get_group(group.kind, &group.references)?.into_iter();
            for place in group.places.into_iter().flatten() {
                values[place] = found.next().expect("as many as asked for");
            }
        }
        Ok(values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Outcome<()> {
        let done = self.outcome(unsafe { fmi2DoStep(self.instance, t, h, 1) });
        let mut last = f64::NAN;
        self.outcome(unsafe { fmi2GetRealStatus(self.instance, 2, &raw mut last) })?;
        let time = self.get_group(ValueKind::Real, &[0])?[0];
        assert_eq!(last.to_bits(), time.to_bits());
        done
    }

    fn save(&mut self) -> Outcome<Vec<u8>> {
        let mut state = ptr::null_mut();
        let mut size = 0;
        self.outcome(unsafe { fmi2GetFMUstate(self.instance, &raw mut state) })?;
        self.outcome(unsafe { fmi2SerializedFMUstateSize(self.instance, state, &raw mut size) })?;
        let mut bytes = vec![0; size];
        self.outcome(unsafe {
            fmi2SerializeFMUstate(self.instance, state, bytes.as_mut_ptr(), size)
        })?;
        self.outcome(unsafe { fmi2FreeFMUstate(self.instance, &raw mut state) })?;
        assert!(state.is_null());
        Ok(bytes)
    }

    fn restore(&mut self, bytes: &[u8]) -> Outcome<()> {
        let mut state = ptr::null_mut();
        let status = unsafe {
            fmi2DeSerializeFMUstate(self.instance, bytes.as_ptr(), bytes.len(), &raw mut state)
        };
        self.outcome(status)?;
        self.outcome(unsafe { fmi2SetFMUstate(self.instance, state) })?;
        self.outcome(unsafe { fmi2FreeFMUstate(self.instance, &raw mut state) })
    }

    fn reset(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi2Reset(self.instance) })
    }

    fn terminate(&mut self) -> Outcome<()> {
        self.outcome(unsafe { fmi2Terminate(self.instance) })
    }
}

#[test]
fn a_blank_name_is_refused_with_a_message() {
    let token = pack(&super::scene(), FmiVersion::V2);
    let messages: Mutex<Vec<String>> = Mutex::default();
    let callbacks = Callbacks {
        logger,
        allocate: ptr::null(),
        free: ptr::null(),
        finished: ptr::null(),
        environment: (&raw const messages).cast_mut().cast(),
    };
    let (name, functions) = (c"  ".as_ptr(), &raw const callbacks);
    let made = unsafe { fmi2Instantiate(name, 1, token.as_ptr(), ptr::null(), functions, 0, 1) };
    assert!(made.is_null());
    let told = messages.lock().expect("no panic inside").concat();
    assert!(told.contains("instanceName: found \"  \""), "{told}");
}
