//! The importer's functions: logger and intermediate update. Called only during a call, from the thread of that call, with
//! the importer's own environment pointer and arithmetic.

use std::ffi::{CStr, c_char, c_void};

use super::In;
use super::arithmetic::outside;
use super::border::Plain;
use crate::fault::Status;

/// `componentEnvironment`, `instanceEnvironment` or a `user` pointer: handed back to the logger, never looked into.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Environment(*mut c_void);

/// A function that importers pass and this library never calls; NULL or not does not matter.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct UnusedCallback(*const c_void);

/// `fmi2CallbackLogger`: variadic, the message is a format.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Logger2(
    Option<
        unsafe extern "C" fn(Environment, *const c_char, Status, *const c_char, *const c_char, ...),
    >,
);

impl Logger2 {
    /// Calls the importer, if it gave a function. `message` is used as a format: `%` must be doubled.
    pub(crate) fn call(
        self,
        environment: Environment,
        name: &CStr,
        status: Status,
        category: &CStr,
        message: &CStr,
    ) {
        if let Some(logger) = self.0 {
            // SAFETY: the importer gave this function for this use; all texts end with a zero byte and outlive the
            // call; the message asks for no further arguments.
            outside(|| unsafe {
                logger(
                    environment,
                    name.as_ptr(),
                    status,
                    category.as_ptr(),
                    message.as_ptr(),
                );
            });
        }
    }
}

/// `sandgate_logger` of the plain C interface.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct PlainLogger(
    Option<unsafe extern "C" fn(Environment, *const c_char, *const c_char)>,
);

impl PlainLogger {
    /// Whether the caller gave a function.
    pub(crate) fn is_given(self) -> bool {
        self.0.is_some()
    }

    /// Calls it, if so.
    pub(crate) fn call(self, user: Environment, category: &CStr, message: &CStr) {
        if let Some(logger) = self.0 {
            // SAFETY: the caller gave this function for this use; both texts end with a zero byte and outlive the
            // call.
            outside(|| unsafe { logger(user, category.as_ptr(), message.as_ptr()) });
        }
    }
}

/// `fmi3LogMessageCallback`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Logger3(
    Option<unsafe extern "C" fn(Environment, Status, *const c_char, *const c_char)>,
);

impl Logger3 {
    /// Calls the importer, if it gave a function.
    pub(crate) fn call(
        self,
        environment: Environment,
        status: Status,
        category: &CStr,
        message: &CStr,
    ) {
        if let Some(logger) = self.0 {
            // SAFETY: the importer gave this function for this use; both texts end with a zero byte and outlive the
            // call.
            outside(|| unsafe { logger(environment, status, category.as_ptr(), message.as_ptr()) });
        }
    }
}

/// What an intermediate update tells the importer.
#[derive(Clone, Copy)]
pub(crate) struct Pause {
    /// Time reached [s].
    pub(crate) time: f64,
    /// Whether inputs may be set for the rest of the step.
    pub(crate) set_requested: bool,
    /// Whether the importer may ask for an early return.
    pub(crate) can_return_early: bool,
}

/// `fmi3IntermediateUpdateCallback`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct IntermediateUpdate3(
    Option<unsafe extern "C" fn(Environment, f64, bool, bool, bool, bool, *mut bool, *mut f64)>,
);

impl IntermediateUpdate3 {
    /// Whether the importer gave a function.
    pub(crate) fn is_given(self) -> bool {
        self.0.is_some()
    }

    /// Calls the importer; the time at which it wants to return early [s], if it does.
    pub(crate) fn call(self, environment: Environment, pause: Pause) -> Option<f64> {
        // Bytes, not bools: what C writes there may be no bool.
        let (mut requested, mut time) = (0_u8, pause.time);
        let update = self.0?;
        // SAFETY: the importer gave this function for this use; both places live until it returns. Reading is allowed
        // (third flag), the internal step is accepted (fourth).
        outside(|| unsafe {
            update(
                environment,
                pause.time,
                pause.set_requested,
                true,
                true,
                pause.can_return_early,
                (&raw mut requested).cast(),
                &raw mut time,
            );
        });
        (requested != 0).then_some(time)
    }
}

/// `fmi2CallbackFunctions`.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Callbacks2 {
    pub(crate) logger: Logger2,
    pub(crate) allocate_memory: UnusedCallback,
    pub(crate) free_memory: UnusedCallback,
    pub(crate) step_finished: UnusedCallback,
    pub(crate) environment: Environment,
}

// SAFETY: pointers that are NULL or what the importer says they are; no other bytes have a meaning.
unsafe impl Plain for Callbacks2 {}

impl In<Callbacks2> {
    /// The callbacks, copied: importers may free the structure early.
    pub(crate) fn copied(&self) -> Option<Callbacks2> {
        self.slice(1, "functions").ok().map(|one| one[0])
    }
}
