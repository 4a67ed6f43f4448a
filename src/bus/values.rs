//! Names and JSON values ⇄ references and flat values of the variables table. The only part of the bus that reads the
//! table's rows.

use super::fields::Given;
use super::refusal::{Code, Refusal};
use super::set_point::SetPoint;
use crate::component::{
    self, Causality, Component, Start, ValueKind, ValueReference, Variability, Variable,
    VariableTable,
};
use crate::wire::json::number;
use serde_json::{Map, Value, json};
use std::collections::HashMap;

/// Inputs of one request, ready for [`Component::set`].
#[derive(Debug, Default, PartialEq)]
pub(super) struct Assignment {
    /// One reference an input.
    pub(super) references: Vec<ValueReference>,
    /// All values, one input after the other.
    pub(super) values: Vec<f64>,
}

impl Assignment {
    /// Finds the variables, checks lengths and that only booleans are given `true` or `false`. Ranges and modes are the component's business.
    pub(super) fn resolve(
        table: &VariableTable,
        inputs: &[(String, Given)],
    ) -> Result<Self, Refusal> {
        let mut assignment = Self::default();
        for (name, given) in inputs {
            let variable = find(table, name, |v| {
                matches!(v.causality, Causality::Input | Causality::Parameter)
            })?;
            let values = &given.flat;
            if given.has_flags && variable.kind != ValueKind::Boolean {
                return Err(Refusal::new(
                    Code::Type,
                    format!("{name}: found true or false, allowed a number"),
                ));
            }
            if values.len() != variable.len() {
                return Err(Refusal::new(
                    Code::Type,
                    format!(
                        "{name}: found {} value(s), allowed {}",
                        values.len(),
                        variable.len()
                    ),
                ));
            }
            assignment.references.push(variable.reference);
            assignment.values.extend(values);
        }
        Ok(assignment)
    }

    /// What these variables hold now.
    pub(super) fn present(&self, component: &Component) -> Result<Self, component::Error> {
        let mut values = vec![0.0; self.values.len()];
        component.get(&self.references, &mut values)?;
        Ok(Self {
            references: self.references.clone(),
            values,
        })
    }
}

/// Variables that can be set at communication points, by name.
pub(super) struct Settable(HashMap<String, Variable>);

impl Settable {
    pub(super) fn of(table: &VariableTable) -> Self {
        let rows = table.rows().iter().filter(|row| {
            let tunable = row.variability == Variability::Tunable;
            let settable = row.causality == Causality::Input
                || row.causality == Causality::Parameter && tunable;
            settable && row.kind != ValueKind::Text && !table.is_for_host(row)
        });
        Self(rows.map(|row| (row.name.clone(), row.clone())).collect())
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether a component that can be set will take this. Only for what waits: the component itself decides, and some
    /// that are not sure it takes.
    pub(super) fn surely_takes(&self, point: &SetPoint, saturates: bool) -> bool {
        let Some(row) = self.0.get(&point.variable) else {
            return false;
        };
        let (least, most) = match row.range {
            Some(range) if !(saturates && row.causality == Causality::Input) => range,
            _ => (f64::MIN, f64::MAX),
        };
        let fits = |value: &f64| {
            let whole = row.kind == ValueKind::Real || value.fract() == 0.0;
            whole && (least..=most).contains(value)
        };
        let Given { flat, has_flags } = &point.given;
        let of_kind = !has_flags || row.kind == ValueKind::Boolean;
        of_kind && flat.len() == row.len() && flat.iter().all(fits)
    }
}

/// The rows that a request names; all (arrays whole, not their elements) if it names none.
pub(super) fn rows<'t>(
    table: &'t VariableTable,
    names: Option<&[String]>,
) -> Result<Vec<&'t Variable>, Refusal> {
    match names {
        Some(names) => names
            .iter()
            .map(|name| find(table, name, |_| true))
            .collect(),
        None => Ok(all_rows(table)),
    }
}

/// All rows: arrays whole, not their elements; none for the host.
pub(super) fn all_rows(table: &VariableTable) -> Vec<&Variable> {
    let rows = table.rows().iter();
    rows.filter(|v| v.element_of.is_none() && !table.is_for_host(v))
        .collect()
}

/// Elements of arrays by name: the array's name, and which one.
pub(super) fn elements(table: &VariableTable) -> HashMap<String, (String, usize)> {
    let rows = table.rows().iter().filter_map(|row| {
        let (array, at) = row.element_of?;
        let array = table.by_reference(array)?;
        Some((row.name.clone(), (array.name.clone(), at)))
    });
    rows.collect()
}

/// Present values by name.
pub(super) fn read(
    component: &Component,
    rows: &[&Variable],
) -> Result<Map<String, Value>, component::Error> {
    rows.iter()
        .map(|variable| {
            let mut flat = vec![0.0; variable.len()];
            component.get(&[variable.reference], &mut flat)?;
            Ok((variable.name.clone(), show(variable, &flat)))
        })
        .collect()
}

/// The table as JSON: what a client needs to know before it sets or reads anything.
pub(super) fn describe(table: &VariableTable) -> Value {
    let describe_one = |v: &Variable| {
        json!({
            "name": v.name,
            "reference": v.reference,
            "description": v.description,
            "causality": match v.causality {
                Causality::Independent => "independent",
                Causality::Parameter => "parameter",
                Causality::Input => "input",
                Causality::Output => "output",
            },
            "variability": match v.variability {
                Variability::Fixed => "fixed",
                Variability::Tunable => "tunable",
                Variability::Discrete => "discrete",
                Variability::Continuous => "continuous",
            },
            "kind": match v.kind {
                ValueKind::Real => "real",
                ValueKind::Integer => "integer",
                ValueKind::Boolean => "boolean",
                ValueKind::Text => "text",
            },
            "unit": v.unit,
            "shape": v.shape,
            "start": match &v.start {
                Start::Exact(values) => show(v, values),
                Start::Empty => Value::from(""),
                Start::Calculated => Value::Null,
            },
            "min": v.range.map_or(Value::Null, |(min, _)| number(min)),
            "max": v.range.map_or(Value::Null, |(_, max)| number(max)),
        })
    };
    all_rows(table).into_iter().map(describe_one).collect()
}

fn show(variable: &Variable, flat: &[f64]) -> Value {
    let one = |x: f64| match variable.kind {
        ValueKind::Boolean => Value::Bool(x != 0.0),
        // Whole numbers up to 2^53 are exact in f64.
        ValueKind::Integer if x.fract() == 0.0 && x.abs() <= 9_007_199_254_740_992.0 => {
            Value::from(x as i64)
        }
        _ => number(x),
    };
    match flat {
        [x] if variable.shape.is_empty() => one(*x),
        _ => flat.iter().copied().map(one).collect(),
    }
}

fn find<'t>(
    table: &'t VariableTable,
    name: &str,
    wanted: impl Fn(&Variable) -> bool,
) -> Result<&'t Variable, Refusal> {
    // What is for the host of a component is not for those who reach it from outside.
    let known = table.by_name(name).filter(|v| !table.is_for_host(v));
    known.ok_or_else(|| {
        let known: Vec<_> = table
            .rows()
            .iter()
            .filter(|v| v.element_of.is_none() && !table.is_for_host(v) && wanted(v))
            .map(|v| v.name.as_str())
            .collect();
        let known = match known.as_slice() {
            [] => "none here".to_owned(),
            few => few.join(", "),
        };
        Refusal::new(
            Code::UnknownVariable,
            format!("unknown variable {name:?}; there are {known}"),
        )
    })
}
