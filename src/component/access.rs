//! Setting and getting variables: all or nothing, any order, any partition, any repetition.

use super::engine::Ramp;
use super::lifecycle::{self, Call};
use super::variables::{Causality, Source, ValueKind, Variability, Variable};
use super::{Component, Error, ValueReference, VariableTable};
use crate::units::{shown, shown_bound};

/// Share of its range by which an input may be out of it: what rounding does to a controller's limit.
pub(super) const RANGE_SLACK: f64 = 1e-9;

impl Component {
    /// Sets variables, all or none. `values` holds the flat values of all references, one after the other.
    ///
    /// An input is held from here on, or has the slope over the next step that it was given since the last one, before this
    /// call or after it. One that is out of range by a billionth of the range, which rounding may do, is clamped; by more,
    /// also by a slope, only if `saturate_inputs` is set, by the same call too, and then [`Component::take_notes`] tells. Fixed
    /// parameters take effect together, at [`Component::settle`].
    ///
    /// # Errors
    /// Unknown reference, wrong length, not finite, out of range, not settable (in this mode): names the variable,
    /// what was found and what is allowed. Nothing is changed then.
    pub fn set(&mut self, references: &[ValueReference], values: &[f64]) -> Result<(), Error> {
        self.check_length("set", references, values.len())?;
        let mut accepted = Vec::with_capacity(values.len());
        let mut notes = Vec::new();
        let saturates = self.saturates_with(references, values);
        let fixed =
            |r: &ValueReference| matches!(self.table.source(*r), Some(Source::Adjustable(_)));
        let settled = !self.is_unsettled() && !references.iter().any(fixed);
        for (row, value) in self.settable("set", references)?.into_iter().zip(values) {
            let range = self.range_now(row, settled);
            let slack = self.slack_of(row);
            accepted.push(accept((row, range, slack), *value, saturates, &mut notes)?);
        }
        self.notes.append(&mut notes);
        for (reference, value) in references.iter().zip(&accepted) {
            match self.table.source(*reference) {
                // A new pool of threads costs time: only when the number is another.
                Some(Source::Threads) if *value as usize == self.threads => {}
                Some(Source::Threads) => self.use_threads(*value as usize),
                Some(Source::SaturateInputs) => self.life.saturate_inputs = *value != 0.0,
                Some(Source::Adjustable(i)) => {
                    if let Some(place) = self.life.parameters.get_mut(*i) {
                        *place = *value;
                    }
                }
                Some(source) => {
                    if let Some(ramp) = self.input_mut(*source) {
                        // Its slope, if it has one, was given since the last step.
                        ramp.value = *value;
                    }
                }
                None => self.set_for_host(*reference, *value),
            }
        }
        Ok(())
    }

    /// The range that a row has with the parameters as they are. The most that an inflow lets in follows from its material's density:
    /// where parameters wait for [`Component::settle`], so do rates.
    fn range_now(&self, row: &Variable, settled: bool) -> Option<(f64, f64)> {
        match self.table.source(row.reference) {
            Some(Source::InflowRate(i)) if settled => Some((0.0, self.scene.inflows[*i].max_rate)),
            Some(Source::InflowRate(_)) => Some((0.0, f64::MAX)),
            _ => row.range,
        }
    }

    /// By how much an input may be out of its range, SI; a rate's range has no end while parameters wait.
    fn slack_of(&self, row: &Variable) -> f64 {
        let span = self
            .range_now(row, true)
            .map_or(0.0, |(least, most)| most - least);
        RANGE_SLACK * span
    }

    /// The range of a variable, SI; that of an inflow's rate follows from its material's density as it is set, and is only that rates
    /// are not negative until [`Component::settle`].
    #[must_use]
    pub fn range_of(&self, row: &Variable) -> Option<(f64, f64)> {
        self.range_now(row, !self.is_unsettled())
    }

    /// Inputs that were clamped to their range since the last call of this, because `saturate_inputs` is set: one
    /// line each, for logs.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Whether inputs out of their range are clamped and not refused: `saturate_inputs`.
    #[must_use]
    pub fn saturates_inputs(&self) -> bool {
        self.life.saturate_inputs
    }

    /// Whether inputs are clamped by a call that sets these, wherever `saturate_inputs` stands among them; settable ones have one value
    /// each.
    fn saturates_with(&self, references: &[ValueReference], values: &[f64]) -> bool {
        let mut set = references.iter().zip(values).rev();
        let given =
            set.find(|(r, _)| matches!(self.table.source(**r), Some(Source::SaturateInputs)));
        given.map_or(self.life.saturate_inputs, |(_, value)| *value != 0.0)
    }

