//! What `sandgate log` does with logs: looks into them, runs them again, recovers, exports and replays them.

use crate::python;
use mcap::records::MessageHeader;
use prost::Message;
use sandgate::component::{Causality, Component};
use sandgate::record::{
    Ending, RawEntry, RawReader, RecordOptions, Recorder, RedriveOptions, Survey, Table,
    check_mass, recover, redrive,
};
use sandgate::wire::keys;
use sandgate::wire::messages::{Applied, Gauge};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

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

/// A log with its applied inputs changed, whole and with right checksums.
fn changed(from: &Path, to: &Path, mut change: impl FnMut(&mut Applied)) {
    let mut writer = mcap::WriteOptions::new()
        .compression(None)
        .create(std::fs::File::create(to).unwrap())
        .unwrap();
    let mut channels = BTreeMap::new();
    for entry in RawReader::open(from).unwrap() {
        match entry.unwrap() {
            RawEntry::Metadata { name, values } => writer
                .write_metadata(&mcap::records::Metadata {
                    name,
                    metadata: values,
                })
                .unwrap(),
            RawEntry::Attachment {
                name,
                media_type,
                log_time,
                data,
            } => writer
                .attach(&mcap::Attachment {
                    log_time,
                    create_time: log_time,
                    name,
                    media_type,
                    data: data.into(),
                })
                .unwrap(),
            RawEntry::Channel(channel) => {
                let schema = &channel.schema;
                let schema = writer
                    .add_schema(&schema.name, &schema.encoding, &schema.data)
                    .unwrap();
                let id = writer
                    .add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)
                    .unwrap();
                channels.insert(channel.topic.clone(), id);
            }
            RawEntry::Message(mut message) => {
                if message.channel.schema.name == "sandgate.Applied" {
                    let mut applied = Applied::decode(message.data.as_slice()).unwrap();
                    change(&mut applied);
                    message.data = applied.encode_to_vec();
                }
                let header = MessageHeader {
                    channel_id: channels[&message.channel.topic],
                    sequence: message.sequence,
                    log_time: message.log_time,
                    publish_time: message.publish_time,
                };
                writer
                    .write_to_known_channel(&header, &message.data)
                    .unwrap();
            }
        }
    }
    writer.finish().unwrap();
}

#[test]
fn a_log_runs_again_with_the_same_bits_and_every_thread_count() {
    let path = logged().join("run.mcap");
    for threads in [1, 2] {
        let options = RedriveOptions {
            threads,
            ..RedriveOptions::default()
        };
        let mut times = Vec::new();
        let done = redrive(&path, &options, &mut |time| times.push(time)).unwrap();
        assert_eq!(done.difference, None);
        assert_eq!(
            (done.steps, done.inputs, done.same_state),
            (40, 40, Some(true))
        );
        assert_eq!(done.ending, Ending::Complete);
        // An initialisation and 40 steps; each gave all outputs, figures and the gate's frame.
        assert_eq!(times.len(), 41);
        assert!(done.compared > 41 * 10, "{}", done.compared);
    }
    let said = log(&["redrive", &log_of(logged()), "--check"]);
    assert!(
        said.contains("same bits: 40 steps with 40 inputs"),
        "{said}"
    );
}

