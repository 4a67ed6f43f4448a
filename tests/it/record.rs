//! Logs of real runs: read by others, equal when runs are equal, whole after a kill and on a full disk.

use crate::python;
use sandgate::component::Component;
use sandgate::record::{Body, Ending, Entry, LogReader, RecordOptions, Recorder, check_mass};
use sandgate::scene::{self, InputTarget, Scene};
use sandgate::wire::messages::{AppliedEvent, CommandKind};
use sandgate::wire::{foxglove, messages, schema};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

const SCENE: &str = "tests/scenes/small_silo.toml";
/// All of the scene: the gate opens and closes half, and the drain takes material.
const STEPS: u32 = 40;

fn silo() -> Scene {
    scene::load(&python::root().join(SCENE)).expect("the scene of the tests is good")
}

/// The scene with its text changed, as a file in `folder`.
fn changed(folder: &Path, change: impl Fn(&str) -> String) -> PathBuf {
    let text = std::fs::read_to_string(python::root().join(SCENE)).unwrap();
    let new = change(&text);
    assert_ne!(text, new, "the scene of the tests has other lines now");
    let path = folder.join("small_silo.toml");
    std::fs::write(&path, new).unwrap();
    path
}

/// Runs the scene as `sandgate run` does and leaves `path`.
fn record(path: &Path, deterministic: bool) {
    let scene = silo();
    let mut component = Component::new(&scene).unwrap();
    let options = RecordOptions {
        deterministic,
        ..RecordOptions::of(&component)
    };
    let mut recorder = Recorder::create(path, &component, options).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    for _ in 0..STEPS {
        step(&mut component, &mut recorder, &scene);
    }
    let finished = recorder.finish(&component, "finished").unwrap();
    assert_eq!(finished.path.as_deref(), Some(path));
    assert_eq!((finished.dropped, finished.failure), (0, None));
}

/// One step with the inputs that the scene's schedules ask for.
fn step(component: &mut Component, recorder: &mut Recorder, scene: &Scene) {
    let (t, h) = (component.time(), scene.run.step);
    for schedule in &scene.schedules {
        let InputTarget::GateOpening(gate) = schedule.input else {
            continue;
        };
        let name = format!("gate.{}.opening", scene.gates[gate].name);
        let input = component.variables().by_name(&name).unwrap().reference;
        let value = schedule.value_at(t);
        component.set(&[input], &[value]).unwrap();
        recorder.record_inputs(component, &[input], &[value], "schedule");
    }
    let report = component.do_step(t, h).unwrap();
    recorder
        .record_step(component, &report, t, h, "test")
        .unwrap();
}

fn write_schemas(folder: &Path) {
    let schemas = [
        ("foxglove.Log", schema::<foxglove::Log>()),
        ("foxglove.PointCloud", schema::<foxglove::PointCloud>()),
        ("foxglove.SceneUpdate", schema::<foxglove::SceneUpdate>()),
        (
            "foxglove.FrameTransform",
            schema::<foxglove::FrameTransform>(),
        ),
    ];
    for (name, bytes) in schemas {
        std::fs::write(folder.join(format!("{name}.fds")), bytes).unwrap();
    }
}

