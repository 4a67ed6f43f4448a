//! Logs that are run again: the same bits, and whatever was changed in a file is found.

use super::{ALL, log, log_of, logged, sandgate, text};
use crate::python;
use mcap::records::MessageHeader;
use prost::Message;
use sandgate::component::{Causality, Component};
use sandgate::record::{
    Ending, RawEntry, RawReader, RecordOptions, Recorder, RedriveOptions, Survey, Table, redrive,
};
use sandgate::wire::messages::Applied;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

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

/// FMUs begin their log before they are initialised, at a time of the importer's choice.
#[test]
fn a_log_that_starts_at_another_time_runs_again() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = sandgate::scene::load(&python::root().join("tests/scenes/small_silo.toml"));
    let scene = scene.unwrap_or_else(|why| panic!("{why}"));
    for start in [2.5, -1.0, 1e9, -0.0] {
        let mut component = Component::new(&scene).unwrap();
        component.enter_initialization(start, None).unwrap();
        let file = folder.path().join(format!("{start}.mcap"));
        let options = RecordOptions::of(&component);
        let mut recorder = Recorder::create(&file, &component, options).unwrap();
        component.exit_initialization().unwrap();
        let done = recorder.record_initialization(&component, start, None, "fmi2");
        done.unwrap();
        let report = component.do_step(start, 0.005).unwrap();
        let done = recorder.record_step(&component, &report, start, 0.005, "fmi2");
        done.unwrap();
        recorder.finish(&component, "done").unwrap();
        let done = redrive(&file, &RedriveOptions::default(), &mut |_| {}).unwrap();
        assert_eq!((done.difference, done.same_state), (None, Some(true)));
    }
}

/// That nothing differs says nothing where there was nothing to compare.
#[test]
fn a_log_with_nothing_to_compare_does_not_pass_the_check() {
    let folder = temp_dir::TempDir::new().unwrap();
    // As a kill leaves it: the scene is there, no message yet.
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let part = folder.path().join("empty.mcap.part");
    std::fs::write(&part, &bytes[..2000]).unwrap();
    let args = ["log", "redrive", "--check"].map(OsStr::new);
    let output = sandgate(&[&args[..], &[part.as_os_str()]].concat());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{said}");
    assert!(said.contains("nothing to compare"), "{said}");
}

/// A failed step leaves a state that nobody comes by: what was saved of it, and the end, are not compared.
#[test]
fn a_log_with_a_failed_step_runs_again_up_to_it() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = sandgate::scene::load(&python::root().join("tests/scenes/no_floor.toml"));
    let scene = scene.unwrap_or_else(|why| panic!("{why}"));
    let mut component = Component::new(&scene).unwrap();
    let file = folder.path().join("failed.mcap");
    let options = RecordOptions::of(&component);
    let mut recorder = Recorder::create(&file, &component, options).unwrap();
    component.initialize(0.0, None).unwrap();
    let done = recorder.record_initialization(&component, 0.0, None, "c");
    done.unwrap();
    let h = scene.run.step;
    let mut steps = 0;
    while let Ok(report) = component.do_step(component.time(), h) {
        let t = report.time - h;
        let done = recorder.record_step(&component, &report, t, h, "c");
        done.unwrap();
        steps += 1;
    }
    recorder.record_failed_step();
    let state = sandgate::component::saved_checksum(&component.save().unwrap()).unwrap();
    recorder.record_save(&component, &state, "c").unwrap();
    component.terminate().unwrap();
    recorder.finish(&component, "terminated").unwrap();
    let done = redrive(&file, &RedriveOptions::default(), &mut |_| {}).unwrap();
    assert_eq!((done.difference, done.same_state), (None, None));
    assert_eq!(done.steps, steps);
}

