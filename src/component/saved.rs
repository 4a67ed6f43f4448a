//! What of a simulation is saved, and whether saved bytes are of this scene.

use serde::{Deserialize, Serialize};

use super::sampling::Sampler;
use super::snapshot;
use crate::solver::Solver;
use crate::state::{Grains, State};

/// What is saved: the state, and what sections have counted.
#[derive(Serialize, Deserialize)]
pub(super) struct Saved<const D: usize> {
    pub(super) state: State<D>,
    pub(super) crossed: Vec<f64>,
}

impl<const D: usize> Saved<D> {
    /// A copy of the state, with the counts of its sections.
    pub(super) fn of(state: &State<D>, sampler: &Sampler<D>) -> Self {
        Self {
            state: state.clone(),
            crossed: sampler.crossed(),
        }
    }

    /// The same as [`Saved::of`] for a state whose particles are those of `self`, which are not copied.
    pub(super) fn slept_on(self, now: &mut State<D>, sampler: &Sampler<D>) -> Self {
        let theirs = std::mem::take(&mut now.grains);
        let mut saved = Self::of(now, sampler);
        now.grains = theirs;
        saved.state.grains = self.state.grains;
        saved
    }

    /// The same as bytes.
    ///
    /// # Errors
    /// They are too many.
    pub(super) fn encode(state: &State<D>, sampler: &Sampler<D>) -> Result<Vec<u8>, String> {
        snapshot::encode(&Self::of(state, sampler))
    }

    /// Takes saved bytes apart; refuses what does not fit this scene, whose state is `now`.
    ///
    /// # Errors
    /// The bytes are not such a state, or do not fit.
    pub(super) fn decode(
        bytes: &[u8],
        now: &State<D>,
        solver: &Solver<D>,
        sampler: &Sampler<D>,
    ) -> Result<Self, String> {
        let saved: Self = snapshot::decode(bytes)?;
        let state = &saved.state;
        let share = |x: f64| (0.0..=1.0).contains(&x);
        let options = |g: &Grains<D>| [g.implicit, g.exact_yield, g.wall_friction, g.saturated];
        let fits = options(&state.grains) == options(&now.grains)
            && state.grains.is_consistent(solver.materials())
            && state
                .gates
                .iter()
                .all(|g| share(g.opening) && share(g.listed_opening) && g.rate.is_finite())
            && state.drives.len() == now.drives.len()
            && solver.can_be(&state.drives)
            && saved.state.gates.len() == now.gates.len()
            && saved.state.inflows.len() == now.inflows.len()
            && saved.state.inflows.iter().all(|i| {
                let figures = [i.rate, i.pending, i.admitted];
                share(i.advance) && share(i.listed_advance) && figures.iter().all(|x| x.is_finite())
            })
            && state.is_finite()
            && saved.crossed.iter().all(|x| x.is_finite())
            && saved.state.drained.len() == now.drained.len()
            && saved.state.impulse.len() == now.impulse.len()
            && saved.crossed.len() == sampler.crossed().len();
        if fits {
            Ok(saved)
        } else {
            Err("its devices, gauges or particles do not fit this scene".to_owned())
        }
    }
}
