//! Files replaced in one go: readers, and who looks after a power cut, find the old one or the new one, never half of
//! one. For everything that this program writes whole; logs and tables that grow have ways of their own.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Ending of the new file until it takes the place of the old one.
pub(crate) const UNFINISHED: &str = ".new";

/// Writes `bytes` to `path`. What is no file (`/dev/stdout`) is written to.
///
/// # Errors
/// What the system said; the old file is there as it was then.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return std::fs::write(path, bytes);
    }
    let mut fresh = path.as_os_str().to_owned();
    fresh.push(UNFINISHED);
    let fresh = PathBuf::from(fresh);
    let placed = write_through(&fresh, bytes).and_then(|()| std::fs::rename(&fresh, path));
    if placed.is_err() {
        // On a full disk half a file is only in the way.
        let _ = std::fs::remove_file(&fresh);
    }
    placed?;
    sync_folder(path);
    Ok(())
}

/// On the disk itself when it returns: a rename may come there before the bytes of what it renames.
fn write_through(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// So that the new name outlives a power cut. Not every system can; without it the old file may come back, whole.
fn sync_folder(path: &Path) {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let name = |entry: io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> = entries
            .map(|entry| name(entry).into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_and_nothing_else_stays() {
        let folder = temp_dir::TempDir::new().unwrap();
        let path = folder.path().join("run.json");
        for text in ["long enough", "short"] {
            replace(&path, text.as_bytes()).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["run.json"]);
    }

    #[test]
    fn a_file_that_cannot_be_replaced_stays_as_it_was() {
        let folder = temp_dir::TempDir::new().unwrap();
        let path = folder.path().join("run.json");
        replace(&path, b"old").unwrap();
        // A folder in the place of the new file: nothing can be written there, whoever runs this.
        std::fs::create_dir(folder.path().join("run.json.new")).unwrap();
        assert!(replace(&path, b"new").is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn what_is_no_file_is_written_to() {
        if cfg!(target_os = "linux") {
            replace(Path::new("/dev/null"), b"nobody reads it").unwrap();
            assert!(!Path::new("/dev/null.new").exists());
        }
    }
}
