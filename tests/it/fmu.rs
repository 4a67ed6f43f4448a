//! FMUs as importers see them: packed here, driven by FMPy in tests/python.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use sandgate::fmi::library::{BUILT_FROM, Kind};
use sandgate::fmi::{self, Extent, FmiVersion, Packing};
use sandgate::scene;

use crate::python::{pytest, root, run, target};
use crate::shared_library::{library, scratch};

/// Packs a scene for one version.
fn packed(scene: &Path, version: FmiVersion, folder: &Path) -> PathBuf {
    let scene = scene::load(scene).unwrap_or_else(|why| panic!("{why}"));
    let out = folder.join(format!("{}_{}.fmu", scene.name, version.name()));
    fmi::pack(&scene, version, library(), &out).unwrap_or_else(|why| panic!("{why}"));
    out
}

/// tests/scenes/devices.toml with schedules; every number in them is dyadic, so that all importers interpolate and add
/// up to the same bits.
fn scheduled_devices(folder: &Path) -> PathBuf {
    let text = fs::read_to_string(root().join("tests/scenes/devices.toml")).expect("it is there");
    let text = text
        .replace("step = \"5 ms\"", "step = 0.00390625")
        .replace("until = \"0.3 s\"", "until = 0.125");
    assert!(text.contains("0.00390625") && text.contains("0.125"));
    let schedules = "
[[schedule]]
input = \"gate.sluice.opening\"
points = [[0, 0], [0.03125, 0], [0.0625, 1], [0.09375, 0.25]]

[[schedule]]
input = \"inflow.feed.rate\"
points = [[0, 0.125], [0.0625, 0.25], [0.125, 0.125]]
";
    let path = folder.join("scheduled_devices.toml");
    fs::write(&path, text + schedules).expect("the scratch folder is writable");
    path
}

/// cases/silo_gate.toml at twice its spacing, its gate's schedule in a fifth of the time, until the gate has closed half.
fn hasty_silo(folder: &Path) -> PathBuf {
    let path = root().join("cases/silo_gate.toml");
    let scene = scene::load(&path).unwrap_or_else(|why| panic!("{why}"));
    let text = fs::read_to_string(path).expect("it is there");
    let mut table: toml::Table = text.parse().expect("it is TOML");
    let mut put = |section: &str, key: &str, value: f64| {
        let section = table.get_mut(section).and_then(toml::Value::as_table_mut);
        let section = section.expect("the case has it");
        section.insert(key.to_owned(), value.into());
    };
    put("numerics", "spacing", 2.0 * scene.numerics.spacing);
    let step = scene.run.step;
    put("run", "step", step);
    put("run", "until", 12.0 * step);
    let [schedule] = &scene.schedules[..] else {
        panic!("the case has one schedule");
    };
    let points = schedule.points.iter().map(|&(t, opening)| {
        let t = (t / (5.0 * step)).round() * step;
        toml::Value::from(vec![t, opening])
    });
    let points = toml::Value::Array(points.collect());
    let schedules = table
        .get_mut("schedule")
        .and_then(toml::Value::as_array_mut)
        .expect("the case has schedules");
    let schedule = schedules[0].as_table_mut().expect("a schedule is a table");
    schedule.insert("points".to_owned(), points);
    let path = folder.join("hasty_silo.toml");
    fs::write(&path, table.to_string()).expect("the scratch folder is writable");
    path
}

