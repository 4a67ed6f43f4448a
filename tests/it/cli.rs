//! The built program from outside: exit codes, messages, the files of a run, Ctrl-C, kill and resume to the bit.

mod endings;
mod going_on;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use temp_dir::TempDir;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn small_silo() -> String {
    scene("small_silo")
}

fn scene(name: &str) -> String {
    let path = root().join("tests/scenes").join(format!("{name}.toml"));
    path.to_str().unwrap().to_owned()
}

/// The program in a scratch folder, so that a default `out/` never lands in the source tree.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self {
            folder: temp_dir::TempDir::new().unwrap(),
        }
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sandgate"));
        command.args(args).current_dir(self.folder.path());
        command
    }

    fn call(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    /// Runs and demands success; answers standard output.
    fn ok(&self, args: &[&str]) -> String {
        let output = self.call(args);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{args:?}: {}",
            stderr(&output)
        );
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs and demands a refusal with this code and these words.
    fn refused(&self, args: &[&str], code: i32, words: &[&str]) {
        let output = self.call(args);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {text}");
        for word in words {
            assert!(text.contains(word), "{args:?}: no {word:?} in: {text}");
        }
        assert!(!text.contains("panicked"), "{args:?}: {text}");
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn summary(&self, folder: &str) -> Value {
        let text = std::fs::read_to_string(self.path(folder).join("summary.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    }

    fn hash(&self, folder: &str) -> String {
        self.summary(folder)["state_sha256"]
            .as_str()
            .unwrap()
            .to_owned()
    }

    fn table(&self, folder: &str) -> String {
        std::fs::read_to_string(self.path(folder).join("gauges.csv")).unwrap()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Columns of `gauges.csv` by name.
fn columns(table: &str) -> BTreeMap<String, Vec<f64>> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: BTreeMap<String, Vec<f64>> = names
        .iter()
        .map(|name| ((*name).to_owned(), Vec::new()))
        .collect();
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        for (name, cell) in names.iter().zip(cells) {
            columns.get_mut(*name).unwrap().push(cell);
        }
    }
    columns
}

#[test]
fn help_names_every_subcommand_and_exit_code() {
    let desk = Desk::new();
    let help = desk.ok(&["--help"]);
    for word in ["run", "info", "fmu", "schema", "Exit codes", "130"] {
        assert!(help.contains(word), "no {word} in: {help}");
    }
    let help = desk.ok(&["run", "--help"]);
    for word in [
        "--until",
        "--out",
        "--threads",
        "--checkpoint-every",
        "--resume",
        "--step",
        "--no-log",
        "--force",
        "gauges.csv",
        "summary.json",
        "Ctrl-C",
    ] {
        assert!(help.contains(word), "no {word} in: {help}");
    }
    assert!(desk.ok(&["--version"]).contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_use_is_refused_with_code_2() {
    let (desk, silo) = (Desk::new(), small_silo());
    desk.refused(&[], 2, &["Usage"]);
    desk.refused(&["fly"], 2, &["unrecognized subcommand 'fly'"]);
    desk.refused(&["run"], 2, &["<CASE>"]);
    desk.refused(
        &["run", &silo, "--until", "2 mm"],
        2,
        &["a length", "a time", "ms"],
    );
    desk.refused(&["run", &silo, "--until", "0 s"], 2, &["more than 0 s"]);
    desk.refused(
        &["run", &silo, "--step", "soon"],
        2,
        &["not a decimal number"],
    );
    desk.refused(&["run", &silo, "--threads", "1000"], 2, &["1000", "256"]);
    desk.refused(&["run", &silo, "--threads", "-1"], 2, &["-1", "0..=256"]);
    desk.refused(&["log", "cat", "no.mcap", "--from", "-2m"], 2, &["-2m"]);
    desk.refused(&["run", &silo, "--force"], 2, &["--out"]);
    for verb in ["info", "redrive"] {
        let words = ["cannot read log no.mcap", "out/silo_gate/run.mcap"];
        desk.refused(&["log", verb, "no.mcap"], 5, &words);
    }
    desk.refused(&["fmu", &silo, "--fmi", "1"], 2, &["2..=3"]);
    let words = ["whose folder does not exist", "make nowhere first"];
    desk.refused(&["fmu", &silo, "--output", "nowhere/silo.fmu"], 2, &words);
    assert!(!desk.path("out").exists(), "a refused run left a folder");
}

#[test]
fn scenes_that_are_missing_or_wrong_are_refused() {
    let desk = Desk::new();
    desk.refused(
        &["run", "nowhere.toml"],
        5,
        &["nowhere.toml", "No such file", "cases/"],
    );
    let text = std::fs::read_to_string(small_silo()).unwrap();
    let bad = text.replace("spacing = \"4 mm\"", "spacing = \"-4 mm\"\nspeed = 3");
    std::fs::write(desk.path("bad.toml"), bad).unwrap();
    for command in ["run", "info"] {
        desk.refused(
            &[command, "bad.toml"],
            3,
            &[
                "bad.toml:",
                "numerics.spacing",
                "numerics.speed",
                "allowed",
                "2 problems",
            ],
        );
    }
    assert!(!desk.path("out").exists(), "a refused run left a folder");
}

#[test]
fn scenes_that_cannot_be_built_are_refused_with_their_file() {
    let desk = Desk::new();
    let mut text = std::fs::read_to_string(scene("stream")).unwrap();
    text.push_str(
        "[inflows.feed]\nmaterial = \"water\"\nfrom = [0.15, 0.15]\nto = [0.05, 0.15]\nvelocity = [0, -0.5]\n\
         [outflows.end]\nlower = [0, 0.12]\nupper = [0.2, 0.16]\n",
    );
    std::fs::write(desk.path("full.toml"), text).unwrap();
    let words = [
        "error: full.toml: cannot build scene: inflow feed",
        "inside outflow end",
    ];
    for command in ["run", "info"] {
        desk.refused(&[command, "full.toml"], 3, &words);
    }
    assert!(!desk.path("out").exists(), "a refused run left a folder");
}

#[cfg(feature = "bus")]
#[test]
fn a_component_that_cannot_be_served_leaves_no_log() {
    let (desk, silo) = (Desk::new(), small_silo());
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = format!("tcp/{}", taken.local_addr().unwrap());
    for _ in 0..2 {
        let args = ["serve", &silo, "--listen", &endpoint, "--log", "day.mcap"];
        desk.refused(&args, 6, &[&endpoint]);
        assert!(!desk.path("day.mcap.part").exists());
    }
}

#[test]
fn a_run_leaves_every_file_and_keeps_all_mass() {
    let desk = Desk::new();
    let shown = desk.ok(&["run", &small_silo(), "--threads", "2"]);
    for word in [
        "small_silo finished at t = 0.2 s",
        "error 0",
        "gauge.level.depth",
        "out/small_silo",
    ] {
        assert!(shown.contains(word), "no {word:?} in: {shown}");
    }
    let out = "out/small_silo";
    let summary = desk.summary(out);
    assert_eq!(summary["made_by"], "sandgate run");
    assert_eq!(summary["status"], "finished");
    assert_eq!(summary["time"], 0.2);
    assert_eq!(summary["communication_steps"], 40);
    assert_eq!(summary["threads"], 2);
    assert_eq!(summary["mass"]["error"], 0.0);
    assert!(
        summary["mass"]["outflow"].as_f64().unwrap() > 0.0,
        "nothing came out: {}",
        summary["mass"]
    );
    assert!(summary["steps"].as_u64().unwrap() >= 40);
    assert!(summary["cpu_s"].as_f64().unwrap() > 0.0);
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    assert_eq!(summary["state_sha256"].as_str().unwrap().len(), 64);

    let columns = columns(&desk.table(out));
    assert_eq!(columns["time"].len(), 41);
    assert_eq!(columns["time"][40], 0.2);
    for (row, &time) in columns["time"].iter().enumerate() {
        assert!(
            (time - 0.005 * row as f64).abs() < 1e-12,
            "row {row} is at {time}"
        );
        assert_eq!(columns["mass.error"][row], 0.0, "mass at t = {time}");
    }
    // The schedule: closed until 20 ms, open from 60 ms to 150 ms.
    assert_eq!(columns["gate.main.opening"][4], 0.0);
    assert_eq!(columns["gate.main.opening"][20], 1.0);
    let variables = summary["variables"].as_object().unwrap();
    for (name, values) in columns.iter().filter(|(name, _)| *name != "time") {
        let entry = &variables[name];
        assert_eq!(entry["final"].as_f64(), values.last().copied(), "{name}");
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(entry["min"].as_f64(), Some(least), "{name}");
    }
    assert_eq!(
        variables["gauge.surface.depth"]["final"]
            .as_array()
            .unwrap()
            .len(),
        4
    );

    let log = std::fs::read(desk.path(out).join("run.mcap")).unwrap();
    assert!(log.starts_with(b"\x89MCAP0\r\n") && log.ends_with(b"\x89MCAP0\r\n"));
    let picture = std::fs::read_to_string(desk.path(out).join("gauges.svg")).unwrap();
    for word in [
        "<svg",
        "gauge.level.depth",
        "gate.main.opening",
        "time [s]",
        // The profile, at its moments.
        "gauge.surface.depth",
        "t = 0 s",
        "</svg>",
    ] {
        assert!(picture.contains(word), "no {word} in the picture");
    }
    assert!(desk.path(out).join("checkpoint.state").exists());
    let names: Vec<_> = std::fs::read_dir(desk.path(out))
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names.len(), 5, "left behind: {names:?}");
}

#[test]
fn earlier_results_are_never_overwritten_unasked() {
    let (desk, silo) = (Desk::new(), small_silo());
    let short = ["--until", "10 ms", "--no-log"];
    let run = |more: &[&'static str]| -> Vec<&str> { [&["run", &silo][..], &short, more].concat() };
    desk.ok(&run(&[]));
    desk.ok(&run(&[]));
    assert!(desk.path("out/small_silo/summary.json").exists());
    assert!(desk.path("out/small_silo-2/summary.json").exists());
    assert!(
        !desk.path("out/small_silo/run.mcap").exists(),
        "--no-log wrote a log"
    );

    desk.ok(&run(&["--out", "mine"]));
    std::fs::write(desk.path("mine/notes.txt"), "precious").unwrap();
    std::fs::write(desk.path("mine/run-7.mcap"), "old segment").unwrap();
    let before = desk.summary("mine");
    desk.refused(
        &run(&["--out", "mine"]),
        2,
        &["mine holds an earlier run", "--force"],
    );
    assert_eq!(desk.summary("mine"), before);
    desk.ok(&run(&["--out", "mine", "--force"]));
    assert!(desk.path("mine/notes.txt").exists());
    assert!(!desk.path("mine/run-7.mcap").exists());

    std::fs::create_dir(desk.path("other")).unwrap();
    std::fs::write(desk.path("other/notes.txt"), "precious").unwrap();
    for more in [&["--out", "other"][..], &["--out", "other", "--force"]] {
        desk.refused(&run(more), 2, &["other is not empty", "notes.txt"]);
    }
    desk.refused(&run(&["--out", "other/notes.txt"]), 5, &["notes.txt"]);
}

#[test]
fn results_do_not_depend_on_threads_or_on_the_log() {
    let (desk, silo) = (Desk::new(), small_silo());
    let run = |more: &[&str]| desk.ok(&[&["run", &silo, "--until", "60 ms"][..], more].concat());
    run(&["--out", "one", "--threads", "1"]);
    run(&["--out", "two", "--threads", "2", "--no-log"]);
    assert_eq!(desk.hash("one"), desk.hash("two"));
    assert_eq!(desk.table("one"), desk.table("two"));
}

#[test]
fn a_resumed_run_ends_with_the_bits_of_an_unbroken_one() {
    let (desk, silo) = (Desk::new(), small_silo());
    desk.ok(&["run", &silo, "--out", "whole", "--until", "0.1 s"]);
    desk.ok(&[
        "run",
        &silo,
        "--out",
        "parts",
        "--until",
        "55 ms",
        "--threads",
        "1",
    ]);
    assert_ne!(desk.hash("whole"), desk.hash("parts"));
    let state = "parts/checkpoint.state";
    desk.refused(
        &["run", &silo, "--resume", state, "--until", "50 ms"],
        2,
        &["--until"],
    );
    desk.ok(&["run", &silo, "--resume", state, "--until", "0.1 s"]);
    assert_eq!(desk.hash("whole"), desk.hash("parts"));
    assert_eq!(desk.table("whole"), desk.table("parts"));
    let summary = desk.summary("parts");
    assert_eq!(summary["communication_steps"], 20);
    let parts = summary["parts"].as_array().unwrap();
    let logs: Vec<_> = parts
        .iter()
        .map(|part| part["log"].as_str().unwrap())
        .collect();
    assert_eq!(logs, ["run.mcap", "run-2.mcap"]);
    assert_eq!(parts[1]["from"], 0.055);
    for log in logs {
        assert!(desk.path("parts").join(log).exists());
    }
    // Naming the same folder is going on, too.
    let again = ["--resume", state, "--out", "./parts", "--until", "0.105 s"];
    desk.ok(&[&["run", &silo][..], &again].concat());
    assert_eq!(desk.summary("parts")["parts"].as_array().unwrap().len(), 3);
    let summary = desk.summary("parts");
    // Into another folder: only what was computed there, and the first folder stays as it was.
    desk.ok(&[
        "run", &silo, "--resume", state, "--until", "0.11 s", "--out", "else",
    ]);
    assert_eq!(columns(&desk.table("else"))["time"], [0.105, 0.11]);
    assert_eq!(desk.summary("parts"), summary);
}

#[test]
fn states_that_do_not_fit_are_refused() {
    let (desk, silo) = (Desk::new(), small_silo());
    desk.ok(&["run", &silo, "--out", "run", "--until", "10 ms"]);
    let state = desk.path("run/checkpoint.state");
    let good = std::fs::read(&state).unwrap();
    desk.refused(
        &["run", &silo, "--resume", "nowhere.state"],
        5,
        &["nowhere.state"],
    );
    // It does not end.
    let endless = &["run", &silo, "--resume", "/dev/zero"];
    desk.refused(
        endless,
        5,
        &["saved state refused", "the mark of a saved state"],
    );
    let mut flipped = good.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 4;
    for bytes in [&flipped[..], &good[..good.len() / 2], b"", b"hello"] {
        std::fs::write(&state, bytes).unwrap();
        desk.refused(
            &["run", &silo, "--resume", "run/checkpoint.state"],
            5,
            &["run/checkpoint.state: saved state refused"],
        );
    }
    std::fs::write(&state, good).unwrap();
    let text = std::fs::read_to_string(&silo)
        .unwrap()
        .replace("6.4 cm", "6.0 cm");
    std::fs::write(desk.path("other.toml"), text).unwrap();
    desk.refused(
        &["run", "other.toml", "--resume", "run/checkpoint.state"],
        5,
        &["scene"],
    );
    assert_eq!(
        desk.summary("run")["status"],
        "finished",
        "a refused resume changed the folder"
    );
}

#[test]
fn a_failed_step_keeps_what_was_computed_before() {
    let desk = Desk::new();
    desk.refused(
        &["run", &scene("no_floor"), "--out", "run"],
        4,
        &["step failed", "particle"],
    );
    let summary = desk.summary("run");
    assert_eq!(summary["status"], "failed");
    let error = summary["error"].as_str().unwrap();
    assert!(error.starts_with("step failed: "), "{error}");
    let columns = columns(&desk.table("run"));
    assert!(columns["time"].len() > 1, "no row before the failure");
    assert_eq!(columns["time"].last().copied(), summary["time"].as_f64());
    assert!(desk.path("run/run.mcap").exists());
}

#[test]
fn info_tells_what_a_case_holds_costs_and_leaves_out() {
    let text = Desk::new().ok(&["info", &small_silo()]);
    for word in [
        "small_silo",
        "320 of spacing 0.004 m",
        "body     fill: 320 particles of beads",
        "material beads: mu(I), mu_s 0.3819 to mu_2 0.6435, I0 0.2790",
        "wall     left: chain of 3 points, no slip",
        "gate     main",
        "outflow  drain",
        "sound      c0 = 7.92",
        "H = 0.064 m high",
        "gauge    surface: depth at 4 places",
        "sleep      once nothing has moved for a while, until an input changes",
        "left out   the third dimension",
        "inflows",
        "acoustic bound",
        "measured",
        "expected   0.2 s simulated = 40 communication steps",
        "cost",
        "particle and step",
        "saved state",
        "gate.main.opening",
        "input",
    ] {
        assert!(text.contains(word), "no {word:?} in: {text}");
    }
}

/// Particles that jitter put beyond a round or slanted rim belong to their body, too.
#[test]
fn a_scene_without_title_is_shown_by_its_name() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(scene("stream")).unwrap();
    let text = text.replace("title = \"A stream over a belt without friction\"\n", "");
    assert!(!text.contains("title"));
    std::fs::write(desk.path("stream.toml"), text).unwrap();
    assert!(desk.ok(&["info", "stream.toml"]).starts_with("stream\n"));
    desk.ok(&["run", "stream.toml", "--out", "run"]);
    let log = desk.ok(&["log", "info", "run/run.mcap"]);
    assert!(log.contains(" stream (sha256 "), "{log}");
    let picture = std::fs::read_to_string(desk.path("run/gauges.svg")).unwrap();
    assert!(picture.contains("stream"), "{picture}");
}

#[test]
fn info_counts_the_particles_of_a_body_as_they_were_made() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(small_silo()).unwrap();
    let of = text.find("box = ").expect("its body is a box");
    let line = text[of..].lines().next().expect("a line");
    let round = "circle = { centre = [\"40 mm\", \"40 mm\"], radius = \"30 mm\" }";
    let path = desk.path("disc.toml");
    std::fs::write(&path, text.replace(line, round)).unwrap();
    let told = desk.ok(&["info", path.to_str().unwrap()]);
    let number = |key: &str| -> usize {
        let rest = told.split(key).nth(1).unwrap_or_else(|| panic!("{told}"));
        let word = rest.split_whitespace().next();
        word.and_then(|w| w.parse().ok())
            .unwrap_or_else(|| panic!("{told}"))
    };
    assert_eq!(number("body     fill:"), number("particles  "));
}

#[test]
fn info_tells_of_a_gate_that_is_held_below_its_speed() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(small_silo()).unwrap();
    assert!(!desk.ok(&["info", &small_silo()]).contains("held to"));
    let quick = text.replace("[gates.main]", "[gates.main]\nmax_speed = \"100 m/s\"");
    let path = desk.path("quick.toml");
    std::fs::write(&path, quick).unwrap();
    let told = desk.ok(&["info", path.to_str().unwrap()]);
    assert!(told.contains("at most 100 m/s asked, held to "), "{told}");
}

#[test]
fn schema_is_json_and_a_reader_may_go_away() {
    let desk = Desk::new();
    let schema: Value = serde_json::from_str(&desk.ok(&["schema"])).unwrap();
    assert!(schema["properties"]["numerics"].is_object(), "{schema}");
    let mut child = desk
        .command(&["schema"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(stderr(&output), "");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_run_says_that_its_sound_speed_is_too_low_for_what_flowed() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(scene("stream")).unwrap();
    for (speed, said) in [("1.9", false), ("2.1", true)] {
        let text = text.replace("velocity = [2.1, 0]", &format!("velocity = [{speed}, 0]"));
        std::fs::write(desk.path("stream.toml"), text).unwrap();
        let out = desk.call(&["run", "stream.toml", "--out", speed]);
        assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
        let shown = String::from_utf8_lossy(&out.stdout).into_owned() + &stderr(&out);
        assert_eq!(shown.contains("numerics.expected_speed"), said, "{shown}");
        let share = desk.summary(speed)["share_fast"].as_f64();
        assert_eq!(share.unwrap() > 0.9, said);
    }
}
