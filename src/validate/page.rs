//! Pages of docs/validation: one a study, and the index of all.
//!
//! A page holds no date and no path, so that writing it again from the same recordings gives the same bytes. Its second
//! line is a summary for programs: the index and `--list` are made from it.

mod text;

use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::report::number;
use super::store::replace;
use super::{Effort, Error, Member, Recording, Report, Store, Study, Table, Verdict};
use crate::units::hex;

/// First line of every page.
const MADE: &str = "<!-- Written by `sandgate validate`; do not edit. -->";
const SUMMARY: &str = "<!-- summary: ";

/// What a page says, for the index.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Whether the runs were those of `--quick`.
    pub quick: bool,
    /// Metrics met.
    pub met: usize,
    /// Metrics whose shortfall is the model's.
    #[serde(default)]
    pub model: usize,
    /// Metrics that fall short.
    pub short: usize,
    /// Metrics without a result.
    pub missing: usize,
    /// Members with a recording, and members in all.
    pub members: (usize, usize),
    /// Largest number of particles.
    pub particles: u64,
    /// CPU time of all members [s].
    pub cpu: f64,
    /// Hash of the sources of each recording, without repetition.
    pub sources: Vec<String>,
    /// Hash of the keys of all recordings: another one means that the page is older than they are.
    pub recordings: String,
}

/// Where a page stands against the recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// There is no page.
    None,
    /// It was written from other recordings than those there are now.
    Stale,
    /// It says what the recordings say.
    Current,
}

/// A study's recordings as the store has them, in the order of its members; stale ones too.
#[derive(Debug)]
pub struct Found {
    /// Whether they are the quick ones.
    pub effort: Effort,
    /// The members.
    pub members: Vec<Member>,
    /// What is kept of each.
    pub recordings: Vec<Option<Recording>>,
    /// How many were computed by other sources or from another scene.
    pub outdated: usize,
}

impl Found {
    /// Looks for a study's members.
    ///
    /// # Errors
    /// [`Error::Defect`] if the study cannot name its members.
    pub fn new(study: &Study, effort: Effort, store: &Store) -> Result<Self, Error> {
        let members = members(study, effort)?;
        let recordings: Vec<_> = members.iter().map(|m| store.any(study.name, m)).collect();
        let pairs = members.iter().zip(&recordings);
        let outdated = pairs
            .filter(|(m, r)| r.as_ref().is_some_and(|r| r.key != store.key(m)))
            .count();
        Ok(Self {
            effort,
            members,
            recordings,
            outdated,
        })
    }

    fn there(&self) -> impl Iterator<Item = (&Member, &Recording)> {
        let pairs = self.members.iter().zip(&self.recordings);
        pairs.filter_map(|(member, recording)| Some((member, recording.as_ref()?)))
    }

    fn hash(&self) -> String {
        let mut hash = Sha256::new();
        for (member, recording) in self.there() {
            hash.update(member.name.as_bytes());
            hash.update(recording.key.as_bytes());
        }
        hex(&hash.finalize()[..8])
    }
}

/// A study's members.
///
/// # Errors
/// [`Error::Defect`].
pub fn members(study: &Study, effort: Effort) -> Result<Vec<Member>, Error> {
    (study.members)(effort).map_err(|problem| Error::Defect {
        study: study.name.to_owned(),
        member: "all".to_owned(),
        problem,
    })
}

impl Summary {
    fn of(found: &Found, report: &Report) -> Self {
        let recordings: Vec<&Recording> = found.there().map(|(_, r)| r).collect();
        let mut sources: Vec<String> = recordings.iter().map(|r| r.sources.clone()).collect();
        sources.sort();
        sources.dedup();
        Self {
            quick: found.effort == Effort::Quick,
            met: report.count(Verdict::Met),
            model: report.count(Verdict::Model),
            short: report.count(Verdict::FallsShort),
            missing: report.count(Verdict::NoResult),
            members: (recordings.len(), found.members.len()),
            particles: recordings.iter().map(|r| r.particles).max().unwrap_or(0),
            cpu: recordings.iter().map(|r| r.cpu).sum(),
            sources,
            recordings: found.hash(),
        }
    }

    /// The summary of a page's text.
    #[must_use]
    pub fn read(page: &str) -> Option<Self> {
        let line = page.lines().find_map(|line| line.strip_prefix(SUMMARY))?;
        serde_json::from_str(line.strip_suffix(" -->")?).ok()
    }

