//! Runs a case with all checks.

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::{Deserialize, Serialize};

use crate::component::{Component, Error};
use crate::math::panic_text;
use crate::scene::{Scene, SceneErrors};

use super::checks::{Check, Failure};
use super::ride::{Done, Ride};
use super::witness::Witness;
use super::{Case, Expect, others, refusals};

/// What a case may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// CPU time of all steps of one run of it [s]: more is a hang.
    pub cpu: f64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self { cpu: 60.0 }
    }
}

/// What was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Most particles at a communication point.
    pub particles: u64,
    /// Communication steps.
    pub communication_steps: u64,
    /// Internal steps.
    pub internal_steps: u64,
    /// Simulated time [s].
    pub simulated: f64,
    /// CPU time in steps [s].
    pub cpu: f64,
    /// Largest growth of energy over what was given, over M g H [1].
    pub energy_excess: f64,
    /// Largest miss of momentum over what the check allows [1].
    pub momentum_error: f64,
    /// Largest share of a particle's neighbourhood that is wall [1]: 0.5 at a wall's surface.
    pub deepest: f64,
    /// Largest speed over what the check allows [1].
    pub speed_share: f64,
    /// Least internal step over the acoustic bound (or the communication step, if that is less) [1].
    pub least_step: f64,
    /// Of rests: how far the centre of mass moved in the second half, over the spacing [1].
    pub creep: f64,
    /// Largest x of any particle at the end [m].
    pub reach: f64,
    /// Kinetic energy at the end over M g H [1].
    pub kinetic: f64,
    /// Whether it slept at some time.
    pub slept: bool,
}

/// What a case came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Checks that it failed; none if all is well.
    pub failures: Vec<Failure>,
    /// What was measured.
    pub figures: Figures,
    /// Why the scene was refused, if it was.
    pub refused: Option<String>,
}

impl Outcome {
    /// The first failure.
    #[must_use]
    pub fn failure(&self) -> Option<&Failure> {
        self.failures.first()
    }

    fn failed(check: Check, what: impl Into<String>) -> Self {
        let what = what.into();
        Self {
            failures: vec![Failure { check, what }],
            ..Self::default()
        }
    }
}

/// Runs a case.
#[must_use]
pub fn run(case: &Case, bounds: &Bounds) -> Outcome {
    catch_unwind(AssertUnwindSafe(|| unguarded(case, bounds)))
        .unwrap_or_else(|cause| Outcome::failed(Check::Panic, panic_text(cause.as_ref())))
}

fn unguarded(case: &Case, bounds: &Bounds) -> Outcome {
    let scene = match (case.scene(), case.drive.expect) {
        (Ok(scene), Expect::Run) => scene,
        (Ok(_), Expect::Refusal) => {
            return Outcome::failed(Check::Expectation, "an illegal scene was taken");
        }
        (Err(problems), Expect::Refusal) => return refused(&problems),
        (Err(problems), Expect::Run) => {
            return Outcome {
                refused: Some(problems.to_string()),
                ..Outcome::failed(Check::Expectation, format!("refused: {problems}"))
            };
        }
    };
    ridden(case, &scene, bounds)
}

/// A refusal says where, what was found, what is allowed and what to do.
fn refused(problems: &SceneErrors) -> Outcome {
    let bare = problems
        .problems()
        .iter()
        .find(|p| p.found.is_empty() || p.allowed.is_empty() || p.remedy.is_empty());
    match bare {
        Some(problem) => Outcome::failed(Check::Expectation, format!("says too little: {problem}")),
        None => Outcome {
            refused: Some(problems.to_string()),
            ..Outcome::default()
        },
    }
}

fn ridden(case: &Case, scene: &Scene, bounds: &Bounds) -> Outcome {
    let mut ride = match Ride::new(case, scene, bounds.cpu) {
        Ok(ride) => ride,
        Err(error) => {
            return Outcome {
                refused: Some(error.to_string()),
                ..Outcome::failed(Check::Expectation, format!("refused: {error}"))
            };
        }
    };
    let mut witness = Witness::new(&ride, &case.drive);
    witness
        .failures
        .extend(refusals::probe(&mut ride.component));
    let watched = watch(&mut ride, &mut witness, case.drive.restore_after);
    witness.figures.cpu = ride.cpu;
    if ride.is_hung() {
        let what = format!("{:.1} s of CPU time, allowed {} s", ride.cpu, bounds.cpu);
        witness
            .failures
            .push(Failure::at(Check::Hang, ride.component.time(), what));
    }
    let (mut failures, figures) = (witness.failures, witness.figures);
    // One that did not come to where the first look failed says nothing against it.
    if let Some(time) = watched.energy_at.filter(|_| !scene.gates.is_empty())
        && let Some(closer) = energy_in_pieces(case, scene, bounds, (time, ride.component.time()))
    {
        failures.retain(|failure| failure.check != Check::Energy);
        failures.extend(closer);
    }
    if failures.is_empty() {
        if let Some((from, saved)) = watched.saved {
            let saved = saved.map_err(|e| e.to_string());
            failures.extend(others::same_bits(&ride, case, saved, &watched.done[from..]));
        }
        if let Some(twin) = &case.drive.twin {
            failures.extend(others::twin(&ride.component, case, twin, bounds));
        }
    }
    Outcome {
        failures,
        figures,
        refused: None,
    }
}