/// Starts the program on a run that does not end by itself: the gate stays closed.
fn endless_run(folder: &Path, out: &Path) -> Child {
    let scene = changed(folder, |text| {
        let (before, rest) = text.split_once("[[schedule]]").unwrap();
        let (_, after) = rest.split_once("\n\n").unwrap();
        format!("{before}{after}")
    });
    Command::new(env!("CARGO_BIN_EXE_sandgate"))
        .arg("run")
        .arg(scene)
        .args(["--until", "10000 s", "--out"])
        .arg(out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Simulated time of the last message that is on the disk now [ns].
fn on_disk(path: &Path) -> u64 {
    let Ok(mut log) = LogReader::open(path) else {
        return 0;
    };
    log.by_ref().for_each(drop);
    match log.ending() {
        Some(Ending::Cut { last, .. }) => last.unwrap_or(0),
        _ => 0,
    }
}

/// Kills a run that has written for a while; gives its unfinished file and the time of the kill [s since 1970].
fn killed_run(folder: &Path) -> (PathBuf, f64) {
    let out = folder.join("killed");
    let part = out.join("run.mcap.part");
    let mut child = endless_run(folder, &out);
    let started = Instant::now();
    // Several flushes of the thread, so that the file has more than its beginning.
    while on_disk(&part) < 100_000_000 || started.elapsed() < Duration::from_secs(2) {
        assert!(started.elapsed() < Duration::from_secs(60), "no log grows");
        assert!(child.try_wait().unwrap().is_none(), "the run ended");
        std::thread::sleep(Duration::from_millis(20));
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    child.kill().unwrap(); // SIGKILL
    child.wait().unwrap();
    (part, now.as_secs_f64())
}

#[test]
fn python_and_rerun_read_what_was_written() {
    let folder = temp_dir::TempDir::new().unwrap();
    let log = folder.path().join("silo.mcap");
    record(&log, false);
    write_schemas(folder.path());
    let (cut, killed_at) = killed_run(folder.path());
    python::pytest(
        "test_record.py",
        &[
            ("SANDGATE_LOG", log.as_os_str()),
            ("SANDGATE_SCHEMAS", folder.path().as_os_str()),
            ("SANDGATE_CUT", cut.as_os_str()),
            ("SANDGATE_KILLED_AT", OsStr::new(&killed_at.to_string())),
        ],
    );
    python::run(
        "rerun mcap check",
        Command::new(python::program("rerun"))
            .args(["mcap", "check"])
            .arg(&log),
        "Rerun must accept the file",
    );
}

#[test]
fn logs_of_every_case_are_whole_and_account_for_all_mass() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut logs = Vec::new();
    for entry in std::fs::read_dir(python::root().join("cases")).unwrap() {
        let case = entry.unwrap().path();
        if case.extension() != Some(OsStr::new("toml")) {
            continue;
        }
        let out = folder.path().join(case.file_stem().unwrap());
        python::run(
            "sandgate run",
            Command::new(env!("CARGO_BIN_EXE_sandgate"))
                .arg("run")
                .arg(&case)
                .args(["--step", "1 ms", "--until", "3 ms", "--out"])
                .arg(&out),
            "the program says what is wrong",
        );
        logs.push(out.join("run.mcap"));
    }
    assert!(logs.len() >= 6, "cases are missing");
    for log in &logs {
        let check = check_mass(log).unwrap();
        assert_eq!((check.lines, check.wrong), (4, None), "{}", log.display());
        python::run(
            "rerun mcap check",
            Command::new(python::program("rerun"))
                .args(["mcap", "check"])
                .arg(log),
            "Rerun must accept the file",
        );
    }
    let logs = std::env::join_paths(logs).unwrap();
    python::pytest("test_logs.py", &[("SANDGATE_LOGS", &logs)]);
}

#[test]
fn the_account_of_mass_is_exact_at_every_line() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("silo.mcap");
    record(&path, true);
    let check = check_mass(&path).unwrap();
    assert_eq!(check.ending, Ending::Complete);
    assert_eq!(check.lines, u64::from(STEPS) + 1);
    assert_eq!(check.wrong, None);
    assert!(check.last.unwrap().outflow > 0.0);
}

#[test]
fn equal_runs_give_equal_bytes() {
    let folder = temp_dir::TempDir::new().unwrap();
    let paths = ["one.mcap", "two.mcap"].map(|name| folder.path().join(name));
    for path in &paths {
        record(path, true);
    }
    let [one, two] = paths.map(|path| std::fs::read(path).unwrap());
    assert!(one.len() > 50_000);
    assert!(one == two, "the bytes differ");
}

#[test]
fn applied_inputs_of_a_log_drive_a_component_to_the_same_bits() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("silo.mcap");
    record(&path, false);
    let mut component = None;
    let mut end = None;
    for entry in LogReader::open(&path).unwrap() {
        match entry.unwrap() {
            Entry::Attachment { name, data, .. } if name == "scene.toml" => {
                let text = String::from_utf8(data).unwrap();
                let scene = scene::parse("scene.toml", &text).unwrap();
                component = Some(Component::new(&scene).unwrap());
            }
            Entry::Metadata { name, values } if name == "end" => end = Some(values),
            Entry::Message {
                body: Body::Applied(applied),
                ..
            } => {
                let component = component.as_mut().expect("the scene comes first");
                for input in &applied.inputs {
                    let values: Vec<_> = input.bits.iter().map(|&b| f64::from_bits(b)).collect();
                    component.set(&[input.reference], &values).unwrap();
                }
                let (t, h) = (
                    f64::from_bits(applied.t_bits),
                    f64::from_bits(applied.h_bits),
                );
                match applied.event() {
                    AppliedEvent::Initialize => {
                        component.initialize(t, h.is_finite().then_some(h)).unwrap();
                    }
                    AppliedEvent::Step => drop(component.do_step(t, h).unwrap()),
                    other => panic!("{other:?} in a run that only steps"),
                }
            }
            _ => {}
        }
    }
    let end = end.expect("a finished log says how it ended");
    assert_eq!(end["state_hash"], component.unwrap().state_hash());
}

