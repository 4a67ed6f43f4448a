//! Our FMUs in other people's hands: checkers, drivers, coupled examples. Packed here, driven in tests/python.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

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

/// FMUs of every case, packed once for all tests: FMI 2, FMI 3, FMI 2, ...
fn of_all_cases() -> &'static [PathBuf] {
    static FMUS: OnceLock<Vec<PathBuf>> = OnceLock::new();
    FMUS.get_or_init(|| {
        let folder = scratch("checks");
        let cases = ["cases", "cases/paper_a", "cases/phases"]
            .map(scenes)
            .concat();
        assert!(cases.len() > 20);
        let pack = |case: &PathBuf| packed(case, &folder, Extent::Until(0.0));
        cases.iter().flat_map(pack).collect()
    })
}

#[test]
fn every_case_s_fmus_pass_all_checks() {
    let fmus = joined(of_all_cases());
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
    let cases: Vec<PathBuf> = of_all_cases().iter().step_by(2).cloned().collect();
    let cases = joined(&cases);
    let environment: [(&str, &OsStr); 5] = [
        ("SANDGATE_CASES", &cases),
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

#[test]
fn a_silted_dam_is_an_fmu_like_any_other() {
    let scene = root().join("cases/silted_dam_reduced.toml");
    let [two, three] = packed(&scene, &scratch("dam"), Extent::Until(0.0));
    let environment: [(&str, &OsStr); 3] = [
        ("SANDGATE_FMU2", two.as_ref()),
        ("SANDGATE_FMU3", three.as_ref()),
        ("SANDGATE_PROGRAM", env!("CARGO_BIN_EXE_sandgate").as_ref()),
    ];
    pytest("test_dam.py", &environment);
}
