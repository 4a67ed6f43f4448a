//! The folder a run writes to, and the rule that nothing of an earlier run is overwritten unasked.
//!
//! - without `--out`: `out/<case>`, or `out/<case>-2`, `-3`, ... if that is taken;
//! - `--out DIR`: new or empty, or with `--force` the folder of an earlier `sandgate run`, whose files are removed;
//! - `--resume DIR/checkpoint.state`: DIR itself goes on, with its table continued and a new log segment.
//!
//! A folder is locked from then on to the end of the run (`lock`): another run is refused there, also with `--force`.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::lock::{self, Lock};
use super::shell_word;
use crate::cli::CliError;
use crate::whole_file;

/// What marks a folder as made by `sandgate run`, in `summary.json`.
pub(super) const MADE_BY: &str = "sandgate run";

/// The state to go on from.
pub(super) const CHECKPOINT: &str = "checkpoint.state";

/// An output folder that exists and is ours to write to.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// The summary of the earlier part of the same run, if this run goes on with it.
    pub(super) earlier: Option<Value>,
    _lock: Lock,
}

impl Folder {
    /// Makes the first free one of `out/<case>`, `out/<case>-2`, ...
    ///
    /// # Errors
    /// [`CliError::File`] if no folder can be made.
    pub(super) fn next_free(case: &str) -> Result<Self, CliError> {
        std::fs::create_dir_all("out").map_err(|e| cannot_make(Path::new("out"), e))?;
        let mut number = 1;
        loop {
            let path = match number {
                1 => Path::new("out").join(case),
                n => Path::new("out").join(format!("{case}-{n}")),
            };
            match std::fs::create_dir(&path) {
                Ok(()) => return Self::locked(path),
                Err(e) if e.kind() == ErrorKind::AlreadyExists => number += 1,
                Err(e) => return Err(cannot_make(&path, e)),
            }
        }
    }

    /// Takes the folder the user named.
    ///
    /// # Errors
    /// [`CliError::Usage`] if something is in it that would be overwritten, [`CliError::File`].
    pub(super) fn named(path: &Path, force: bool) -> Result<Self, CliError> {
        std::fs::create_dir_all(path).map_err(|e| cannot_make(path, e))?;
        let folder = Self::locked(path.to_path_buf())?;
        let files = names(path)?;
        if files.is_empty() {
            return Ok(folder);
        }
        let shown = path.display();
        match (earlier_summary(path), force) {
            (None, _) => Err(CliError::Usage(format!(
                "{shown} is not empty and was not made by `sandgate run` (found {}); give a new or an empty folder",
                files[0]
            ))),
            (Some(_), false) => Err(CliError::Usage(taken(path))),
            (Some(_), true) => {
                for name in files.iter().filter(|name| is_ours(name)) {
                    let file = path.join(name);
                    std::fs::remove_file(&file).map_err(|source| CliError::File {
                        action: "remove",
                        path: file,
                        source,
                        remedy: "remove it by hand or give another folder with --out",
                    })?;
                }
                Ok(folder)
            }
        }
    }

    /// The folder a checkpoint lies in, for a run that [goes on](goes_on) there.
    ///
    /// # Errors
    /// [`CliError::Usage`] if another run has it, [`CliError::File`].
    pub(super) fn of_checkpoint(file: &Path) -> Result<Self, CliError> {
        let mut folder = Self::locked(parent(file).to_path_buf())?;
        folder.earlier = earlier_summary(&folder.path);
        Ok(folder)
    }

    fn locked(path: PathBuf) -> Result<Self, CliError> {
        Ok(Self {
            _lock: Lock::take(&path)?,
            path,
            earlier: None,
        })
    }

    /// The folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Name of the next log: `run.mcap`, then `run-2.mcap`, ... A log over several files has numbers behind its name.
    pub(super) fn next_log(&self) -> String {
        let taken = |name: &str| {
            [name.to_owned(), numbered(name)]
                .iter()
                .any(|name| self.file(name).exists() || self.file(&format!("{name}.part")).exists())
        };
        (1_u32..)
            .map(|n| match n {
                1 => "run.mcap".to_owned(),
                n => format!("run-{n}.mcap"),
            })
            .find(|name| !taken(name))
            .unwrap_or_else(|| "run.mcap".to_owned())
    }

    /// Writes a whole file in one go: readers see the old one or the new one, never half of it.
    ///
    /// # Errors
    /// [`CliError::File`].
    pub(super) fn replace(&self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        let path = self.file(name);
        whole_file::replace(&path, bytes).map_err(|source| CliError::File {
            action: "write",
            path,
            source,
            remedy: "make room or choose another folder with --out",
        })
    }

