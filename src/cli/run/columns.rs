//! The columns of `gauges.csv`: which variables have one, and what all rows say of each.

use super::curve::Curve;
use crate::component::{Causality, Component, ValueKind, ValueReference, VariableTable};
use crate::scene::InputTarget;

/// One scalar variable of the run.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Name in the variables table, as the header of `gauges.csv` has it.
    pub(super) name: String,
    /// SI unit.
    pub(super) unit: &'static str,
    /// Unit people like to see, with factor.
    pub(super) display_unit: Option<(&'static str, f64)>,
    /// Real, whole or yes-no.
    pub(super) kind: ValueKind,
    /// Whether it is an input: its value is the one that held over the step that ended at the row's time.
    pub(super) is_input: bool,
    /// Whether it is one element of an array (a profile).
    pub(super) is_element: bool,
    /// What all rows say of it, SI; none before the first.
    pub(super) figures: Option<Figures>,
    /// What the picture shows of it, SI; none of what is left to the table.
    pub(super) curve: Option<Curve>,
}

impl Column {
    /// Whether it is of a gauge or a device, and no element of an array.
    pub(super) fn is_of_device(&self) -> bool {
        let device = ["gauge.", "gate.", "inflow.", "outflow.", "wall."];
        !self.is_element && device.iter().any(|prefix| self.name.starts_with(prefix))
    }
}

/// What all rows say of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figures {
    pub(super) first: f64,
    pub(super) last: f64,
    /// Smallest value with the first time that it was there.
    pub(super) low: (f64, f64),
    /// Largest value, alike.
    pub(super) high: (f64, f64),
    /// Sum of the values, each times the step that ended at it.
    pub(super) over_time: f64,
}

impl Figures {
    pub(super) fn of(time: f64, value: f64) -> Self {
        Self {
            first: value,
            last: value,
            low: (value, time),
            high: (value, time),
            over_time: 0.0,
        }
    }

    /// Adds a row that a step of this length [s] ended at.
    pub(super) fn add(&mut self, time: f64, step: f64, value: f64) {
        self.last = value;
        if value.total_cmp(&self.low.0).is_lt() {
            self.low = (value, time);
        }
        if value.total_cmp(&self.high.0).is_gt() {
            self.high = (value, time);
        }
        self.over_time += value * step;
    }
}

/// The columns of a gate, and what it was told and had in the last row in which material kept it from moving.
#[derive(Clone, Debug)]
pub(super) struct GateColumns {
    pub(super) opening: usize,
    pub(super) actual_opening: usize,
    pub(super) blocked: usize,
    pub(super) last_blocked: Option<(f64, f64)>,
}

impl GateColumns {
    pub(super) fn see(&mut self, values: &[f64]) {
        if values[self.blocked] > 0.0 {
            self.last_blocked = Some((values[self.opening], values[self.actual_opening]));
        }
    }
}

/// Inputs and outputs with one value each; elements of arrays are among them, arrays as a whole are not.
pub(super) fn scalars(table: &VariableTable) -> (Vec<ValueReference>, Vec<Column>) {
    let rows = table.rows().iter();
    rows.filter(|v| matches!(v.causality, Causality::Input | Causality::Output))
        .filter(|v| v.shape.is_empty())
        .map(|v| {
            let mut column = Column {
                name: v.name.clone(),
                unit: v.unit,
                display_unit: v.display_unit,
                kind: v.kind,
                is_input: v.causality == Causality::Input,
                is_element: v.element_of.is_some(),
                figures: None,
                curve: None,
            };
            if column.is_of_device() && column.kind == ValueKind::Real {
                column.curve = Some(Curve::new());
            }
            (v.reference, column)
        })
        .unzip()
}

/// Columns of the gates of a scene.
pub(super) fn gates(component: &Component, references: &[ValueReference]) -> Vec<GateColumns> {
    let table = component.variables();
    let place = |reference| place(references, reference).expect("scalars of devices have columns");
    let columns = |gate: usize| GateColumns {
        opening: place(table.input(InputTarget::GateOpening(gate))),
        actual_opening: place(table.actual_opening(gate)),
        blocked: place(table.gate_blocked(gate)),
        last_blocked: None,
    };
    (0..component.scene().gates.len()).map(columns).collect()
}

pub(super) fn place(references: &[ValueReference], reference: ValueReference) -> Option<usize> {
    references.iter().position(|other| *other == reference)
}

/// The column that says whether a gauge's reading is a measurement.
pub(super) fn flag_of(column: &Column, columns: &[Column]) -> Option<usize> {
    let (gauge, _) = column.name.rsplit_once('.')?;
    let flag = format!("{gauge}.validity");
    columns.iter().position(|other| other.name == flag)
}

pub(super) fn header(columns: &[Column]) -> String {
    let mut header = String::from("time");
    for column in columns {
        header.push(',');
        header.push_str(&column.name);
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_of_all_rows() {
        let mut figures = Figures::of(0.0, 2.0);
        for (time, step, value) in [(1.0, 1.0, 5.0), (3.0, 2.0, -1.0), (4.0, 1.0, 5.0)] {
            figures.add(time, step, value);
        }
        let wanted = Figures {
            first: 2.0,
            last: 5.0,
            low: (-1.0, 3.0),
            high: (5.0, 1.0),
            over_time: 8.0,
        };
        assert_eq!(figures, wanted);
    }
}
