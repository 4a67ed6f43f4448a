//! Names of log files: never overwritten, unfinished ones told apart, numbered after a reset or restore.

use super::error::RecordError;
use std::path::PathBuf;

/// Names of a file.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// As given by the caller.
    pub(super) first: PathBuf,
    /// Number of this file, from 0.
    pub(super) segment: u32,
}

impl Place {
    /// `run.mcap`, then `run-0001.mcap`, ...
    pub(super) fn path(&self) -> PathBuf {
        if self.segment == 0 {
            return self.first.clone();
        }
        let mut name = self.first.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{:04}", self.segment));
        if let Some(extension) = self.first.extension() {
            name.push(".");
            name.push(extension);
        }
        self.first.with_file_name(name)
    }

    /// The name until it is finished.
    pub(super) fn part(&self) -> PathBuf {
        let mut name = self.path().into_os_string();
        name.push(".part");
        name.into()
    }

    pub(super) fn create(&self) -> Result<std::fs::File, RecordError> {
        let (path, part) = (self.path(), self.part());
        if path.exists() {
            return Err(RecordError::Exists { path });
        }
        std::fs::File::create_new(&part).map_err(|source| match source.kind() {
            std::io::ErrorKind::AlreadyExists => RecordError::Exists { path: part },
            _ => RecordError::Create { path: part, source },
        })
    }

    pub(super) fn rename(&self) -> Result<PathBuf, RecordError> {
        let (path, part) = (self.path(), self.part());
        let failed = |why: String| RecordError::Rename {
            part: part.clone(),
            path: path.clone(),
            why,
        };
        if path.exists() {
            return Err(failed("a file of that name appeared meanwhile".to_owned()));
        }
        std::fs::rename(&part, &path).map_err(|error| failed(error.to_string()))?;
        Ok(path)
    }
}