    /// Gives inputs a slope for the next step: value + slope (t - t0), t0 being the start of the step. After the
    /// step the input holds the value it reached. `slopes` in the variable's unit per second.
    ///
    /// # Errors
    /// As [`Component::set`]; parameters have no slope.
    pub fn set_input_derivatives(
        &mut self,
        references: &[ValueReference],
        slopes: &[f64],
    ) -> Result<(), Error> {
        const CALL: &str = "set_input_derivatives";
        self.check_length(CALL, references, slopes.len())?;
        for (row, slope) in self.settable(CALL, references)?.into_iter().zip(slopes) {
            if row.causality != Causality::Input {
                return Err(bad(CALL, &row.name, "a parameter", "inputs"));
            }
            if !slope.is_finite() {
                return Err(bad(CALL, &row.name, &shown(*slope), "a finite slope"));
            }
        }
        for (reference, slope) in references.iter().zip(slopes) {
            if let Some(source) = self.table.source(*reference).copied()
                && let Some(ramp) = self.input_mut(source)
            {
                ramp.slope = *slope;
            }
        }
        Ok(())
    }

    /// Slopes that inputs have for the next step: reference and slope in the variable's unit per second. Those of 0 are
    /// left out.
    #[must_use]
    pub fn input_slopes(&self) -> Vec<(ValueReference, f64)> {
        let inputs = &self.life.inputs;
        let slope = |source: &Source| match source {
            Source::GateOpening(i) => inputs.gate_opening[*i].slope,
            Source::InflowRate(i) => inputs.inflow_rate[*i].slope,
            Source::WallDrive(i) => inputs.wall_drive[*i].slope,
            _ => 0.0,
        };
        let rows = self.table.with_sources();
        rows.map(|(row, source)| (row.reference, slope(source)))
            .filter(|(_, slope)| *slope != 0.0)
            .collect()
    }

    /// Reads variables into `values` (flat, as in [`Component::set`]). Pure: gauges are sampled once a step, not here.
    ///
    /// # Errors
    /// Unknown reference, wrong length.
    pub fn get(&self, references: &[ValueReference], values: &mut [f64]) -> Result<(), Error> {
        self.get_as(references, values, self.life.time, &self.life.outputs)
    }

    /// As [`Component::get`], with these outputs at this time.
    pub(super) fn get_as(
        &self,
        references: &[ValueReference],
        values: &mut [f64],
        time: f64,
        outputs: &[f64],
    ) -> Result<(), Error> {
        self.check_length("get", references, values.len())?;
        let mut rest = values;
        for row in self.rows("get", references)? {
            // The lengths were checked above.
            let (mine, others) = rest.split_at_mut(row.len());
            self.read(row, mine, time, outputs);
            rest = others;
        }
        Ok(())
    }

    /// The values of one row.
    fn read(&self, row: &Variable, values: &mut [f64], time: f64, outputs: &[f64]) {
        let inputs = &self.life.inputs;
        match self.table.source(row.reference) {
            Some(Source::Time) => values.fill(time),
            Some(Source::Threads) => values.fill(self.threads as f64),
            Some(Source::SaturateInputs) => values.fill(f64::from(self.life.saturate_inputs)),
            Some(Source::Adjustable(i)) => values.fill(self.life.parameters[*i]),
            Some(Source::GateOpening(i)) => values.fill(inputs.gate_opening[*i].value),
            Some(Source::InflowRate(i)) => values.fill(inputs.inflow_rate[*i].value),
            Some(Source::WallDrive(i)) => values.fill(inputs.wall_drive[*i].value),
            None => values.fill(self.number_for_host(row.reference)),
            _ => {
                let offset = self.table.offset(row);
                values.copy_from_slice(&outputs[offset..offset + values.len()]);
            }
        }
    }

    fn input_mut(&mut self, source: Source) -> Option<&mut Ramp> {
        match source {
            Source::GateOpening(i) => self.life.inputs.gate_opening.get_mut(i),
            Source::InflowRate(i) => self.life.inputs.inflow_rate.get_mut(i),
            Source::WallDrive(i) => self.life.inputs.wall_drive.get_mut(i),
            _ => None,
        }
    }

    /// Rows of references.
    pub(super) fn rows(
        &self,
        call: &'static str,
        references: &[ValueReference],
    ) -> Result<Vec<&Variable>, Error> {
        self.table.rows_of(call, references)
    }

