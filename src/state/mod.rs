//! Rank 2: everything that can change a later bit (docs/theory.md, "State"), and nothing else.
//!
//! Lists, pressures, velocity gradients and wall points are derived: they are rebuilt from this, with the same bits.

mod cells;
mod grains;
mod random;
mod rings;

pub use cells::CellGrid;
pub use grains::{Grains, flat, flat_tensors};
pub use random::Random;

use serde::{Deserialize, Serialize};

use crate::math::Vector;

/// The running state of a scene in D dimensions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State<const D: usize> {
    /// Simulated time [s].
    pub time: f64,
    /// The particles.
    pub grains: Grains<D>,
    /// Where walls are that move as a whole.
    pub pose: PoseTimes,
    /// Walls that are steered, in the order of the scene.
    pub drives: Vec<DriveState>,
    /// One per gate of the scene.
    pub gates: Vec<GateState>,
    /// One per inflow of the scene.
    pub inflows: Vec<InflowState>,
    /// Mass each outflow has taken [kg].
    pub drained: Vec<f64>,
    /// Impulse on each wall, then each gate, over the last advance [N s]; then the moments of the plan [N m s].
    #[serde(with = "flat")]
    pub impulse: Vec<Vector<D>>,
    /// Mass at the start [kg].
    pub initial_mass: f64,
    /// Next particle number.
    pub next_id: u64,
    /// Internal steps done.
    pub steps: u64,
    /// Iterations of viscous solves done.
    pub iterations: u64,
    /// Last internal step [s].
    pub step_size: f64,
    /// Share of its last change by which the viscous acceleration is expected to change in the next step [1].
    pub trend: f64,
    /// Whether the scene sleeps, or how near it is to it.
    pub rest: RestState<D>,
    /// Generator of inflow jitter.
    pub random: Random,
}

/// Sleep of a scene at rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestState<const D: usize> {
    /// Quiet steps of this window so far.
    pub quiet_steps: u32,
    /// Whether nothing is computed until an input changes.
    pub asleep: bool,
    /// Time of those steps [s].
    pub quiet_time: f64,
    /// Impulse of those steps, as the state has it.
    #[serde(with = "flat")]
    pub impulse: Vec<Vector<D>>,
    /// Mean force of the window before on each wall, then each gate [N], then moments [N m]; empty if that was not quiet. Asleep: of the last one.
    #[serde(with = "flat")]
    pub force: Vec<Vector<D>>,
}

impl<const D: usize> State<D> {
    /// Whether all that is not of particles, gates and inflows is a number. Saved ones may be anything.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let rest = &self.rest;
        let single = [
            self.time,
            self.pose.now,
            self.pose.listed,
            self.initial_mass,
            self.step_size,
            self.trend,
            rest.quiet_time,
        ];
        let vectors = self.impulse.iter().chain(&rest.impulse).chain(&rest.force);
        let mut all = single.iter().chain(&self.drained).chain(vectors.flatten());
        all.all(|x| x.is_finite())
    }

    /// From here on `blocked` of gates and inflows tells what happens: a communication step begins.
    pub fn forget_blocked(&mut self) {
        self.gates.iter_mut().for_each(|gate| gate.blocked = false);
        let inflows = self.inflows.iter_mut();
        inflows.for_each(|inflow| inflow.blocked = false);
    }
}

/// How long walls that move as a whole, and are not steered, have moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseTimes {
    /// Until now [s].
    pub now: f64,
    /// Until the neighbour lists were built [s].
    pub listed: f64,
}

/// Where a wall is that is steered: ways are times that it would have taken at full speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriveState {
    /// Way until now [s].
    pub way: f64,
    /// Share of full speed over the last step, negative: backwards [1].
    pub rate: f64,
    /// Way until the neighbour lists were built [s].
    pub listed_way: f64,
}

/// Where a gate is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GateState {
    /// Actual opening, 0 to 1.
    pub opening: f64,
    /// Rate of opening over the last step [1/s].
    pub rate: f64,
    /// Whether material stopped it since [`State::forget_blocked`].
    pub blocked: bool,
    /// Opening when the neighbour lists were built.
    pub listed_opening: f64,
}

/// What an inflow has let in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InflowState {
    /// Requested mass that has not made a row yet [kg].
    pub pending: f64,
    /// Mass let in since the start [kg].
    pub admitted: f64,
    /// Whether material stood in the way of a row since [`State::forget_blocked`].
    pub blocked: bool,
    /// Of a stream that pushes: how far the wall behind it has come forward, 0 to 1 [spacings].
    pub advance: f64,
    /// Its rate over the last step [1/s].
    pub rate: f64,
    /// Advance when the neighbour lists were built.
    pub listed_advance: f64,
}
