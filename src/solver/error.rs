//! Why a step can fail. Every message names particle, time and quantity.

use crate::state::State;

use super::Solver;
use super::outputs::three;

/// Errors of the solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// A number that is not finite (or a density that is not positive).
    #[error(
        "{quantity} of particle {particle} is not finite or out of range at t = {time} s, at {position:?} m; a smaller courant number or a higher sound_speed may help"
    )]
    NotFinite {
        /// Persistent number of the particle.
        particle: u64,
        /// Time [s].
        time: f64,
        /// What went wrong.
        quantity: &'static str,
        /// Where [m].
        position: [f64; 3],
    },
    /// A particle left the domain other than by an outflow.
    #[error(
        "particle {particle} left the domain at t = {time} s, at {position:?} m with velocity {velocity:?} m/s; add a wall or an outflow there (one with outside = true takes all that leaves), or enlarge the domain"
    )]
    Lost {
        /// Persistent number of the particle.
        particle: u64,
        /// Time [s].
        time: f64,
        /// Where [m].
        position: [f64; 3],
        /// How fast [m/s].
        velocity: [f64; 3],
    },
    /// The viscous solve did not reach its tolerance.
    #[error(
        "viscous solve did not converge at t = {time} s: residual {residual:e} kg m/s after {iterations} iterations, allowed {allowed:e}; raise solver_max_iterations or lower cap_time"
    )]
    NotConverged {
        /// Time [s].
        time: f64,
        /// Iterations spent.
        iterations: u32,
        /// Residual reached.
        residual: f64,
        /// Residual asked for.
        allowed: f64,
    },
    /// The step fell so low that the run would not end.
    #[error(
        "the internal step fell to {step:e} s at t = {time} s (bound: {bound}); allowed at least {smallest:e} s"
    )]
    StepCollapsed {
        /// Time [s].
        time: f64,
        /// Step [s].
        step: f64,
        /// What bound it.
        bound: &'static str,
        /// Smallest step allowed [s].
        smallest: f64,
    },
}

impl<const D: usize> Solver<D> {
    /// The first particle for which `fine` is false, as an error.
    pub(super) fn not_finite(
        &self,
        state: &State<D>,
        quantity: &'static str,
        fine: impl Fn(usize) -> bool,
    ) -> SolverError {
        let i = (0..state.grains.len()).find(|&i| !fine(i)).unwrap_or(0);
        SolverError::NotFinite {
            particle: state.grains.id.get(i).copied().unwrap_or(0),
            time: state.time,
            quantity,
            position: state.grains.position.get(i).map_or([0.0; 3], three),
        }
    }
}
