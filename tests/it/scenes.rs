//! Scene files: every case loads, every bad file gets the messages it states, docs/scene.md and the schema are true.
#![allow(
    clippy::unwrap_used,
    reason = "in a test a panic is the report, also in its helpers"
)]

mod gates;
mod together;

use std::fs;
use std::path::{Path, PathBuf};

use sandgate::scene::{self, Dimension, GaugeKind, InputTarget, Scene};
use sandgate::solver::Scheme;
use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn toml_files(folder: &str) -> Vec<PathBuf> {
    let folder = root().join(folder);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

fn case(name: &str) -> Scene {
    let path = root().join("cases").join(format!("{name}.toml"));
    scene::load(&path).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_case_loads_and_is_named_after_its_file_and_listed() {
    let list = fs::read_to_string(root().join("cases/README.md")).unwrap();
    let files = toml_files("cases");
    assert!(files.len() >= 6);
    for path in files {
        let scene = scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let stem = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(scene.name, stem);
        assert!(!scene.title.is_empty(), "{stem} has no title");
        assert!(
            list.contains(&format!("`{stem}`")),
            "{stem} is not in cases/README.md"
        );
        assert_eq!(scene.source, fs::read_to_string(&path).unwrap());
    }
}

#[test]
fn the_silo_is_what_its_file_says() {
    let silo = case("silo_gate");
    assert_eq!(silo.dimension, Dimension::Two);
    assert_eq!(silo.domain.gravity, [0.0, -9.81, 0.0]);
    assert_eq!(silo.domain.width, 0.1);
    assert_eq!(silo.numerics.spacing, 0.003_125);
    let gate = &silo.gates[0];
    assert_eq!(
        (gate.from, gate.to),
        ([0.0375, 0.0, 0.0], [0.0875, 0.0, 0.0])
    );
    assert_eq!(gate.thickness, 0.0125, "four spacings if left out");
    assert_eq!(gate.slip, scene::Slip::FreeSlip);
    assert_eq!(silo.schedules[0].input, InputTarget::GateOpening(0));
    assert_eq!(silo.schedules[0].points[2], (0.4, 0.5), "\"50 %\"");
    // 10 sqrt(g H): H = 0.45 m over the floor and 12.5 mm of lip; more than the expected 1.6 m/s.
    let speed = 10.0 * (9.81_f64 * 0.4625).sqrt();
    assert!((silo.numerics.sound_speed - speed).abs() < 1e-9);
    let depth = silo.gauges.iter().find(|g| g.name == "depth_centre");
    let Some(GaugeKind::Depth { up, length, .. }) = depth.map(|g| &g.kind) else {
        panic!("no depth gauge: {depth:?}");
    };
    assert_eq!(*up, [0.0, 1.0, 0.0]);
    assert_eq!(*length, 0.55, "up to the top of the domain");
}

#[test]
fn a_slope_turns_gravity_and_leaves_up_across_the_bed() {
    let plane = case("inclined_plane");
    let [gx, gy, _] = plane.domain.gravity;
    assert!((gx / -gy - 25f64.to_radians().tan()).abs() < 1e-12);
    assert!((gx.hypot(gy) - 9.81).abs() < 1e-12);
    assert_eq!(plane.up(), [0.0, 1.0, 0.0]);
    assert_eq!(plane.domain.periodic, [true, false, false]);
}

#[test]
fn a_size_of_gravity_is_not_negative() {
    let text = case("silo_gate")
        .source
        .replace("[domain]", "[domain]\ngravity = -9.81");
    let message = scene::parse("again", &text).unwrap_err().to_string();
    for part in ["-9.81 m/s^2", "downwards", "write 9.81"] {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
}

#[test]
fn an_inflow_takes_its_capacity_however_it_was_rounded() {
    let chute = case("chute_inflow");
    let most = chute.inflows[0].max_rate;
    let with = |rate: f64| {
        let schedule = format!(
            "[[schedule]]\ninput = \"inflow.{}.rate\"\npoints = [[0, {rate:?}]]\n",
            chute.inflows[0].name
        );
        scene::parse("again", &format!("{}\n{schedule}", chute.source))
    };
    let above = with(most * (1.0 + 1e-12)).unwrap();
    assert_eq!(above.schedules.last().unwrap().points[0].1, most);
    assert!(with(most * 1.001).is_err());
}

#[test]
fn the_fingerprint_is_that_of_the_text() {
    let silo = case("silo_gate");
    let mut text = silo.source.clone();
    assert_eq!(
        scene::parse("again", &text).unwrap().fingerprint(),
        silo.fingerprint()
    );
    text.push_str("# a comment\n");
    assert_ne!(
        scene::parse("again", &text).unwrap().fingerprint(),
        silo.fingerprint()
    );
}

#[test]
fn the_cases_of_several_phases_load_and_are_listed() {
    let list = fs::read_to_string(root().join("cases/README.md")).unwrap();
    let files = toml_files("cases/phases");
    assert_eq!(files.len(), 9);
    for path in &files {
        let scene = scene::load(path).unwrap_or_else(|e| panic!("{e}"));
        let stem = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(scene.name, stem);
        let listed = list.contains(&format!("`phases/{stem}`"));
        assert!(
            listed || stem.starts_with("silted_dam"),
            "{stem} is not listed"
        );
        scene::build::<2>(&scene).unwrap_or_else(|e| panic!("{stem}: {e}"));
    }
}

/// Paper A's own cases are as printed in its Tables 2 and 3: K_t, tau_0 and m_0 become what the solver takes.
#[test]
fn the_cases_of_paper_a_load_and_are_what_its_tables_say() {
    let list = fs::read_to_string(root().join("cases/README.md")).unwrap();
    let files = toml_files("cases/paper_a");
    assert_eq!(files.len(), 7);
    for path in &files {
        let scene = scene::load(path).unwrap_or_else(|e| panic!("{e}"));
        let stem = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(scene.name, stem);
        assert!(
            list.contains(&format!("`paper_a/{stem}`")),
            "{stem} is not listed"
        );
    }
    let column = case("paper_a/column_3");
    let speed = 1.0 / (4.1e-5_f64 * 2600.0 * 0.6).sqrt();
    assert!((column.numerics.sound_speed / speed - 1.0).abs() < 1e-12);
    let Scheme::PaperA(choices) = column.numerics.scheme else {
        panic!("{:?}", column.numerics.scheme);
    };
    assert_eq!(
        (
            choices.reference_yield_stress,
            choices.scaling_time,
            choices.ghost_velocity_factor
        ),
        (795.0, 1.2, 1.5)
    );
    // The slope of the plane lies between the friction angles; the default scheme starts from its profile as well.
    let text = case("paper_a/inclined_plane").source;
    let flat = text.replace("slope = \"25 deg\"", "slope = \"20 deg\"");
    let message = scene::parse("flat.toml", &flat).unwrap_err().to_string();
    assert!(message.contains("a slope of 20.00 deg"), "{message}");
    let own_keys = ["scheme", "reference_yield_stress", "scaling_time"];
    let kept = |line: &&str| !own_keys.iter().any(|key| line.starts_with(key));
    let implicit = text.lines().filter(kept).collect::<Vec<_>>().join("\n");
    assert_eq!(
        scene::parse("other.toml", &implicit)
            .unwrap()
            .numerics
            .scheme,
        Scheme::Implicit
    );
}

/// Paper B's own cases are its sections 3.1 and 3.2.
#[test]
fn the_cases_of_paper_b_load_and_are_listed() {
    let list = fs::read_to_string(root().join("cases/README.md")).unwrap();
    let files = toml_files("cases/paper_b");
    assert_eq!(files.len(), 6);
    for path in &files {
        let scene = scene::load(path).unwrap_or_else(|e| panic!("{e}"));
        let stem = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(scene.name, stem);
        assert!(
            list.contains(&format!("`paper_b/{stem}`")),
            "{stem} is not listed"
        );
        let Scheme::PaperB(choices) = scene.numerics.scheme else {
            panic!("{stem}: {:?}", scene.numerics.scheme);
        };
        // Its Table 1.
        let expected = if stem == "clay_dam_break" {
            (1.0, 0.1)
        } else {
            (0.01, 0.01)
        };
        let got = (choices.relaxation_factor, choices.stiffening_time);
        assert_eq!(got, expected, "{stem}");
        assert_eq!(scene.numerics.smoothing_ratio, 2.0);
    }
}

/// A message that a bad file expects: line and a part of it.
struct Expected<'t> {
    line: usize,
    part: &'t str,
}

/// `#^ part` expects a problem on the nearest line above that is no such comment; `#^ at N: part` one on line N;
/// parts separated by ` ; ` must all stand in the same message.
fn expected(text: &str) -> Vec<Expected<'_>> {
    let mut list = Vec::new();
    let mut above = 0;
    for (index, line) in text.lines().enumerate() {
        let Some(part) = line.trim_start().strip_prefix("#^") else {
            above = index + 1;
            continue;
        };
        let part = part.trim();
        let other = part
            .strip_prefix("at ")
            .and_then(|rest| rest.split_once(": "))
            .and_then(|(line, part)| Some((line.parse().ok()?, part)));
        let (line, part) = other.unwrap_or((above, part));
        list.push(Expected { line, part });
    }
    list
}

#[test]
fn bad_scenes_are_refused_with_the_messages_they_state() {
    let files = toml_files("tests/scenes/bad");
    assert!(files.len() >= 20, "only {} bad files", files.len());
    let mut failures = String::new();
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        let expected = expected(&text);
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!expected.is_empty(), "{name} expects nothing");
        let Err(errors) = scene::parse(&name, &text) else {
            failures.push_str(&format!("{name}: accepted\n"));
            continue;
        };
        let meets = |e: &Expected, p: &scene::SceneError| {
            let message = p.to_string();
            p.line == e.line && e.part.split(" ; ").all(|part| message.contains(part))
        };
        let missing = expected
            .iter()
            .filter(|e| !errors.problems().iter().any(|p| meets(e, p)));
        for Expected { line, part } in missing {
            failures.push_str(&format!(
                "{name}:{line}: not reported: {part}\n{errors}\n\n"
            ));
        }
        let surplus = errors
            .problems()
            .iter()
            .filter(|p| !expected.iter().any(|e| meets(e, p)));
        for problem in surplus {
            failures.push_str(&format!("not expected: {problem}\n\n"));
        }
        for problem in errors.problems() {
            let SceneErrorParts {
                found,
                allowed,
                remedy,
            } = parts(problem);
            assert!(
                !found && !allowed && !remedy,
                "{name}: an empty part in {problem}"
            );
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Which parts of a message are empty.
struct SceneErrorParts {
    found: bool,
    allowed: bool,
    remedy: bool,
}

fn parts(problem: &scene::SceneError) -> SceneErrorParts {
    SceneErrorParts {
        found: problem.found.is_empty(),
        allowed: problem.allowed.is_empty(),
        remedy: problem.remedy.is_empty(),
    }
}

#[test]
fn files_that_are_no_text_are_refused_with_a_remedy() {
    let folder = temp_dir::TempDir::new().unwrap();
    let check = |name: &str, bytes: &[u8], part: &str| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let message = scene::load(&path).unwrap_err().to_string();
        assert!(message.contains(part), "{name}: {message}");
    };
    check("latin.toml", b"name = \"\xe4\"\n", "not UTF-8");
    let latin = b"name = \"a\"\ntitle = \"\xe4\"\n";
    check(
        "latin.toml",
        latin,
        "latin.toml:2\n  found:   a byte at column 10",
    );
    check("empty.toml", b"", "add [domain] with lower, upper");
    check("zeros.toml", &[0; 64], "TOML");
    check("image.toml", b"\x89PNG\r\n\x1a\n", "not UTF-8");
    check("json.toml", b"{ \"name\": 1 }", "not JSON");
    check("huge.toml", &vec![b'#'; 5 << 20], "at most 4 MiB");
    check(
        "deep.toml",
        format!("a = {}", "[".repeat(100_000)).as_bytes(),
        "TOML",
    );
    let message = scene::load(folder.path()).unwrap_err().to_string();
    assert!(message.contains("a folder"), "{message}");
    let message = scene::load(&folder.path().join("none.toml")).unwrap_err();
    assert!(message.to_string().contains("check the path"), "{message}");
}

#[test]
fn messages_are_blocks_that_people_can_read() {
    let text = case("hydrostatic").source.replace("\"5 mm\"", "\"5 s\"");
    let line = text.lines().position(|l| l.contains("5 s")).unwrap() + 1;
    let message = scene::parse("box.toml", &text).unwrap_err().to_string();
    assert_eq!(
        message,
        format!(
            "box.toml:{line}: numerics.spacing\n  \
             found:   \"5 s\" (a time)\n  \
             allowed: a length: a number in m, or text with a unit (m, mm, cm, um, km)\n  \
             remedy:  write for example \"2 mm\"\n\
             1 problem"
        )
    );
}

/// A material that nothing is made of changes nothing, whatever stands before it, and costs nothing: it is not in the scene.
#[test]
fn materials_that_nothing_is_made_of_are_left_out() {
    let plain = case("column_collapse");
    let water = "[materials.a_water]\nlaw = \"fluid\"\npreset = \"water\"\n\n[materials.sand]";
    let text = plain.source.replace("[materials.sand]", water);
    let with = scene::parse("column.toml", &text).unwrap();
    assert_eq!(with.unused_materials, ["a_water"]);
    assert!(plain.unused_materials.is_empty());
    assert_eq!(with.materials, plain.materials);
    assert_eq!(with.numerics, plain.numerics);
    assert_eq!(with.bodies, plain.bodies);
    let parameter = |a: &scene::Adjustable| a.name.clone();
    let parameters = |s: &Scene| s.adjustables.iter().map(parameter).collect::<Vec<_>>();
    assert_eq!(parameters(&with), parameters(&plain));
}

#[test]
fn the_reference_of_scene_files_is_fresh() {
    let path = root().join("docs/scene.md");
    let fresh = scene::reference_markdown();
    if std::env::var_os("SANDGATE_REGENERATE").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, &fresh).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == fresh,
        "docs/scene.md is stale: run SANDGATE_REGENERATE=1 cargo test --release --test it scenes"
    );
}

