//! What several phases cost a scene that has none of them: in one run, in turns.

use serde::{Deserialize, Serialize};

use super::scenes::{self, Phases};
use super::{Error, Machine};

/// All that docs/phases.md reports.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhasesRun {
    /// Where and when.
    pub machine: Machine,
    /// Whether it was a quick one.
    pub quick: bool,
    /// Repetitions, of which each step's median counts.
    pub repeats: usize,
    /// What was found.
    pub phases: Phases,
}

/// Times the scenes. `watch` hears the share that is done.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn run(quick: bool, watch: &mut dyn FnMut(f64)) -> Result<PhasesRun, Error> {
    let mut machine = Machine::here();
    let (simulated, repeats) = if quick { (0.02, 1) } else { (0.5, 5) };
    let phases = scenes::phases(simulated, repeats, watch)?;
    machine.finish();
    Ok(PhasesRun {
        machine,
        quick,
        repeats,
        phases,
    })
}
