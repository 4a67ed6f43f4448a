//! The column by [A]'s scheme beside the default.

use serde::{Deserialize, Serialize};

use super::{COLUMN, Runner, Stretch, template};
use crate::bench::Error;

/// Row 3 of [A]'s table by its scheme as printed.
const PAPER_A: &str = include_str!("../../../cases/paper_a/column_3.toml");

/// [A]'s scheme as printed beside the default, over the same simulated time from the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgainstPaperA {
    /// [A]'s scheme, its sums pair by pair.
    pub paper_a: Stretch,
    /// The same on the default's kernels.
    pub lanes: Stretch,
    /// The default with the exact yield.
    pub default: Stretch,
    /// Ends of the windows [s], and in each CPU time of [A]'s scheme over that of the default.
    pub windows: Vec<(f64, f64)>,
}

impl AgainstPaperA {
    /// CPU time of [A]'s scheme, pair by pair, over that of the default.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.paper_a.cpu / self.default.cpu
    }

    /// CPU time of [A]'s scheme on the default's kernels over that of the default.
    #[must_use]
    pub fn ratio_in_lanes(&self) -> f64 {
        self.lanes.cpu / self.default.cpu
    }
}

/// Steps all three in turn until [A]'s scheme, pair by pair, has taken `budget` CPU seconds or `latest` simulated seconds are over.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn against_paper_a(
    budget: f64,
    latest: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<AgainstPaperA, Error> {
    /// Communication step [s]: short, so that the budget is kept; a few internal steps of the default.
    const STEP: f64 = 0.002;
    let form = |name: &str, sweeps: &str| {
        let template = template(PAPER_A, name)?.with("numerics.sweeps", sweeps);
        Runner::new(name, &template)
    };
    let mut paper_a = form("paper_a, pair by pair", "plain")?;
    let mut lanes = form("paper_a, the default's kernels", "lanes")?;
    let mut default = Runner::new("default", &template(COLUMN, "default")?)?;
    let mut spent = 0.0;
    while spent < budget && paper_a.component.time() < latest - 0.5 * STEP {
        paper_a.step(STEP)?;
        lanes.step(STEP)?;
        default.step(STEP)?;
        spent += paper_a.cpu.last().copied().unwrap_or(f64::INFINITY);
        watch((spent / budget).max(paper_a.component.time() / latest));
    }
    let steps = paper_a.cpu.len();
    // Of 20 ms, or longer ones where that would be many.
    let window = 10 * steps.div_ceil(100).max(1);
    let windows = (1..=steps).filter(|n| n % window == 0).map(|n| {
        let of = |cpu: &[f64]| cpu[n - window..n].iter().sum::<f64>();
        (n as f64 * STEP, of(&paper_a.cpu) / of(&default.cpu))
    });
    Ok(AgainstPaperA {
        windows: windows.collect(),
        paper_a: paper_a.stretch(),
        lanes: lanes.stretch(),
        default: default.stretch(),
    })
}
