//! Names of log files: never overwritten, unfinished ones told apart by `.part`, numbered by epoch (how often the
//! component was reset or restored) and within it.

use super::error::RecordError;
use std::path::PathBuf;

/// Names of a file.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// As given by the caller.
    pub(super) first: PathBuf,
    /// How often the component jumped (was reset or restored) before this file.
    pub(super) epoch: u32,
    /// Number of this file within its epoch, from 0.
    pub(super) number: u32,
    /// Whether a log goes over several files: then the first one has numbers, too.
    pub(super) rotates: bool,
    /// What follows the name until the file is finished.
    pub(super) unfinished: &'static str,
}

impl Place {
    /// One file that no other follows.
    pub(super) fn alone(path: &std::path::Path) -> Self {
        Self {
            first: path.to_owned(),
            epoch: 0,
            number: 0,
            rotates: false,
            unfinished: ".part",
        }
    }

    /// The file that follows in the same epoch.
    pub(super) fn next(&self) -> Self {
        Self {
            number: self.number + 1,
            ..self.clone()
        }
    }

    /// The first file after a jump.
    pub(super) fn jumped(&self) -> Self {
        Self {
            epoch: self.epoch + 1,
            number: 0,
            ..self.clone()
        }
    }

    /// `run.mcap`, then `run-1-0000.mcap`, ...; if it rotates, `run-0-0000.mcap`, `run-0-0001.mcap`, ...
    pub(super) fn path(&self) -> PathBuf {
        if self.epoch == 0 && self.number == 0 && !self.rotates {
            return self.first.clone();
        }
        let mut name = self.first.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{}-{:04}", self.epoch, self.number));
        if let Some(extension) = self.first.extension() {
            name.push(".");
            name.push(extension);
        }
        self.first.with_file_name(name)
    }

    /// The name until it is finished.
    pub(super) fn part(&self) -> PathBuf {
        let mut name = self.path().into_os_string();
        name.push(self.unfinished);
        name.into()
    }

    pub(super) fn create(&self) -> Result<std::fs::File, RecordError> {
        let (path, part) = (self.path(), self.part());
        if path.is_dir() {
            return Err(RecordError::Folder { path });
        }
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
