//! A component's state beside its engine's, and both as saved bytes.

use serde::{Deserialize, Serialize};

use super::engine::{self, Engine, Inputs, Ramp};
use super::outputs::{self, FlowMass};
use super::parameters::same_bits;
use super::{Component, Error, Mode, VariableTable, snapshot};
use crate::scene::Scene;

/// The state beside the engine's: what save and restore carry with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Life {
    pub(super) mode: Mode,
    /// Whether the engine stands within a step that failed, also when the component has been terminated since.
    pub(super) half_stepped: bool,
    /// Simulated time [s].
    pub(super) time: f64,
    /// No step may end later [s]: the orchestrator's, no part of what is saved.
    pub(super) stop: Option<f64>,
    pub(super) communication_steps: u64,
    pub(super) inputs: Inputs,
    /// Values of the scene's adjustable numbers that were set, in their order.
    pub(super) parameters: Vec<f64>,
    /// Whether inputs out of range are clamped instead of refused.
    pub(super) saturate_inputs: bool,
    /// Flat output values as of the last good step; see `outputs`.
    pub(super) outputs: Vec<f64>,
    /// Those of the step before; see `slopes`.
    pub(super) before: Vec<f64>,
    /// Lengths of the last two steps, the last one first; 0 where there was none [s].
    pub(super) steps: [f64; 2],
}

impl Life {
    /// Engine and life at the start of a scene.
    pub(super) fn start(
        scene: &Scene,
        table: &VariableTable,
        threads: usize,
    ) -> Result<(Box<dyn Engine>, Self), Error> {
        let mut engine = engine::build(scene)?;
        engine.set_threads(threads);
        let held = |value: f64| Ramp { value, slope: 0.0 };
        let inputs = Inputs {
            gate_opening: scene.gates.iter().map(|g| held(g.start)).collect(),
            inflow_rate: scene.inflows.iter().map(|i| held(i.rate)).collect(),
            wall_drive: scene.drives().map(|(_, d)| held(d.start_value())).collect(),
        };
        let before = FlowMass::now(engine.devices());
        let outputs =
            outputs::sample(table, engine.as_ref(), &before, 0.0).map_err(Error::Setup)?;
        let life = Self {
            mode: Mode::Instantiated,
            half_stepped: false,
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

    /// Whether all of its figures are numbers. Saved ones may be anything.
    fn is_finite(&self) -> bool {
        let ramps = self
            .inputs
            .all()
            .flat_map(|ramp| [&ramp.value, &ramp.slope]);
        let values = [&self.parameters, &self.outputs, &self.before];
        let mut all = ramps.chain(values.into_iter().flatten()).chain(&self.steps);
        self.time.is_finite() && all.all(|x| x.is_finite())
    }
}

impl Component {
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

    /// Keeps the state as it is in memory, in place of what was kept before. That copies the particles, but for a scene that
    /// slept since, and makes no bytes: it costs little beside a step, so that each step may be preceded by it. A step that
    /// fails leaves a state that none goes on from; this is the way back.
    pub fn keep(&mut self) {
        self.kept = Some(self.life.clone());
        self.engine.keep();
    }

    /// Goes back to the state that [`Component::keep`] kept last, which is kept no more; the stop time stays. Allowed in
    /// every mode. False, and nothing happens, where none has been kept since the component was made, reset, restored, or
    /// built for other parameters.
    pub fn back_to_kept(&mut self) -> bool {
        let Some(life) = self.kept.take() else {
            return false;
        };
        if !self.engine.back_to_kept() {
            return false;
        }
        let stop = self.life.stop;
        self.life = Life { stop, ..life };
        self.step_failed = false;
        true
    }

    /// Whether [`Component::restore`] would take these bytes, as far as can be told without building anything.
    ///
    /// # Errors
    /// As [`Component::restore`].
    pub fn check_saved(&self, bytes: &[u8]) -> Result<(), Error> {
        let (life, engine) = self.opened(bytes)?;
        // What other parameters make of the scene, an engine built for them tells.
        if engine.is_empty() || !same_bits(&life.parameters, &self.built) {
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
                l.inputs.wall_drive.len(),
                l.outputs.len(),
                l.before.len(),
                l.parameters.len(),
            ]
        };
        if counts(&life) != counts(&self.life) {
            return Err(Error::Snapshot(format!(
                "found {:?} gates, inflows, steered walls, output values (twice) and parameters, allowed {:?} (this scene's)",
                counts(&life),
                counts(&self.life)
            )));
        }
        if !life.is_finite() {
            return Err(Error::Snapshot(
                "found NaN or infinity among its times, inputs, parameters or outputs".to_owned(),
            ));
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

    /// SHA-256 of the state (without header and stop time), hex: two components with the same hash go on with the
    /// same bits.
    #[must_use]
    pub fn state_hash(&self) -> String {
        // A state too large to encode has no hash; its error text stands in, so that it equals no other state's.
        self.payload()
            .map_or_else(|why| why, |payload| snapshot::hash(&payload))
    }
}
