//! The table of demands: what was asked of the program, what came out, and what became of it.

use super::{pairs_ns, percent, plane, range, times};
use crate::bench::SpeedRun;
use crate::bench::kernels::RooflineTime;
use crate::bench::scenes::{Stretch, Threads};
use crate::solver::Pass;
use crate::validate::Verdict;
use crate::validate::report::number;

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

/// The table of demands, in order.
#[must_use]
pub fn demands(run: &SpeedRun) -> Vec<Demand> {
    let mut demands = against_rivals(run).to_vec();
    demands.push(over_sizes(run));
    demands.extend(column(run));
    demands.extend(against_paper_a(run));
    demands.push(rest(run));
    demands.push(threads(run));
    demands
}

/// The pair sweep against other kernels.
fn against_rivals(run: &SpeedRun) -> [Demand; 4] {
    let roofline = |figure: fn(&RooflineTime) -> f64| {
        let kernels = plane(run).filter_map(|k| k.roofline.as_ref());
        kernels.map(figure)
    };
    let reached = range(roofline(|r| r.reached));
    let cells = times(roofline(|r| r.times_cells));
    let own = plane(run).filter_map(|k| k.pass(Pass::Pairs)?.times_plain);
    [
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
            measured: times(roofline(|r| r.times_plain)).1,
            verdict: Verdict::Reported,
        },
        Demand {
            what: "pair sweep against its own plain scalar form over the same lists",
            asked: "nothing (work for work)",
            measured: times(own).1,
            verdict: Verdict::Reported,
        },
    ]
}

fn over_sizes(run: &SpeedRun) -> Demand {
    let flat = range(plane(run).map(pairs_ns));
    let spread = flat.1 / flat.0 - 1.0;
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
    }
}

fn column(run: &SpeedRun) -> [Demand; 2] {
    let cost = |k: usize| run.column.get(k).map_or(f64::NAN, Stretch::cost);
    [
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
    ]
}

/// The column by the scheme of [A] over the default.
fn against_paper_a(run: &SpeedRun) -> [Demand; 2] {
    let (ratio, in_lanes) = (run.paper_a.ratio(), run.paper_a.ratio_in_lanes());
    let stretch = number(run.paper_a.paper_a.simulated);
    [
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
    ]
}

fn rest(run: &SpeedRun) -> Demand {
    Demand {
        what: "the pile at rest: CPU time of one simulated second in steps of 0.1 s, no log",
        asked: "under 2 ms",
        measured: run.rest.as_ref().map_or_else(
            || "it did not fall asleep".to_owned(),
            |r| format!("{} ms", number(1e3 * r.cpu)),
        ),
        verdict: judged(run.rest.as_ref().is_some_and(|r| r.cpu < 2e-3)),
    }
}

fn threads(run: &SpeedRun) -> Demand {
    let speed_ups = range(run.threads.iter().map(Threads::speed_up));
    Demand {
        what: "two threads against one, wall time, 20,000 particles and more",
        asked: "at least 1.8 times",
        measured: format!("{:.2} to {:.2} times", speed_ups.0, speed_ups.1),
        verdict: judged(speed_ups.0 >= 1.8),
    }
}
