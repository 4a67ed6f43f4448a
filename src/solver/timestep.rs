//! Length of the internal step: its bounds, one function a bound (docs/theory.md, E13), and how they end at a given time.

use crate::state::State;

use super::devices::course;
use super::{Scheme, Solver, SolverError, StepBound, StepInputs};

/// Most that a plate moves in a step, over h [1].
pub(super) const MOST_OF_A_PLATE: f64 = 0.1;
/// Largest relative speed over c0 in steps of several acoustic steps [1], of what rests, creeps and begins to move. What flows
/// fast or crashes compresses within one of them (docs/decisions/014-two-acoustic-steps.md).
const SLOW: f64 = 0.03;

impl<const D: usize> Solver<D> {
    /// Neighbours and walls move at most 0.2 h against each other in a step, which is one acoustic step where they are fast.
    fn motion_bound(&self, state: &State<D>) -> f64 {
        let (rows, rings) = (&self.kinematics, &self.rings);
        let [v] = self.workers.largest(rows.len(), |i| {
            let own = rows[i].relative_speed;
            // The image across the axis comes as fast.
            let meets_image = rings.get(i).is_some_and(|ring| ring.axis != 0.0);
            [if meets_image {
                own.max(2.0 * state.grains.velocity[i][0].abs())
            } else {
                own
            }]
        });
        if v > 0.0 {
            let bound = 0.2 * self.kernel.h / v;
            if v > SLOW * self.numerics.sound_speed {
                bound.min(self.numerics.acoustic_step())
            } else {
                bound
            }
        } else {
            f64::INFINITY
        }
    }

    /// Plates move at most 0.1 h in a step: while one is to move a step is no longer, nor need it be shorter than an acoustic step.
    fn gate_bound(&self, state: &State<D>, wanted: &[f64]) -> f64 {
        let gates = state.gates.iter().zip(wanted).zip(&self.plates);
        let moving = gates.filter(|((gate, wanted), _)| gate.opening != **wanted);
        let fastest = moving.fold(0.0, |v, (_, plate)| f64::max(v, plate.max_speed));
        self.device_bound(fastest)
    }

    /// Bound of a step in which a device sets off that moves this fast [m/s].
    fn device_bound(&self, fastest: f64) -> f64 {
        if fastest > 0.0 {
            (MOST_OF_A_PLATE * self.kernel.h / fastest).max(self.numerics.acoustic_step())
        } else {
            f64::INFINITY
        }
    }

    /// Steered walls that move as a whole likewise, while they are to move otherwise than they do: neighbours know of it a step later.
    fn drive_bound(&self, state: &State<D>, wanted: &[(f64, f64)]) -> f64 {
        let drives = self.drives.iter().zip(&state.drives).zip(wanted);
        let changing = drives.filter(|((drive, at), (told, slope))| {
            *slope != 0.0 || !drive.is_settled(course(at), *told)
        });
        let fastest = changing.fold(0.0, |v, ((drive, _), _)| f64::max(v, drive.speed));
        self.device_bound(fastest)
    }

    /// Largest stable step now, and what bounds it.
    pub(super) fn step_bound(
        &self,
        state: &State<D>,
        inputs: &StepInputs<'_>,
    ) -> Result<(f64, StepBound), SolverError> {
        let time = state.time;
        let mut best = (self.numerics.longest_step(), StepBound::Acoustic);
        let devices = self.gate_bound(state, inputs.openings);
        let devices = devices.min(self.drive_bound(state, inputs.drives));
        let motion = self.motion_bound(state).min(devices);
        if motion < best.0 {
            // Fast motion asks for one acoustic step, and that is then what bounds.
            let acoustic = motion == self.numerics.acoustic_step();
            best.0 = motion;
            best.1 = if acoustic {
                StepBound::Acoustic
            } else {
                StepBound::Motion
            };
        }
        let smallest = 1e-6 * self.numerics.longest_step();
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

    /// The stable step, shortened so that equal steps end at `end`.
    pub(super) fn choose_step(
        &self,
        state: &State<D>,
        inputs: &StepInputs<'_>,
        end: f64,
    ) -> Result<(f64, StepBound), SolverError> {
        let (stable, bound) = match self.numerics.scheme {
            Scheme::Implicit => self.step_bound(state, inputs)?,
            Scheme::PaperA(_) => self.bound_paper_a(state.time)?,
            Scheme::PaperB(_) => self.bound_paper_b(state)?,
        };
        let left = end - state.time;
        let count = (left / stable - 1e-9).ceil().max(1.0);
        if count <= 1.0 {
            Ok((
                left,
                if left < 0.999 * stable {
                    StepBound::Communication
                } else {
                    bound
                },
            ))
        } else {
            Ok((left / count, bound))
        }
    }
}
