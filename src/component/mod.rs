//! The one interface: what the program, FMI, the C ABI and Zenoh all step.
//!
//! Adapters contain no physics, no lifecycle rule and no list of variables: the lifecycle stands in `lifecycle`,
//! the variables in `variables`, the map from errors to numbers in `status`. What is advanced stands behind
//! `engine`; what a saved state looks like in `snapshot`.
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
mod host;
mod lifecycle;
mod outputs;
mod parameters;
mod points;
mod reports;
mod sampling;
mod simulation;
mod slopes;
mod snapshot;
mod status;
mod variables;
mod watch;

pub use error::{Error, Severity};
pub use host::HostSettings;
pub use points::{next_point, step_end};
pub use reports::{MassLedger, ParticleView, Statistics, StepReport, Totals};
pub use snapshot::saved_checksum;
pub use status::Status;
pub use variables::{
    Causality, Start, ValueKind, ValueReference, Variability, Variable, VariableTable,
    variables_markdown,
};
pub use watch::{Intermediate, Wish};

pub use crate::solver::StaysAwake;

use crate::scene::Scene;
use engine::{Engine, Inputs, Ramp};
use lifecycle::Call;
use outputs::FlowMass;

/// Rounding of a start time over the acoustic step [1].
const MOST_ROUNDING: f64 = 1e-3;

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
}

/// The state beside the engine's: what save and restore carry with it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Life {
    mode: Mode,
    /// Simulated time [s].
    time: f64,
    /// No step may end later [s]: the orchestrator's, no part of what is saved.
    stop: Option<f64>,
    communication_steps: u64,
    inputs: Inputs,
    /// Values of the scene's adjustable numbers that were set, in their order.
    parameters: Vec<f64>,
    /// Whether inputs out of range are clamped instead of refused.
    saturate_inputs: bool,
    /// Flat output values as of the last good step; see `outputs`.
    outputs: Vec<f64>,
    /// Those of the step before; see `slopes`.
    before: Vec<f64>,
    /// Lengths of the last two steps, the last one first; 0 where there was none [s].
    steps: [f64; 2],
}

