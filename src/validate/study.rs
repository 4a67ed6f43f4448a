//! What a study is: members to run and an analysis of what they recorded.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{Recording, Report};

/// How much to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What the verdicts are made from.
    Full,
    /// Coarser, shorter or fewer runs, to see that all works; pages say so.
    Quick,
}

impl Effort {
    /// `full` or `quick`, whichever it is.
    #[must_use]
    pub fn pick<T>(self, full: T, quick: T) -> T {
        match self {
            Self::Full => full,
            Self::Quick => quick,
        }
    }
}

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Name within its study, `[a-z0-9_.]+`: also that of its file.
    pub name: String,
    /// The scene file's text; `run.step` and `run.until` say how it is stepped.
    pub scene: String,
    /// What to keep.
    pub plan: Plan,
    /// CPU time a particle step costs, over that of the default scheme [1]: only for the time left.
    pub relative_cost: f64,
}

/// What a run keeps.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Plan {
    /// Variables kept at every communication point, by name.
    pub series: Vec<String>,
    /// Times at which particles are kept [s]: at the first communication point not before each.
    pub snapshots: Vec<f64>,
}

impl Member {
    /// A member of the default scheme.
    #[must_use]
    pub fn new(name: String, scene: String, series: &[&str], snapshots: Vec<f64>) -> Self {
        let series = series.iter().map(|&name| name.to_owned()).collect();
        Self {
            name,
            scene,
            plan: Plan { series, snapshots },
            relative_cost: 1.0,
        }
    }
}

/// A validation study.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Name on the command line and of its page.
    pub name: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// What is compared with what, and how: Markdown, the page's first part.
    pub about: &'static str,
    /// The runs.
    ///
    /// # Errors
    /// Text: a template and its edits do not fit, a defect of the study.
    pub members: fn(Effort) -> Result<Vec<Member>, String>,
    /// Metrics, tables and figures from what is there; members may be missing or failed.
    ///
    /// # Errors
    /// Text: a figure cannot be drawn or reference data are broken.
    pub analyse: fn(&Results) -> Result<Report, String>,
}

/// Recordings of a study's members, by name.
#[derive(Clone, Debug)]
pub struct Results {
    /// How much was computed.
    pub effort: Effort,
    /// Folder with reference data that are not part of the program, if the user gave one.
    data: Option<PathBuf>,
    recordings: BTreeMap<String, Recording>,
}

impl Results {
    /// From recordings, finished or failed.
    #[must_use]
    pub fn new(effort: Effort, data: Option<&Path>, recordings: Vec<(String, Recording)>) -> Self {
        Self {
            effort,
            data: data.map(Path::to_path_buf),
            recordings: recordings.into_iter().collect(),
        }
    }

    /// A file of reference data that is not part of the program; `None` if the user gave no folder.
    ///
    /// # Errors
    /// The folder does not hold the file, or it cannot be read.
    pub fn data(&self, name: &str) -> Result<Option<String>, String> {
        let Some(path) = self.data.as_ref().map(|folder| folder.join(name)) else {
            return Ok(None);
        };
        let text = std::fs::read_to_string(&path);
        text.map(Some)
            .map_err(|error| format!("{}: {error}", path.display()))
    }

    /// A member that ran to its end.
    #[must_use]
    pub fn finished(&self, name: &str) -> Option<&Recording> {
        self.recordings.get(name).filter(|r| r.is_finished())
    }

    /// Members whose names begin so and that ran to their end, in order of name.
    pub fn starting<'a, 'p>(
        &'a self,
        prefix: &'p str,
    ) -> impl Iterator<Item = (&'a str, &'a Recording)> + use<'a, 'p> {
        self.all()
            .filter(move |(name, r)| name.starts_with(prefix) && r.is_finished())
    }

    /// All members there are, in order of name.
    pub fn all(&self) -> impl Iterator<Item = (&str, &Recording)> {
        self.recordings.iter().map(|(name, r)| (name.as_str(), r))
    }
}
