//! A driver over `sandgate_*`.

use std::ffi::{CStr, CString, c_char, c_void};

use sandgate::scene::Scene;

use super::suite::{Driver, Outcome, Refusal};

unsafe extern "C" {
    fn sandgate_create(
        text: *const c_char,
        name: *const c_char,
        error: *mut c_char,
        size: usize,
    ) -> *mut c_void;
    fn sandgate_free(c: *mut c_void);
    fn sandgate_last_error(c: *const c_void) -> *const c_char;
    fn sandgate_enter_initialization(c: *mut c_void, start: f64, stop: f64) -> i32;
    fn sandgate_exit_initialization(c: *mut c_void) -> i32;
    fn sandgate_set(c: *mut c_void, r: *const u32, n: usize, v: *const f64, m: usize) -> i32;
    fn sandgate_get(c: *const c_void, r: *const u32, n: usize, v: *mut f64, m: usize) -> i32;
    fn sandgate_step(c: *mut c_void, t: f64, h: f64, report: *mut c_void) -> i32;
    fn sandgate_save_size(c: *const c_void, size: *mut usize) -> i32;
    fn sandgate_save(c: *const c_void, bytes: *mut u8, room: usize, size: *mut usize) -> i32;
    fn sandgate_restore(c: *mut c_void, bytes: *const u8, size: usize) -> i32;
    fn sandgate_reset(c: *mut c_void) -> i32;
    fn sandgate_terminate(c: *mut c_void) -> i32;
}

pub(super) struct C(*mut c_void);

impl C {
    pub(super) fn new(scene: &Scene) -> Self {
        let text = CString::new(scene.source.as_str()).expect("no zero byte");
        let mut error = vec![0 as c_char; 2000];
        let made = unsafe {
            sandgate_create(
                text.as_ptr(),
                c"scene.toml".as_ptr(),
                error.as_mut_ptr(),
                error.len(),
            )
        };
        assert!(!made.is_null(), "{:?}", unsafe {
            CStr::from_ptr(error.as_ptr())
        });
        Self(made)
    }

    fn outcome(&self, status: i32) -> Outcome<()> {
        if status == 0 {
            return Ok(());
        }
        let text = unsafe { CStr::from_ptr(sandgate_last_error(self.0)) };
        Err(Refusal::Message(text.to_str().expect("UTF-8").to_owned()))
    }
}

impl Drop for C {
    fn drop(&mut self) {
        unsafe { sandgate_free(self.0) }
    }
}

impl Driver for C {
    fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Outcome<()> {
        let stop = stop.unwrap_or(f64::INFINITY);
        self.outcome(unsafe { sandgate_enter_initialization(self.0, start, stop) })
    }

    fn exit_initialization(&mut self) -> Outcome<()> {
        self.outcome(unsafe { sandgate_exit_initialization(self.0) })
    }

    fn set(&mut self, references: &[u32], values: &[f64]) -> Outcome<()> {
        let (n, m) = (references.len(), values.len());
        self.outcome(unsafe { sandgate_set(self.0, references.as_ptr(), n, values.as_ptr(), m) })
    }

    fn get(&mut self, references: &[u32], count: usize) -> Outcome<Vec<f64>> {
        let mut values = vec![f64::NAN; count];
        let (n, out) = (references.len(), values.as_mut_ptr());
        self.outcome(unsafe { sandgate_get(self.0, references.as_ptr(), n, out, count) })?;
        Ok(values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Outcome<()> {
        self.outcome(unsafe { sandgate_step(self.0, t, h, std::ptr::null_mut()) })
    }

    fn save(&mut self) -> Outcome<Vec<u8>> {
        let mut size = 0;
        self.outcome(unsafe { sandgate_save_size(self.0, &raw mut size) })?;
        let mut bytes = vec![0; size];
        let mut written = 0;
        self.outcome(unsafe { sandgate_save(self.0, bytes.as_mut_ptr(), size, &raw mut written) })?;
        assert_eq!(written, size);
        Ok(bytes)
    }

    fn restore(&mut self, bytes: &[u8]) -> Outcome<()> {
        self.outcome(unsafe { sandgate_restore(self.0, bytes.as_ptr(), bytes.len()) })
    }

    fn reset(&mut self) -> Outcome<()> {
        self.outcome(unsafe { sandgate_reset(self.0) })
    }

    fn terminate(&mut self) -> Outcome<()> {
        self.outcome(unsafe { sandgate_terminate(self.0) })
    }
}