/// Every case, coarse and for a few short steps, its gates and inflows moved as a client would.
#[test]
fn logs_of_every_case_run_again_with_gates_and_inflows_moved_live() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut moved = 0;
    let folders = ["cases", "cases/phases"].map(|name| python::root().join(name));
    let cases = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut cases: Vec<PathBuf> = cases.map(|entry| entry.unwrap().path()).collect();
    cases.retain(|path| path.extension() == Some(OsStr::new("toml")));
    for path in cases {
        let scene = sandgate::scene::load(&path).unwrap_or_else(|why| panic!("{why}"));
        let mut component = Component::new(&scene).unwrap();
        let table = component.variables().clone();
        let scale = table.by_name("solver.resolution_scale").unwrap().reference;
        // As coarse as the scene's rules allow.
        let coarse = [0.4, 0.5, 0.7, 1.0];
        let coarse = coarse.into_iter().find(|&value| {
            let set = component.set(&[scale], &[value]);
            set.and_then(|()| component.settle()).is_ok()
        });
        let file = folder.path().join(format!("{}.mcap", scene.name));
        let options = RecordOptions {
            instance: "moved".to_owned(),
            ..RecordOptions::of(&component)
        };
        let mut recorder = Recorder::create(&file, &component, options).unwrap();
        let source = "client";
        let value = [coarse.unwrap_or_else(|| panic!("{}: no scale will do", scene.name))];
        recorder.record_inputs(&component, &[scale], &value, source);
        component.initialize(0.0, None).unwrap();
        recorder
            .record_initialization(&component, 0.0, None, source)
            .unwrap();
        let inputs = table
            .rows()
            .iter()
            .filter(|v| v.causality == Causality::Input);
        let inputs: Vec<_> = inputs.collect();
        // Nothing dyadic, so that every bit counts.
        let h = scene.run.step / 3.0;
        for k in 0..3 {
            for (i, input) in inputs.iter().enumerate() {
                let (least, most) = input.range.unwrap();
                let share = (0.37 * f64::from(k + 1) + 0.11 * i as f64).fract();
                let value = [least + share * (most - least)];
                component.set(&[input.reference], &value).unwrap();
                recorder.record_inputs(&component, &[input.reference], &value, source);
                moved += 1;
            }
            let t = component.time();
            let report = component.do_step(t, h).unwrap();
            recorder
                .record_step(&component, &report, t, h, source)
                .unwrap();
        }
        recorder.finish(&component, "finished").unwrap();
        let done = redrive(&file, &RedriveOptions::default(), &mut |_| {}).unwrap();
        assert!(done.is_same(), "{}: {:?}", scene.name, done.difference);
        assert_eq!(
            (done.steps, done.same_state),
            (3, Some(true)),
            "{}",
            scene.name
        );
    }
    assert!(moved >= 6, "{moved} inputs were moved");
}

#[test]
fn one_bit_of_one_input_makes_the_check_fail_at_its_step() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bad = folder.path().join("flipped.mcap");
    let from = logged().join("run.mcap");
    // Shut instead of half open, whole and with right checksums: what came out is another.
    changed(&from, &bad, |applied| {
        if applied.step == 9 {
            assert_eq!(applied.inputs[0].values, [0.5]);
            applied.inputs[0].values[0] = 0.0;
            applied.inputs[0].bits[0] = 0;
        }
    });
    let found = redrive(&bad, &RedriveOptions::default(), &mut |_| {}).unwrap();
    let difference = found.difference.expect("an input was changed");
    assert_eq!(
        (difference.step, difference.variable.as_str()),
        (9, "gate.main.actual_opening")
    );
    assert!(difference.what.contains("log says"), "{difference}");

    // The lowest bit, in the file itself.
    let mut bytes = std::fs::read(&from).unwrap();
    let mut entries = RawReader::open(&from).unwrap().map(Result::unwrap);
    let message = entries.find_map(|entry| match entry {
        RawEntry::Message(m) if m.channel.schema.name == "sandgate.Applied" => {
            let step = Applied::decode(m.data.as_slice()).unwrap().step;
            (step == 9).then_some(m.data)
        }
        _ => None,
    });
    let message = message.unwrap();
    let find =
        |bytes: &[u8], what: &[u8]| bytes.windows(what.len()).position(|w| w == what).unwrap();
    let bits = find(&message, &0.5f64.to_bits().to_le_bytes());
    bytes[find(&std::fs::read(&from).unwrap(), &message) + bits] ^= 1;
    let flipped = folder.path().join("one-bit.mcap");
    std::fs::write(&flipped, bytes).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sandgate"));
    let command = command.args(["log", "redrive", "--check"]).arg(&flipped);
    let output = command.output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(7), "{said}");
    assert!(said.contains("DIFFERS first at step 9 "), "{said}");
    assert!(
        said.contains("gate.main.opening: input was changed in the log"),
        "{said}"
    );
}

