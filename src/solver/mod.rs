//! The solver.
mod numerics;
pub use numerics::{Numerics, Scheme};

/// What bounds an internal step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum StepBound {
    /// courant h / c0.
    Acoustic,
    /// Relative motion of neighbours or walls.
    Motion,
    /// Explicit viscosity.
    Viscous,
    /// The end of the communication step.
    Communication,
}