    /// Writes over a file in its place, where a new one has no room; one that is shorter or not there stays as it is.
    pub(super) fn write_over(&self, name: &str, bytes: &[u8]) {
        // What is in the way has been told: this only makes the best of it.
        let write = || {
            let mut file = std::fs::File::options().write(true).open(self.file(name))?;
            if file.metadata()?.len() >= bytes.len() as u64 {
                file.write_all(bytes)?;
                file.set_len(bytes.len() as u64)?;
            }
            Ok(())
        };
        let _: std::io::Result<()> = write();
    }
}

/// Whether a run from the checkpoint `file` goes on in its folder: `sandgate run` made that, and `out` is no other one.
pub(super) fn goes_on(file: &Path, out: Option<&Path>) -> bool {
    let own = parent(file);
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    earlier_summary(own).is_some()
        && out.is_none_or(|out| real(out).is_some_and(|out| real(own) == Some(out)))
}

/// Whether a file stands, or would stand, in the folder of a run.
pub(super) fn holds_run(file: &Path) -> bool {
    earlier_summary(parent(file)).is_some()
}

/// Whether a saved state stands beside a file, or where it would stand.
pub(super) fn holds_checkpoint(file: &Path) -> bool {
    parent(file).join(CHECKPOINT).is_file()
}

/// What to do about a folder with an earlier run; that can be gone on with only where its checkpoint is there.
fn taken(path: &Path) -> String {
    let shown = path.display();
    let checkpoint = path.join(CHECKPOINT);
    if checkpoint.is_file() {
        let checkpoint = shell_word(&checkpoint);
        return format!(
            "{shown} holds an earlier run; give another folder, add --force to replace that run, or go on with it by \
             --resume {checkpoint}"
        );
    }
    format!(
        "{shown} holds an earlier run, which left no checkpoint.state to go on from; give another folder, or add --force to \
         replace that run (--checkpoint-every saves states on the way)"
    )
}

fn parent(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The first file of a log that goes over several.
fn numbered(name: &str) -> String {
    format!("{}-0-0000.mcap", name.trim_end_matches(".mcap"))
}

/// Files that a run makes; nothing else in a folder is ever touched.
fn is_ours(name: &str) -> bool {
    let whole = name.strip_suffix(".part").unwrap_or(name);
    matches!(
        whole_file::unfinished(name).unwrap_or(whole),
        "summary.json" | "gauges.csv" | "gauges.svg" | CHECKPOINT
    ) || is_log(whole)
}

/// The names that [`Folder::next_log`] and a log over several files give: `run`, `run-2`, `run-0-0001`, `run-2-0-0001`.
fn is_log(name: &str) -> bool {
    let middle = name
        .strip_prefix("run")
        .and_then(|rest| rest.strip_suffix(".mcap"));
    let Some(middle) = middle else {
        return false;
    };
    let numbers: Vec<&str> = middle.split('-').collect();
    let digits = |text: &&str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    numbers[0].is_empty()
        && numbers[1..].iter().all(digits)
        && match numbers[1..] {
            [] | [_] => true,
            [_, part] | [_, _, part] => part.len() >= 4,
            _ => false,
        }
}

fn earlier_summary(folder: &Path) -> Option<Value> {
    let text = std::fs::read_to_string(folder.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_str(&text).ok()?;
    (summary.get("made_by")?.as_str()? == MADE_BY).then_some(summary)
}

fn names(folder: &Path) -> Result<Vec<String>, CliError> {
    let read = |source| CliError::File {
        action: "list",
        path: folder.to_path_buf(),
        source,
        remedy: "give another folder with --out",
    };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(read)? {
        names.push(
            entry
                .map_err(read)?
                .file_name()
                .to_string_lossy()
                .into_owned(),
        );
    }
    names.retain(|name| name != lock::NAME);
    names.sort();
    Ok(names)
}

pub(super) fn cannot_make(path: &Path, source: std::io::Error) -> CliError {
    CliError::File {
        // The lock is the first file that is written there.
        action: match path.is_dir() {
            true => "write to folder",
            false => "make folder",
        },
        path: path.to_path_buf(),
        source,
        remedy: "give a folder you may write to with --out",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_that_a_run_gives_are_ours() {
        for ours in [
            "summary.json",
            "checkpoint.state",
            "run.mcap",
            "run.mcap.part",
            "run-2.mcap",
            "run-0-0000.mcap",
            "gauges.csv.part",
            "checkpoint.state.new",
            "run-3-12345.mcap.part",
            "run-2-1-0003.mcap",
        ] {
            assert!(is_ours(ours), "{ours}");
        }
        for other in [
            "run-best.mcap",
            "running.mcap",
            "run2.mcap",
            "run-0-1.mcap",
            "run-0-0000-1-1.mcap",
            "run-.mcap",
            "run--0001.mcap",
            "run.mcap.recovering",
            "run.mcap.new",
            "run_old.mcap",
            "prerun.mcap",
        ] {
            assert!(!is_ours(other), "{other}");
        }
    }
}
