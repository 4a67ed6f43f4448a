//! Slopes of outputs: how fast they change, from the last two communication points.
//!
//! An output that is a value at a point in time (a depth, a mass) has the slope of the straight line between the last
//! two points. One that is a mean over a step (a discharge, a force) belongs to the middle of its step, so its line
//! goes over half of each of the last two steps, and there is none before the second step.

use super::access::bad;
use super::lifecycle::{self, Call};
use super::variables::{Causality, Source, ValueKind, Variability, Variable};
use super::{Component, Error, ValueReference};
use crate::scene::GaugeKind;

impl Component {
    /// First derivatives of continuous outputs with respect to time, as of the last communication point, in each
    /// variable's unit per second: `values` flat as in [`Component::get`]. 0 before the first step, and where a gauge
    /// read nothing at one of the points.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`]; [`Error::BadArgument`] for unknown references, wrong lengths and what is no
    /// continuous output.
    pub fn output_derivatives(
        &self,
        references: &[ValueReference],
        values: &mut [f64],
    ) -> Result<(), Error> {
        const CALL: &str = "get_output_derivatives";
        lifecycle::check(Call::GetDerivatives, self.life.mode)?;
        self.check_length(CALL, references, values.len())?;
        let rows = self.rows(CALL, references)?;
        for row in &rows {
            let continuous = row.variability == Variability::Continuous;
            if row.causality != Causality::Output || row.kind != ValueKind::Real || !continuous {
                return Err(bad(
                    CALL,
                    &row.name,
                    "a variable without a derivative",
                    "real outputs of variability continuous",
                ));
            }
        }
        let mut rest = values;
        for row in rows {
            // The lengths were checked above.
            let (mine, others) = rest.split_at_mut(row.len());
            self.slope(row, mine);
            rest = others;
        }
        Ok(())
    }

    fn slope(&self, row: &Variable, values: &mut [f64]) {
        let [last, earlier] = self.life.steps;
        let span = match self.table.source(row.reference) {
            Some(source) if self.is_mean(*source) && earlier > 0.0 => 0.5 * (last + earlier),
            Some(source) if self.is_mean(*source) => 0.0,
            _ => last,
        };
        if span <= 0.0 || !self.was_valid(row) {
            values.fill(0.0);
            return;
        }
        let offset = self.table.offset(row);
        for (k, value) in values.iter_mut().enumerate() {
            *value = (self.life.outputs[offset + k] - self.life.before[offset + k]) / span;
        }
    }

    /// Whether an output is a mean over the step.
    fn is_mean(&self, source: Source) -> bool {
        match source {
            Source::InflowActualRate(_) | Source::OutflowRate(_) => true,
            Source::Reading { gauge, first } => match self.scene.gauges[gauge].kind {
                GaugeKind::Discharge { .. } => first == 0,
                GaugeKind::Force { .. } => true,
                _ => false,
            },
            _ => false,
        }
    }

    /// Whether the row's gauge read something at both points; other outputs always do.
    fn was_valid(&self, row: &Variable) -> bool {
        let Some(Source::Reading { gauge, .. }) = self.table.source(row.reference) else {
            return true;
        };
        let mut flags = self.table.with_sources();
        let Some((flag, _)) = flags.find(|(_, s)| **s == Source::Validity(*gauge)) else {
            return true;
        };
        let offset = self.table.offset(flag);
        self.life.outputs[offset] == 0.0 && self.life.before[offset] == 0.0
    }
}
