//! The one interface: what the program, FMI, the C ABI and Zenoh all step.
//!
//! Adapters contain no physics, no lifecycle rule and no list of variables: the lifecycle stands in `lifecycle`,
//! the variables in `variables`, the map from errors to numbers in `status`.

mod engine;
mod error;
mod sampling;
mod snapshot;
mod variables;

pub use error::{Error, Severity};
pub use variables::{
    Causality, Start, ValueKind, ValueReference, Variability, Variable, VariableTable,
};

use crate::scene::Scene;

/// Where a component is in its life. `lifecycle` holds the table of which call is allowed when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Built; parameters may be set.
    Instantiated,
    /// Between `enter_initialization` and `exit_initialization`.
    Initialization,
    /// Between steps.
    Stepping,
    /// After `terminate`.
    Terminated,
    /// A step failed: only get, restore, reset, terminate.
    Failed,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time reached: t + h, bit for bit [s].
    pub time: f64,
    /// Internal steps taken.
    pub substeps: u32,
    /// Smallest internal step [s].
    pub smallest_step: f64,
    /// What bound it.
    pub bound_by: crate::solver::StepBound,
    /// Iterations of the viscous solve, summed over internal steps.
    pub iterations: u32,
}

/// Exact account of material: initial + inflow - outflow = present, in f64, at every time.
///
/// Particle masses are multiples of a power of two, so that every sum is exact whatever its order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassLedger {
    /// Mass at the start [kg].
    pub initial: f64,
    /// Mass that came in since [kg].
    pub inflow: f64,
    /// Mass that left since [kg].
    pub outflow: f64,
    /// Mass present, summed over particles [kg].
    pub present: f64,
}

impl MassLedger {
    /// initial + inflow - outflow - present [kg]: exactly 0.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.initial + self.inflow - self.outflow - self.present
    }
}

/// Figures of the solver that go to logs and summaries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Communication steps done.
    pub communication_steps: u64,
    /// Internal steps done.
    pub steps: u64,
    /// Iterations of viscous solves, in all.
    pub iterations: u64,
    /// Particles present.
    pub particles: u64,
    /// Last internal step [s].
    pub step_size: f64,
    /// Kinetic energy [J].
    pub kinetic_energy: f64,
    /// Largest particle speed [m/s].
    pub max_speed: f64,
    /// Share of mass with I > 0.3 [1]: outside the dense regime.
    pub share_dilute: f64,
}

/// A steppable granular-flow unit.
pub struct Component {
    scene: Scene,
}

impl Component {
    /// Builds the scene's particles, walls, devices and gauges.
    ///
    /// # Errors
    /// [`Error::Setup`] if the scene cannot be built.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Ok(Self {
            scene: scene.clone(),
        })
    }

    /// The scene it was built from.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The one table of variables.
    #[must_use]
    pub fn variables(&self) -> &VariableTable {
        todo!()
    }

    /// Where it is in its life.
    #[must_use]
    pub fn mode(&self) -> Mode {
        todo!()
    }

    /// Simulated time [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        todo!()
    }

    /// Instantiated -> Initialization. `stop`: no step may end later [s].
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`] for times that are not finite or in the wrong order.
    pub fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        let _ = (start, stop);
        todo!()
    }

    /// Initialization -> Stepping: first gauges are sampled.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`].
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        todo!()
    }

    /// `enter_initialization` and `exit_initialization` in one.
    ///
    /// # Errors
    /// As these.
    pub fn initialize(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        self.enter_initialization(start, stop)?;
        self.exit_initialization()
    }

    /// Sets variables, all or none. `values` holds the flat values of all references, one after the other.
    ///
    /// # Errors
    /// Unknown reference, wrong length, not finite, out of range, not settable (in this mode): names the variable,
    /// what was found and what is allowed. Nothing is changed then.
    pub fn set(&mut self, references: &[ValueReference], values: &[f64]) -> Result<(), Error> {
        let _ = (references, values);
        todo!()
    }

    /// Reads variables into `values` (flat, as in [`Component::set`]). Pure: gauges are sampled once a step, not here.
    ///
    /// # Errors
    /// Unknown reference, wrong length.
    pub fn get(&self, references: &[ValueReference], values: &mut [f64]) -> Result<(), Error> {
        let _ = (references, values);
        todo!()
    }

    /// Advances from `t` to `t + h` exactly, in as many internal steps as stability asks for.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`] (t is not the current time, h not finite and positive, past the
    /// stop time): nothing happened. [`Error::Solver`]: mode is [`Mode::Failed`] afterwards.
    pub fn do_step(&mut self, t: f64, h: f64) -> Result<StepReport, Error> {
        let _ = (t, h);
        todo!()
    }

    /// Everything that can change a later bit, as bytes: versioned header, scene fingerprint, checksum. Allowed in every mode.
    ///
    /// # Errors
    /// [`Error::Snapshot`].
    pub fn save(&self) -> Result<Vec<u8>, Error> {
        todo!()
    }

    /// Goes back (or forth) to saved bytes, also from another process. Allowed in every mode.
    ///
    /// # Errors
    /// [`Error::Snapshot`] for bytes of another version or scene, cut short or corrupt; the component stays as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let _ = bytes;
        todo!()
    }

    /// Back to Instantiated with start values, as after `new`. Allowed in every mode.
    ///
    /// # Errors
    /// [`Error::Setup`].
    pub fn reset(&mut self) -> Result<(), Error> {
        todo!()
    }

    /// Stepping (or Failed) -> Terminated.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`].
    pub fn terminate(&mut self) -> Result<(), Error> {
        todo!()
    }

    /// The account of material.
    #[must_use]
    pub fn ledger(&self) -> MassLedger {
        todo!()
    }

    /// Figures of the solver.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        todo!()
    }

    /// Particles as plain arrays, for logs and pictures. Built on demand.
    #[must_use]
    pub fn particles(&self) -> ParticleView {
        todo!()
    }

    /// Wall and gate particles where they are now, for pictures.
    #[must_use]
    pub fn wall_points(&self) -> Vec<[f64; 3]> {
        todo!()
    }

    /// Threads used by sweeps: results do not depend on it. 0 means all cores.
    pub fn set_threads(&mut self, threads: usize) {
        let _ = threads;
        todo!()
    }

    /// SHA-256 of the state (without header), hex: two components with the same hash go on with the same bits.
    #[must_use]
    pub fn state_hash(&self) -> String {
        todo!()
    }
}

/// A copy of the particles in single precision, for logs and pictures (planar scenes: z = 0).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleView {
    /// Position [m].
    pub position: Vec<[f32; 3]>,
    /// Velocity [m/s].
    pub velocity: Vec<[f32; 3]>,
    /// Pressure [Pa].
    pub pressure: Vec<f32>,
    /// Inertial number [1].
    pub inertial_number: Vec<f32>,
    /// Phase: index of the material.
    pub phase: Vec<u8>,
    /// Whether the particle sleeps (always 0 until sleeping exists).
    pub asleep: Vec<u8>,
}
