//! Bounds of the internal step, one function a bound (docs/theory.md, E13).

use super::{Solver, SolverError, StepBound};

impl<const D: usize> Solver<D> {
    /// dt <= courant h / c0.
    #[must_use]
    pub fn acoustic_bound(&self) -> f64 {
        self.numerics.courant * self.kernel.h / self.numerics.sound_speed
    }

    /// Neighbours and walls move at most 0.2 h against each other in a step.
    fn motion_bound(&self) -> f64 {
        let rows = &self.kinematics;
        let [v] = self
            .workers
            .largest(rows.len(), |i| [rows[i].relative_speed]);
        if v > 0.0 {
            0.2 * self.kernel.h / v
        } else {
            f64::INFINITY
        }
    }

    /// Largest stable step now, and what bounds it.
    pub(super) fn step_bound(&self, time: f64) -> Result<(f64, StepBound), SolverError> {
        let mut best = (self.acoustic_bound(), StepBound::Acoustic);
        let motion = self.motion_bound();
        if motion < best.0 {
            best = (motion, StepBound::Motion);
        }
        let smallest = 1e-6 * self.acoustic_bound();
        if best.0 < smallest {
            return Err(SolverError::StepCollapsed {
                time,
                step: best.0,
                bound: best.1.name(),
                smallest,
            });
        }
        Ok(best)
    }
}
