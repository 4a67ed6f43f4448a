//! The lock of an output folder: one run at a time writes there.
//!
//! The system holds it and lets go of it when the process ends, however it ends. A run that ends takes the file away; one
//! that was killed leaves it, and the next one takes it over.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use super::folder::cannot_make;
use crate::cli::CliError;

/// The file that is locked.
pub(super) const NAME: &str = "sandgate.lock";

/// A folder that is ours until this is dropped.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Takes a folder.
    ///
    /// # Errors
    /// [`CliError::Usage`] if another run has it, [`CliError::File`] if nothing can be written there.
    pub(super) fn take(folder: &Path) -> Result<Self, CliError> {
        let path = folder.join(NAME);
        loop {
            let file = File::options()
                .create(true)
                .truncate(false)
                .write(true)
                .open(&path)
                .map_err(|source| cannot_make(folder, source))?;
            match file.try_lock() {
                Ok(()) if is_at(&file, &path) => return Ok(Self { path, _file: file }),
                // Who had it took the file away between our two calls: what we locked has no name any more.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let shown = folder.display();
                    return Err(CliError::Usage(format!(
                        "another run writes to {shown} now (it holds {NAME} there); wait for its end, end it with Ctrl-C, or give \
                         another folder with --out"
                    )));
                }
                Err(TryLockError::Error(error)) => {
                    tell!(
                        "warning: {} cannot be locked ({error}): do not start another run in that folder meanwhile",
                        path.display()
                    );
                    return Ok(Self { path, _file: file });
                }
            }
        }
    }
}

impl Drop for Lock {
    /// While it is still locked, so that nobody else has it. A file that stays is in nobody's way.
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Whether `path` is a name of the open file. Elsewhere than on Unix a file keeps its name as long as it is open.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let (open, named) = (file.metadata(), std::fs::metadata(path));
        let id = |m: &std::fs::Metadata| (m.dev(), m.ino());
        matches!((open, named), (Ok(open), Ok(named)) if id(&open) == id(&named))
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}
