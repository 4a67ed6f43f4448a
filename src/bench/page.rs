//! docs/performance.md from a stored run: what was asked, what came out, what binds.

mod binds;
mod peers;
pub mod phases;
mod runs;
mod sweeps;

use super::kernels::Kernels;
use super::scenes::Stretch;
use super::{Machine, SpeedRun};
use crate::solver::Pass;
use crate::validate::Verdict;
use crate::validate::report::number;

/// First line of the page.
pub const MADE: &str = "<!-- Written by `sandgate bench speed` from a stored run; do not edit. -->";

/// One line of the table of demands.
#[derive(Clone, Debug, PartialEq)]
pub struct Demand {
    /// What is measured.
    pub what: &'static str,
    /// What was asked, in words.
    pub asked: &'static str,
    /// What came out, in words.
    pub measured: String,
    /// What became of it.
    pub verdict: Verdict,
}

impl Demand {
    /// The verdict in plain words.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match self.verdict {
            Verdict::Met => "met",
            Verdict::FallsShort | Verdict::Model => "**not met**",
            Verdict::Reported => "for comparison",
            Verdict::NoResult => "not measured",
        }
    }
}

fn judged(met: bool) -> Verdict {
    if met {
        Verdict::Met
    } else {
        Verdict::FallsShort
    }
}

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

/// The table of demands, in order.
#[must_use]
pub fn demands(run: &SpeedRun) -> Vec<Demand> {
    let roofline = || plane(run).filter_map(|k| k.roofline.as_ref());
    let reached = range(roofline().map(|r| r.reached));
    let own = || plane(run).filter_map(|k| k.pass(Pass::Pairs)?.times_plain);
    let cells = times(roofline().map(|r| r.times_cells));
    let flat = range(plane(run).map(pairs_ns));
    let spread = flat.1 / flat.0 - 1.0;
    let cost = |k: usize| run.column.get(k).map_or(f64::NAN, Stretch::cost);
    let (ratio, in_lanes) = (run.paper_a.ratio(), run.paper_a.ratio_in_lanes());
    let stretch = number(run.paper_a.paper_a.simulated);
    let mut demands = vec![
        Demand {
            what: "pair sweep against the roofline kernel (pairs a second, plane, h/dp 1.6, one core)",
            asked: "at least 65 %",
            measured: format!(
                "{} to {} over all sizes",
                percent(reached.0),
                percent(reached.1)
            ),
            verdict: judged(reached.0 >= 0.65),
        },
        Demand {
            what: "pair sweep against the plain scalar kernel that searches cells (pairs a second)",
            asked: "at least 4 times",
            measured: cells.1,
            verdict: judged(cells.0 >= 4.0),
        },
        Demand {
            what: "pair sweep against the plain scalar kernel over neighbour lists",
            asked: "nothing (a faster rival)",
            measured: times(roofline().map(|r| r.times_plain)).1,
            verdict: Verdict::Reported,
        },
        Demand {
            what: "pair sweep against its own plain scalar form over the same lists",
            asked: "nothing (work for work)",
            measured: times(own()).1,
            verdict: Verdict::Reported,
        },
        Demand {
            what: "pair sweep, cost a particle over particle counts",
            asked: "flat within 30 % from 2,000 to 500,000",
            measured: format!(
                "{:.0} to {:.0} ns, {} apart",
                flat.0,
                flat.1,
                percent(spread)
            ),
            verdict: judged(spread <= 0.3),
        },
        Demand {
            what: "column a = 0.90, exact yield: CPU time of one simulated second",
            asked: "at most 3 s",
            measured: format!("{:.2} s", cost(0)),
            verdict: judged(cost(0) <= 3.0),
        },
        Demand {
            what: "the same with the plain cap",
            asked: "at most 1.5 s",
            measured: format!("{:.2} s", cost(2)),
            verdict: judged(cost(2) <= 1.5),
        },
        Demand {
            what: "the same by `paper_a` (plain scalar sweeps) over the default, same simulated time",
            asked: "at least 250 times the CPU time",
            measured: format!("{ratio:.0} times over the first {stretch} s"),
            verdict: judged(ratio >= 250.0),
        },
        Demand {
            what: "the same by `paper_a` on the same kernels",
            asked: "at least 60 times",
            measured: format!("{in_lanes:.0} times over the first {stretch} s"),
            verdict: judged(in_lanes >= 60.0),
        },
        Demand {
            what: "the pile at rest: CPU time of one simulated second in steps of 0.1 s, no log",
            asked: "under 2 ms",
            measured: run.rest.as_ref().map_or_else(
                || "it did not fall asleep".to_owned(),
                |r| format!("{} ms", number(1e3 * r.cpu)),
            ),
            verdict: judged(run.rest.as_ref().is_some_and(|r| r.cpu < 2e-3)),
        },
    ];
    let speed_ups = range(run.threads.iter().map(super::scenes::Threads::speed_up));
    demands.push(Demand {
        what: "two threads against one, wall time, 20,000 particles and more",
        asked: "at least 1.8 times",
        measured: format!("{:.2} to {:.2} times", speed_ups.0, speed_ups.1),
        verdict: judged(speed_ups.0 >= 1.8),
    });
    demands
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
