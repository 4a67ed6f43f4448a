//! What no run may fail, and how each is judged.

use serde::{Deserialize, Serialize};

/// Why a case failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// The program panicked.
    Panic,
    /// A step of a legal scene failed.
    Step,
    /// An output or a sum is not a finite number.
    Finite,
    /// The mass ledger is not exact.
    Mass,
    /// Momentum does not change by gravity and the walls' forces.
    Momentum,
    /// Mechanical energy grew by more than walls, inflows and dilatancy can give.
    Energy,
    /// A particle is far faster than anything in the scene could make it.
    Speed,
    /// A particle is inside a wall, or outside the container.
    Leak,
    /// The internal step collapsed.
    StepSize,
    /// Material that should rest moves.
    Rest,
    /// A scene slept through an input, or a sleeping scene moved.
    Sleep,
    /// A gate does not do what it was told.
    Gate,
    /// Time is not where the step should end.
    Time,
    /// Not the same bits after restore, with another number of threads, or watched.
    SameBits,
    /// Two runs that must end alike do not.
    Twin,
    /// What is illegal was taken, or refused without a reason, or a refusal changed something.
    Refusal,
    /// A scene that should be refused ran, or one that should run was refused.
    Expectation,
    /// More CPU time than allowed.
    Hang,
}

impl Check {
    /// All, with what each asks.
    pub const ALL: [(Check, &'static str, &'static str); 18] = [
        (Check::Panic, "panic", "the program does not panic"),
        (
            Check::Step,
            "step",
            "no step of a legal scene fails (not finite, lost from the domain, solve not converged)",
        ),
        (Check::Finite, "finite", "every output is a finite number"),
        (
            Check::Mass,
            "mass",
            "initial + inflow - outflow - present is 0 exactly, after every communication step",
        ),
        (
            Check::Momentum,
            "momentum",
            "where nothing flows in or out, momentum changes by gravity and the forces that the gauges of walls and gates \
             report, to 1e-9 of the largest of these impulses and 1e-13 of the sum of m abs(v); without walls to 1e-9 of \
             the sum of m abs(v)",
        ),
        (
            Check::Energy,
            "energy",
            "kinetic + potential energy never exceeds that of the start by more than walls, gates and inflows gave (force \
             times way), plus what the pressure may give: see below",
        ),
        (
            Check::Speed,
            "speed",
            "no particle is faster than three times what fall, start, walls, gates and inflows could give",
        ),
        (
            Check::Leak,
            "leak",
            "no particle is deeper in a wall or gate than the first row of its points, or half a spacing outside of a container's outline",
        ),
        (
            Check::StepSize,
            "step_size",
            "no internal step is below a third of the least that sound, speed limit and communication step ask for",
        ),
        (
            Check::Rest,
            "rest",
            "over the second half the centre of mass moves by less than 1 % of a spacing and kinetic energy stays below 1e-5 of the potential",
        ),
        (
            Check::Sleep,
            "sleep",
            "a scene that sleeps wakes in the very step in which a gate, an inflow or a wall is told something",
        ),
        (
            Check::Gate,
            "gate",
            "an opening stays in 0 to 1, moves no faster than max_speed, and arrives unless it says that it is blocked",
        ),
        (Check::Time, "time", "a step ends at t + h, bit for bit"),
        (
            Check::SameBits,
            "same_bits",
            "saved in the middle, restored in a new component with another number of threads and watched at every internal \
             step: the same state at the end, bit for bit",
        ),
        (
            Check::Twin,
            "twin",
            "runs that must end alike (another frame, other communication steps, sleep off) do",
        ),
        (
            Check::Refusal,
            "refusal",
            "illegal inputs and steps are refused with the reason, and change nothing",
        ),
        (
            Check::Expectation,
            "expectation",
            "an illegal scene is refused with key, found, allowed and remedy",
        ),
        (Check::Hang, "hang", "it ends: at most so much CPU time"),
    ];

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(check, ..)| *check == self)
            .map_or("", |(_, name, _)| name)
    }
}

/// A check that was failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Which one.
    pub check: Check,
    /// When, what was found, what is allowed.
    pub what: String,
}

impl Failure {
    /// At a time [s].
    #[must_use]
    pub fn at(check: Check, time: f64, what: impl std::fmt::Display) -> Self {
        Self {
            check,
            what: format!("t = {time:.6} s: {what}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_check_has_its_name_once() {
        let mut names: Vec<&str> = Check::ALL.iter().map(|(check, ..)| check.name()).collect();
        for (check, name, _) in Check::ALL {
            assert_eq!(check.name(), name);
            assert_eq!(
                serde_json::to_string(&check).unwrap(),
                format!("\"{name}\"")
            );
        }
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Check::ALL.len());
    }
}
