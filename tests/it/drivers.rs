//! Our FMUs in other people's hands: checkers, drivers, coupled examples. Packed here, driven in tests/python.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use sandgate::fmi::library::Kind;
use sandgate::fmi::{self, Extent, FmiVersion, Packing};
use sandgate::scene;

use crate::python::{pytest, root};
use crate::shared_library::{library, scratch};

/// Packs a scene for both versions.
fn packed(scene: &Path, folder: &Path, reference: Extent) -> [PathBuf; 2] {
    let scene = scene::load(scene).unwrap_or_else(|why| panic!("{why}"));
    [FmiVersion::V2, FmiVersion::V3].map(|version| {
        let out = folder.join(format!("{}_{}.fmu", scene.name, version.name()));
        let packing = Packing {
            version,
            libraries: vec![library().to_path_buf()],
            reference,
            kind: Kind::Plain,
        };
        fmi::pack_with(&scene, &packing, &out).unwrap_or_else(|why| panic!("{why}"));
        out
    })
}

fn joined(paths: &[PathBuf]) -> std::ffi::OsString {
    std::env::join_paths(paths).expect("no colon in a path")
}

/// Scene files of a folder.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let files = fs::read_dir(root().join(folder)).expect("the folder is there");
    let mut files: Vec<PathBuf> = files.map(|e| e.expect("readable").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "toml"));
    files.sort();
    files
}

#[test]
fn every_case_s_fmus_pass_all_checks() {
    let folder = scratch("checks");
    let mut cases = scenes("cases");
    cases.extend(scenes("cases/paper_a"));
    assert!(cases.len() > 12);
    let fmus: Vec<PathBuf> = cases
        .iter()
        .flat_map(|case| packed(case, &folder, Extent::Until(0.0)))
        .collect();
    let fmus = joined(&fmus);
    pytest("test_checks.py", &[("SANDGATE_FMUS", &fmus)]);
}

#[test]
fn importers_get_the_reference_results() {
    let folder = scratch("reference");
    let scenes = ["tests/scenes/small_silo.toml", "tests/scenes/devices.toml"];
    let fmus = scenes.map(|scene| packed(&root().join(scene), &folder, Extent::Until(0.07)));
    let fmus = joined(&fmus.concat());
    pytest("test_reference.py", &[("SANDGATE_FMUS", &fmus)]);
}

#[test]
fn other_drivers_get_the_bits_of_the_c_interface() {
    let scene = root().join("tests/scenes/small_silo.toml");
    let [two, three] = packed(&scene, &scratch("drivers"), Extent::Until(0.0));
    let environment: [(&str, &OsStr); 4] = [
        ("SANDGATE_SCENE", scene.as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
        ("SANDGATE_FMU2", two.as_ref()),
        ("SANDGATE_FMU3", three.as_ref()),
    ];
    pytest("test_drivers.py", &environment);
}

#[test]
fn a_coupled_controller_holds_a_depth() {
    let scene = root().join("examples/coupling/chute.toml");
    let [two, three] = packed(&scene, &scratch("coupling"), Extent::Until(0.0));
    let environment: [(&str, &OsStr); 2] = [
        ("SANDGATE_FMU2", two.as_ref()),
        ("SANDGATE_FMU3", three.as_ref()),
    ];
    pytest("test_coupling.py", &environment);
}

#[test]
fn an_ensemble_survives_a_killed_worker_bit_for_bit() {
    let environment: [(&str, &OsStr); 2] = [
        ("SANDGATE_PROGRAM", env!("CARGO_BIN_EXE_sandgate").as_ref()),
        ("SANDGATE_LIBRARY", library().as_ref()),
    ];
    pytest("test_ensemble.py", &environment);
}
