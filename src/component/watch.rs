//! Steps that somebody watches: a look at every internal step, inputs in between, and an early end.
//!
//! Watching changes no bit: the internal steps are the same, and outputs are sampled from a state that is only read.

use super::access::bad;
use super::outputs::{self, FlowMass};
use super::variables::Causality;
use super::{Component, Error, ValueReference};

/// What a watcher wants after an internal step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// Go on to the end of the step.
    GoOn,
    /// End the step at this time [s], or at once if it has passed.
    EndAt(f64),
}

/// A component in the middle of a step, after an internal one.
pub struct Intermediate<'a> {
    pub(super) component: &'a mut Component,
    /// Start of the communication step [s].
    pub(super) start: f64,
    /// Where it is to end, unless a wish ends it earlier [s].
    pub(super) end: f64,
    /// Time reached [s].
    pub(super) time: f64,
    pub(super) before: &'a FlowMass,
    /// Outputs at this time, once somebody asked.
    pub(super) outputs: Option<Vec<f64>>,
}

impl Intermediate<'_> {
    /// Time reached [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Start and end of the communication step as it was asked for [s].
    #[must_use]
    pub fn step(&self) -> (f64, f64) {
        (self.start, self.end)
    }

    /// The component's table and scene; its values are those of the last communication point.
    #[must_use]
    pub fn component(&self) -> &Component {
        self.component
    }

    /// As [`Component::get`], at this time: means over the step are over its part that is done. Outputs are sampled
    /// when they are first asked for.
    ///
    /// # Errors
    /// As [`Component::get`]; [`Error::Solver`] if an output is not finite.
    pub fn get(&mut self, references: &[ValueReference], values: &mut [f64]) -> Result<(), Error> {
        let outputs = self.sampled()?;
        let found = self
            .component
            .get_as(references, values, self.time, &outputs);
        self.outputs = Some(outputs);
        found
    }

    /// As [`Component::output_derivatives`], at this time: from the start of the step on.
    ///
    /// # Errors
    /// As [`Component::output_derivatives`]; [`Error::Solver`] if an output is not finite.
    pub fn output_derivatives(
        &mut self,
        references: &[ValueReference],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let outputs = self.sampled()?;
        let now = (self.start, self.time, outputs.as_slice());
        let found = self
            .component
            .output_derivatives_within(now, references, values);
        self.outputs = Some(outputs);
        found
    }

    fn sampled(&mut self) -> Result<Vec<f64>, Error> {
        match self.outputs.take() {
            Some(outputs) => Ok(outputs),
            None => outputs::sample(
                &self.component.table,
                self.component.engine.as_ref(),
                self.before,
                self.time - self.start,
            )
            .map_err(|why| Error::Solver(format!("at t = {} s: {why}", self.time))),
        }
    }

    /// Sets inputs for the rest of the step, all or none; a slope is dropped.
    ///
    /// # Errors
    /// As [`Component::set`]; parameters wait for the end of the step.
    pub fn set(&mut self, references: &[ValueReference], values: &[f64]) -> Result<(), Error> {
        for row in self.component.rows("set", references)? {
            if row.causality == Causality::Parameter {
                let allowed = "inputs, while a step is running";
                return Err(bad("set", &row.name, "a parameter", allowed));
            }
        }
        self.component.set(references, values)?;
        // It counted from the start of the step.
        let none = vec![0.0; references.len()];
        self.component.set_input_derivatives(references, &none)
    }
}
