//! What a component drives: particles, walls, devices and gauges of either dimension behind one trait.
//!
//! The dimension is erased here, once per communication step and never per pair. The trait knows no mode, no
//! variable table and no snapshot header; those stand in the modules beside it. `build` joins scene, state,
//! solver and gauges.

use super::{MassLedger, ParticleView, Statistics, Totals};
use crate::gauge::Reading;
use crate::scene::{InputTarget, Scene};
use crate::solver::{StaysAwake, StepBound, SubStep};

/// Steps that differ by less are the same [1].
const SAME_STEP: f64 = 1e-9;

/// An input over one communication step: `value + slope (t - t0)`, t0 being the start of the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Ramp {
    /// Value at the start of the step, in the variable's unit.
    pub(crate) value: f64,
    /// Change per second within the step; 0 holds the value.
    pub(crate) slope: f64,
}

impl Inputs {
    /// All of them, in one order.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Ramp> {
        let gates = self.gate_opening.iter();
        gates.chain(&self.inflow_rate).chain(&self.wall_drive)
    }

    /// As [`Inputs::all`].
    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Ramp> {
        let gates = self.gate_opening.iter_mut();
        gates
            .chain(&mut self.inflow_rate)
            .chain(&mut self.wall_drive)
    }
}

/// What the inputs of a scene are, with their ranges, in the order of [`Inputs::all`].
pub(crate) fn input_ranges(scene: &Scene) -> impl Iterator<Item = (InputTarget, (f64, f64))> {
    let openings = (0..scene.gates.len()).map(|i| (InputTarget::GateOpening(i), (0.0, 1.0)));
    let inflows = scene.inflows.iter().enumerate();
    let rates = inflows.map(|(i, inflow)| (InputTarget::InflowRate(i), (0.0, inflow.max_rate)));
    let drives = scene.drives().enumerate();
    let drives = drives.map(|(i, (_, drive))| (InputTarget::WallDrive(i), drive.range()));
    openings.chain(rates).chain(drives)
}

impl Ramp {
    /// Value `elapsed` seconds after the start of the step.
    pub(crate) fn at(&self, elapsed: f64) -> f64 {
        self.value + self.slope * elapsed
    }
}

/// What the orchestrator wants during one communication step; held within its range where a slope leads out of it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Inputs {
    /// Opening wanted of each gate, in the scene's order [1], 0 to 1.
    pub(crate) gate_opening: Vec<Ramp>,
    /// Rate wanted of each inflow, in the scene's order [kg/s].
    pub(crate) inflow_rate: Vec<Ramp>,
    /// Speed or position wanted of each steered wall, in the scene's order [m/s, m; of turning rad/s, rad].
    pub(crate) wall_drive: Vec<Ramp>,
}

/// What one call of [`Engine::advance`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Advance {
    /// Internal steps taken, none while the scene sleeps.
    pub(crate) substeps: u64,
    /// Smallest internal step; of a scene that sleeps throughout, the time slept [s].
    pub(crate) smallest_step: f64,
    /// What bound that one.
    pub(crate) bound_by: StepBound,
    /// Iterations of the viscous solve, summed over internal steps.
    pub(crate) iterations: u64,
}

impl Advance {
    /// Before the first internal step.
    pub(crate) fn none() -> Self {
        Self {
            substeps: 0,
            smallest_step: f64::INFINITY,
            bound_by: StepBound::Communication,
            iterations: 0,
        }
    }

    /// Adds an internal step, or a sleep.
    pub(crate) fn add(&mut self, done: &SubStep) {
        let first = self.substeps == 0;
        if done.bound == StepBound::Asleep {
            if first {
                (self.smallest_step, self.bound_by) = (done.dt, done.bound);
            }
            return;
        }
        self.substeps += 1;
        self.iterations += u64::from(done.iterations);
        // Equal steps differ by rounding, and the last of them ends with the communication step without being bound by it.
        if first || done.dt < (1.0 - SAME_STEP) * self.smallest_step {
            if first || done.bound != StepBound::Communication {
                self.bound_by = done.bound;
            }
            self.smallest_step = done.dt;
        }
    }
}

/// A gate after the last advance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GateState {
    /// Opening it has [1], 0 to 1.
    pub(crate) opening: f64,
    /// Whether material kept it from following its input.
    pub(crate) blocked: bool,
    /// Impulse of the material on it over the last advance [N s].
    pub(crate) impulse: [f64; 3],
}

