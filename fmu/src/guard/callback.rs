//! The importer's functions. Only the logger is ever called, only during a call, with its own environment pointer.

use std::ffi::{CStr, c_char, c_void};

use super::In;
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
            unsafe {
                logger(
                    environment,
                    name.as_ptr(),
                    status,
                    category.as_ptr(),
                    message.as_ptr(),
                );
            }
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
            unsafe { logger(user, category.as_ptr(), message.as_ptr()) }
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
            unsafe { logger(environment, status, category.as_ptr(), message.as_ptr()) }
        }
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
