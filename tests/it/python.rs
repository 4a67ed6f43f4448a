//! Python for tests: makes a virtual environment below `target/` once and runs files of tests/python with pytest.
//!
//! The folder's name carries a hash of requirements.txt and of the interpreter's version, so a change of either
//! makes a new environment. A file lock lets several test binaries ask at the same time.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use sha2::{Digest, Sha256};

const REQUIREMENTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/requirements.txt");

/// The root of the source tree.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Cargo's target folder of this build.
pub(crate) fn target() -> PathBuf {
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    scratch
        .parent()
        .expect("cargo puts the scratch folder inside the target folder")
        .to_path_buf()
}

/// Path of a program of the environment: `program("python")`, `program("rerun")`.
pub(crate) fn program(name: &str) -> PathBuf {
    static VENV: OnceLock<PathBuf> = OnceLock::new();
    VENV.get_or_init(make_environment).join("bin").join(name)
}

/// Runs tests/python/`file` with pytest; panics with everything it printed when a test fails.
///
/// The tests find `SANDGATE_ROOT` (the source tree) and what `environment` adds.
pub(crate) fn pytest(file: &str, environment: &[(&str, &OsStr)]) {
    let output = Command::new(program("python"))
        .args(["-m", "pytest", "-q", "-ra", "-p", "no:cacheprovider"])
        .arg(root().join("tests/python").join(file))
        .env("SANDGATE_ROOT", root())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .envs(environment.iter().copied())
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .output()
        .expect("the environment's python starts");
    assert!(
        output.status.success(),
        "pytest {file}: {}\n{}",
        output.status,
        text(&output)
    );
    // pytest ends with success only if it ran at least one test; skipped ones would hide a lack.
    let said = text(&output);
    assert!(!said.contains("SKIPPED"), "pytest {file} skipped:\n{said}");
}

fn make_environment() -> PathBuf {
    let version = run(
        "python3",
        Command::new("python3").arg("--version"),
        "these tests need Python 3.11 or later as `python3` (Debian: apt-get install python3 python3-venv)",
    );
    let wanted = fs::read(REQUIREMENTS).expect("tests/python/requirements.txt is readable");
    let mut hash = Sha256::new();
    hash.update(&wanted);
    hash.update(&version.stdout);
    let name = hash
        .finalize()
        .iter()
        .take(6)
        .fold("venv-".to_owned(), |mut name, byte| {
            let _ = write!(name, "{byte:02x}");
            name
        });
    let venv = target().join(name);

    let lock = File::create(venv.with_extension("lock")).expect("target/ is writable");
    lock.lock().expect("target/ is on a file system with locks");
    let done = venv.join("complete");
    if done.exists() {
        return venv;
    }
    // A folder without the mark is what an interrupted run left.
    let _ = fs::remove_dir_all(&venv);
    run(
        "python3 -m venv",
        Command::new("python3").args(["-m", "venv"]).arg(&venv),
        "these tests need Python's venv module with pip (Debian: apt-get install python3-venv)",
    );
    run(
        "pip install -r tests/python/requirements.txt",
        Command::new(venv.join("bin/python"))
            .args(["-m", "pip", "install", "--quiet", "--no-input"])
            .args(["--disable-pip-version-check", "-r"])
            .arg(REQUIREMENTS),
        "the Python packages of these tests come from PyPI once: is it reachable (or a mirror set in pip's configuration)?",
    );
    File::create(&done).expect("target/ is writable");
    venv
}

/// Runs a step of the set-up; on failure says what it was for and what it printed.
pub(crate) fn run(what: &str, command: &mut Command, remedy: &str) -> Output {
    match command.output() {
        Ok(output) if output.status.success() => output,
        Ok(output) => panic!(
            "{what} failed ({}): {remedy}\n{}",
            output.status,
            text(&output)
        ),
        Err(error) => panic!("{what} does not start ({error}): {remedy}"),
    }
}

fn text(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

#[test]
fn the_python_environment_has_all_that_tests_import() {
    pytest("test_environment.py", &[]);
    run(
        "rerun --version",
        Command::new(program("rerun")).arg("--version"),
        "rerun-sdk brings the program",
    );
}