/// The file that a log goes on in when its component is brought to the state of one that failed elsewhere.
#[test]
fn a_log_that_begins_from_a_failed_state_and_is_terminated_runs_again() {
    let folder = temp_dir::TempDir::new().unwrap();
    let scene = sandgate::scene::load(&python::root().join("tests/scenes/no_floor.toml"));
    let scene = scene.unwrap_or_else(|why| panic!("{why}"));
    let mut failed = Component::new(&scene).unwrap();
    failed.initialize(0.0, None).unwrap();
    while failed.do_step(failed.time(), scene.run.step).is_ok() {}
    for ends in [true, false] {
        let mut component = Component::new(&scene).unwrap();
        component.restore(&failed.save().unwrap()).unwrap();
        let file = folder.path().join(format!("terminated_{ends}.mcap"));
        let options = RecordOptions::of(&component);
        let recorder = Recorder::create(&file, &component, options).unwrap();
        if ends {
            component.terminate().unwrap();
        }
        recorder.finish(&component, "done").unwrap();
        let done = redrive(&file, &RedriveOptions::default(), &mut |_| {}).unwrap();
        assert_eq!(done.difference, None);
        assert_eq!(done.same_state, ends.then_some(true));
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

/// The log of two steps of a tank whose water has another density: `rate`, set with `saturate_inputs` before initialisation ends or after it,
/// and its slope over the second step [kg/s, kg/s^2].
fn tank_of_density(file: &Path, rho: f64, settled: bool, (rate, slope): (f64, f64)) {
    let scene = sandgate::scene::load(&python::root().join("cases/water_tank.toml"));
    let mut tank = Component::new(&scene.unwrap_or_else(|why| panic!("{why}"))).unwrap();
    let [supply, density, saturate] = [
        "inflow.supply.rate",
        "material.water.density",
        "saturate_inputs",
    ]
    .map(|name| tank.variables().by_name(name).unwrap().reference);
    let options = RecordOptions::of(&tank);
    let mut log = Recorder::create(file, &tank, options).unwrap();
    let set = |tank: &mut Component, log: &mut Recorder, references: &[u32], values: &[f64]| {
        tank.set(references, values).unwrap();
        log.record_inputs(tank, references, values, "test");
    };
    set(&mut tank, &mut log, &[density], &[rho]);
    if !settled {
        set(&mut tank, &mut log, &[supply, saturate], &[rate, 1.0]);
    }
    tank.initialize(0.0, None).unwrap();
    let done = log.record_initialization(&tank, 0.0, None, "test");
    done.unwrap();
    if settled {
        set(&mut tank, &mut log, &[supply, saturate], &[rate, 1.0]);
    }
    for slope in [0.0, slope] {
        let (t, h) = (tank.time(), tank.scene().run.step);
        if slope != 0.0 {
            tank.set_input_derivatives(&[supply], &[slope]).unwrap();
            log.record_slopes(&tank, &[supply], &[slope], "test");
        }
        let report = tank.do_step(t, h).unwrap();
        log.record_step(&tank, &report, t, h, "test").unwrap();
    }
    log.finish(&tank, "done").unwrap();
}

/// What an inflow lets in follows from the density that is set, and so does what a log tells of its rate.
#[test]
fn rates_of_inflows_of_another_density_run_again() {
    let folder = temp_dir::TempDir::new().unwrap();
    // A face of 60 mm by 100 mm at 0.5 m/s, water of 1000 kg/m^3.
    let most = 0.06 * 0.1 * 0.5 * 1000.0;
    // Density, then the rate that is asked for, its slope over the second step, and what is held in each.
    let cases = [
        (1200.0, 1.1 * most, 0.0, [1.1 * most; 2]),
        (1200.0, most, 1e9, [most, 1.2 * most]),
        (800.0, most, 0.0, [0.8 * most; 2]),
        (800.0, 0.5 * most, 1e9, [0.5 * most, 0.8 * most]),
    ];
    for (rho, asked, slope, held) in cases {
        for settled in [false, true] {
            let file = folder.path().join(format!("{rho}-{asked}-{settled}.mcap"));
            tank_of_density(&file, rho, settled, (asked, slope));
            let done = redrive(&file, &RedriveOptions::default(), &mut |_| {}).unwrap();
            assert_eq!((done.difference, done.same_state), (None, Some(true)));
            let told = Table::read(&file, (f64::NEG_INFINITY, f64::INFINITY)).unwrap();
            let told = &told.column("inflow.supply.rate").unwrap().values;
            for (told, held) in told[told.len() - 2..].iter().zip(held) {
                assert!((told / held - 1.0).abs() < 1e-12, "{told} for {held}");
            }
        }
    }
}
