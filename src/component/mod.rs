//! The one interface: what the program, FMI, the C ABI and Zenoh all step.
//!
//! Adapters contain no physics, no lifecycle rule and no list of variables: the lifecycle stands in `lifecycle`,
//! the variables in `variables`, the map from errors to numbers in `status`. What is advanced stands behind
//! `engine`; what is saved in `life`, and what the bytes look like in `snapshot`.
//!
//! Fixed parameters may be set until initialisation ends; the engine is built anew for them when it is next needed
//! (`parameters`). Inputs are held over a step (unless [`Component::set_input_derivatives`] gave a slope); outputs are sampled once
//! at its end. A refused call changes nothing. A failed step leaves time and outputs at the last good step and
//! the component in [`Mode::Failed`].

mod access;
mod advance;
mod anew;
mod engine;
mod error;
mod figures;
mod host;
mod initialize;
mod life;
mod lifecycle;
mod outputs;
mod parameters;
mod points;
mod reports;
mod sampling;
mod saved;
mod simulation;
mod slopes;
mod snapshot;
mod status;
mod variables;
mod watch;

pub use error::Error;
pub use host::HostSettings;
pub use initialize::Beginning;
pub use points::{Followed, next_point, step_end};
pub use reports::{MassLedger, ParticleView, Statistics, StepReport, Totals};
pub use snapshot::{read_saved, saved_checksum};
pub use status::Status;
pub use variables::{
    Causality, Start, ValueKind, ValueReference, Variability, Variable, VariableTable,
    variables_markdown,
};
pub use watch::{Intermediate, Wish};

pub use crate::solver::StaysAwake;

use crate::scene::Scene;
use engine::Engine;
use life::Life;
use lifecycle::Call;

/// Where a component is in its life. `lifecycle` holds the table of which call is allowed when.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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

/// A steppable granular-flow unit.
pub struct Component {
    /// As its text has it.
    base: Scene,
    /// With the parameters that the engine was built for.
    scene: Scene,
    /// These parameters, in the order of [`Scene::adjustables`].
    built: Vec<f64>,
    table: VariableTable,
    fingerprint: [u8; 32],
    engine: Box<dyn Engine>,
    /// Threads of the sweeps: no part of the state, results do not depend on it.
    threads: usize,
    /// Threads after a reset: what the host gave, whatever `solver.threads` was set to since.
    own_threads: usize,
    /// Inputs that were clamped since somebody asked: no part of the state.
    notes: Vec<String>,
    /// For the host: no part of the state.
    host: HostSettings,
    /// See [`Component::step_failed`]: no part of the state.
    step_failed: bool,
    life: Life,
    /// What [`Component::back_to_kept`] goes back to, beside the engine's part: no part of the state.
    kept: Option<Life>,
}

impl Component {
    /// Most threads that anybody may ask for, here and on the command line.
    pub const MOST_THREADS: u16 = 256;

