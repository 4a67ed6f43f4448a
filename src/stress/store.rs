//! What is kept of a campaign: every scene that was tried, one line each, and their summary.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{Campaign, Error, Figures, Tried, generate};
use crate::bench::Machine;
use crate::validate::SOURCES;
use crate::whole_file;

/// What was tried so far, in a file to which each scene is added: a campaign goes on from it.
pub struct Journal {
    path: PathBuf,
    file: std::fs::File,
    known: Vec<Tried>,
}

impl Journal {
    /// The journal `tried.jsonl` of a folder. One of another campaign or another program is begun anew.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn open(folder: &Path, campaign: &Campaign) -> Result<Self, Error> {
        let path = folder.join("tried.jsonl");
        let failed = |action| {
            let path = path.clone();
            move |source| Error::File {
                action,
                path,
                source,
            }
        };
        std::fs::create_dir_all(folder).map_err(failed("make the folder of"))?;
        let head = json!({
            "sources": SOURCES, "checks": env!("CARGO_PKG_VERSION"), "seed": campaign.seed,
            "count": campaign.count, "kind": campaign.kind, "cpu": campaign.bounds.cpu,
        })
        .to_string();
        let text = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            // Not begun anew: what cannot be read now may be days of work.
            Err(error) => return Err(failed("read")(error)),
        };
        let mut lines = text.lines();
        let known: Vec<Tried> = if lines.next() == Some(&head) {
            // A line that was cut by a kill is tried again.
            lines
                .filter_map(|line| serde_json::from_str(line).ok())
                .collect()
        } else {
            Vec::new()
        };
        let mut text = head + "\n";
        for tried in &known {
            text += &line(&path, tried)?;
        }
        whole_file::replace(&path, text.as_bytes()).map_err(failed("write"))?;
        let added_to = std::fs::File::options().append(true).open(&path);
        let file = added_to.map_err(failed("write"))?;
        Ok(Self { path, file, known })
    }

    /// What an earlier run of the same campaign tried.
    #[must_use]
    pub fn known(&self) -> &[Tried] {
        &self.known
    }

    /// Adds one.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn add(&mut self, tried: &Tried) -> Result<(), Error> {
        let line = line(&self.path, tried)?;
        self.file
            .write_all(line.as_bytes())
            .map_err(|source| Error::File {
                action: "write",
                path: self.path.clone(),
                source,
            })
    }
}

fn line(path: &Path, tried: &Tried) -> Result<String, Error> {
    let line = serde_json::to_string(tried).map_err(|error| not_encoded(path, error))?;
    Ok(line + "\n")
}

fn not_encoded(path: &Path, error: serde_json::Error) -> Error {
    Error::File {
        action: "encode",
        path: path.to_path_buf(),
        source: error.into(),
    }
}

/// What became of the scenes of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfKind {
    /// The kind.
    pub kind: String,
    /// Scenes.
    pub scenes: u64,
    /// Of these, failed ones.
    pub failed: u64,
    /// The worst of each figure; `simulated`, `cpu` and steps are sums, `reach` and `kinetic` are left out.
    pub figures: Figures,
    /// Sum over scenes of most particles times internal steps.
    pub particle_steps: u64,
    /// Scenes that slept at some time.
    pub slept: u64,
}

/// The summary of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressRun {
    /// Where and when.
    pub machine: Machine,
    /// First seed and number of scenes.
    pub seed: u64,
    /// Number of scenes that were tried.
    pub count: u64,
    /// Only this kind, if any.
    pub kind: Option<String>,
    /// Scenes side by side.
    pub jobs: usize,
    /// CPU time that each was allowed [s].
    pub cpu_limit: f64,
    /// Wall time of the last sitting [s].
    pub wall: f64,
    /// By kind.
    pub kinds: Vec<OfKind>,
    /// All that failed.
    pub failed: Vec<Tried>,
}

