//! Where threads are started: by whoever wants them, or, in a library that may be unloaded, by a thread that ends at once.
//!
//! A thread that starts another keeps something of the standard library's, which the system is told to drop when that thread
//! ends. Until then it keeps the code mapped that does so: a library that has started a thread from its caller's could not be
//! unloaded before the caller's thread ends. The package in `fmu/` therefore says by whom threads are started.

use std::sync::OnceLock;

/// Calls what it is given once, in another thread, and returns when that thread has ended; or does not call it, if there is no
/// thread to be had.
pub type Launcher = fn(&mut (dyn FnMut() + Send));

static LAUNCHER: OnceLock<Launcher> = OnceLock::new();

/// From here on all threads are started by way of `launcher`; the first one stays.
pub fn start_threads_by(launcher: Launcher) {
    let _ = LAUNCHER.set(launcher);
}

/// Calls `start`, which starts threads. `None` if there is no thread to be had.
pub(crate) fn launch<T: Send>(start: impl FnOnce() -> T + Send) -> Option<T> {
    let Some(launcher) = LAUNCHER.get() else {
        return Some(start());
    };
    let (mut start, mut started) = (Some(start), None);
    launcher(&mut || started = start.take().map(|start| start()));
    started
}
