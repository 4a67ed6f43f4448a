//! Names of log files: never overwritten, unfinished ones told apart by `.part`, numbered by epoch (how often the
//! component was reset or restored) and within it.

use super::error::RecordError;
use std::io::ErrorKind;
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
            ErrorKind::AlreadyExists => RecordError::Exists { path: part },
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
        let appeared = || failed("a file of that name appeared meanwhile".to_owned());
        // A second name is given only where there is none, while renaming takes the place of what has come since one looked.
        match std::fs::hard_link(&part, &path) {
            Ok(()) => std::fs::remove_file(&part).map_err(|error| {
                failed(format!(
                    "it has that name, too, and the first one cannot be removed ({error})"
                ))
            })?,
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return Err(appeared()),
            // There are file systems without second names.
            Err(_) if path.symlink_metadata().is_ok() => return Err(appeared()),
            Err(_) => std::fs::rename(&part, &path).map_err(|error| failed(error.to_string()))?,
        }
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finished_file_has_its_name_and_no_other() {
        let folder = temp_dir::TempDir::new().unwrap();
        let place = Place::alone(&folder.path().join("run.mcap"));
        drop(place.create().unwrap());
        let path = place.rename().unwrap();
        assert!(path == place.path() && path.is_file());
        assert!(!place.part().exists());
    }

    #[cfg(unix)]
    #[test]
    fn what_cannot_be_created_says_what_to_do_about_it() {
        let folder = temp_dir::TempDir::new().unwrap();
        std::fs::write(folder.path().join("file"), "").unwrap();
        let long = "long".repeat(100);
        for (name, remedy) in [
            ("none/run.mcap", "make the folder first"),
            ("file/run.mcap", "what stands there is a file"),
            (long.as_str(), "choose a shorter name"),
        ] {
            let place = Place::alone(&folder.path().join(name));
            let refused = place.create().unwrap_err().to_string();
            assert!(refused.contains(remedy), "{refused}");
        }
    }

    #[test]
    fn what_appeared_meanwhile_keeps_the_name() {
        let folder = temp_dir::TempDir::new().unwrap();
        let place = Place::alone(&folder.path().join("run.mcap"));
        drop(place.create().unwrap());
        std::fs::write(place.path(), "somebody's").unwrap();
        let refused = place.rename().unwrap_err().to_string();
        assert!(refused.contains("appeared meanwhile"), "{refused}");
        assert_eq!(std::fs::read(place.path()).unwrap(), b"somebody's");
        assert!(place.part().is_file());
    }

    /// A link to nowhere does not exist for who follows it, so that only the system knows that the name is taken.
    #[cfg(unix)]
    #[test]
    fn a_name_is_given_only_where_the_system_has_none() {
        let folder = temp_dir::TempDir::new().unwrap();
        let place = Place::alone(&folder.path().join("run.mcap"));
        drop(place.create().unwrap());
        std::os::unix::fs::symlink("nowhere", place.path()).unwrap();
        assert!(place.rename().is_err());
        assert!(place.path().is_symlink() && place.part().is_file());
    }
}
