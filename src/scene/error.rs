//! What is wrong with a scene file: every problem with its file, line, key, what was found, what is allowed
//! and what to do. Found by `raw` and `lift`; read by people.

use std::fmt;

/// One problem of a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// File name as it was given.
    pub file: String,
    /// Line, from 1; 0 if the file as a whole is meant.
    pub line: usize,
    /// Path of the key: `bodies.fill.box.lower[0]`; empty for the file as a whole.
    pub key: String,
    /// What was found.
    pub found: String,
    /// What is allowed.
    pub allowed: String,
    /// What to do.
    pub remedy: String,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        write!(f, "\n  found:   {}", self.found)?;
        write!(f, "\n  allowed: {}", self.allowed)?;
        write!(f, "\n  remedy:  {}", self.remedy)
    }
}

impl std::error::Error for SceneError {}

/// Every problem of a scene file, in the order of its lines; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneErrors {
    problems: Vec<SceneError>,
}

impl SceneErrors {
    /// Sorts problems by line. `problems` must not be empty.
    pub(super) fn new(mut problems: Vec<SceneError>) -> Self {
        debug_assert!(!problems.is_empty(), "an error without a problem");
        problems.sort_by_key(|p| p.line);
        Self { problems }
    }

    /// The problems, by line.
    #[must_use]
    pub fn problems(&self) -> &[SceneError] {
        &self.problems
    }
}

impl fmt::Display for SceneErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for problem in &self.problems {
            writeln!(f, "{problem}")?;
        }
        match self.problems.len() {
            1 => write!(f, "1 problem"),
            n => write!(f, "{n} problems"),
        }
    }
}

impl std::error::Error for SceneErrors {}