#[test]
fn a_byte_changed_in_the_file_makes_the_check_fail() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    let bad = folder.path().join("damaged.mcap");
    std::fs::write(&bad, bytes).unwrap();
    let program = env!("CARGO_BIN_EXE_sandgate");
    let mut command = Command::new(program);
    let output = command
        .args(["log", "redrive", "--check"])
        .arg(&bad)
        .output()
        .unwrap();
    assert!(!output.status.success(), "{}", text(&output.stdout));
}

#[test]
fn no_changed_byte_of_a_chunk_header_passes_the_check() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let length = |at: usize| u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    let mut at = 8;
    // Chunks have opcode 6.
    while bytes[at] != 6 {
        at += 9 + length(at);
    }
    let bad = folder.path().join("damaged.mcap");
    for byte in at..at + 9 {
        let mut changed = bytes.clone();
        changed[byte] ^= 16;
        std::fs::write(&bad, changed).unwrap();
        let output = sandgate(&[
            OsStr::new("log"),
            OsStr::new("redrive"),
            OsStr::new("--check"),
            bad.as_os_str(),
        ]);
        let code = output.status.code();
        assert!(matches!(code, Some(5 | 7)), "byte {byte}: {code:?}");
    }
}

#[test]
fn an_unfinished_log_is_recovered_to_its_own_name() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let (cut, whole) = (
        folder.path().join("run.mcap.part"),
        folder.path().join("run.mcap"),
    );
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let done = recover(&cut, &whole).unwrap();
    assert!(done.messages > 10);
    assert_eq!(Survey::of(&whole).unwrap().ending, Ending::Complete);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    // What is exported of the cut one comes with a warning.
    let (csv, vtk) = (folder.path().join("run.csv"), folder.path().join("vtk"));
    for (option, to) in [("--csv", &csv), ("--vtk", &vtk)] {
        for (log, cut) in [(&cut, true), (&whole, false)] {
            let words = [OsStr::new("log"), OsStr::new("export"), log.as_os_str()];
            let output = sandgate(&[&words[..], &[OsStr::new(option), to.as_os_str()]].concat());
            let said = text(&output.stderr);
            assert!(output.status.success(), "{said}");
            assert_eq!(said.contains("cut short near byte"), cut, "{said}");
            if to.is_dir() {
                std::fs::remove_dir_all(to).unwrap();
            } else {
                std::fs::remove_file(to).unwrap();
            }
        }
    }
}

#[test]
fn a_new_run_of_a_log_can_be_logged_with_more_particles() {
    let folder = temp_dir::TempDir::new().unwrap();
    let again = folder.path().join("again.mcap").display().to_string();
    log(&[
        "redrive",
        &log_of(logged()),
        "--check",
        "--log",
        &again,
        "--particles-every",
        "10 ms",
    ]);
    let count = |path: &str| {
        let survey = Survey::of(Path::new(path)).unwrap();
        survey.channels["sandgate/v1/small_silo/out/particles"].messages
    };
    assert_eq!((count(&log_of(logged())), count(&again)), (5, 21));
    let (one, two) = (
        Table::read(&logged().join("run.mcap"), ALL).unwrap(),
        Table::read(Path::new(&again), ALL).unwrap(),
    );
    assert_eq!(format!("{one:?}"), format!("{two:?}"));
}

#[test]
fn the_layout_for_foxglove_names_what_is_there() {
    let text =
        std::fs::read_to_string(python::root().join("docs/foxglove_silo_gate.json")).unwrap();
    let layout: serde_json::Value = serde_json::from_str(&text).unwrap();
    let scene = sandgate::scene::load(&python::root().join("cases/silo_gate.toml")).unwrap();
    let table = sandgate::component::VariableTable::of(&scene);
    let base = "sandgate/v1/silo_gate";
    let known: Vec<String> = table
        .rows()
        .iter()
        .map(|row| keys::output(base, &row.name))
        .chain([
            keys::particles(base),
            keys::scene(base),
            keys::applied(base),
            keys::stats(base),
            keys::log(base),
        ])
        .collect();
    let mut named = 0;
    for part in text.split('"').map(|part| part.trim_end_matches('\\')) {
        if part.starts_with(base) {
            assert!(known.iter().any(|topic| topic == part), "{part}");
            named += 1;
        }
    }
    assert!(named > 12, "{named}");
    // Every panel has its place, and every place its panel.
    fn places(value: &serde_json::Value, found: &mut Vec<String>) {
        match value {
            serde_json::Value::String(panel) => found.push(panel.clone()),
            serde_json::Value::Object(split) => {
                ["first", "second"]
                    .iter()
                    .for_each(|side| places(&split[*side], found));
            }
            other => panic!("{other} is no place"),
        }
    }
    let mut found = Vec::new();
    places(&layout["layout"], &mut found);
    found.sort();
    let mut panels: Vec<_> = layout["configById"]
        .as_object()
        .unwrap()
        .keys()
        .cloned()
        .collect();
    panels.sort();
    assert_eq!(found, panels);
}

