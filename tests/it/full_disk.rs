//! A disk that fills up while a run writes its log: the fault of the log is told once and by name, whatever else cannot be
//! written either, and the file reads up to its cut.
//!
//! When it is full does not depend on the clock: the logs here are deterministic, so that each step goes to the disk.

use crate::python;
use sandgate::record::{Ending, check_mass};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Steps of the run: its log would take half a megabyte.
const STEPS: u64 = 40;

/// The small silo with a large log.
fn scene(folder: &Path, required: bool) -> PathBuf {
    let text =
        std::fs::read_to_string(python::root().join("tests/scenes/small_silo.toml")).unwrap();
    let usual = "particles_every = \"50 ms\"";
    assert!(text.contains(usual));
    let log = format!("particles_every = \"5 ms\"\ndeterministic = true\nrequired = {required}");
    let path = folder.join("small_silo.toml");
    std::fs::write(&path, text.replace(usual, &log)).unwrap();
    path
}

/// A file system of its own with this much room, until it is dropped; none where this user may not mount one.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Path, size: &str) -> Option<Self> {
        let place = folder.join("disk");
        std::fs::create_dir(&place).unwrap();
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"]);
        let done = command.arg(&place).output();
        done.is_ok_and(|output| output.status.success())
            .then_some(Self(place))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// What must hold of a run whose log met the end of the disk, and whose other files at the end did, too.
fn judge(output: &Output, out: &Path, required: bool, fault: &str) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(5), "{said}");
    assert!(!said.contains("panicked"), "{said}");
    let told: Vec<&str> = said
        .lines()
        .filter(|line| line.contains("log stopped at simulated time"))
        .collect();
    assert_eq!(told.len(), 1, "{said}");
    assert!(
        told[0].contains(fault) && told[0].contains("run.mcap.part"),
        "{said}"
    );
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let part = out.join("run.mcap.part");
    if required {
        // It is what ended the run: the last word is the log's, and the others are warnings before it.
        let last = said.trim_end().lines().last().unwrap();
        assert!(last.starts_with("error: log stopped at"), "{said}");
        assert!(last.contains("the scene requires its log"), "{said}");
        assert_eq!(said.matches("error: ").count(), 1, "{said}");
    } else {
        assert!(told[0].starts_with("warning: "), "{said}");
        assert!(
            told[0].contains("the run goes on without its log"),
            "{said}"
        );
        // Told at the end, to which it came.
        assert!(said.contains("messages are not in the log"), "{said}");
        assert!(table.contains("0.2"), "{table}");
    }
    // Nobody is left in doubt about the other files.
    let other = match required {
        true => "warning: cannot write",
        false => "error: cannot write",
    };
    assert!(said.contains(other), "{said}");
    // The summary does not say for ever that the run goes on, and the table has whole rows.
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "failed", "{said}");
    assert!(summary["error"].is_string(), "{said}");
    let rows = std::fs::read_to_string(out.join("gauges.csv")).unwrap();
    assert!(rows.ends_with('\n'), "{said}");
    // Up to its last chunk the log is whole.
    let check = check_mass(&part).unwrap();
    assert_eq!(check.wrong, None);
    assert!(matches!(check.ending, Ending::Cut { .. }));
    assert!((1..STEPS).contains(&check.lines), "{}", check.lines);
}

#[test]
fn a_run_on_a_full_file_system_tells_of_its_log() {
    for required in [true, false] {
        let folder = temp_dir::TempDir::new().unwrap();
        let scene = scene(folder.path(), required);
        let Some(disk) = SmallDisk::mount(folder.path(), "160k") else {
            let warning = "\nNOT RUN: a run on a file system that is full, because this user may not mount a tmpfs (needs root)\n";
            std::io::stderr().write_all(warning.as_bytes()).unwrap();
            return;
        };
        let out = disk.0.join("out");
        let output = Command::new(env!("CARGO_BIN_EXE_sandgate"))
            .arg("run")
            .arg(&scene)
            .args(["--threads", "1", "--out"])
            .arg(&out)
            .output()
            .unwrap();
        judge(&output, &out, required, "No space left on device");
    }
}

/// The same where files cannot grow, which needs no file system: writes beyond the limit fail, and the signal ends nothing.
#[cfg(unix)]
#[test]
fn a_run_whose_files_cannot_grow_tells_of_its_log() {
    for required in [true, false] {
        let folder = temp_dir::TempDir::new().unwrap();
        let scene = scene(folder.path(), required);
        let out = folder.path().join("out");
        // 51 kB: more than a log begins with, less than a saved state, or than gauges.csv with ten times as many steps.
        let script = format!(
            "ulimit -f 100; exec '{}' run '{}' --threads 1 --step '0.5 ms' --out '{}'",
            env!("CARGO_BIN_EXE_sandgate"),
            scene.display(),
            out.display()
        );
        let output = Command::new("sh").args(["-c", &script]).output().unwrap();
        judge(&output, &out, required, "File too large");
        // Nor could the state be saved, and nobody looks for it in vain.
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            said.contains(" s is not saved; none was in this run"),
            "{said}"
        );
        assert!(!out.join("checkpoint.state").exists());
    }
}

/// The log alone meets the limit: the run is whole and says so, and so does its summary of the log.
#[cfg(unix)]
#[test]
fn a_run_that_lost_its_log_ends_well_and_its_summary_says_what_is_missing() {
    for required in [true, false] {
        let folder = temp_dir::TempDir::new().unwrap();
        let scene = scene(folder.path(), required);
        let out = folder.path().join("out");
        // 205 kB: more than any other file of the run, less than its log.
        let script = format!(
            "ulimit -f 400; exec '{}' run '{}' --threads 1 --out '{}'",
            env!("CARGO_BIN_EXE_sandgate"),
            scene.display(),
            out.display()
        );
        let output = Command::new("sh").args(["-c", &script]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        let (status, code) = match required {
            true => ("failed", Some(5)),
            false => ("finished", Some(0)),
        };
        assert_eq!(output.status.code(), code, "{said}");
        assert_eq!(summary["status"], status, "{said}");
        assert_eq!(summary["error"].is_null(), !required, "{text}");
        let failure = summary["parts"][0]["log_failure"].as_str().unwrap();
        assert!(failure.contains("File too large"), "{failure}");
        assert!(failure.contains("run.mcap.part"), "{failure}");
        if !required {
            assert!(failure.contains("messages are not in the log"), "{failure}");
            assert!(!said.contains("error: "), "{said}");
        }
    }
}
