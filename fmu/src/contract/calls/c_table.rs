//! Calls of the plain C interface: the modes in which each is allowed, and what it is called with.

use std::ptr;

use super::*;

/// All functions of the plain C interface.
mod capi {
    pub(super) use crate::capi::state::*;
    pub(super) use crate::capi::variables::*;
    pub(super) use crate::capi::*;
}

#[rustfmt::skip]
pub(super) fn calls_of_c() -> Vec<Row> {
    calls! {
        "sandgate_variable_info", NEVER, |h, _| code(capi::sandgate_variable_info(h.handle(), 9999, none()));
        "sandgate_variable_by_name", ALL, |h, _| code(capi::sandgate_variable_by_name(h.handle(), text(c"time"), to(&mut [0])));
        "sandgate_variable_by_name", NEVER, |h, _| code(capi::sandgate_variable_by_name(h.handle(), text(c"nothing"), to(&mut [0])));
        "sandgate_enter_initialization", START, |h, _| code(capi::sandgate_enter_initialization(h.handle(), 0.0, 100.0));
        "sandgate_exit_initialization", LEAVE_INIT, |h, _| code(capi::sandgate_exit_initialization(h.handle()));
        "sandgate_initialize", START, |h, _| code(capi::sandgate_initialize(h.handle(), 0.0, 100.0));
        "sandgate_set", SETTABLE, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.saturate]), 2, of(&[1.0, 1.0]), 2));
        "sandgate_set", BEFORE_STEPS, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.scale]), 2, of(&[1.0, 0.9]), 2));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads, n.output]), 2, of(&[1.0, 0.9]), 2));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.threads]), 1, of(&[f64::NAN]), 1));
        "sandgate_get", ALL, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.threads, n.output]), 2, to(&mut [0.0; 2]), 2));
        "sandgate_get", NEVER, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.output]), 1, to(&mut [0.0; 2]), 2));
        "sandgate_get", NEVER, |h, n| code(capi::sandgate_get(h.handle(), of(&[n.output]), 1, none(), 1));
        "sandgate_set_text", BEFORE_STEPS, |h, n| code(capi::sandgate_set_text(h.handle(), n.path, text(c"x")));
        "sandgate_set_text", NEVER, |h, n| code(capi::sandgate_set_text(h.handle(), n.output, text(c"x")));
        "sandgate_set_text", NEVER, |h, n| code(capi::sandgate_set_text(h.handle(), n.path, none()));
        "sandgate_get_text", ALL, |h, n| code(capi::sandgate_get_text(h.handle(), n.path, to(&mut [ptr::null()])));
        "sandgate_get_text", NEVER, |h, n| code(capi::sandgate_get_text(h.handle(), n.output, to(&mut [ptr::null()])));
        "sandgate_set", NEVER, |h, n| code(capi::sandgate_set(h.handle(), of(&[n.path]), 1, of(&[1.0]), 1));
        "sandgate_step", STEP, |h, _| code(capi::sandgate_step(h.handle(), h.time(), H, none()));
        "sandgate_step", NEVER, |h, _| code(capi::sandgate_step(h.handle(), h.time(), -H, none()));
        "sandgate_step", NEVER, |h, _| code(capi::sandgate_step(h.handle(), f64::NAN, H, none()));
        "sandgate_time", ALL, |h, _| code(capi::sandgate_time(h.handle(), to(&mut [0.0])));
        "sandgate_get_mode", ALL, |h, _| code(capi::sandgate_get_mode(h.handle(), to(&mut [0])));
        "sandgate_get_ledger", NEVER, |h, _| code(capi::sandgate_get_ledger(h.handle(), none()));
        "sandgate_save_size", ALL, |h, _| code(capi::sandgate_save_size(h.handle(), to(&mut [0])));
        "sandgate_save", ALL, |h, _| { let mut b = h.state(); code(capi::sandgate_save(h.handle(), to(&mut b), b.len(), to(&mut [0]))) };
        "sandgate_save", NEVER, |h, _| code(capi::sandgate_save(h.handle(), to(&mut [0]), 1, to(&mut [0])));
        "sandgate_restore", ALL, |h, _| { let b = h.state(); code(capi::sandgate_restore(h.handle(), of(&b), b.len())) };
        "sandgate_restore", NEVER, |h, _| code(capi::sandgate_restore(h.handle(), of(b"rubbish"), 7));
        "sandgate_reset", ALL, |h, _| code(capi::sandgate_reset(h.handle()));
        "sandgate_terminate", END, |h, _| code(capi::sandgate_terminate(h.handle()));
        "sandgate_set_threads", ALL, |h, _| code(capi::sandgate_set_threads(h.handle(), 1));
        "sandgate_set_logger", ALL, |h, _| code(capi::sandgate_set_logger(h.handle(), none(), none()));
        "sandgate_state_hash", ALL, |h, _| code(capi::sandgate_state_hash(h.handle(), to(&mut [0; 65])));
    }
}
