//! Where recordings are kept: `FOLDER/STUDY/MEMBER.json` when finished, `MEMBER.part` on the way.
//!
//! A recording belongs to its key: the SHA-256 of scene text, plan and sources. One of another key is stale: it is shown
//! on pages as such and computed again by the next run.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::{Error, Member, Recording};
use crate::units::hex;
use crate::whole_file;

/// A folder of recordings.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    sources: String,
}

impl Store {
    /// The recordings below a folder, as computed by a program with this hash of sources ([`super::SOURCES`]).
    #[must_use]
    pub fn new(folder: &Path, sources: &str) -> Self {
        Self {
            folder: folder.to_path_buf(),
            sources: sources.to_owned(),
        }
    }

    /// The key of a member, lower-case hexadecimal.
    #[must_use]
    pub fn key(&self, member: &Member) -> String {
        let mut hash = Sha256::new();
        // Lengths first, so that no two triples make the same bytes. A plan is strings and numbers: it always encodes.
        let plan = serde_json::to_string(&member.plan).unwrap_or_default();
        for part in [&self.sources, &member.scene, &plan] {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part.as_bytes());
        }
        hex(&hash.finalize())
    }

    /// What an earlier run left of a member, whatever its key; `None` if there is nothing or it cannot be read.
    #[must_use]
    pub fn any(&self, study: &str, member: &Member) -> Option<Recording> {
        let text = std::fs::read_to_string(self.path(study, member, "json")).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// A recording of exactly this member by exactly these sources.
    #[must_use]
    pub fn current(&self, study: &str, member: &Member) -> Option<Recording> {
        self.any(study, member)
            .filter(|r| r.key == self.key(member))
    }

    /// Keeps a finished or failed recording and drops what was saved on the way.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn keep(&self, study: &str, member: &Member, recording: &Recording) -> Result<(), Error> {
        let path = self.path(study, member, "json");
        let text = serde_json::to_vec(recording).map_err(|error| Error::File {
            action: "encode",
            path: path.clone(),
            source: error.into(),
        })?;
        replace(&path, &text)?;
        // A left-over part is only ever wasted space: its key is checked before it is used.
        let _ = std::fs::remove_file(self.path(study, member, "part"));
        Ok(())
    }

    /// Saves a member on its way: its recording so far and the component's state.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn save_part(
        &self,
        study: &str,
        member: &Member,
        recording: &Recording,
        state: &[u8],
    ) -> Result<(), Error> {
        let path = self.path(study, member, "part");
        let mut bytes = serde_json::to_vec(recording).map_err(|error| Error::File {
            action: "encode",
            path: path.clone(),
            source: error.into(),
        })?;
        // One line of JSON, then the state.
        bytes.push(b'\n');
        bytes.extend_from_slice(state);
        replace(&path, &bytes)
    }

    /// What was saved on the way by a run with the same key.
    #[must_use]
    pub fn part(&self, study: &str, member: &Member) -> Option<(Recording, Vec<u8>)> {
        let bytes = std::fs::read(self.path(study, member, "part")).ok()?;
        let line = bytes.iter().position(|&b| b == b'\n')?;
        let recording: Recording = serde_json::from_slice(&bytes[..line]).ok()?;
        (recording.key == self.key(member)).then(|| (recording, bytes[line + 1..].to_vec()))
    }

    /// The file of a member.
    #[must_use]
    pub fn path(&self, study: &str, member: &Member, ending: &str) -> PathBuf {
        let name = format!("{}.{ending}", member.name);
        self.folder.join(study).join(name)
    }
}

/// Writes a whole file in one go: readers see the old one or the new one, never half of it.
///
/// # Errors
/// [`Error::File`].
pub(super) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let failed = |action, path: &Path, source| Error::File {
        action,
        path: path.to_path_buf(),
        source,
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| failed("make folder", folder, e))?;
    }
    whole_file::replace(path, bytes).map_err(|e| failed("write", path, e))
}
