//! docs/performance.md from a stored run: what was asked, what came out, what binds.

mod binds;
mod demands;
mod peers;
pub mod phases;
mod runs;
mod sweeps;

use super::kernels::Kernels;
use super::{Machine, SpeedRun};
use crate::solver::Pass;
use crate::validate::report::number;

pub use demands::{Demand, demands};

/// First line of the page.
pub const MADE: &str = "<!-- Written by `sandgate bench speed` from a stored run; do not edit. -->";

/// Smallest and largest.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    })
}

fn plane(run: &SpeedRun) -> impl Iterator<Item = &Kernels> {
    run.kernels.iter().filter(|k| k.dimension == 2)
}

fn pairs_ns(kernels: &Kernels) -> f64 {
    kernels.pass(Pass::Pairs).map_or(f64::NAN, |p| p.ns)
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// The smallest, and the range in words.
fn times(values: impl Iterator<Item = f64>) -> (f64, String) {
    let (low, high) = range(values);
    (low, format!("{low:.1} to {high:.1} times"))
}

/// The whole page. The same run gives the same bytes.
#[must_use]
pub fn text(run: &SpeedRun) -> String {
    let parts = [
        opening(run),
        sweeps::kernels(run),
        sweeps::roofline(run),
        runs::column(run),
        runs::paper_a(run),
        binds::budget(run),
        runs::sizes(run),
        runs::threads(run),
        peers::peers(run),
        how(run),
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

fn opening(run: &SpeedRun) -> String {
    let mut head = vec!["measured", "asked", "came out", "verdict"];
    // A quick run judges nothing.
    head.truncate(if run.quick { 3 } else { 4 });
    let rows: Vec<Vec<String>> = demands(run)
        .into_iter()
        .map(|d| {
            let verdict = d.verdict().to_owned();
            let mut row = vec![d.what.to_owned(), d.asked.to_owned(), d.measured, verdict];
            row.truncate(head.len());
            row
        })
        .collect();
    let warning = if run.quick {
        "**These are the small sizes and short stretches of `--quick`: they show that the measurement works and judge \
         nothing.**\n\n"
    } else {
        ""
    };
    format!(
        "{MADE}\n# Performance\n\n{warning}Where the time goes, measured by one command on {}.\n\n{}",
        where_and_when(&run.machine),
        table(&head, &rows)
    )
}

/// The machine, its load, the program and the day.
fn where_and_when(m: &Machine) -> String {
    let cores = if m.cores == 1 { "core" } else { "cores" };
    let load = m.load.map_or(String::new(), |(start, end)| {
        format!(", load {start:.1} at the start and {end:.1} at the end (1 is this measurement)")
    });
    let commit = m
        .commit
        .as_ref()
        .map_or(String::new(), |c| format!(", commit {c}"));
    format!(
        "{} {cores} of {} ({}, AVX2 {}){load}, version {}, sources {}{commit}, {}",
        m.cores,
        m.processor,
        m.system,
        if m.avx2 { "on" } else { "off" },
        m.version,
        m.sources,
        m.date,
    )
}

fn how(run: &SpeedRun) -> String {
    format!(
        "## How to repeat it\n\n```\ncargo run --release -- bench speed --page docs/performance.md\n```\n\nIt takes some minutes \
         (`--quick`: seconds, judges nothing), keeps the run in `benches/runs/`, and writes this page from it; \
         `--only-page` writes the page from a kept run. `--paper-a-budget` is the CPU time that [A]'s scheme may take pair by pair ({} s \
         here).\n\nTimes are CPU times of the thread (two threads: wall time too), so that other programs cost no time, though \
         they do take cache and memory from it. What is compared runs in turns, ratios are medians of the ratios within a round. \
         Do it on a machine that does nothing else, or believe the ratios more than the times.",
        number(run.paper_a.paper_a.cpu)
    )
}
