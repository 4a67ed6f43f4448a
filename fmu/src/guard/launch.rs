//! Threads that are started for an importer: not by its own thread, which would keep this library mapped until it ends
//! (`sandgate::math::start_threads_by` says why).

/// From here on threads are started by way of a short thread that the standard library knows nothing of.
#[cfg(unix)]
pub(crate) fn spare_callers_thread() {
    sandgate::math::start_threads_by(short::in_a_short_thread);
}

/// Elsewhere callers start them.
#[cfg(not(unix))]
pub(crate) fn spare_callers_thread() {}

#[cfg(unix)]
mod short {
    use std::any::Any;
    use std::ffi::c_void;
    use std::mem::MaybeUninit;
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
    use std::ptr;

    struct Job<'w> {
        work: &'w mut (dyn FnMut() + Send),
        panic: Option<Box<dyn Any + Send>>,
    }

    /// A `sandgate::math::Launcher`. A panic of `work` goes on in the caller.
    pub(super) fn in_a_short_thread(work: &mut (dyn FnMut() + Send)) {
        let mut job = Job { work, panic: None };
        let mut thread = MaybeUninit::<libc::pthread_t>::uninit();
        // SAFETY: room for a thread's name, default attributes, and a function whose argument is a job that stays until the
        // thread has been joined, and that nobody else looks at meanwhile.
        let refused = unsafe {
            let job = (&raw mut job).cast::<c_void>();
            libc::pthread_create(thread.as_mut_ptr(), ptr::null(), run, job)
        };
        if refused != 0 {
            return;
        }
        // SAFETY: the thread was made, so that it has its name, and is joined this once.
        unsafe {
            libc::pthread_join(thread.assume_init(), ptr::null_mut());
        }
        if let Some(panic) = job.panic {
            resume_unwind(panic);
        }
    }

    extern "C" fn run(job: *mut c_void) -> *mut c_void {
        // SAFETY: `in_a_short_thread` gives a pointer to a job, and waits for this thread before it looks at it again.
        let job = unsafe { &mut *job.cast::<Job<'_>>() };
        job.panic = catch_unwind(AssertUnwindSafe(&mut job.work)).err();
        ptr::null_mut()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::short::in_a_short_thread;
    use crate::guard::shield;

    #[test]
    fn work_is_done_in_a_thread_that_has_ended() {
        let here = std::thread::current().id();
        let mut there = None;
        in_a_short_thread(&mut || there = Some(std::thread::current().id()));
        assert!(there.is_some_and(|there| there != here));
    }

    #[test]
    fn a_panic_there_goes_on_here() {
        let told = shield(|| in_a_short_thread(&mut || panic!("on purpose")));
        assert!(told.is_err_and(|how| how.contains("on purpose")));
    }
}