    /// The verdict in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let judged = self.met + self.model + self.short + self.missing;
        if self.quick {
            return format!(
                "quick runs, not judged ({} of {judged} inside their tolerance)",
                self.met
            );
        }
        let also = |count: usize, what: &str| match count {
            0 => String::new(),
            _ => format!(", {count} {what}"),
        };
        let model = also(self.model, "the model's");
        match (self.short, self.missing) {
            (0, 0) if judged > 0 => format!("met ({judged} of {judged}{model})"),
            (0, 0) => "reported only".to_owned(),
            (0, missing) => format!("incomplete ({missing} of {judged} without a result{model})"),
            (short, missing) => {
                let missing = also(missing, "without a result");
                format!("falls short ({short} of {judged}{missing}{model})")
            }
        }
    }
}

/// Where a study's page in `folder` stands against its recordings.
#[must_use]
pub fn standing(folder: &Path, study: &Study, found: &Found) -> Standing {
    let page = std::fs::read_to_string(folder.join(format!("{}.md", study.name)));
    match page.ok().as_deref().and_then(Summary::read) {
        None => Standing::None,
        Some(summary) if summary.recordings == found.hash() => Standing::Current,
        Some(_) => Standing::Stale,
    }
}

/// Analyses what there is of a study and writes its page and figures into `folder`; answers what the page says. `data`:
/// folder with reference data that are not part of the program.
///
/// # Errors
/// [`Error::File`], [`Error::Figure`] and [`Error::Defect`] if the analysis cannot be made.
pub fn write(
    folder: &Path,
    study: &Study,
    found: &Found,
    data: Option<&Path>,
) -> Result<Summary, Error> {
    let recordings = found.there().map(|(m, r)| (m.name.clone(), r.clone()));
    let results = super::Results::new(found.effort, data, recordings.collect());
    let report = (study.analyse)(&results).map_err(|problem| Error::Figure {
        name: study.name.to_owned(),
        problem,
    })?;
    for figure in &report.figures {
        let file = folder.join(format!("{}_{}.svg", study.name, figure.name));
        replace(&file, figure.svg.as_bytes())?;
    }
    let summary = Summary::of(found, &report);
    let text = text::text(study, found, &report, &summary);
    replace(&folder.join(format!("{}.md", study.name)), text.as_bytes())?;
    Ok(summary)
}

/// Writes the index of all studies from the pages that are there.
///
/// # Errors
/// [`Error::File`].
pub fn write_index(folder: &Path, studies: &[Study]) -> Result<(), Error> {
    replace(&folder.join("README.md"), index(folder, studies).as_bytes())
}

/// The text of the index of all studies, from the pages in a folder.
#[must_use]
pub fn index(folder: &Path, studies: &[Study]) -> String {
    let mut rows = Vec::new();
    for study in studies {
        let page = std::fs::read_to_string(folder.join(format!("{}.md", study.name)));
        rows.push(match page.ok().as_deref().and_then(Summary::read) {
            Some(s) => vec![
                format!("[{}]({}.md)", study.name, study.name),
                study.title.to_owned(),
                s.verdict(),
                format!("{} of {}", s.members.0, s.members.1),
                s.particles.to_string(),
                number(s.cpu),
                s.sources.join(", "),
            ],
            None => {
                let mut row = vec![String::new(); 7];
                row[..3].clone_from_slice(&[
                    study.name.to_owned(),
                    study.title.to_owned(),
                    "not run yet".to_owned(),
                ]);
                row
            }
        });
    }
    let head = [
        "study",
        "what is compared",
        "verdict",
        "runs",
        "largest [particles]",
        "CPU [s]",
        "sources",
    ];
    let table = Table {
        title: String::new(),
        head: head.map(str::to_owned).to_vec(),
        rows,
    };
    format!(
        "{MADE}\n# Validation\n\n\
         Sandgate against published data and exact solutions. Every figure and number on these pages is written by\n\
         `sandgate validate`, from runs of the component; none is typed by hand. What falls short stands here as such.\n\n\
         {}\n\
         - **met**: inside the tolerance that stands, with its reason, beside the number.\n\
         - **the model's**: outside of it, but not by the scheme: spacing, start, sound speed and yield iterations, where\n  \
         there are any, each changed on its own, together change the number by less than 3 %. What is left is how the model\n  \
         differs from the source.\n\
         - **falls short**: outside of it.\n\
         - **reported**: not judged: another model, a law for another geometry, or a figure for information.\n\n\
         `sources` is a hash of all source files that can change a result, also in the program that ran them: runs of\n\
         other sources are computed again. CPU times are of one thread a run, unless its page says otherwise. The published data and where they come from:\n\
         [cases/reference](../../cases/reference/SOURCE.md).\n",
        text::markdown(&table)
    )
}
