//! What a process may do with the shared library inside: unload it, fork, run out of memory.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::python::{root, run};
use crate::shared_library::{compiled, library, link, scratch, silo};

fn program(name: &str) -> PathBuf {
    let link = link();
    let link: Vec<&str> = link.iter().map(String::as_str).collect();
    compiled(
        &format!("tests/c/{name}.c"),
        &scratch(&format!("host_{name}")),
        &link,
    )
}

fn silent(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(said, "", "somebody printed to the host's terminal");
}

#[test]
fn a_library_that_used_threads_and_a_log_can_be_unloaded() {
    let folder = scratch("host_unload");
    let unload = compiled("tests/c/unload.c", &folder, &["-ldl", "-lm"]);
    let output = run(
        "tests/c/unload.c",
        Command::new(unload)
            .args([library(), &silo()])
            .arg(folder.join("run.mcap")),
        "it says what went wrong",
    );
    silent(&output);
}

#[test]
fn a_forked_process_has_threads_of_its_own_and_the_same_bits() {
    let log = scratch("host_fork_log").join("run.mcap");
    let output = run(
        "tests/c/fork.c",
        Command::new(program("fork")).arg(silo()).arg(&log),
        "it says what went wrong; signal 14 is a child that waits for threads that it has not",
    );
    silent(&output);
    let ending = sandgate::record::check_mass(&log).unwrap().ending;
    assert!(
        matches!(ending, sandgate::record::Ending::Complete),
        "the parent's log is whole: {ending:?}"
    );
}

#[test]
fn walls_that_do_not_fit_into_memory_are_refused_before_they_are_made() {
    let folder = scratch("host_large");
    // A small heap on a floor of 1.7 million points.
    let case = fs::read_to_string(root().join("cases/column_collapse_3d.toml")).unwrap();
    let text = [
        ("spacing = \"4 mm\"", "spacing = \"0.5 mm\""),
        ("radius = \"50 mm\"", "radius = \"4 mm\""),
        ("height = \"45 mm\"", "height = \"4 mm\""),
    ]
    .iter()
    .fold(case, |text, (was, is)| {
        assert!(text.contains(was), "{was}");
        text.replace(was, is)
    });
    let scene = folder.join("large.toml");
    fs::write(&scene, text).unwrap();
    let output = run(
        "tests/c/memory.c",
        Command::new(program("memory")).arg(scene).arg("300"),
        "a signal is memory that was not to be had in the middle of building",
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("points of walls take about") && said.contains("coarser spacing"),
        "{said}"
    );
}
