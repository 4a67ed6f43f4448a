//! How the calling thread computes: rounding, traps and denormals of the importer are kept out of this library, and its
//! own are put back around the importer's functions.
//!
//! An importer may trap invalid operations (lanes of a sweep that are masked out divide 0 by 0, which is no fault) or round
//! upwards (results then depend on which thread computes, and the instantiation token on the mode). So every call computes as
//! a program starts: to the nearest, nothing trapped, denormals kept. Threads that are started meanwhile inherit that.
//!
//! Exception flags are put back with the rest: what a call raises inside says nothing about the importer's computation. x87
//! has a control word of its own, which no code for x86-64 with `f64` looks at.

use std::cell::Cell;

thread_local! {
    /// How the caller of the call that is running computes. Without a destructor: the library may be unloaded.
    static CALLERS: Cell<Option<Control>> = const { Cell::new(None) };
}

/// Runs one call with the library's own arithmetic; the caller's comes back afterwards, also after a panic.
pub(crate) fn inside<T>(work: impl FnOnce() -> T) -> T {
    let _leave = Leave(CALLERS.replace(Some(Control::read())));
    Control::OURS.write();
    apart(work)
}

/// Runs a function of the caller's, during a call, with the caller's arithmetic. What it changes there stays changed for the
/// caller, as it would without a call between.
pub(super) fn outside<T>(work: impl FnOnce() -> T) -> T {
    let Some(callers) = CALLERS.get() else {
        return work();
    };
    callers.write();
    let _return = Return;
    apart(work)
}

/// Not inlined: the compiler knows nothing of control registers and could move arithmetic to where another one is set.
#[inline(never)]
fn apart<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// Puts the caller's arithmetic back, and what was kept before for a caller further out.
struct Leave(Option<Control>);

impl Drop for Leave {
    fn drop(&mut self) {
        if let Some(callers) = CALLERS.replace(self.0) {
            callers.write();
        }
    }
}

/// Comes back from a function of the caller's.
struct Return;

impl Drop for Return {
    fn drop(&mut self) {
        CALLERS.set(Some(Control::read()));
        Control::OURS.write();
    }
}

/// MXCSR: control and exception flags in one register.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Control(u32);

#[cfg(target_arch = "x86_64")]
impl Control {
    /// All exceptions masked, to the nearest, denormals kept.
    const OURS: Self = Self(0x1f80);

    fn read() -> Self {
        let mut control = 0_u32;
        // SAFETY: stores four bytes at the address of a u32.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut control, options(nostack, preserves_flags));
        }
        Self(control)
    }

    fn write(self) {
        // SAFETY: loads four bytes from the address of a u32, which are OURS or what was read: no reserved bit is set.
        unsafe {
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const self.0, options(nostack, preserves_flags));
        }
    }
}

/// FPCR and, for the exception flags, FPSR.
#[cfg(target_arch = "aarch64")]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Control(u64, u64);

#[cfg(target_arch = "aarch64")]
impl Control {
    const OURS: Self = Self(0, 0);

    fn read() -> Self {
        let (control, flags): (u64, u64);
        // SAFETY: reads two registers that every program may read.
        unsafe {
            std::arch::asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) flags, options(nostack, preserves_flags));
        }
        Self(control, flags)
    }

    fn write(self) {
        // SAFETY: writes two registers that every program may write, with OURS or what was read.
        unsafe {
            std::arch::asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) self.0, in(reg) self.1, options(nostack, preserves_flags));
        }
    }
}

/// Elsewhere nothing is kept apart.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Control;

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
impl Control {
    const OURS: Self = Self;

    fn read() -> Self {
        Self
    }

    fn write(self) {}
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::guard::shield;

    /// Rounds upwards, with a flag raised.
    const UPWARD: Control = Control(0x1f80 | 0x4000 | 0x20);

    fn third(of: f64) -> f64 {
        std::hint::black_box(of) / std::hint::black_box(3.0)
    }

    #[test]
    fn each_side_computes_in_its_own_way() {
        UPWARD.write();
        let upward = apart(|| third(1.0));
        let (within, back, again) = inside(|| {
            let within = third(1.0);
            let nested = outside(|| (third(1.0), inside(|| third(1.0)), Control::read()));
            (within, nested, third(1.0))
        });
        let after = Control::read();
        Control::OURS.write();
        assert_eq!(
            (within, again, upward),
            (1.0 / 3.0, 1.0 / 3.0, (1.0_f64 / 3.0).next_up())
        );
        assert_eq!((back.0, back.1), (upward, 1.0 / 3.0));
        assert_eq!((back.2, after), (UPWARD, UPWARD));
        assert_eq!(CALLERS.get(), None);
    }

    #[test]
    fn a_panic_and_a_caller_who_changes_its_mind_are_no_exception() {
        let changed = Control(UPWARD.0 | 0x8000);
        UPWARD.write();
        let broken = shield(|| inside(|| outside(|| -> () { panic!("on purpose") })));
        let after_panic = Control::read();
        inside(|| outside(|| changed.write()));
        let after_change = Control::read();
        Control::OURS.write();
        assert!(broken.is_err());
        assert_eq!((after_panic, after_change), (UPWARD, changed));
    }

    #[test]
    fn threads_that_a_call_starts_compute_as_it_does() {
        UPWARD.write();
        let there = inside(|| std::thread::spawn(|| third(1.0)).join());
        Control::OURS.write();
        assert_eq!(there.ok(), Some(1.0 / 3.0));
    }
}
