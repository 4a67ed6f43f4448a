//! Ctrl-C, and on Unix the polite signals SIGTERM and SIGHUP (unless it is ignored, as under `nohup`): the first asks the command
//! to finish what it is doing and save, the second ends it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::CliError;

/// Installs the handlers. The flag becomes true at the first signal, and `doing` says on standard error what happens until the
/// command ends; a second signal ends the program at once (exit code 130, or the signal's).
///
/// # Errors
/// [`CliError::Usage`] if the system refuses a handler.
pub(super) fn on_interrupt(doing: &'static str) -> Result<Arc<AtomicBool>, CliError> {
    let flag = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        tell!("\n{doing} (Ctrl-C again: end at once)");
    })
    .map_err(|error| CliError::Usage(format!("cannot listen for Ctrl-C: {error}")))?;
    #[cfg(unix)]
    on_polite_signals(&flag)
        .map_err(|error| CliError::Usage(format!("cannot listen for signals: {error}")))?;
    Ok(flag)
}

/// A file that may not grow (`ulimit -f`, batch systems) fails as one on a full disk does, and does not end the program.
#[cfg(unix)]
pub(super) fn hear_file_limits() {
    // Heard by a flag that nobody reads. Where the system refuses it stays as it is.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

#[cfg(unix)]
fn on_polite_signals(flag: &Arc<AtomicBool>) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGTERM};
    use signal_hook::flag::{register, register_conditional_shutdown};
    for signal in [SIGTERM, SIGHUP] {
        if !is_ignored(signal) {
            // In this order: the second signal finds the flag set.
            register_conditional_shutdown(signal, 128 + signal, Arc::clone(flag))?;
            register(signal, Arc::clone(flag))?;
        }
    }
    Ok(())
}

/// Whether whoever started the program has this signal ignored, as far as the system tells.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| (mask >> (signal - 1)) & 1 == 1)
}
