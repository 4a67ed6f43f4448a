//! What `sandgate log` does with logs: looks into them, runs them again, recovers, exports and replays them.

mod files;
mod kept;
mod recovered;
mod redriven;
mod told;

use crate::python;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SCENE: &str = "tests/scenes/small_silo.toml";

fn sandgate(arguments: &[&OsStr]) -> Output {
    let program = env!("CARGO_BIN_EXE_sandgate");
    Command::new(program).args(arguments).output().unwrap()
}

/// Runs `sandgate log VERB ...`, which must succeed; gives what it said.
fn log(arguments: &[&str]) -> String {
    let all: Vec<&OsStr> = std::iter::once("log")
        .chain(arguments.iter().copied())
        .map(OsStr::new)
        .collect();
    let output = sandgate(&all);
    let (said, warned) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{arguments:?}: {said}{warned}");
    said
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The folder of a run of the small silo, whose gate opens.
fn run(folder: &Path, more: &[&str]) -> PathBuf {
    let out = folder.join("out");
    let scene = python::root().join(SCENE);
    let mut arguments = vec![
        OsStr::new("run"),
        scene.as_os_str(),
        OsStr::new("--out"),
        out.as_os_str(),
    ];
    arguments.extend(more.iter().map(OsStr::new));
    let output = sandgate(&arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    out
}

/// A run that has been logged, once for all tests.
fn logged() -> &'static Path {
    static RUN: std::sync::OnceLock<(temp_dir::TempDir, PathBuf)> = std::sync::OnceLock::new();
    &RUN.get_or_init(|| {
        let folder = temp_dir::TempDir::new().unwrap();
        let out = run(folder.path(), &[]);
        (folder, out)
    })
    .1
}

fn log_of(run: &Path) -> String {
    run.join("run.mcap").display().to_string()
}

const ALL: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