const ALL: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

#[test]
fn a_log_says_what_is_in_it() {
    let said = log(&["info", &log_of(logged())]);
    for part in [
        "complete",
        "small_silo as small_silo, sandgate ",
        "begins with \"start\" at t = 0 s",
        "0 to 0.2 s simulated",
        "\"finished\" at t = 0.2 s after 40 communication steps, 0 messages dropped, state hash",
        "scene.toml",
        "out/gauge/level.depth               41",
        "sandgate.Applied",
    ] {
        let squeezed = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(squeezed(&said).contains(&squeezed(part)), "{part}\n{said}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&log(&["info", "--json", &log_of(logged())])).unwrap();
    assert_eq!(json["metadata"]["end"]["reason"], "finished");
    assert_eq!(json["last_ns"], 200_000_000);
    let channels = json["channels"].as_array().unwrap();
    assert!(channels.iter().all(|c| c["missing"] == 0));
}

#[test]
fn messages_are_printed_by_topic_and_time() {
    let path = log_of(logged());
    let lines = |arguments: &[&str]| -> Vec<String> {
        let mut all = vec!["cat", &path];
        all.extend(arguments);
        log(&all).lines().map(str::to_owned).collect()
    };
    let depth = lines(&[
        "--topic",
        "out/gauge/level.*",
        "--from",
        "100 ms",
        "--until",
        "150 ms",
    ]);
    assert_eq!(depth.len(), 11, "{depth:?}");
    assert!(
        depth[0].contains("0.100000000 s  out/gauge/level.depth  #20"),
        "{}",
        depth[0]
    );
    let applied = lines(&["--topic", "out/applied"]);
    assert!(
        applied[9].contains("step 9 at t = 0.04")
            && applied[9].contains("gate.main.opening = [0.5]"),
        "{}",
        applied[9]
    );
    let stats = lines(&["--topic", "out/stats", "--json", "--until", "5 ms"]);
    let value: serde_json::Value = serde_json::from_str(&stats[1]).unwrap();
    assert_eq!(
        (&value["value"]["step"], &value["log_time_ns"]),
        (&1.into(), &5_000_000.into())
    );
    assert!(value["value"]["ledger"]["initial"].as_f64().unwrap() > 0.0);
    let points = lines(&["--topic", "out/particles", "--json", "--until", "0"]);
    let value: serde_json::Value = serde_json::from_str(&points[0]).unwrap();
    assert_eq!(value["value"]["points"][0].as_array().unwrap().len(), 10);
    assert_eq!(lines(&["--topic", "no/such"]), Vec::<String>::new());
    // One level is not what somebody meant who asks for `*`: it is said, not left at nothing.
    let words = ["log", "cat", &path, "--topic", "*"].map(OsStr::new);
    let said = text(&sandgate(&words).stderr);
    assert!(said.contains("** for any number"), "{said}");
}

#[test]
fn other_files_and_taken_names_are_refused() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = python::root().join(SCENE).display().to_string();
    let taken = folder.path().join("taken").display().to_string();
    std::fs::write(&taken, "mine").unwrap();
    let path = log_of(logged());
    for (arguments, code, part) in [
        (vec!["info", scene.as_str()], 5, "is not an MCAP file"),
        (vec!["cat", scene.as_str()], 5, "is not an MCAP file"),
        (vec!["redrive", scene.as_str()], 5, "is not an MCAP file"),
        (
            vec!["recover", path.as_str(), taken.as_str()],
            5,
            "exists already",
        ),
        (
            vec!["export", path.as_str(), "--csv", taken.as_str()],
            5,
            "a name that is free",
        ),
        (
            vec!["export", path.as_str(), "--vtk", taken.as_str()],
            5,
            "a name that is free",
        ),
        (vec!["export", path.as_str()], 2, "--csv"),
        (
            vec!["cat", path.as_str(), "--from", "soon"],
            2,
            "not a decimal number",
        ),
    ] {
        let all: Vec<&OsStr> = std::iter::once("log")
            .chain(arguments.iter().copied())
            .map(OsStr::new)
            .collect();
        let output = sandgate(&all);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "mine");
}

#[test]
fn the_exported_table_is_that_of_the_run_and_others_read_it() {
    let folder = temp_dir::TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (csv, parquet, vtk) = (at("gauges.csv"), at("gauges.parquet"), at("vtk"));
    log(&[
        "export",
        &log_of(logged()),
        "--csv",
        &csv,
        "--parquet",
        &parquet,
        "--vtk",
        &vtk,
    ]);
    let own = std::fs::read_to_string(logged().join("gauges.csv")).unwrap();
    assert!(
        own == std::fs::read_to_string(&csv).unwrap(),
        "the tables differ"
    );
    python::pytest(
        "test_export.py",
        &[
            ("SANDGATE_CSV", OsStr::new(&csv)),
            ("SANDGATE_PARQUET", OsStr::new(&parquet)),
            ("SANDGATE_VTK", OsStr::new(&vtk)),
            (
                "SANDGATE_PROGRAM",
                OsStr::new(env!("CARGO_BIN_EXE_sandgate")),
            ),
            ("SANDGATE_LOG", logged().join("run.mcap").as_os_str()),
        ],
    );
}

/// A run without end: the gate stays closed.
fn endless(folder: &Path) -> (Child, PathBuf) {
    let text = std::fs::read_to_string(python::root().join(SCENE)).unwrap();
    let (before, rest) = text.split_once("[[schedule]]").unwrap();
    let (_, after) = rest.split_once("\n\n").unwrap();
    let scene = folder.join("small_silo.toml");
    std::fs::write(&scene, format!("{before}{after}")).unwrap();
    let out = folder.join("killed");
    let child = Command::new(env!("CARGO_BIN_EXE_sandgate"))
        .arg("run")
        .arg(scene)
        .args(["--until", "10000 s", "--threads", "1", "--out"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    (child, out.join("run.mcap.part"))
}

fn since_1970() -> f64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap()
        .as_secs_f64()
}

#[test]
fn what_was_killed_at_any_moment_is_recovered_but_for_its_last_second() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut recovered = Vec::new();
    // Moments from 0 to 2 s after the log began, by a linear congruence (Numerical Recipes).
    let mut random = 20_u32;
    for round in 0..20 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let moment = Duration::from_secs_f64(2.0 * f64::from(random) / f64::from(u32::MAX));
        let own = folder.path().join(round.to_string());
        std::fs::create_dir(&own).unwrap();
        let (mut child, part) = endless(&own);
        let started = Instant::now();
        while std::fs::metadata(&part).map_or(0, |m| m.len()) == 0 {
            assert!(started.elapsed() < Duration::from_secs(60), "no log");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(moment);
        let killed_at = since_1970();
        child.kill().unwrap(); // SIGKILL
        child.wait().unwrap();

        let whole = own.join("recovered.mcap");
        let done = recover(&part, &whole).unwrap();
        assert_eq!(done.path, whole);
        let survey = Survey::of(&whole).unwrap();
        assert_eq!(survey.ending, Ending::Complete, "round {round}");
        assert_eq!(survey.messages(), done.messages);
        assert_eq!(survey.metadata("run").unwrap()["scene"], "small_silo");
        assert!(survey.metadata("segment").is_some());
        assert!(survey.metadata("recovered").is_some());
        assert_eq!(survey.attachments[0].0, "scene.toml");
        assert!(survey.channels.values().all(|c| c.missing == 0));
        assert_eq!(check_mass(&whole).unwrap().wrong, None);
        // The scene is written as the log begins, so that there is a message in any case.
        let last = survey.published().unwrap().1 as f64 * 1e-9;
        assert!(
            killed_at - last < 1.0,
            "round {round}, killed after {moment:?}: {} s are lost",
            killed_at - last
        );
        recovered.push(whole);
    }
    // One of them in full: it runs again with the same bits up to the cut.
    let longest = recovered
        .iter()
        .max_by_key(|path| std::fs::metadata(path).unwrap().len())
        .unwrap();
    let done = redrive(longest, &RedriveOptions::default(), &mut |_| {}).unwrap();
    assert!(done.is_same() && done.steps > 10, "{done:?}");
    let logs = std::env::join_paths(&recovered).unwrap();
    python::pytest("test_recovered.py", &[("SANDGATE_LOGS", &logs)]);
}

#[test]
fn whole_messages_of_a_cut_chunk_are_recovered_too() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let mut before = 0;
    for share in 1..20 {
        let cut = folder.path().join(format!("cut-{share}.mcap"));
        std::fs::write(&cut, &bytes[..bytes.len() * share / 20]).unwrap();
        let whole = folder.path().join(format!("whole-{share}.mcap"));
        let done = recover(&cut, &whole).unwrap();
        // What the recovered file has is what the reader of the cut one gives, byte for byte.
        let read = |path: &Path| -> Vec<RawEntry> {
            let entries = RawReader::open(path).unwrap().map(Result::unwrap);
            entries
                .filter(|e| !matches!(e, RawEntry::Metadata { name, .. } if name == "recovered"))
                .collect()
        };
        let messages = |entries: Vec<RawEntry>| -> Vec<RawEntry> {
            entries
                .into_iter()
                .filter(|e| !matches!(e, RawEntry::Channel(_)))
                .collect()
        };
        assert_eq!(
            messages(read(&cut)),
            messages(read(&whole)),
            "cut at {share}/20"
        );
        assert!(done.messages >= before);
        before = done.messages;
    }
    assert!(before > 100);
}

