//! Ctrl-C (and a polite kill): the first asks the command to finish what it is doing and save, the second ends it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::CliError;

/// Installs the handler. The flag becomes true at the first signal; a second signal ends the program at once
/// with exit code 130.
///
/// # Errors
/// [`CliError::Usage`] if the system refuses the handler.
pub(super) fn on_interrupt() -> Result<Arc<AtomicBool>, CliError> {
    let flag = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        eprintln!(
            "\nstopping after this step and saving (Ctrl-C again: end at once, without saving)"
        );
    })
    .map_err(|error| CliError::Usage(format!("cannot listen for Ctrl-C: {error}")))?;
    Ok(flag)
}
