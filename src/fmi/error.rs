//! What can go wrong while packing. Every message says what was found, what is allowed and what to do.

use std::path::PathBuf;

/// Errors of packing an FMU.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene could not be built.
    #[error(transparent)]
    Component(#[from] crate::component::Error),
    /// The shared library was not found and could not be built.
    #[error("{0}")]
    Library(String),
    /// The file is not a shared library of this program.
    #[error(
        "{path} is not this program's shared library: {found}; build it with `cargo build --release -p sandgate-fmu`, one with Zenoh with -p sandgate-fmu-zenoh"
    )]
    WrongLibrary {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        found: String,
    },
    /// The scene text is too long for the library's slot.
    #[error(
        "the scene has {found} bytes, an FMU holds up to {allowed}; shorten its polylines or schedules"
    )]
    SceneTooLong {
        /// Bytes of the scene.
        found: usize,
        /// Bytes of the slot.
        allowed: usize,
    },
    /// A file could not be read or written.
    #[error("cannot {action} {path}: {source}")]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
