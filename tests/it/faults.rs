//! Faults from outside: a stop in mid-step, more memory than there is, a full disk, fewer threads than asked.

use std::path::Path;
use std::process::{Command, Output};

use sandgate::component::{Component, Wish};
use sandgate::{scene, stress};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn column(change: impl Fn(String) -> String) -> String {
    let text = std::fs::read_to_string(root().join("cases/column_collapse.toml")).unwrap();
    change(text)
}

/// Coarse: some 200 particles.
fn coarse() -> scene::Scene {
    let text = column(|text| text.replace("[numerics]\n", "[numerics]\nquality = \"draft\"\n"));
    scene::parse("column", &text).unwrap()
}

fn begun(scene: &scene::Scene, threads: usize) -> Component {
    let mut component = Component::new(scene).unwrap();
    component.set_threads(threads);
    component.initialize(0.0, None).unwrap();
    component
}

/// Stopped within a communication step, saved there and gone on elsewhere: the same state as gone on at once.
#[test]
fn a_stop_in_mid_step_loses_nothing() {
    let scene = coarse();
    let mut first = begun(&scene, 1);
    let mut count = 0;
    let report = first.do_step_watched(0.0, 0.05, &mut |moment| {
        count += 1;
        if count == 7 {
            return Wish::EndAt(moment.time());
        }
        Wish::GoOn
    });
    let report = report.unwrap();
    assert!(report.ended_early && report.substeps == 7 && report.time < 0.05);
    let saved = first.save().unwrap();
    let mut second = begun(&scene, 2);
    second.restore(&saved).unwrap();
    for component in [&mut first, &mut second] {
        let time = component.time();
        component.do_step(time, 0.02).unwrap();
        assert_eq!(component.ledger().error(), 0.0);
    }
    assert_eq!(first.state_hash(), second.state_hash());
}

/// A size that no machine holds is refused with what to do before any memory is asked for, by key and line.
#[test]
fn more_particles_than_memory_are_refused() {
    for (spacing, what) in [
        ("\"0.4 um\"", "particles"),
        ("\"1e-6 um\"", "particles"),
        ("1e-300", "particles"),
    ] {
        let text = column(|text| {
            let line = text.lines().find(|l| l.starts_with("spacing")).unwrap();
            text.replace(line, &format!("spacing = {spacing}"))
        });
        let error = scene::parse("column", &text).unwrap_err().to_string();
        assert!(
            error.contains("numerics.spacing") && error.contains(what) && error.contains("coarser"),
            "{error}"
        );
    }
}

/// More threads than cores, none, and thousands: the same bits.
#[test]
fn fewer_threads_than_asked_change_nothing() {
    let case = stress::generate::of_kind("threads", 3).unwrap();
    let scene = case.scene().unwrap();
    let hash = |threads: usize| {
        let mut component = begun(&scene, threads);
        component.do_step(0.0, 1e-3).unwrap();
        component.state_hash()
    };
    let one = hash(1);
    for threads in [0, 3, 64] {
        assert_eq!(hash(threads), one, "{threads} threads");
    }
}

#[cfg(unix)]
fn with_little_room(blocks: u32, log: &str, folder: &Path) -> Output {
    let case = root().join("tests/scenes/small_silo.toml");
    // What a file may hold ends as a disk does, with an error of the write (the signal is not heard).
    let command = format!(
        "trap '' XFSZ; ulimit -f {blocks}; exec '{}' run '{}' --out run --until '1 s' {log}",
        env!("CARGO_BIN_EXE_sandgate"),
        case.display()
    );
    Command::new("sh")
        .args(["-c", &command])
        .current_dir(folder)
        .output()
        .unwrap()
}

/// A disk that is full while the log is written: it is said, with the file; nothing hangs or panics.
#[cfg(unix)]
#[test]
fn a_full_disk_is_told() {
    let folder = temp_dir::TempDir::new().unwrap();
    let output = with_little_room(16, "", folder.path());
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code().is_some(), "{text}");
    assert!(!output.status.success(), "{text}");
    assert!(
        text.contains("run.mcap") && text.contains("make room") && !text.contains("panicked"),
        "{text}"
    );
}