#[test]
fn every_key_of_the_schema_says_what_it_means() {
    let schema: Value = serde_json::from_str(&scene::schema()).unwrap();
    let mut keys = 0;
    walk(&schema, &mut |object| {
        if let Some(properties) = object.get("properties").and_then(Value::as_object) {
            for (key, value) in properties {
                let description = value["description"].as_str().unwrap_or_default();
                assert!(description.len() > 8, "{key} is not described: {value}");
                keys += 1;
            }
        }
    });
    assert!(keys > 60, "only {keys} keys");
}

fn walk(value: &Value, visit: &mut impl FnMut(&serde_json::Map<String, Value>)) {
    match value {
        Value::Object(object) => {
            visit(object);
            object.values().for_each(|v| walk(v, visit));
        }
        Value::Array(items) => items.iter().for_each(|v| walk(v, visit)),
        _ => {}
    }
}

#[cfg(feature = "cli")]
#[test]
fn every_case_meets_the_schema_and_wrong_ones_do_not() {
    let program = std::ffi::OsStr::new(env!("CARGO_BIN_EXE_sandgate"));
    crate::python::pytest("test_scene_schema.py", &[("SANDGATE", program)]);
}

/// A small generator (splitmix64), so that the mutations are the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }
}

#[test]
fn broken_scenes_never_panic() {
    const WORDS: [&str; 26] = [
        "0",
        "-1",
        "1e308",
        "-1e308",
        "1e-308",
        "nan",
        "inf",
        "-inf",
        "\"\"",
        "\"2 mm\"",
        "\"1 s\"",
        "[]",
        "[0]",
        "[0, 0]",
        "[0, 0, 0]",
        "{}",
        "[[0, 0], [0, 0]]",
        "true",
        "1979-05-27",
        "99999999999999999999",
        "3",
        "2",
        "\"wall.\"",
        "0x10",
        "\"9999999 km\"",
        "\"x\"",
    ];
    let mut random = Random(7);
    let mut refused = 0;
    for path in toml_files("cases")
        .into_iter()
        .chain(toml_files("tests/scenes/bad"))
    {
        let text = fs::read_to_string(&path).unwrap();
        for _ in 0..150 {
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            for _ in 0..=random.below(4) {
                let at = random.below(lines.len());
                let line = lines[at].clone();
                match random.below(5) {
                    0 => lines[at] = String::new(),
                    1 => lines.push(line),
                    2 => {
                        let cut = random.below(line.len() + 1);
                        if line.is_char_boundary(cut) {
                            lines[at].truncate(cut);
                        }
                    }
                    3 => {
                        let other = random.below(lines.len());
                        lines.swap(at, other);
                    }
                    _ => {
                        if let Some((key, _)) = line.split_once('=') {
                            lines[at] = format!("{key}= {}", WORDS[random.below(WORDS.len())]);
                        }
                    }
                }
            }
            let mutated = lines.join("\n");
            if let Err(errors) = scene::parse("mutated.toml", &mutated) {
                assert!(!errors.problems().is_empty());
                assert!(!errors.to_string().is_empty());
                let count = mutated.lines().count() + 1;
                assert!(errors.problems().iter().all(|p| p.line <= count));
                refused += 1;
            }
        }
    }
    // Otherwise the mutations would be too tame to show anything.
    assert!(refused > 500, "only {refused} refused");
}
