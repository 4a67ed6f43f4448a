//! What velocity the viscous solve starts from (docs/theory.md, E9): v* with the last viscous acceleration, and a share of how
//! that changed in the last step.
//!
//! The share is what would have been best in the step before: near 1 where the flow speeds up or slows down evenly, -1/2
//! where accelerations are noise. The count of iterations depends on it, and where steps have two acoustic ones the plastic rate that the
//! yield's first iteration starts from; the solve ends at the same tolerance.

use crate::math::{Vector, dot, sub};
use crate::state::State;

use super::Solver;

impl<const D: usize> Solver<D> {
    /// The first guess of the velocity at the end of the step [m/s].
    pub(super) fn guess(&self, state: &State<D>, dt: f64, velocity: &mut [Vector<D>]) {
        let (a, change) = (
            &state.grains.viscous_acceleration,
            &state.grains.viscous_change,
        );
        let (prediction, trend) = (&self.prediction, state.trend);
        self.workers.each(velocity, |i, v| {
            let start = &prediction[i].velocity;
            *v = std::array::from_fn(|k| start[k] + dt * (a[i][k] + trend * change[i][k]));
        });
    }

    /// Keeps the accelerations of the solve that is done, and how well a change tells the next one.
    pub(super) fn note_accelerations(&self, state: &mut State<D>, dt: f64) {
        let (new, prediction) = (&self.viscous.velocity, &self.prediction);
        let grains = &mut state.grains;
        let mass = &grains.mass;
        let [along, square] = self.workers.both(
            &mut grains.viscous_acceleration,
            &mut grains.viscous_change,
            |i, a, change| {
                let start = &prediction[i].velocity;
                let now = std::array::from_fn(|k| (new[i][k] - start[k]) / dt);
                let fresh = sub(&now, a);
                let parts = [dot(&fresh, change), dot(change, change)];
                (*a, *change) = (now, fresh);
                parts.map(|part| mass[i] * part)
            },
        );
        state.trend = if square > 0.0 {
            (along / square).clamp(-0.5, 1.0)
        } else {
            0.0
        };
    }
}