    /// Rows of references, all of them inputs or parameters that may be set in this mode.
    fn settable(
        &self,
        call: &'static str,
        references: &[ValueReference],
    ) -> Result<Vec<&Variable>, Error> {
        let rows = self.rows(call, references)?;
        for row in &rows {
            let kind = match (row.causality, row.variability) {
                (Causality::Input, _) => Call::SetInput,
                (Causality::Parameter, Variability::Tunable) => Call::SetTunable,
                (Causality::Parameter, _) => Call::SetFixed,
                (Causality::Output, _) => {
                    return Err(bad(call, &row.name, "an output", "inputs and parameters"));
                }
                (Causality::Independent, _) => {
                    return Err(bad(
                        call,
                        &row.name,
                        "the independent variable",
                        "inputs and parameters",
                    ));
                }
            };
            lifecycle::check(kind, self.life.mode).map_err(|error| error.about(&row.name))?;
        }
        Ok(rows)
    }

    pub(super) fn check_length(
        &self,
        call: &'static str,
        references: &[ValueReference],
        found: usize,
    ) -> Result<(), Error> {
        self.table.check_length(call, references, found)
    }
}

impl VariableTable {
    /// Rows of references.
    fn rows_of(
        &self,
        call: &'static str,
        references: &[ValueReference],
    ) -> Result<Vec<&Variable>, Error> {
        let find = |reference: &ValueReference| {
            self.by_reference(*reference).ok_or_else(|| {
                let last = self.rows().len() - 1;
                bad(
                    call,
                    "value reference",
                    &reference.to_string(),
                    &format!("0 to {last}"),
                )
            })
        };
        references.iter().map(find).collect()
    }

    /// Whether these variables are numbers and have `found` flat values together: what [`Component::get`] and
    /// [`Component::set`] refuse otherwise, for adapters that make room for values before. `call` stands in the message.
    ///
    /// # Errors
    /// [`Error::BadArgument`]: unknown reference, a text, another number of values.
    pub fn check_length(
        &self,
        call: &'static str,
        references: &[ValueReference],
        found: usize,
    ) -> Result<(), Error> {
        let rows = self.rows_of(call, references)?;
        if let Some(row) = rows.iter().find(|row| row.kind == ValueKind::Text) {
            return Err(bad(call, &row.name, "a text", "variables that are numbers"));
        }
        let wanted: usize = rows.iter().map(|row| row.len()).sum();
        if wanted == found {
            return Ok(());
        }
        let allowed = format!("{wanted}, as many as these variables have");
        Err(bad(call, "number of values", &found.to_string(), &allowed))
    }
}

/// The value as it is taken: inputs a little out of range, or if they are saturated far, are clamped.
fn accept(
    (row, range, slack): (&Variable, Option<(f64, f64)>, f64),
    value: f64,
    saturates: bool,
    notes: &mut Vec<String>,
) -> Result<f64, Error> {
    if row.causality == Causality::Input
        && value.is_finite()
        && let Some((least, most)) = range
        && !(least..=most).contains(&value)
    {
        let clamped = value.clamp(least, most);
        if (value - clamped).abs() <= slack {
            return Ok(clamped);
        }
        if saturates {
            notes.push(saturated(&row.name, value, clamped));
            return Ok(clamped);
        }
    }
    check_value(row, range, value)?;
    Ok(value)
}

/// What is told of an input that was clamped.
pub(super) fn saturated(what: &str, found: f64, clamped: f64) -> String {
    let (found, clamped) = (shown(found), shown_bound(clamped));
    format!("{what}: found {found}, clamped to {clamped}, because saturate_inputs is true")
}

/// Finite, in range, whole where it must be.
fn check_value(row: &Variable, range: Option<(f64, f64)>, value: f64) -> Result<(), Error> {
    let (least, most) = range.unwrap_or((f64::MIN, f64::MAX));
    let whole = row.kind == ValueKind::Real || value.fract() == 0.0;
    if value.is_finite() && (least..=most).contains(&value) && whole {
        return Ok(());
    }
    let number = if row.kind == ValueKind::Real {
        "a number"
    } else {
        "a whole number"
    };
    let unit = if row.unit.is_empty() || row.unit == "1" {
        ""
    } else {
        row.unit
    };
    let (least, most) = (shown_bound(least), shown_bound(most));
    let allowed = format!("{number} from {least} to {most} {unit}");
    Err(bad("set", &row.name, &shown(value), allowed.trim_end()))
}

pub(super) fn bad(call: &'static str, what: &str, found: &str, allowed: &str) -> Error {
    Error::BadArgument {
        call,
        what: what.to_owned(),
        found: found.to_owned(),
        allowed: allowed.to_owned(),
        remedy: String::new(),
    }
}