impl StressRun {
    /// Of what was tried.
    #[must_use]
    pub fn new(campaign: &Campaign, tried: &[Tried], wall: f64) -> Self {
        let mut kinds: BTreeMap<&str, OfKind> = BTreeMap::new();
        for one in tried {
            let sum = kinds.entry(&one.kind).or_insert_with(|| OfKind {
                kind: one.kind.clone(),
                figures: Figures {
                    least_step: f64::INFINITY,
                    ..Figures::default()
                },
                ..OfKind::default()
            });
            let (all, f) = (&mut sum.figures, &one.figures);
            sum.scenes += 1;
            sum.failed += u64::from(!one.failures.is_empty());
            sum.slept += u64::from(f.slept);
            sum.particle_steps += f.particles * f.internal_steps;
            all.particles = all.particles.max(f.particles);
            all.communication_steps += f.communication_steps;
            all.internal_steps += f.internal_steps;
            all.simulated += f.simulated;
            all.cpu += f.cpu;
            all.energy_excess = all.energy_excess.max(f.energy_excess);
            all.momentum_error = all.momentum_error.max(f.momentum_error);
            all.speed_share = all.speed_share.max(f.speed_share);
            all.deepest = all.deepest.max(f.deepest);
            all.creep = all.creep.max(f.creep);
            if f.internal_steps > 0 {
                all.least_step = all.least_step.min(f.least_step);
            }
        }
        for sum in kinds.values_mut() {
            if !sum.figures.least_step.is_finite() {
                sum.figures.least_step = 0.0;
            }
        }
        let order = |kind: &OfKind| {
            let place = generate::KINDS.iter().position(|k| k.name == kind.kind);
            place.unwrap_or(usize::MAX)
        };
        let mut kinds: Vec<OfKind> = kinds.into_values().collect();
        kinds.sort_by_key(order);
        Self {
            machine: Machine::here(),
            seed: campaign.seed,
            count: tried.len() as u64,
            kind: campaign.kind.clone(),
            jobs: campaign.jobs,
            cpu_limit: campaign.bounds.cpu,
            wall,
            kinds,
            failed: tried
                .iter()
                .filter(|t| !t.failures.is_empty())
                .cloned()
                .collect(),
        }
    }

    /// CPU time of all steps [s].
    #[must_use]
    pub fn cpu(&self) -> f64 {
        self.kinds.iter().map(|k| k.figures.cpu).sum()
    }

    /// A table for a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let mut lines = vec![format!(
            "{:10} {:>6} {:>6} {:>9} {:>8} {:>9} {:>9} {:>8}",
            "kind", "scenes", "failed", "steps", "CPU s", "energy", "momentum", "in wall"
        )];
        for k in &self.kinds {
            let f = &k.figures;
            lines.push(format!(
                "{:10} {:>6} {:>6} {:>9} {:>8.1} {:>9.1e} {:>9.1e} {:>8.2}",
                k.kind,
                k.scenes,
                k.failed,
                f.internal_steps,
                f.cpu,
                f.energy_excess,
                f.momentum_error,
                f.deepest
            ));
        }
        let failed = self.failed.len();
        lines.push(format!(
            "{} scenes, {failed} failed, {:.1} s of CPU time in steps",
            self.count,
            self.cpu()
        ));
        lines.join("\n")
    }
}

/// Keeps a run.
///
/// # Errors
/// [`Error::File`].
pub fn write<T: Serialize>(path: &Path, run: &T) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(run).map_err(|error| not_encoded(path, error))?;
    write_text(path, &(text + "\n"))
}

/// Reads a kept run.
///
/// # Errors
/// [`Error::File`]; [`Error::Content`] for what is no such run.
pub fn read<T: for<'d> Deserialize<'d>>(path: &Path) -> Result<T, Error> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::File {
        action: "read",
        path: path.to_path_buf(),
        source,
    })?;
    serde_json::from_str(&text).map_err(|error| Error::Content {
        path: path.to_path_buf(),
        problem: format!("{error}; it was kept by another version: run it anew"),
    })
}

/// Writes a file and its folder.
///
/// # Errors
/// [`Error::File`].
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    let failed = |action| {
        move |source| Error::File {
            action,
            path: path.to_path_buf(),
            source,
        }
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed("make the folder of"))?;
    }
    whole_file::replace(path, text.as_bytes()).map_err(failed("write"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::Bounds;

    #[test]
    fn a_journal_with_a_line_cut_by_a_kill_is_gone_on_from() {
        let folder = temp_dir::TempDir::new().unwrap();
        let campaign = Campaign {
            seed: 5,
            count: 2,
            kind: None,
            jobs: 1,
            bounds: Bounds::default(),
        };
        let tried = Tried {
            kind: "illegal".to_owned(),
            seed: 5,
            failures: Vec::new(),
            figures: Figures::default(),
        };
        let mut journal = Journal::open(folder.path(), &campaign).unwrap();
        journal.add(&tried).unwrap();
        drop(journal);
        let path = folder.path().join("tried.jsonl");
        let whole = std::fs::read(&path).unwrap();
        // Cut within a letter.
        let mut bytes = whole.clone();
        bytes.extend(b"{\"kind\":\"\xc3");
        std::fs::write(&path, bytes).unwrap();
        let journal = Journal::open(folder.path(), &campaign).unwrap();
        assert_eq!(journal.known(), [tried]);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
