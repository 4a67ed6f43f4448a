//! Puts a hash of everything that can change a result into the program: the sources up to `component`, the manifest and
//! the lock file. `sandgate validate` keeps finished runs by it, so that a new help text does not compute a study again.
//!
//! Another one goes on over `fmi`: by it packing knows a library that describes a scene as the program does.

use std::path::{Path, PathBuf};

/// Modules of rank 0 to 6 in ARCHITECTURE.md; what lies above them changes no bit of a result.
const MODULES: [&str; 10] = [
    "math",
    "units",
    "kernel",
    "material",
    "shape",
    "state",
    "boundary",
    "solver",
    "scene",
    "component",
];

fn main() {
    let mut files: Vec<PathBuf> = vec!["Cargo.toml".into(), "Cargo.lock".into()];
    for module in MODULES.iter().chain(&["gauge"]) {
        collect_module(module, &mut files);
    }
    println!("cargo:rerun-if-changed=Cargo.toml");
    println!("cargo:rerun-if-changed=Cargo.lock");
    let mut hash = FNV_START;
    mix_files(&mut hash, files);
    println!("cargo:rustc-env=SANDGATE_SOURCES={hash:016x}");
    let mut files = Vec::new();
    collect_module("fmi", &mut files);
    mix_files(&mut hash, files);
    println!("cargo:rustc-env=SANDGATE_LIBRARY_SOURCES={hash:016x}");
}

fn collect_module(name: &str, files: &mut Vec<PathBuf>) {
    let path = Path::new("src").join(name);
    println!("cargo:rerun-if-changed={}", path.display());
    collect(&path, files);
}

fn mix_files(hash: &mut u64, mut files: Vec<PathBuf>) {
    files.sort();
    for file in &files {
        mix(hash, file.to_string_lossy().as_bytes());
        // A packed crate has no lock file: its absence is as good a fact as its content.
        mix(hash, &std::fs::read(file).unwrap_or_default());
    }
}

/// Files below a path, or the path itself.
fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    match std::fs::read_dir(path) {
        Ok(entries) => {
            for entry in entries.flatten() {
                collect(&entry.path(), files);
            }
        }
        Err(_) => files.push(path.to_path_buf()),
    }
}

/// FNV-1a, 64 bits: short enough to stand here, and the same with every compiler.
const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;

fn mix(hash: &mut u64, bytes: &[u8]) {
    for byte in bytes {
        *hash = (*hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    }
}
