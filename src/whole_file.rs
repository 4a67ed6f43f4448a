//! Files replaced in one go: readers, and who looks after a power cut, find the old one or the new one, never half of
//! one. For everything that this program writes whole; logs and tables that grow have ways of their own.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Ending of the new file until it takes the place of the old one; a number follows where that name is taken.
const UNFINISHED: &str = ".new";

/// Writes `bytes` to `path`, or to what a link there leads to. What is no file (`/dev/stdout`) is written to.
///
/// # Errors
/// What the system said; the old file is there as it was then.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return std::fs::write(path, bytes);
    }
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (fresh, file) = beside(path)?;
    let placed = write_through(file, bytes).and_then(|()| std::fs::rename(&fresh, path));
    if placed.is_err() {
        // On a full disk half a file is only in the way.
        let _ = std::fs::remove_file(&fresh);
    }
    placed?;
    sync_folder(path);
    Ok(())
}

/// The name of the file whose replacement is called `name`, if it is one that was not finished.
#[cfg(feature = "cli")]
pub(crate) fn unfinished(name: &str) -> Option<&str> {
    let (finished, number) = name.rsplit_once(UNFINISHED)?;
    number
        .bytes()
        .all(|b| b.is_ascii_digit())
        .then_some(finished)
}

/// A new file beside `path`, under a name that nobody has: others may be replacing it too.
fn beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let mut number = 1_u32;
    loop {
        let mut fresh = path.as_os_str().to_owned();
        fresh.push(UNFINISHED);
        if number > 1 {
            fresh.push(number.to_string());
        }
        match File::create_new(&fresh) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            made => return made.map(|file| (PathBuf::from(fresh), file)),
        }
    }
}

/// On the disk itself when it returns: a rename may come there before the bytes of what it renames.
fn write_through(mut file: File, bytes: &[u8]) -> io::Result<()> {
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
        // A name that leaves no room for an ending: nothing can be written beside it, whoever runs this.
        let path = folder.path().join("n".repeat(255));
        std::fs::write(&path, b"old").unwrap();
        assert!(replace(&path, b"new").is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn files_that_others_have_there_stay() {
        let folder = temp_dir::TempDir::new().unwrap();
        let path = folder.path().join("page.html");
        std::fs::write(folder.path().join("page.html.new"), b"a user's").unwrap();
        replace(&path, b"page").unwrap();
        assert_eq!(names(folder.path()), ["page.html", "page.html.new"]);
        let own = std::fs::read(folder.path().join("page.html.new")).unwrap();
        assert_eq!(own, b"a user's");
    }

    #[cfg(feature = "cli")]
    #[test]
    fn names_of_what_was_not_finished_are_known() {
        assert_eq!(unfinished("page.html.new"), Some("page.html"));
        assert_eq!(unfinished("page.html.new12"), Some("page.html"));
        assert_eq!(unfinished("page.html.newer"), None);
        assert_eq!(unfinished("page.html"), None);
    }

    #[test]
    fn many_may_replace_a_file_at_once() {
        let folder = temp_dir::TempDir::new().unwrap();
        let path = folder.path().join("page.html");
        std::thread::scope(|scope| {
            for k in 0..8_u8 {
                let path = &path;
                scope.spawn(move || (0..20).for_each(|_| replace(path, &[k; 5000]).unwrap()));
            }
        });
        let left = std::fs::read(&path).unwrap();
        assert!(left.len() == 5000 && left.iter().all(|b| *b == left[0]));
        assert_eq!(names(folder.path()), ["page.html"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_goes_on_leading_to_the_file() {
        let folder = temp_dir::TempDir::new().unwrap();
        let (path, link) = (folder.path().join("page.html"), folder.path().join("last"));
        std::fs::write(&path, b"old").unwrap();
        std::os::unix::fs::symlink("page.html", &link).unwrap();
        replace(&link, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(link.is_symlink());
    }

    #[test]
    fn what_is_no_file_is_written_to() {
        if cfg!(target_os = "linux") {
            replace(Path::new("/dev/null"), b"nobody reads it").unwrap();
            assert!(!Path::new("/dev/null.new").exists());
        }
    }
}