/// Packs a scene for both versions, runs it with 1 and 2 threads and compares all ways of running it.
fn same_bits(scene: &Path, folder: &Path) -> [PathBuf; 2] {
    let fmus = [FmiVersion::V2, FmiVersion::V3].map(|v| packed(scene, v, folder));
    let runs = ["1", "2"].map(|threads| {
        let out = folder.join(format!("run{threads}"));
        run(
            "sandgate run",
            Command::new(env!("CARGO_BIN_EXE_sandgate"))
                .arg("run")
                .arg(scene)
                .args(["--threads", threads, "--out"])
                .arg(&out),
            "the program says what is wrong",
        );
        out
    });
    let environment: [(&str, &OsStr); 6] = [
        ("SANDGATE_SCENE", scene.as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
        ("SANDGATE_FMU2", fmus[0].as_ref()),
        ("SANDGATE_FMU3", fmus[1].as_ref()),
        ("SANDGATE_RUN1", runs[0].as_ref()),
        ("SANDGATE_RUN2", runs[1].as_ref()),
    ];
    pytest("test_same_bits.py", &environment);
    fmus
}

#[test]
fn every_way_to_run_a_silo_gives_the_same_bits() {
    let folder = scratch("fmu_silo");
    same_bits(&hasty_silo(&folder), &folder);
}

#[test]
fn every_way_to_run_a_channel_gives_the_same_bits_and_states_are_safe() {
    let folder = scratch("fmu");
    let scene = scheduled_devices(&folder);
    let fmus = same_bits(&scene, &folder);
    let cases = ["cases/silo_gate.toml", "cases/column_collapse_3d.toml"];
    let mut all = fmus.to_vec();
    for case in cases.map(|case| root().join(case)) {
        all.extend([FmiVersion::V2, FmiVersion::V3].map(|v| packed(&case, v, &folder)));
    }
    let all = std::env::join_paths(all).expect("no colon in a path");
    let environment: [(&str, &OsStr); 5] = [
        ("SANDGATE_SCENE", scene.as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
        ("SANDGATE_FMU2", fmus[0].as_ref()),
        ("SANDGATE_FMU3", fmus[1].as_ref()),
        ("SANDGATE_FMUS", &all),
    ];
    pytest("test_fmu.py", &environment);
}

#[test]
fn logs_of_fmus_run_again_with_the_same_bits() {
    let folder = scratch("fmu_log");
    let scene = scheduled_devices(&folder);
    let fmus = [FmiVersion::V2, FmiVersion::V3].map(|v| packed(&scene, v, &folder));
    let environment: [(&str, &OsStr); 5] = [
        ("SANDGATE_SCENE", scene.as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
        ("SANDGATE_FMU2", fmus[0].as_ref()),
        ("SANDGATE_FMU3", fmus[1].as_ref()),
        ("SANDGATE_PROGRAM", env!("CARGO_BIN_EXE_sandgate").as_ref()),
    ];
    pytest("test_fmu_log.py", &environment);
    pytest("test_fmu_log_states.py", &environment);
}

/// The library with Zenoh, built together with the program: so both share the build of all crates. (`sandgate fmu --zenoh`
/// builds it by itself.)
fn library_with_zenoh() -> PathBuf {
    run(
        "cargo build -p sandgate -p sandgate-fmu-zenoh",
        Command::new(env!("CARGO"))
            .args([
                "build",
                "--release",
                "-p",
                "sandgate",
                "-p",
                "sandgate-fmu-zenoh",
            ])
            .arg("--target-dir")
            .arg(target())
            .current_dir(root()),
        "the library with Zenoh builds",
    );
    target().join("release/libsandgate_fmu_zenoh.so")
}

#[test]
fn fmus_publish_on_zenoh_and_take_set_points() {
    let folder = scratch("fmu_zenoh");
    let path = scheduled_devices(&folder);
    let scene = scene::load(&path).unwrap_or_else(|why| panic!("{why}"));
    let library = library_with_zenoh();
    let fmus = [FmiVersion::V2, FmiVersion::V3].map(|version| {
        let out = folder.join(format!("zenoh_{}.fmu", version.name()));
        let packing = Packing {
            version,
            libraries: vec![library.clone()],
            reference: Extent::Until(0.0),
            kind: Kind::Zenoh,
        };
        fmi::pack_with(&scene, &packing, &out).unwrap_or_else(|why| panic!("{why}"));
        let size = fs::metadata(&out).expect("it was just written").len();
        assert!(size < 8_000_000, "{size} bytes");
        out
    });
    let plain = packed(&path, FmiVersion::V3, &folder);
    let size = fs::metadata(&plain).expect("it was just written").len();
    assert!(size < 4_000_000, "{size} bytes");
    let environment: [(&str, &OsStr); 7] = [
        ("SANDGATE_SCENE", path.as_ref()),
        ("SANDGATE_LIBRARY", library.as_ref()),
        ("SANDGATE_FMU2", fmus[0].as_ref()),
        ("SANDGATE_FMU3", fmus[1].as_ref()),
        ("SANDGATE_PLAIN", plain.as_ref()),
        (
            "SANDGATE_PLAIN_LIBRARY",
            crate::shared_library::library().as_ref(),
        ),
        ("SANDGATE_PROGRAM", env!("CARGO_BIN_EXE_sandgate").as_ref()),
    ];
    pytest("test_fmu_zenoh.py", &environment);
}

/// Whether every part of the benchmarks works; what it measures here, beside other tests, is not looked at.
#[test]
fn the_cost_of_the_interfaces_can_be_measured() {
    let libraries = [library().to_path_buf(), library_with_zenoh()];
    let folder = scratch("benchmarks");
    for file in libraries {
        let name = file.file_name().expect("a file has a name");
        fs::copy(&file, folder.join(name)).expect("the scratch folder is writable");
    }
    let program = Path::new(env!("CARGO_BIN_EXE_sandgate"));
    fs::copy(program, folder.join("sandgate")).expect("the scratch folder is writable");
    let output = run(
        "tests/python/benchmarks.py --quick",
        Command::new(crate::python::program("python"))
            .arg(root().join("tests/python/benchmarks.py"))
            .args(["--quick", "--target"])
            .arg(&folder),
        "the script says what went wrong",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    for part in [
        "gauge variables",
        "round trip",
        "gauges lost",
        "SIGSTOP",
        "25 Hz",
        "replay",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn packing_twice_gives_the_same_bytes() {
    let (first, second) = (scratch("pack_first"), scratch("pack_second"));
    let scene = root().join("tests/scenes/small_silo.toml");
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let bytes = [&first, &second]
            .map(|folder| fs::read(packed(&scene, version, folder)).expect("it was just written"));
        assert!(bytes[0] == bytes[1]);
    }
}

#[test]
fn packing_refuses_what_it_cannot_pack() {
    let folder = scratch("pack_refused");
    let path = root().join("tests/scenes/small_silo.toml");
    let scene = scene::load(&path).unwrap_or_else(|why| panic!("{why}"));
    let out = folder.join("out.fmu");
    let refusal = |scene: &scene::Scene, library: &Path, out: &Path| {
        let error = fmi::pack(scene, FmiVersion::V3, library, out).expect_err("refused");
        error.to_string()
    };
    assert!(
        refusal(&scene, &path, &out)
            .contains("no shared library for x86_64-linux or x86_64-windows")
    );
    let program = Path::new(env!("CARGO_BIN_EXE_sandgate"));
    assert!(refusal(&scene, program, &out).contains("found 0 scene slots, a library has 1"));
    assert!(refusal(&scene, &folder.join("nowhere"), &out).contains("cannot read"));
    assert!(refusal(&scene, library(), &folder.join("no/folder.fmu")).contains("cannot write"));
    // One of other sources, of the same version: its hash is another.
    let other = folder.join("other.so");
    let (mut bytes, text) = (
        fs::read(library()).expect("it was built"),
        BUILT_FROM.as_bytes(),
    );
    let places: Vec<usize> = (0..bytes.len() - text.len())
        .filter(|&at| bytes[at..].starts_with(text))
        .collect();
    assert!(!places.is_empty());
    for at in places {
        let digit = &mut bytes[at + text.len() - 3];
        *digit = if *digit == b'0' { b'1' } else { b'0' };
    }
    fs::write(&other, bytes).expect("the scratch folder is writable");
    assert!(refusal(&scene, &other, &out).contains("built from other sources than this program"));
    let mut long = scene;
    long.source += &format!("\n# {}", "x".repeat(fmi::slot::CAPACITY));
    assert!(refusal(&long, library(), &out).contains("an FMU holds up to 262144"));
    assert!(!out.exists());
}

#[test]
fn the_exported_functions_keep_the_contract() {
    run(
        "cargo test -p sandgate-fmu",
        Command::new(env!("CARGO"))
            .args(["test", "--release", "-p", "sandgate-fmu", "--target-dir"])
            .arg(target())
            .current_dir(root()),
        "the library's own tests failed",
    );
}
