//! Places in a file and the problems found there: reading goes on after each, so that all are told at once.

use crate::scene::error::SceneError;

/// Where something stands: byte offset in the file and path of the key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::scene) struct Place {
    /// Byte offset in the file.
    pub(in crate::scene) offset: usize,
    /// Path of the key: `bodies.fill.box.lower[0]`.
    pub(in crate::scene) key: String,
}

impl Place {
    /// The place of a key that this table lacks.
    pub(in crate::scene) fn child(&self, key: &str) -> Place {
        Place {
            offset: self.offset,
            key: join(&self.key, key),
        }
    }
}

fn join(parent: &str, key: &str) -> String {
    if parent.is_empty() {
        key.to_owned()
    } else {
        format!("{parent}.{key}")
    }
}

/// Collects problems while reading goes on.
pub(in crate::scene) struct Problems {
    file: String,
    line_starts: Vec<usize>,
    found: Vec<SceneError>,
}

/// Most problems reported for one file: a file with more is broken in one place that shows early.
const MOST: usize = 100;

impl Problems {
    /// An empty collection for `file` with this `text`.
    pub(in crate::scene) fn new(file: &str, text: &str) -> Self {
        let newlines = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            file: file.to_owned(),
            line_starts: std::iter::once(0).chain(newlines).collect(),
            found: Vec::new(),
        }
    }

    /// Adds a problem.
    pub(in crate::scene) fn report(
        &mut self,
        at: &Place,
        found: impl Into<String>,
        allowed: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        if self.found.len() >= MOST {
            return;
        }
        self.found.push(SceneError {
            file: self.file.clone(),
            line: self.line_starts.partition_point(|&s| s <= at.offset),
            key: at.key.clone(),
            found: found.into(),
            allowed: allowed.into(),
            remedy: remedy.into(),
        });
    }

    /// The problems so far.
    pub(in crate::scene) fn into_vec(self) -> Vec<SceneError> {
        self.found
    }

    /// Whether there are none.
    pub(in crate::scene) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }
}

/// The place of a syntax error, which belongs to no key.
pub(in crate::scene) fn syntax_place(offset: usize) -> Place {
    Place {
        offset,
        key: String::new(),
    }
}