/// A steered wall after the last advance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DriveReading {
    /// Speed that it has, along its velocity or in the sense in which it turns [m/s or rad/s].
    pub(crate) speed: f64,
    /// How far it is from where it is drawn, likewise [m or rad].
    pub(crate) position: f64,
    /// Whether that is its input.
    pub(crate) is_told_place: bool,
}

/// An inflow after the last advance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InflowState {
    /// Mass let in since the start [kg].
    pub(crate) mass: f64,
    /// Whether material before its face kept it from letting in what was wanted.
    pub(crate) blocked: bool,
}

/// All devices after the last advance, each list in the scene's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Devices {
    /// Gates.
    pub(crate) gates: Vec<GateState>,
    /// Inflows.
    pub(crate) inflows: Vec<InflowState>,
    /// Steered walls.
    pub(crate) drives: Vec<DriveReading>,
    /// Mass taken out by each outflow since the start [kg].
    pub(crate) outflow_mass: Vec<f64>,
    /// Impulse of the material on each wall over the last advance [N s].
    pub(crate) wall_impulse: Vec<[f64; 3]>,
    /// Moments of such impulses that force gauges read, in their order [N m s].
    pub(crate) moment: Vec<[f64; 3]>,
}

/// Why the solver gave up. The component is in mode Failed afterwards.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub(crate) struct SolverError {
    /// Time, particle, quantity, what was found and what is allowed.
    pub(crate) what: String,
}

/// The simulation behind a component.
pub(crate) trait Engine: Send {
    /// Advances from `start` to `end` exactly [s]; the inputs' slopes count from `start`.
    ///
    /// # Errors
    /// The solver could not go on; the state is then not to be stepped any more.
    fn advance(&mut self, start: f64, end: f64, inputs: &Inputs) -> Result<Advance, SolverError>;

    /// Begins a communication step at `start` that goes on with [`Engine::substep`].
    fn begin(&mut self, start: f64, inputs: &Inputs);

    /// One internal step of a communication step from `span.0` to `span.1` [s], added to `advance`; the time reached,
    /// at most `span.1`. Devices and readings are those of that time.
    ///
    /// # Errors
    /// As [`Engine::advance`].
    fn substep(
        &mut self,
        span: (f64, f64),
        inputs: &Inputs,
        advance: &mut Advance,
    ) -> Result<f64, SolverError>;

    /// Devices after the last advance (or at the start).
    fn devices(&self) -> &Devices;

    /// Readings of all gauges in the scene's order; `step` is the length of the last advance [s], 0 before the first.
    fn sample(&self, step: f64) -> Vec<Reading>;

    /// Everything that can change a later bit, independent of the number of threads.
    ///
    /// # Errors
    /// The state is too large to encode.
    fn save(&self) -> Result<Vec<u8>, String>;

    /// Takes over what [`Engine::save`] gave, from this or another process.
    ///
    /// # Errors
    /// The bytes are not such a state; the engine is then as it was.
    fn restore(&mut self, bytes: &[u8]) -> Result<(), String>;

    /// Whether [`Engine::restore`] would take these bytes.
    ///
    /// # Errors
    /// They are not such a state.
    fn check(&self, bytes: &[u8]) -> Result<(), String>;

    /// Keeps the state as it is in memory, in place of what was kept before.
    fn keep(&mut self);

    /// Goes back to what was kept last, which is kept no more; whether anything was.
    fn back_to_kept(&mut self) -> bool;

    /// The account of material.
    fn ledger(&self) -> MassLedger;

    /// Figures of the solver (without the number of communication steps, which the component counts).
    fn statistics(&self) -> Statistics;

    /// Internal steps done.
    fn steps(&self) -> u64;

    /// Momentum, energy and bounds of all particles.
    fn totals(&self) -> Totals;

    /// Particles as plain arrays, for logs and pictures.
    fn particles(&self) -> ParticleView;

    /// Why the scene never sleeps.
    fn stays_awake(&self) -> Option<StaysAwake>;

    /// Whether an inflow pushes what is before it.
    fn inflow_pushes(&self, inflow: usize) -> bool;

    /// Wall and gate particles where they are now, for pictures [m].
    fn wall_points(&self) -> Vec<[f64; 3]>;

    /// Share of a full point of each of them [1].
    fn wall_shares(&self) -> Vec<f64>;

    /// How long each wall of the scene would have moved at its full speed to be where it is [s].
    fn wall_times(&self) -> Vec<f64>;

    /// Threads of the sweeps, 0 for all cores; results do not depend on it.
    fn set_threads(&mut self, threads: usize);
}

pub(crate) use super::simulation::build;
