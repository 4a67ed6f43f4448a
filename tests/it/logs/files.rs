//! The files of a log: deterministic, rotated, never overwritten.

use super::{SCENE, sandgate, text};
use crate::python;
use sandgate::record::{Ending, RawEntry, RawReader, RedriveOptions, Survey, redrive};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A run of the small silo with other keys in its `[log]`.
fn run_with(folder: &Path, log_keys: &str, more: &[&str]) -> PathBuf {
    let text = std::fs::read_to_string(python::root().join(SCENE)).unwrap();
    let usual = "particles_every = \"50 ms\"";
    assert!(text.contains(usual));
    let scene = folder.join("small_silo.toml");
    std::fs::write(&scene, text.replace(usual, &format!("{usual}\n{log_keys}"))).unwrap();
    let out = folder.join("out");
    let mut arguments = vec![
        OsStr::new("run"),
        scene.as_os_str(),
        OsStr::new("--out"),
        out.as_os_str(),
    ];
    arguments.extend(more.iter().map(OsStr::new));
    let output = sandgate(&arguments);
    assert!(output.status.success(), "{}", text_of(&output));
    out
}

fn text_of(output: &Output) -> String {
    format!("{}{}", text(&output.stdout), text(&output.stderr))
}

fn logs_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut logs: Vec<_> = entries
        .filter(|path| path.display().to_string().contains(".mcap"))
        .collect();
    logs.sort();
    logs
}

#[test]
fn deterministic_logs_are_equal_for_every_thread_count() {
    let keys = "deterministic = true\nrotate_every = \"60 ms\"";
    let folders = [1, 2].map(|_| temp_dir::TempDir::new().unwrap());
    let [one, two] = ["1", "2"].map(|threads| {
        let folder = folders[usize::from(threads == "2")].path();
        logs_in(&run_with(folder, keys, &["--threads", threads]))
    });
    assert_eq!((one.len(), two.len()), (4, 4));
    for (a, b) in one.iter().zip(&two) {
        assert_eq!(a.file_name(), b.file_name());
        assert!(
            std::fs::read(a).unwrap() == std::fs::read(b).unwrap(),
            "{} differs",
            a.display()
        );
    }
}

#[test]
fn every_file_of_a_long_log_stands_by_itself() {
    let folder = temp_dir::TempDir::new().unwrap();
    for (keys, count) in [
        ("rotate_every = \"50 ms\"", 5..=5),
        ("rotate_megabytes = 0.02", 4..=40),
    ] {
        let own = folder.path().join(count.end().to_string());
        std::fs::create_dir(&own).unwrap();
        let logs = logs_in(&run_with(&own, keys, &[]));
        assert!(count.contains(&logs.len()), "{logs:?}");
        let mut steps = 0;
        let mut next = 0;
        for (number, path) in logs.iter().enumerate() {
            let name = path.file_name().unwrap().to_string_lossy();
            assert_eq!(name, format!("run-0-{number:04}.mcap"));
            let survey = Survey::of(path).unwrap();
            assert_eq!(survey.ending, Ending::Complete);
            let reason = |record: &str| survey.metadata(record).unwrap()["reason"].clone();
            let last = number + 1 == logs.len();
            assert_eq!(
                reason("segment"),
                if number == 0 { "start" } else { "rotated" }
            );
            assert_eq!(reason("end"), if last { "finished" } else { "rotated" });
            let names: Vec<_> = survey.attachments.iter().map(|a| a.0.as_str()).collect();
            assert_eq!(
                names,
                if number == 0 {
                    &["scene.toml"][..]
                } else {
                    &["scene.toml", "start.state"]
                }
            );
            // Numbers go on from file to file.
            for entry in RawReader::open(path).unwrap() {
                if let RawEntry::Message(m) = entry.unwrap()
                    && m.channel.topic.ends_with("/out/stats")
                {
                    assert_eq!(m.sequence, next);
                    next += 1;
                }
            }
            let done = redrive(path, &RedriveOptions::default(), &mut |_| {}).unwrap();
            assert!(
                done.is_same() && done.same_state == Some(true),
                "{}: {done:?}",
                path.display()
            );
            steps += done.steps;
        }
        assert_eq!(steps, 40);
    }
}

#[test]
fn a_file_of_a_long_log_is_never_overwritten() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = sandgate::scene::load(&python::root().join(SCENE)).unwrap();
    let mut component = sandgate::component::Component::new(&scene).unwrap();
    let options = sandgate::record::RecordOptions {
        rotate_every: 0.004,
        required: false,
        ..sandgate::record::RecordOptions::of(&component)
    };
    let (path, taken) = (
        folder.path().join("silo.mcap"),
        folder.path().join("silo-0-0001.mcap"),
    );
    std::fs::write(&taken, "mine").unwrap();
    let mut recorder =
        sandgate::record::Recorder::create(&path, &component, options.clone()).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    for _ in 0..2 {
        let t = component.time();
        let report = component.do_step(t, 0.005).unwrap();
        recorder
            .record_step(&component, &report, t, 0.005, "test")
            .unwrap();
    }
    // Not required: it goes on without its log, and says so once.
    let failure = recorder.failure().unwrap();
    assert!(failure.cause.contains("exists already"), "{failure}");
    assert!(recorder.finish(&component, "finished").unwrap().dropped > 0);
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "mine");
    assert!(sandgate::record::Recorder::create(&path, &component, options).is_err());
}

#[test]
fn a_name_taken_meanwhile_does_not_stop_a_run() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = sandgate::scene::load(&python::root().join(SCENE)).unwrap();
    let mut component = sandgate::component::Component::new(&scene).unwrap();
    let options = sandgate::record::RecordOptions {
        rotate_every: 0.004,
        required: false,
        ..sandgate::record::RecordOptions::of(&component)
    };
    component.initialize(0.0, None).unwrap();
    let path = folder.path().join("silo.mcap");
    let mut recorder = sandgate::record::Recorder::create(&path, &component, options).unwrap();
    std::fs::write(folder.path().join("silo-0-0000.mcap"), "mine").unwrap();
    for _ in 0..2 {
        let t = component.time();
        let report = component.do_step(t, 0.005).unwrap();
        recorder
            .record_step(&component, &report, t, 0.005, "test")
            .unwrap();
    }
    assert_eq!((recorder.failure(), recorder.dropped()), (None, 0));
    let error = recorder.finish(&component, "finished").unwrap_err();
    assert!(error.to_string().contains("rename it by hand"), "{error}");
    for whole in [
        "silo-0-0000.mcap.part",
        "silo-0-0001.mcap",
        "silo-0-0002.mcap",
    ] {
        let survey = Survey::of(&folder.path().join(whole)).unwrap();
        assert_eq!(survey.ending, Ending::Complete, "{whole}");
    }
}

#[test]
fn a_log_that_goes_to_the_disk_at_every_flush_is_a_log() {
    let folder = temp_dir::TempDir::new().unwrap();
    let out = run_with(folder.path(), "sync = \"flush\"\ndeterministic = true", &[]);
    let done = redrive(
        &out.join("run.mcap"),
        &RedriveOptions::default(),
        &mut |_| {},
    )
    .unwrap();
    assert!(done.is_same() && done.steps == 40, "{done:?}");
}
