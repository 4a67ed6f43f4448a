//! What a log shall be, and what became of it.

use super::error::Failure;
use crate::component::Component;
use std::path::PathBuf;

/// How a log is written.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// Instance in topics, 1 to 64 of `a-z 0-9 _ -`.
    pub instance: String,
    /// `publish_time` is simulated time and chunks are closed at communication points: two equal runs then give equal
    /// bytes. Otherwise `publish_time` is the wall clock and everything is on disk within a second.
    pub deterministic: bool,
    /// A failed write is an error of the next call; otherwise the run goes on without its log.
    pub required: bool,
    /// Particle snapshots every so many seconds of simulated time, 0 for none [s].
    pub particles_every: f64,
    /// A new file every so many seconds of simulated time, 0 for never [s].
    pub rotate_every: f64,
    /// A new file when the messages of one take so many bytes, 0 for never.
    pub rotate_bytes: u64,
    /// Whether every flush goes to the disk itself (fsync), not only the end of a file.
    pub sync_every_flush: bool,
    /// Why this file begins: "start", "resumed", "rotated", "reset", "restored".
    pub reason: String,
    /// Simulated time at which this file begins, if the component is not there yet [s].
    pub begins: Option<f64>,
    /// Files to carry along, such as modelDescription.xml: name, media type, bytes.
    pub attachments: Vec<(String, String, Vec<u8>)>,
}

impl RecordOptions {
    /// Whether a log goes over several files.
    pub(super) fn rotates(&self) -> bool {
        self.rotate_every > 0.0 || self.rotate_bytes > 0
    }

    /// What the component's scene asks for.
    #[must_use]
    pub fn of(component: &Component) -> Self {
        let scene = component.scene();
        Self {
            instance: scene.name.clone(),
            deterministic: scene.log.deterministic,
            required: scene.log.required,
            rotate_every: scene.log.rotate_every,
            rotate_bytes: scene.log.rotate_bytes,
            sync_every_flush: scene.log.sync_every_flush,
            particles_every: scene.log.particles_every,
            reason: "start".to_owned(),
            begins: None,
            attachments: Vec::new(),
        }
    }
}

/// What became of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// The file: under its final name if it is whole, else under the name that ends in `.part`.
    pub path: Option<PathBuf>,
    /// Messages in the file.
    pub messages: u64,
    /// Messages that are neither in it nor in the files before it because a write failed.
    pub dropped: u64,
    /// The first failure, of this file or one before it, if there was one.
    pub failure: Option<Failure>,
}
