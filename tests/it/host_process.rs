//! What a process may do with the shared library inside: unload it.
#![cfg(target_os = "linux")]

use std::process::{Command, Output};

use crate::python::run;
use crate::shared_library::{compiled, library, scratch, silo};

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