impl Component {
    /// Builds the scene's particles, walls, devices and gauges.
    ///
    /// # Errors
    /// [`Error::Setup`] if the scene cannot be built.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let table = VariableTable::of(scene);
        let threads = 1;
        let (engine, life) = Self::start(scene, &table, threads)?;
        let built = life.parameters.clone();
        Ok(Self {
            base: scene.clone(),
            scene: scene.clone(),
            built,
            table,
            fingerprint: scene.fingerprint(),
            engine,
            threads,
            own_threads: threads,
            notes: Vec::new(),
            host: HostSettings::of(scene),
            step_failed: false,
            life,
        })
    }

    /// Engine and life at the start of a scene.
    fn start(
        scene: &Scene,
        table: &VariableTable,
        threads: usize,
    ) -> Result<(Box<dyn Engine>, Life), Error> {
        let mut engine = engine::build(scene)?;
        engine.set_threads(threads);
        let held = |value: f64| Ramp { value, slope: 0.0 };
        let inputs = Inputs {
            gate_opening: scene.gates.iter().map(|g| held(g.start)).collect(),
            inflow_rate: scene.inflows.iter().map(|i| held(i.rate)).collect(),
        };
        let before = FlowMass::now(engine.devices());
        let outputs =
            outputs::sample(table, engine.as_ref(), &before, 0.0).map_err(Error::Setup)?;
        let life = Life {
            mode: Mode::Instantiated,
            time: 0.0,
            stop: None,
            communication_steps: 0,
            inputs,
            parameters: scene.adjustables.iter().map(|a| a.start).collect(),
            saturate_inputs: false,
            before: outputs.clone(),
            outputs,
            steps: [0.0; 2],
        };
        Ok((engine, life))
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

    /// Instantiated -> Initialization. `stop`: no step may end later [s].
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`] for times that are not finite, in the wrong order, or so far from 0 that doubles
    /// do not tell a thousandth of an acoustic step from the next.
    pub fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        lifecycle::check(Call::EnterInitialization, self.life.mode)?;
        self.check_times("enter_initialization", start, stop)?;
        self.life.mode = Mode::Initialization;
        self.life.time = start;
        self.life.stop = stop;
        Ok(())
    }

    /// Whether a simulation may begin at `start` and end at `stop` [s], for adapters that are told before
    /// [`Component::enter_initialization`]; `call` stands in the message.
    ///
    /// # Errors
    /// [`Error::BadArgument`], as there.
    pub fn check_times(
        &self,
        call: &'static str,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        let refuse = |what: &str, found: f64, allowed: String| {
            Err(Error::BadArgument {
                call,
                what: what.to_owned(),
                found: format!("{found} s"),
                allowed,
            })
        };
        if !start.is_finite() {
            return refuse("start time", start, "a finite time".to_owned());
        }
        // Times are doubles, and must tell internal steps apart.
        let fine = MOST_ROUNDING * self.scene.numerics.acoustic_step();
        let latest = fine / f64::EPSILON;
        if start.abs() > latest {
            let allowed = format!(
                "at most {latest:.1e} s from 0, where doubles still tell times {fine:.1e} s apart, a thousandth of this scene's \
                 acoustic step; count time from a later origin"
            );
            return refuse("start time", start, allowed);
        }
        if let Some(stop) = stop
            && !(stop.is_finite() && stop >= start)
        {
            return refuse(
                "stop time",
                stop,
                format!("a finite time from {start} s, the start, on"),
            );
        }
        Ok(())
    }

    /// Initialization -> Stepping. Outputs are those of the start.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`]; those of [`Component::settle`]: the mode stays, parameters may be corrected.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        lifecycle::check(Call::ExitInitialization, self.life.mode)?;
        self.settle()?;
        self.life.mode = Mode::Stepping;
        Ok(())
    }

    /// `enter_initialization` and `exit_initialization` in one.
    ///
    /// # Errors
    /// As these; nothing is changed then.
    pub fn initialize(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        let before = (self.life.mode, self.life.time, self.life.stop);
        self.enter_initialization(start, stop)?;
        self.exit_initialization().inspect_err(|_| {
            (self.life.mode, self.life.time, self.life.stop) = before;
        })
    }

    /// Everything that can change a later bit, as bytes: versioned header, scene fingerprint, checksum. Allowed in
    /// every mode; a failed component saves as failed. The stop time is the orchestrator's and not among it.
    ///
    /// # Errors
    /// [`Error::Snapshot`].
    pub fn save(&self) -> Result<Vec<u8>, Error> {
        let payload = self.payload().map_err(Error::Snapshot)?;
        Ok(snapshot::seal(&self.fingerprint, &payload))
    }

    /// Goes back (or forth) to saved bytes, also from another process; the stop time stays. Allowed in every mode.
    ///
    /// # Errors
    /// [`Error::Snapshot`] for bytes of another version or scene, cut short or corrupt; the component stays as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let (life, engine) = self.opened(bytes)?;
        self.take_over(life, engine)
    }

    /// Whether [`Component::restore`] would take these bytes, as far as can be told without building anything.
    ///
    /// # Errors
    /// As [`Component::restore`].
    pub fn check_saved(&self, bytes: &[u8]) -> Result<(), Error> {
        let (life, engine) = self.opened(bytes)?;
        // What other parameters make of the scene, an engine built for them tells.
        if engine.is_empty() || !parameters::same_bits(&life.parameters, &self.built) {
            return Ok(());
        }
        self.engine.check(engine).map_err(Error::Snapshot)
    }

    /// Life and bytes of the engine of a saved state that fits this component's table.
    fn opened<'b>(&self, bytes: &'b [u8]) -> Result<(Life, &'b [u8]), Error> {
        let payload = snapshot::open(&self.fingerprint, bytes)?;
        let (life, engine): (Life, &[u8]) = snapshot::split(payload).map_err(Error::Snapshot)?;
        let counts = |l: &Life| {
            [
                l.inputs.gate_opening.len(),
                l.inputs.inflow_rate.len(),
                l.outputs.len(),
                l.before.len(),
                l.parameters.len(),
            ]
        };
        if counts(&life) != counts(&self.life) {
            return Err(Error::Snapshot(format!(
                "found {:?} gates, inflows, output values (twice) and parameters, allowed {:?} (this scene's)",
                counts(&life),
                counts(&self.life)
            )));
        }
        Ok((life, engine))
    }

    /// The state without header and stop time: length of life, life, engine. While parameters wait for their engine it
    /// is that of the start, and nothing stands for it.
    fn payload(&self) -> Result<Vec<u8>, String> {
        let life = Life {
            stop: None,
            ..self.life.clone()
        };
        if self.is_unsettled() {
            return snapshot::join(&life, &[]);
        }
        snapshot::join(&life, &self.engine.save()?)
    }

    /// Back to Instantiated with start values, as after `new` (threads as [`Component::set_threads`] gave them). Allowed in
    /// every mode.
    ///
    /// # Errors
    /// [`Error::Setup`]; the component stays as it was.
    pub fn reset(&mut self) -> Result<(), Error> {
        (self.engine, self.life) = Self::start(&self.base, &self.table, self.own_threads)?;
        self.threads = self.own_threads;
        self.scene = self.base.clone();
        self.built = self.life.parameters.clone();
        self.host = HostSettings::of(&self.base);
        self.notes.clear();
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

    /// The account of material.
    #[must_use]
    pub fn ledger(&self) -> MassLedger {
        self.engine.ledger()
    }

    /// Communication steps done since the start. At once, as [`Component::steps`]: [`Component::statistics`] goes through all particles.
    #[must_use]
    pub fn communication_steps(&self) -> u64 {
        self.life.communication_steps
    }

    /// Internal steps done since the start.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.engine.steps()
    }

    /// Figures of the solver. Built on demand.
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

    /// How long walls that move as a whole have moved: since the start, for pictures [s].
    #[must_use]
    pub fn wall_time(&self) -> f64 {
        self.engine.wall_time()
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

    /// SHA-256 of the state (without header and stop time), hex: two components with the same hash go on with the
    /// same bits.
    #[must_use]
    pub fn state_hash(&self) -> String {
        // A state too large to encode has no hash; its error text stands in, so that it equals no other state's.
        self.payload()
            .map_or_else(|why| why, |payload| snapshot::hash(&payload))
    }
}