#[test]
fn behind_changed_bytes_nothing_is_recovered() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = logged().join("run.mcap");
    let mut bytes = std::fs::read(&path).unwrap();
    let gauge = RawReader::open(&path)
        .unwrap()
        .map(Result::unwrap)
        .find_map(|entry| match entry {
            RawEntry::Message(m) if m.channel.schema.name == "sandgate.Gauge" && m.log_time > 0 => {
                Some(m.data)
            }
            _ => None,
        });
    let gauge = gauge.unwrap();
    assert!(Gauge::decode(gauge.as_slice()).is_ok());
    let at = bytes.windows(gauge.len()).position(|w| w == gauge).unwrap();
    bytes[at + gauge.len() / 2] ^= 8;
    let (bad, whole) = (
        folder.path().join("bad.mcap"),
        folder.path().join("whole.mcap"),
    );
    std::fs::write(&bad, &bytes).unwrap();
    let done = recover(&bad, &whole).unwrap();
    assert!(
        matches!(done.ending, Ending::Cut { damaged: true, .. }),
        "{:?}",
        done.ending
    );
    assert_eq!(done.unchecked, 0);
    let survey = Survey::of(&whole).unwrap();
    assert_eq!(survey.ending, Ending::Complete);
    assert_eq!(survey.attachments[0].0, "scene.toml");
    for entry in RawReader::open(&whole).unwrap() {
        if let RawEntry::Message(message) = entry.unwrap() {
            assert!(message.log_time == 0 || message.data != gauge);
        }
    }
}

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

#[cfg(feature = "bus")]
#[test]
fn what_clients_did_runs_again_and_is_replayed() {
    let program = env!("CARGO_BIN_EXE_sandgate");
    python::pytest(
        "test_replay.py",
        &[
            ("SANDGATE", OsStr::new(program)),
            ("SANDGATE_LOG", logged().join("run.mcap").as_os_str()),
        ],
    );
}

#[cfg(feature = "bus")]
#[test]
fn gates_and_inflows_of_every_case_moved_live_run_again() {
    let program = OsStr::new(env!("CARGO_BIN_EXE_sandgate"));
    python::pytest("test_live_cases.py", &[("SANDGATE", program)]);
}
