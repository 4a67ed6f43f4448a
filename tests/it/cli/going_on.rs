//! From what an earlier run can be gone on with, and that nothing else is offered.

use super::{Desk, scene, small_silo, stderr};

#[test]
fn a_failed_step_leaves_the_state_before_it() {
    let (desk, falling) = (Desk::new(), scene("no_floor"));
    let state = "run/checkpoint.state";
    let fails = ["step failed", "saved in run/checkpoint.state"];
    desk.refused(&["run", &falling, "--out", "run"], 4, &fails);
    let summary = desk.summary("run");
    let good = summary["time"].as_f64().unwrap();
    assert!(good > 0.0, "it failed at once");
    // It is that of a run which ends there.
    let until = good.to_string();
    desk.ok(&["run", &falling, "--out", "short", "--until", &until]);
    assert_eq!(desk.hash("run"), desk.hash("short"));
    let saved = |name: &str| std::fs::read(desk.path(name)).unwrap();
    assert!(saved(state) == saved("short/checkpoint.state"));
    for figure in ["steps", "kinetic_energy", "particles"] {
        assert_eq!(summary[figure], desk.summary("short")[figure], "{figure}");
    }
    // What is offered is there; it fails in the same way.
    desk.refused(&["run", &falling, "--out", "run"], 2, &["--resume", state]);
    desk.refused(&["run", &falling, "--resume", state], 4, &fails);
    let again = desk.summary("run");
    assert_eq!(
        (&again["error"], &again["time"]),
        (&summary["error"], &summary["time"])
    );
    assert_eq!(desk.hash("run"), desk.hash("short"));
}

/// As one that was killed has none.
#[test]
fn a_run_without_a_checkpoint_is_not_offered_to_go_on() {
    let (desk, silo) = (Desk::new(), small_silo());
    desk.ok(&["run", &silo, "--out", "run", "--until", "10 ms"]);
    // A slip of the pen is none: what is there is not to be overwritten.
    desk.refused(
        &["run", &silo, "--resume", "run/chekpoint.state"],
        5,
        &["that folder has a checkpoint.state: give that"],
    );
    std::fs::remove_file(desk.path("run/checkpoint.state")).unwrap();
    let output = desk.call(&["run", &silo, "--out", "run"]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    for word in ["holds an earlier run", "no checkpoint.state", "--force"] {
        assert!(text.contains(word), "no {word:?} in: {text}");
    }
    assert!(!text.contains("--resume"), "{text}");
    desk.refused(
        &["run", &silo, "--resume", "run/checkpoint.state"],
        5,
        &["the run there left none", "--checkpoint-every"],
    );
}