/// What is kept of a ride for the checks after it.
#[derive(Default)]
struct Watched {
    done: Vec<Done>,
    /// The state to go back to, and how many steps were done by then; none if it did not come so far.
    saved: Option<(usize, Result<Vec<u8>, Error>)>,
    /// When the check of energy first failed [s].
    energy_at: Option<f64>,
}

/// Goes to the end or to the first step that fails, with the witness beside; saves the state after so many steps.
fn watch(ride: &mut Ride, witness: &mut Witness, restore_after: usize) -> Watched {
    let mut watched = Watched::default();
    loop {
        if ride.index == restore_after && watched.saved.is_none() {
            watched.saved = Some((watched.done.len(), ride.component.save()));
        }
        let (start, wanted) = (ride.component.time(), ride.wanted());
        match ride.next() {
            None => break,
            Some(Ok(step)) => {
                witness.look(&ride.component, &step, start, &wanted);
                witness.count(&step);
                watched.done.push(step);
                if watched.energy_at.is_none() && energy_failure(&witness.failures).is_some() {
                    watched.energy_at = Some(ride.component.time());
                }
            }
            Some(Err(error)) => {
                witness
                    .failures
                    .push(Failure::at(Check::Step, start, error));
                break;
            }
        }
    }
    watched
}

fn energy_failure(failures: &[Failure]) -> Option<&Failure> {
    failures
        .iter()
        .find(|failure| failure.check == Check::Energy)
}

/// The check of energy once more with a gate's work taken force by force: over a long communication step only the mean
/// force on a plate is known, and it need not be the one while the plate moved. Each way counts with the mean of the forces
/// before and after it. It goes to `end` [s]; None if it does not come to `failed` [s], without a failure.
fn energy_in_pieces(
    case: &Case,
    scene: &Scene,
    bounds: &Bounds,
    (failed, end): (f64, f64),
) -> Option<Option<Failure>> {
    let mut ride = Ride::new(case, scene, bounds.cpu).ok()?.in_pieces();
    let mut witness = Witness::new(&ride, &case.drive).in_pieces();
    // Sums of pieces are rounded otherwise than steps.
    let before = |time: f64, other: f64| time < other * (1.0 - 1e-9);
    loop {
        let (start, wanted) = (ride.component.time(), ride.wanted());
        if !before(start, end) {
            return Some(None);
        }
        match ride.next() {
            None if before(start, failed) => return None,
            None => return Some(None),
            Some(Ok(step)) => witness.look(&ride.component, &step, start, &wanted),
            Some(Err(error)) => return Some(Some(Failure::at(Check::Step, start, error))),
        }
        if let Some(failure) = energy_failure(&witness.failures) {
            return Some(Some(failure.clone()));
        }
    }
}

/// The component's state after a case without checks, for comparisons.
///
/// # Errors
/// Why it did not come to its end.
pub(super) fn end_of(case: &Case, bounds: &Bounds) -> Result<Component, String> {
    let scene = case.scene().map_err(|e| e.to_string())?;
    let mut ride = Ride::new(case, &scene, bounds.cpu).map_err(|e| e.to_string())?;
    while let Some(step) = ride.next() {
        step.map_err(|e| e.to_string())?;
    }
    Ok(ride.component)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::generate;

    #[test]
    fn a_closer_look_that_ends_early_does_not_acquit() {
        let gated = (1..200).find_map(|seed| {
            let case = generate::of_kind(generate::kind_of(seed).name, seed).ok()?;
            let scene = case.scene().ok()?;
            (!scene.gates.is_empty() && case.drive.count > 1).then_some((case, scene))
        });
        let (case, scene) = gated.unwrap();
        // No CPU time is left after the first step.
        let look = |failed| energy_in_pieces(&case, &scene, &Bounds { cpu: 0.0 }, (failed, 1e3));
        assert_eq!(look(1e3), None);
        assert_eq!(look(0.0), Some(None));
    }
}
