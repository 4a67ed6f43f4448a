//! What is said of a log, printed and exported.

use super::{SCENE, log, log_of, logged, sandgate, text};
use crate::python;
use sandgate::wire::keys;
use std::ffi::OsStr;

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
fn a_file_that_cannot_be_read_hides_no_other() {
    let path = log_of(logged());
    let words = ["log", "info", "absent.mcap", &path, "gone.mcap", &path].map(OsStr::new);
    let output = sandgate(&words);
    let (said, told) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(5), "{told}");
    assert_eq!(said.matches("state hash").count(), 2, "{said}");
    for file in ["absent.mcap", "gone.mcap"] {
        assert_eq!(told.matches(file).count(), 1, "{told}");
    }
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
fn an_export_of_times_that_the_log_does_not_have_is_told() {
    let folder = temp_dir::TempDir::new().unwrap();
    let csv = folder.path().join("gauges.csv").display().to_string();
    let path = log_of(logged());
    let words = ["log", "export", &path, "--csv", &csv, "--from", "1000 s"].map(OsStr::new);
    let output = sandgate(&words);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("from 1000 s on: the log holds 0 to "),
        "{said}"
    );
    assert_eq!(std::fs::read_to_string(&csv).unwrap().lines().count(), 1);
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
