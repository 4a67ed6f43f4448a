//! Licences of the crates inside the shared library: the text that goes into every FMU is not stale.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::python::{root, run};

/// The texts in archives, and the packages whose libraries they are for.
const TEXTS: [(&str, &str); 2] = [
    ("src/fmi/licenses/third_party.txt", "sandgate-fmu"),
    (
        "src/fmi/licenses/third_party_zenoh.txt",
        "sandgate-fmu-zenoh",
    ),
];

/// The platform of the libraries that tests pack.
const TARGET: &str = "x86_64-unknown-linux-gnu";
const REMEDY: &str = "cargo reads the sources of all crates in Cargo.lock: is the registry reachable, or have they been fetched?";

/// A crate that is linked into the library.
struct Package {
    name: String,
    version: String,
    license: String,
    folder: PathBuf,
}

/// Crates that a library of ours needs at run time, without our own and without those that only help the compiler.
fn packages(library: &str) -> Vec<Package> {
    let tree = run(
        "cargo tree",
        Command::new(env!("CARGO"))
            .args(["tree", "-p", library, "-e", "normal,no-proc-macro"])
            .args(["--prefix", "none", "--format", "{p}", "--target", TARGET])
            .current_dir(root()),
        REMEDY,
    );
    let tree = String::from_utf8_lossy(&tree.stdout).into_owned();
    let linked: BTreeSet<(&str, &str)> = tree
        .lines()
        .filter(|line| !line.contains("sandgate"))
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            Some((words.next()?, words.next()?.trim_start_matches('v')))
        })
        .collect();
    let metadata = run(
        "cargo metadata",
        Command::new(env!("CARGO"))
            .args([
                "metadata",
                "--format-version",
                "1",
                "--filter-platform",
                TARGET,
            ])
            .current_dir(root()),
        REMEDY,
    );
    let metadata: serde_json::Value =
        serde_json::from_slice(&metadata.stdout).expect("cargo writes JSON");
    let all = metadata["packages"].as_array().expect("a list of packages");
    let text = |package: &serde_json::Value, key: &str| {
        package[key].as_str().unwrap_or_default().to_owned()
    };
    let packages = all.iter().filter_map(|package| {
        let (name, version) = (text(package, "name"), text(package, "version"));
        let manifest = text(package, "manifest_path");
        linked
            .contains(&(name.as_str(), version.as_str()))
            .then(|| Package {
                license: text(package, "license")
                    .replace('/', " OR ")
                    .replace("  ", " "),
                folder: Path::new(&manifest)
                    .parent()
                    .expect("a folder")
                    .to_path_buf(),
                name,
                version,
            })
    });
    let mut packages: Vec<Package> = packages.collect();
    packages.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    assert_eq!(packages.len(), linked.len());
    packages
}

/// Licence files of a crate, by name.
fn texts(package: &Package) -> Vec<String> {
    let mut files: Vec<PathBuf> = fs::read_dir(&package.folder)
        .expect("the crate's sources are there")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .to_lowercase();
            path.is_file()
                && ["license", "licence", "copying", "notice"]
                    .iter()
                    .any(|w| name.starts_with(w))
        })
        .collect();
    files.sort();
    let read = |path: &PathBuf| fs::read_to_string(path).expect("licences are text");
    files
        .iter()
        .map(|path| read(path).replace("\r\n", "\n").trim().to_owned())
        .collect()
}

fn written(library: &str) -> String {
    let packages = packages(library);
    let mut out = String::from(
        "Libraries inside the binaries of this FMU, and their licences. The Rust standard library is there too:\n\
         MIT OR Apache-2.0, Copyright (c) The Rust Project Contributors.\n\n",
    );
    let mut by_text: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in &packages {
        let name = format!("{} {}", package.name, package.version);
        let _ = writeln!(out, "{name}: {}", package.license);
        // Crates that may be had under Apache-2.0 have the same long text of it; once is enough, it stands in license.txt.
        for text in texts(package) {
            let apache = text.contains("Apache License") && text.len() > 8_000;
            let other = package.license.contains(" OR ");
            if !(apache && other) {
                by_text.entry(text).or_default().push(name.clone());
            }
        }
    }
    for (text, names) in by_text {
        let _ = write!(out, "\n==== {} ====\n\n{text}\n", names.join(", "));
    }
    out
}

#[test]
fn the_licences_in_fmus_are_those_of_the_crates_inside() {
    for (text, library) in TEXTS {
        let written = written(library);
        let path = root().join(text);
        if std::env::var_os("SANDGATE_REGENERATE").is_some() {
            fs::write(&path, &written).expect("the source tree is writable");
        }
        assert!(
            fs::read_to_string(&path).is_ok_and(|found| found == written),
            "{text} is stale: run SANDGATE_REGENERATE=1 cargo test --release --test it licences"
        );
    }
}
