//! What is kept of a campaign: every scene that was tried, one line each, and their summary.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{Campaign, Error, Figures, Tried, generate};
use crate::bench::Machine;
use crate::validate::SOURCES;

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
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let mut lines = text.lines();
        let known: Vec<Tried> = if lines.next() == Some(&head) {
            // A line that was cut by a kill is tried again.
            lines
                .filter_map(|line| serde_json::from_str(line).ok())
                .collect()
        } else {
            Vec::new()
        };
        let mut file = std::fs::File::create(&path).map_err(failed("write"))?;
        let mut text = head + "\n";
        for tried in &known {
            text += &line(tried);
        }
        file.write_all(text.as_bytes()).map_err(failed("write"))?;
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
        self.file
            .write_all(line(tried).as_bytes())
            .map_err(|source| Error::File {
                action: "write",
                path: self.path.clone(),
                source,
            })
    }
}

fn line(tried: &Tried) -> String {
    // Numbers and text always encode.
    serde_json::to_string(tried).unwrap_or_default() + "\n"
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
    // Numbers, flags and text always encode.
    let text = serde_json::to_string_pretty(run).unwrap_or_default() + "\n";
    write_text(path, &text)
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
    std::fs::write(path, text).map_err(failed("write"))
}
