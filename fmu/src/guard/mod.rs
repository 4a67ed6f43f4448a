//! The one room with `unsafe`: everything that a C caller hands over becomes a checked Rust value here.
//!
//! `border` holds the pointer types that exported functions take. They cannot be made in Rust: a value of such a type
//! comes from a C caller, whose side of the contract is written in the headers (a pointer is NULL or points to as many
//! elements as said, for the time of the call). So using one is safe Rust, and the other files of this package need
//! no `unsafe` but the attribute that exports a name. `handle` keeps instances, `state` saved states, `callback` the
//! importer's functions, `records` the structures of the C interface, `embedded` reads the scene inside the library.

mod border;
mod callback;
mod embedded;
mod handle;
mod records;
mod state;

pub(crate) use border::{In, Out, Plain, Text};
pub(crate) use callback::{
    Callbacks2, Environment, IntermediateUpdate3, Logger3, Pause, PlainLogger, UnusedCallback,
};
pub(crate) use embedded::embedded_scene;
#[cfg(test)]
pub(crate) use embedded::packed;
pub(crate) use handle::{Door, Handle, Need, shield};
pub(crate) use records::{CLedger, CStepReport, CVariable};
pub(crate) use state::{SavedState, StateHandle, StateSlot};

#[cfg(test)]
mod tests {
    #[test]
    fn no_other_file_needs_unsafe_but_to_export_names() {
        let files = [
            include_str!("../access.rs"),
            include_str!("../capi.rs"),
            include_str!("../fault.rs"),
            include_str!("../fmi2.rs"),
            include_str!("../fmi3.rs"),
            include_str!("../instance.rs"),
            include_str!("../journal.rs"),
            include_str!("../lib.rs"),
            include_str!("../log.rs"),
        ];
        for line in files.iter().flat_map(|file| file.lines()) {
            let code = line.split("//").next().unwrap_or_default();
            let code = code.replace("#[unsafe(no_mangle)]", "");
            assert!(!code.contains("unsafe"), "{line}");
        }
    }
}
