//! The one room with `unsafe`: everything that a C caller hands over becomes a checked Rust value here.
//!
//! `border` holds the pointer types that exported functions take. They cannot be made in Rust: a value of such a type
//! comes from a C caller, whose side of the contract is written in the headers (a pointer is NULL or points to as many
//! elements as said, for the time of the call). So using one is safe Rust, and the other files of this package need
//! no `unsafe` but the attribute that exports a name. `handle` keeps instances, `state` saved states, `callback` the
//! importer's functions, `arithmetic` how the thread computes on either side, `launch` starts threads, `records` the structures
//! of the C interface, `embedded` reads the scene inside the library.

mod arithmetic;
mod border;
mod callback;
mod embedded;
mod handle;
mod launch;
mod records;
mod state;

pub(crate) use arithmetic::inside;
pub(crate) use border::{In, Out, Plain, Text};
pub(crate) use callback::{
    Callbacks2, Environment, IntermediateUpdate3, Logger3, Pause, PlainLogger, UnusedCallback,
};
pub(crate) use embedded::embedded_scene;
#[cfg(test)]
pub(crate) use embedded::packed;
pub(crate) use handle::{Door, Handle, Need, shield};
pub(crate) use launch::spare_callers_thread;
pub(crate) use records::{CLedger, CStepReport, CVariable};
pub(crate) use state::{SavedState, StateHandle, StateSlot};

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    /// Files of the library outside this room. The contract suite calls the exported functions as C does.
    fn others(folder: &Path) -> Vec<PathBuf> {
        let mut found = Vec::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if matches!(name.as_str(), "guard" | "contract" | "contract.rs") {
                continue;
            }
            match path.is_dir() {
                true => found.extend(others(&path)),
                false => found.push(path),
            }
        }
        found
    }

    #[test]
    fn no_other_file_needs_unsafe_but_to_export_names() {
        let files = others(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
        let seen = |name: &str| files.iter().any(|file| file.ends_with(name));
        assert!(seen("capi.rs") && seen("journal/network.rs"), "{files:?}");
        for file in files {
            for line in std::fs::read_to_string(&file).unwrap().lines() {
                let code = line.split("//").next().unwrap_or_default();
                let code = code.replace("#[unsafe(no_mangle)]", "");
                assert!(!code.contains("unsafe"), "{}: {line}", file.display());
            }
        }
    }
}
