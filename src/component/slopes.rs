//! Slopes of outputs: how fast they change, from the last two communication points.
//!
//! An output that is a value at a point in time (a depth, a mass) has the slope of the straight line between the last
//! two points. One that is a mean over a step (a discharge, a force) belongs to the middle of its step, so its line
//! goes over half of each of the last two steps, and there is none before the second step.

use super::access::bad;
use super::lifecycle::{self, Call};
use super::variables::{Causality, Source, ValueKind, Variability, Variable};
use super::{Component, Error, ValueReference};
use crate::boundary::Steers;
use crate::scene::GaugeKind;

/// Outputs at two points in time, and what lies before them.
#[derive(Clone, Copy)]
struct Points<'a> {
    now: &'a [f64],
    before: &'a [f64],
    /// Time between the points, and length of the step before; 0 where there was none [s].
    steps: [f64; 2],
}

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
        let points = Points {
            now: &self.life.outputs,
            before: &self.life.before,
            steps: self.life.steps,
        };
        self.slopes_between(points, references, values)
    }

    /// As [`Component::output_derivatives`], inside a step that has come to `time` [s] with these outputs.
    pub(super) fn output_derivatives_within(
        &self,
        (start, time, outputs): (f64, f64, &[f64]),
        references: &[ValueReference],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let points = Points {
            now: outputs,
            before: &self.life.outputs,
            steps: [time - start, self.life.steps[0]],
        };
        self.slopes_between(points, references, values)
    }

    fn slopes_between(
        &self,
        points: Points<'_>,
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
            self.slope(points, row, mine);
            rest = others;
        }
        Ok(())
    }

    fn slope(&self, points: Points<'_>, row: &Variable, values: &mut [f64]) {
        let [last, earlier] = points.steps;
        let span = match self.table.source(row.reference) {
            Some(source) if self.is_mean(*source) && earlier > 0.0 => 0.5 * (last + earlier),
            Some(source) if self.is_mean(*source) => 0.0,
            _ => last,
        };
        if span <= 0.0 || !self.was_valid(points, row) {
            values.fill(0.0);
            return;
        }
        let offset = self.table.offset(row);
        for (k, value) in values.iter_mut().enumerate() {
            *value = (points.now[offset + k] - points.before[offset + k]) / span;
        }
    }

    /// Whether an output is a mean over the step.
    fn is_mean(&self, source: Source) -> bool {
        match source {
            Source::InflowActualRate(_) | Source::OutflowRate(_) => true,
            Source::WallActualSpeed(i) => {
                let mut drives = self.scene.drives();
                drives.nth(i).is_some_and(|(_, d)| d.steers == Steers::Way)
            }
            Source::Reading { gauge, first } => match self.scene.gauges[gauge].kind {
                GaugeKind::Discharge { .. } => first == 0,
                GaugeKind::Force { .. } => true,
                _ => false,
            },
            _ => false,
        }
    }

    /// Whether the row's gauge read something at both points; other outputs always do.
    fn was_valid(&self, points: Points<'_>, row: &Variable) -> bool {
        let Some(Source::Reading { gauge, .. }) = self.table.source(row.reference) else {
            return true;
        };
        let mut flags = self.table.with_sources();
        let Some((flag, _)) = flags.find(|(_, s)| **s == Source::Validity(*gauge)) else {
            return true;
        };
        let offset = self.table.offset(flag);
        points.now[offset] == 0.0 && points.before[offset] == 0.0
    }
}
