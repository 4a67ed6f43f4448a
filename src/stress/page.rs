//! docs/stability.md from stored runs: what was tried, what failed and its fix, the map of limits, broken builds.

mod campaign;
mod map;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::limits::LimitsRun;
use super::store::{self, StressRun};
use super::{Case, Check, Error};
use crate::bench::Machine;

/// First line of the page.
pub const MADE: &str =
    "<!-- Written by `sandgate stress --only-page` from stored runs; do not edit. -->";

/// A build that was broken on purpose, and what the harness said of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Broken {
    /// What was broken.
    pub what: String,
    /// The change, as `diff -U0` has it.
    pub diff: String,
    /// The command.
    pub command: String,
    /// Lines that it printed.
    pub printed: Vec<String>,
}

/// A case of cases/stress: its name, the lines before it, the case.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// File name.
    pub name: String,
    /// Comment lines, without `#`.
    pub head: Vec<String>,
    /// The case.
    pub case: Case,
}

/// Everything that the page is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// The campaign.
    pub run: StressRun,
    /// The map.
    pub limits: LimitsRun,
    /// Broken builds.
    pub broken: Vec<Broken>,
    /// Cases that failed once and pass.
    pub fixed: Vec<Kept>,
    /// Cases that still fail.
    pub open: Vec<Kept>,
}

impl Stored {
    /// From the folder of stored runs and that of kept cases.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Content`].
    pub fn read(runs: &Path, cases: &Path) -> Result<Self, Error> {
        Ok(Self {
            run: store::read(&runs.join("stress.json"))?,
            limits: store::read(&runs.join("limits.json"))?,
            broken: store::read(&runs.join("broken_builds.json"))?,
            fixed: kept(cases)?,
            open: kept(&cases.join("open"))?,
        })
    }
}

/// The cases of a folder, by name.
///
/// # Errors
/// [`Error::File`], [`Error::Content`].
pub fn kept(folder: &Path) -> Result<Vec<Kept>, Error> {
    let failed = |source| Error::File {
        action: "read",
        path: folder.to_path_buf(),
        source,
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(failed)?;
        let head = text.lines().map_while(|line| line.strip_prefix("# "));
        let case = Case::read(&text).map_err(|problem| Error::Content {
            path: path.clone(),
            problem,
        })?;
        found.push(Kept {
            name: path
                .file_name()
                .map_or(String::new(), |n| n.to_string_lossy().into_owned()),
            head: head.map(str::to_owned).collect(),
            case,
        });
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// The whole page.
#[must_use]
pub fn text(stored: &Stored) -> String {
    let parts = [
        opening(stored),
        campaign::checks(),
        campaign::kinds(stored),
        campaign::bounds(stored),
        campaign::cases(stored),
        map::map(&stored.limits),
        broken(&stored.broken),
        faults(),
        missing(),
    ];
    parts.join("\n\n") + "\n"
}

fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        text.push_str(&format!("| {} |\n", row.join(" | ")));
    }
    text.trim_end().to_owned()
}

fn machine(m: &Machine) -> String {
    format!(
        "{} cores of {} ({}), version {}, sources {}{}, {}",
        m.cores,
        m.processor,
        m.system,
        m.version,
        m.sources,
        m.commit
            .as_ref()
            .map_or(String::new(), |c| format!(", commit {c}")),
        m.date
    )
}

fn opening(stored: &Stored) -> String {
    let run = &stored.run;
    let failed = run.failed.len();
    let steps: u64 = run.kinds.iter().map(|k| k.figures.internal_steps).sum();
    let work: u64 = run.kinds.iter().map(|k| k.particle_steps).sum();
    let mut by_check: Vec<String> = Vec::new();
    for (check, name, _) in Check::ALL {
        let first = |t: &&super::Tried| t.failures.first().is_some_and(|f| f.check == check);
        let count = run.failed.iter().filter(first).count();
        if count > 0 {
            by_check.push(format!("{count} {name}"));
        }
    }
    let verdict = if failed == 0 {
        "none failed a check".to_owned()
    } else {
        format!(
            "**{failed} failed** ({}): see \"Cases\" for the open ones",
            by_check.join(", ")
        )
    };
    format!(
        "{MADE}\n# Stability\n\n`sandgate stress` makes scenes at random, drives them at random, holds every step against the \
         checks below, and makes what fails smaller until it is a small case file. The last campaign: **{} scenes** (seeds {} \
         to {}) in one sitting of {:.0} s on {} job{}, {} internal steps, {:.1} million particle steps, {:.0} s of CPU \
         time; {verdict}. Measured on {}.\n\n```\nsandgate stress --count {} --jobs {} --store benches/runs\nsandgate stress \
         --limits --store benches/runs\nsandgate stress --only-page --page docs/stability.md\nsandgate stress \
         cases/stress/heap-95.toml          # a kept case again\nsandgate stress --kind silo --seed 42 --count 1     # one scene of a \
         campaign\n```\n\nThe test command runs the first 200 seeds and all kept cases.",
        run.count,
        run.seed,
        run.seed + run.count.max(1) - 1,
        run.wall,
        run.jobs,
        if run.jobs == 1 { "" } else { "s" },
        steps,
        work as f64 / 1e6,
        run.cpu(),
        machine(&run.machine),
        run.count,
        run.jobs,
    )
}

fn broken(builds: &[Broken]) -> String {
    let mut text = "## Broken on purpose\n\nBuilds with one line changed, each in a scratch copy of the tree, and what the harness said."
        .to_owned();
    for build in builds {
        text.push_str(&format!(
            "\n\n**{}**\n\n```diff\n{}\n```\n\n```\n$ {}\n{}\n```",
            build.what,
            build.diff.trim_end(),
            build.command,
            build.printed.join("\n")
        ));
    }
    text
}

/// The tests are `tests/it/faults.rs`.
fn faults() -> String {
    let rows = [
        (
            "a stop in mid-step, the state saved there and gone on with on another number of threads",
            "the same state, bit for bit, and mass to 0; every campaign scene that is cut after so many internal steps does so too",
        ),
        (
            "more particles than memory",
            "more than 5e7 (or 1e9 cells of the neighbour grid where the domain repeats) are refused before any memory is asked for: key, line, how many particles, use a coarser spacing; fewer, where \
             what they take (about 5 kB each in the plane, 12 kB in space) is not to be had, before the first of them is made",
        ),
        (
            "a disk that is full while the log is written",
            "the run stops with the log's name, what was kept, and how to go on without a log; exit code 5",
        ),
        (
            "fewer cores than threads asked for (64 on 2)",
            "the same bits; a machine that starts none computes in the calling thread",
        ),
    ];
    let rows: Vec<Vec<String>> = rows
        .iter()
        .map(|(what, then)| vec![(*what).to_owned(), (*then).to_owned()])
        .collect();
    format!(
        "## Faults from outside\n\nPart of the test command (`cargo test --test it faults`).\n\n{}",
        table(&["fault", "what happens"], &rows)
    )
}

fn missing() -> String {
    "## What is not tried\n\nS22 (convergence over three resolutions) needs more than 500 particles: it is part of `sandgate validate`. \
     S23 (gravity flips) and S24 (a floor that vibrates) need gravity and walls whose motion changes with time; there are \
     none. Sweeps use one thread below 512 particles, so that only kind `threads` compares numbers of threads."
        .to_owned()
}