#[test]
fn a_restored_component_goes_on_in_a_file_of_its_own() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("silo.mcap");
    let scene = silo();
    let mut component = Component::new(&scene).unwrap();
    let options = RecordOptions::of(&component);
    let mut recorder = Recorder::create(&path, &component, options.clone()).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    step(&mut component, &mut recorder, &scene);
    let saved = component.save().unwrap();
    step(&mut component, &mut recorder, &scene);
    component.restore(&saved).unwrap();
    recorder
        .record_jump(&component, AppliedEvent::Restore, "test")
        .unwrap();
    step(&mut component, &mut recorder, &scene);
    let finished = recorder.finish(&component, "finished").unwrap();
    let second = folder.path().join("silo-1-0000.mcap");
    assert_eq!(finished.path.as_ref(), Some(&second));

    let read = |path: &Path| -> Vec<Entry> {
        LogReader::open(path).unwrap().map(Result::unwrap).collect()
    };
    let ends = |entries: &[Entry]| {
        entries.iter().find_map(|entry| match entry {
            Entry::Metadata { name, values } if name == "end" => Some((
                values["reason"].clone(),
                values["communication_steps"].clone(),
            )),
            _ => None,
        })
    };
    let text = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
    assert_eq!(ends(&read(&path)), text("restored", "2"));
    let entries = read(&second);
    assert_eq!(ends(&entries), text("finished", "2"));
    let start = entries.iter().find_map(|entry| match entry {
        Entry::Attachment { name, data, .. } if name == "start.state" => Some(data),
        _ => None,
    });
    assert_eq!(start, Some(&saved));
    for path in [&path, &second] {
        assert_eq!(check_mass(path).unwrap().wrong, None);
    }

    // Neither a finished nor an unfinished log is overwritten.
    let Err(error) = Recorder::create(&path, &component, options) else {
        panic!("a log was overwritten");
    };
    assert!(error.to_string().contains("exists already"), "{error}");
    let options = RecordOptions::of(&component);
    let Err(error) = Recorder::create(folder.path(), &component, options) else {
        panic!("a log was written to a folder");
    };
    assert!(error.to_string().contains("found the folder"), "{error}");
}

#[test]
fn calls_and_lines_are_logged_both_ways() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("calls.mcap");
    let component = Component::new(&silo()).unwrap();
    let options = RecordOptions::of(&component);
    let mut recorder = Recorder::create(&path, &component, options).unwrap();
    let request = messages::Command {
        kind: CommandKind::Request as i32,
        interface: "rpc".to_owned(),
        verb: "step".to_owned(),
        request: "c7e1".to_owned(),
        body: r#"{"req":"c7e1"}"#.to_owned(),
        ..messages::Command::default()
    };
    let reply = messages::Command {
        kind: CommandKind::Reply as i32,
        status: "ok".to_owned(),
        ..request.clone()
    };
    recorder.record_command(&request).unwrap();
    recorder.record_command(&reply).unwrap();
    recorder
        .log(0.0, foxglove::LogLevel::Warning, "bus", "a client left")
        .unwrap();
    recorder.finish(&component, "finished").unwrap();

    let heard: Vec<_> = LogReader::open(&path)
        .unwrap()
        .filter_map(|entry| match entry.unwrap() {
            Entry::Message {
                topic,
                body: Body::Command(command),
                ..
            } => Some((topic, command)),
            Entry::Message {
                body: Body::Log(line),
                ..
            } => {
                assert_eq!(line.message, "a client left");
                None
            }
            _ => None,
        })
        .collect();
    let base = "sandgate/v1/small_silo/@rpc/step";
    assert_eq!(
        heard,
        [
            (format!("{base}/request"), request),
            (format!("{base}/reply"), reply)
        ]
    );
}

/// Runs the program where files cannot grow beyond 350 kB, which stands for a full disk: writes beyond it fail, and the
/// signal is ignored.
fn run_on_a_small_disk(folder: &Path, required: bool) -> std::process::Output {
    let scene = changed(folder, |text| {
        // A log of half a megabyte, larger than any other file of the run.
        let log = format!("particles_every = \"5 ms\"\nrequired = {required}");
        text.replace("particles_every = \"50 ms\"", &log)
    });
    let script = format!(
        "trap '' XFSZ; ulimit -f 700; exec '{}' run '{}' --out '{}'",
        env!("CARGO_BIN_EXE_sandgate"),
        scene.display(),
        folder.join("out").display()
    );
    Command::new("sh").args(["-c", &script]).output().unwrap()
}

#[test]
fn a_run_goes_on_when_its_log_cannot() {
    let folder = temp_dir::TempDir::new().unwrap();
    let output = run_on_a_small_disk(folder.path(), false);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("log stopped at simulated time"), "{said}");
    assert!(said.contains("File too large"), "{said}");
    let out = folder.path().join("out");
    assert!(out.join("summary.json").exists());
    assert!(!out.join("run.mcap").exists());
    let check = check_mass(&out.join("run.mcap.part")).unwrap();
    assert_eq!(check.wrong, None);
    assert!(matches!(check.ending, Ending::Cut { .. }));
    assert!(
        (1..=u64::from(STEPS)).contains(&check.lines),
        "{}",
        check.lines
    );
}

#[test]
fn a_run_that_requires_its_log_fails_without_it() {
    let folder = temp_dir::TempDir::new().unwrap();
    let output = run_on_a_small_disk(folder.path(), true);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "{said}");
    assert!(said.contains("the scene requires its log"), "{said}");
}
