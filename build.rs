//! Puts a hash of everything that can change a result into the program: the sources up to `component`, the manifest and
//! the lock file. `sandgate validate` keeps finished runs by it, so that a new help text does not compute a study again.

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
        let path = Path::new("src").join(module);
        println!("cargo:rerun-if-changed={}", path.display());
        collect(&path, &mut files);
    }
    println!("cargo:rerun-if-changed=Cargo.toml");
    println!("cargo:rerun-if-changed=Cargo.lock");
    files.sort();
    let mut hash = FNV_START;
    for file in &files {
        mix(&mut hash, file.to_string_lossy().as_bytes());
        // A packed crate has no lock file: its absence is as good a fact as its content.
        mix(&mut hash, &std::fs::read(file).unwrap_or_default());
    }
    println!("cargo:rustc-env=SANDGATE_SOURCES={hash:016x}");
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
