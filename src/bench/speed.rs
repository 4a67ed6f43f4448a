//! Where the time goes: everything that docs/performance.md reports, in one run.

use serde::{Deserialize, Serialize};

use super::kernels::{self, Kernels};
use super::scenes::{self, AgainstPaperA, Rest, Stretch, Threads};
use super::{Error, Machine};

/// What a run may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choices {
    /// Small sizes and short stretches that take seconds: to see that all works, not to judge.
    pub quick: bool,
    /// CPU time that [A]'s scheme may take, above 0 [s].
    pub paper_a_budget: f64,
}

/// All that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedRun {
    /// Where and when.
    pub machine: Machine,
    /// Whether it was a quick one.
    pub quick: bool,
    /// Sweeps alone, by dimension and size.
    pub kernels: Vec<Kernels>,
    /// The column, one simulated second unless quick: default, sleep off, plain cap, plain cap with sleep off.
    pub column: Vec<Stretch>,
    /// The pile at rest; `None` if it did not fall asleep.
    pub rest: Option<Rest>,
    /// The column by [A]'s scheme.
    pub paper_a: AgainstPaperA,
    /// The column against resolution.
    pub sizes: Vec<Stretch>,
    /// Two threads.
    pub threads: Vec<Threads>,
}

/// How far a run is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Share of the expected work done, 0 to 1.
    pub share: f64,
    /// What is being timed.
    pub what: String,
}

/// Steps before the timed ones, timed steps, rounds: of the threads' comparison by size.
type Window = (f64, (usize, usize), usize);

/// Sizes and lengths of a run.
struct Plan {
    plane: &'static [usize],
    space: &'static [usize],
    rounds: usize,
    column: (f64, usize),
    /// Latest time at which the pile may fall asleep [s].
    rest: f64,
    paper_a: f64,
    sizes: (&'static [f64], f64),
    threads: &'static [Window],
}

const FULL: Plan = Plan {
    plane: &[2_000, 8_000, 32_000, 125_000, 500_000],
    space: &[8_000, 125_000],
    rounds: 11,
    column: (1.0, 3),
    rest: 20.0,
    paper_a: 1.0,
    sizes: (&[1.0, 2.0, 4.0], 0.05),
    threads: &[(20e3, (60, 6), 15), (100e3, (20, 3), 7)],
};

const QUICK: Plan = Plan {
    plane: &[500, 2_000],
    space: &[1_000],
    rounds: 3,
    column: (0.02, 1),
    rest: 0.2,
    paper_a: 0.002,
    sizes: (&[0.5, 1.0], 0.01),
    threads: &[(3e3, (2, 2), 2)],
};

impl Plan {
    /// Expected CPU time of each part in turn, if [A]'s scheme may take so much [s].
    fn expected(&self, paper_a_budget: f64) -> Vec<f64> {
        let size = |count: &usize| *count as f64 * self.rounds as f64 * 4e-6;
        let mut parts: Vec<f64> = self.plane.iter().map(size).collect();
        parts.extend(self.space.iter().map(|count| 5.0 * size(count)));
        let (simulated, repeats) = self.column;
        parts.push(20.0 * simulated * repeats as f64);
        parts.push(1.5 * self.rest);
        // Pair by pair, and in lanes.
        parts.push(1.7 * paper_a_budget.min(1300.0 * self.paper_a));
        let (refinements, simulated) = self.sizes;
        let finer = refinements.iter().map(|r| 4.0 * simulated * r.powi(3));
        parts.push(finer.sum());
        for (count, (before, steps), rounds) in self.threads {
            parts.push(count * 4e-6 * (before + 2 * rounds * steps) as f64);
        }
        parts
    }
}

/// Adds the parts' progress up.
struct Tally<'a> {
    /// Expected seconds of the parts to come.
    parts: std::vec::IntoIter<f64>,
    done: f64,
    total: f64,
    watch: &'a mut dyn FnMut(Progress),
}

impl Tally<'_> {
    /// Does the next part, which tells its share done.
    fn part<R>(&mut self, what: &'static str, work: impl FnOnce(&mut dyn FnMut(f64)) -> R) -> R {
        let weight = self.parts.next().unwrap_or(0.0);
        let (done, total) = (self.done, self.total);
        let watch = &mut *self.watch;
        let result = work(&mut |share| {
            let share = (done + weight * share.min(1.0)) / total;
            watch(Progress {
                share,
                what: what.to_owned(),
            });
        });
        self.done += weight;
        result
    }
}

/// Times everything. `watch` hears how far it is.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn run(choices: &Choices, watch: &mut dyn FnMut(Progress)) -> Result<SpeedRun, Error> {
    let plan = if choices.quick { QUICK } else { FULL };
    let mut machine = Machine::here();
    let parts = plan.expected(choices.paper_a_budget);
    let mut tally = Tally {
        done: 0.0,
        total: parts.iter().sum(),
        parts: parts.into_iter(),
        watch,
    };
    let mut kernels = Vec::new();
    for count in plan.plane {
        kernels.push(tally.part("sweeps in the plane", |tell| {
            kernels::measure::<2>(*count, plan.rounds, tell)
        }));
    }
    for count in plan.space {
        kernels.push(tally.part("sweeps in space", |tell| {
            kernels::measure::<3>(*count, plan.rounds, tell)
        }));
    }
    let (simulated, repeats) = plan.column;
    let column = tally.part("the column", |tell| {
        scenes::column(simulated, repeats, tell)
    })?;
    let rest = tally.part("the pile at rest", |tell| scenes::rest(plan.rest, tell))?;
    let paper_a = tally.part("the column by scheme paper_a", |tell| {
        scenes::against_paper_a(choices.paper_a_budget, plan.paper_a, tell)
    })?;
    let (refinements, simulated) = plan.sizes;
    let sizes = tally.part("finer columns", |tell| {
        scenes::sizes(refinements, simulated, tell)
    })?;
    let mut threads = Vec::new();
    for (count, window, rounds) in plan.threads {
        threads.push(tally.part("two threads", |tell| {
            scenes::threads(*count, *window, *rounds, tell)
        })?);
    }
    machine.finish();
    Ok(SpeedRun {
        machine,
        quick: choices.quick,
        kernels,
        column,
        rest,
        paper_a,
        sizes,
        threads,
    })
}
