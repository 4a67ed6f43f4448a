//! FMUs as importers see them: packed here, driven by FMPy in tests/python/test_fmu.py.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use sandgate::fmi::{self, FmiVersion};
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

#[test]
fn every_way_to_run_a_scene_gives_the_same_bits_and_states_are_safe() {
    let folder = scratch("fmu");
    let scene = scheduled_devices(&folder);
    let [fmu2, fmu3] = [FmiVersion::V2, FmiVersion::V3].map(|v| packed(&scene, v, &folder));
    let cases = ["cases/silo_gate.toml", "cases/column_collapse_3d.toml"];
    let mut all = vec![fmu2.clone(), fmu3.clone()];
    for case in cases.map(|case| root().join(case)) {
        all.extend([FmiVersion::V2, FmiVersion::V3].map(|v| packed(&case, v, &folder)));
    }
    let all = std::env::join_paths(all).expect("no colon in a path");
    let [run1, run2] = ["1", "2"].map(|threads| {
        let out = folder.join(format!("run{threads}"));
        run(
            "sandgate run",
            Command::new(env!("CARGO_BIN_EXE_sandgate"))
                .arg("run")
                .arg(&scene)
                .args(["--threads", threads, "--out"])
                .arg(&out),
            "the program says what is wrong",
        );
        out
    });
    let environment: [(&str, &OsStr); 7] = [
        ("SANDGATE_SCENE", scene.as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
        ("SANDGATE_FMU2", fmu2.as_ref()),
        ("SANDGATE_FMU3", fmu3.as_ref()),
        ("SANDGATE_FMUS", &all),
        ("SANDGATE_RUN1", run1.as_ref()),
        ("SANDGATE_RUN2", run2.as_ref()),
    ];
    pytest("test_fmu.py", &environment);
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
    assert!(refusal(&scene, &path, &out).contains("no shared library for Linux on x86-64"));
    let program = Path::new(env!("CARGO_BIN_EXE_sandgate"));
    assert!(refusal(&scene, program, &out).contains("found 0 scene slots, a library has 1"));
    assert!(refusal(&scene, &folder.join("nowhere"), &out).contains("cannot read"));
    assert!(refusal(&scene, library(), &folder.join("no/folder.fmu")).contains("cannot write"));
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