    /// Builds the scene's particles, walls, devices and gauges.
    ///
    /// # Errors
    /// [`Error::Setup`] if the scene cannot be built.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let table = VariableTable::of(scene);
        let threads = 1;
        let (engine, life) = Life::start(scene, &table, threads)?;
        let built = life.parameters.clone();
        Ok(Self {
            base: scene.clone(),
            scene: scene.clone(),
            built,
            table,
            fingerprint: scene.identity(),
            engine,
            threads,
            own_threads: threads,
            notes: Vec::new(),
            host: HostSettings::of(scene),
            step_failed: false,
            life,
            kept: None,
        })
    }

    /// The scene it was built from, with the parameters it was built for.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene as its text has it.
    #[must_use]
    pub fn base_scene(&self) -> &Scene {
        &self.base
    }

    /// The one table of variables.
    #[must_use]
    pub fn variables(&self) -> &VariableTable {
        &self.table
    }

    /// Where it is in its life.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.life.mode
    }

    /// Whether a step has failed since the last reset or restored state: then no calls that were accepted lead to the
    /// state that it is in, also when it has been terminated.
    #[must_use]
    pub fn step_failed(&self) -> bool {
        self.step_failed
    }

    /// Simulated time [s]: that of the last good step.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.life.time
    }

    /// No step may end later than this [s], if an orchestrator said so.
    #[must_use]
    pub fn stop_time(&self) -> Option<f64> {
        self.life.stop
    }

    /// Says so to a component that came to its time by a saved state and not by [`Component::initialize`]. `None`: no end.
    pub fn set_stop_time(&mut self, stop: Option<f64>) {
        self.life.stop = stop;
    }

    /// Back to Instantiated with start values, as after `new` (threads as [`Component::set_threads`] gave them). Allowed in
    /// every mode.
    ///
    /// # Errors
    /// [`Error::Setup`]; the component stays as it was.
    pub fn reset(&mut self) -> Result<(), Error> {
        (self.engine, self.life) = Life::start(&self.base, &self.table, self.own_threads)?;
        self.threads = self.own_threads;
        self.scene = self.base.clone();
        self.built = self.life.parameters.clone();
        self.host = HostSettings::of(&self.base);
        self.notes.clear();
        self.kept = None;
        self.step_failed = false;
        Ok(())
    }

    /// Stepping (or Failed) -> Terminated.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`].
    pub fn terminate(&mut self) -> Result<(), Error> {
        lifecycle::check(Call::Terminate, self.life.mode)?;
        self.life.mode = Mode::Terminated;
        Ok(())
    }

    /// The account of material; after a failed step that of the last good one, as outputs are.
    #[must_use]
    pub fn ledger(&self) -> MassLedger {
        if self.life.half_stepped {
            return outputs::ledger(&self.table, &self.life.outputs);
        }
        self.engine.ledger()
    }

    /// Communication steps done since the start. At once, as [`Component::steps`]: [`Component::statistics`] goes through all particles.
    #[must_use]
    pub fn communication_steps(&self) -> u64 {
        self.life.communication_steps
    }

    /// Internal steps done since the start, those of a failed step among them.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.engine.steps()
    }

    /// Figures of the solver; after a failed step those of the moment at which it failed. Built on demand.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics {
            communication_steps: self.life.communication_steps,
            ..self.engine.statistics()
        }
    }

    /// Momentum, energy and bounds of all particles. Built on demand.
    #[must_use]
    pub fn totals(&self) -> Totals {
        self.engine.totals()
    }

    /// Particles as plain arrays, for logs and pictures. Built on demand.
    #[must_use]
    pub fn particles(&self) -> ParticleView {
        self.engine.particles()
    }

    /// Why the scene never sleeps, so that every step of it is computed; none if it may.
    #[must_use]
    pub fn stays_awake(&self) -> Option<StaysAwake> {
        self.engine.stays_awake()
    }

    /// Whether inflow `inflow` of the scene pushes what is before its face, as a fluid does that comes through a wall that
    /// stands; else it lets in what there is room for.
    #[must_use]
    pub fn inflow_pushes(&self, inflow: usize) -> bool {
        self.engine.inflow_pushes(inflow)
    }

    /// Wall and gate particles where they are now, for pictures [m].
    #[must_use]
    pub fn wall_points(&self) -> Vec<[f64; 3]> {
        self.engine.wall_points()
    }

    /// Share of a full point of each of [`Component::wall_points`], over 0 to 1 and a little more where points lie further
    /// apart than particles [1]: the last point of a plate that slides past its end counts by what is left of it.
    #[must_use]
    pub fn wall_shares(&self) -> Vec<f64> {
        self.engine.wall_shares()
    }

    /// How long each wall of the scene would have moved at its full speed to be where it is, for pictures [s]: since the start, but of
    /// those that are steered.
    #[must_use]
    pub fn wall_times(&self) -> Vec<f64> {
        self.engine.wall_times()
    }

    /// Threads used by sweeps: results do not depend on it. 0 means all cores. A new component has 1. As setting
    /// `solver.threads`, but a reset comes back to it.
    pub fn set_threads(&mut self, threads: usize) {
        self.own_threads = threads;
        self.use_threads(threads);
    }

    /// As many until the next reset.
    fn use_threads(&mut self, threads: usize) {
        self.threads = threads;
        self.engine.set_threads(threads);
    }
}
