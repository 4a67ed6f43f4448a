//! The plain C interface's table of variables, and their values.

use std::ffi::{CString, c_char};

use sandgate::component::{Causality, Start, ValueKind, Variability, Variable};

use super::code;
use crate::access::{Values, get_texts};
use crate::asked::Asked;
use crate::fault::Fault;
use crate::guard::{CVariable, Handle, In, Need, Out, Text};
use crate::instance::Instance;
use crate::log::text;

/// Name, description, unit and display unit of each variable: what a [`CVariable`] points to while its instance lives.
pub(super) fn names(instance: &Instance) -> Vec<[CString; 4]> {
    let rows = instance.component.variables().rows().iter();
    rows.map(|row| {
        let shown = row.display_unit.map_or("", |(name, _)| name);
        [&row.name, &row.description, row.unit, shown].map(text)
    })
    .collect()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_count(instance: Handle) -> u32 {
    instance
        .call("sandgate_variable_count", Need::Any, |i| {
            Ok(u32::try_from(i.names.len()).unwrap_or(u32::MAX))
        })
        .unwrap_or(0)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_info(
    instance: Handle,
    reference: u32,
    mut variable: Out<CVariable>,
) -> i32 {
    code(instance.call("sandgate_variable_info", Need::Any, |i| {
        let row = i.component.variables().by_reference(reference);
        match (row, i.names.get(reference as usize)) {
            (Some(row), Some(names)) => variable.write(&[info(row, names)], "variable"),
            _ => Err(Fault::border(format!(
                "value reference {reference} is unknown; the table has {} rows",
                i.names.len()
            ))),
        }
    }))
}

fn info(row: &Variable, names: &[CString; 4]) -> CVariable {
    let [name, description, unit, display_unit] = names;
    let (minimum, maximum) = row.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let (element_of, place) = row.element_of.unwrap_or_default();
    CVariable {
        name: name.as_ptr(),
        description: description.as_ptr(),
        unit: unit.as_ptr(),
        display_unit: display_unit.as_ptr(),
        display_factor: row.display_unit.map_or(1.0, |(_, factor)| factor),
        minimum,
        maximum,
        length: row.len() as u64,
        reference: row.reference,
        causality: match row.causality {
            Causality::Independent => 0,
            Causality::Parameter => 1,
            Causality::Input => 2,
            Causality::Output => 3,
        },
        variability: match row.variability {
            Variability::Fixed => 0,
            Variability::Tunable => 1,
            Variability::Discrete => 2,
            Variability::Continuous => 3,
        },
        kind: match row.kind {
            ValueKind::Real => 0,
            ValueKind::Integer => 1,
            ValueKind::Boolean => 2,
            ValueKind::Text => 3,
        },
        has_start: i32::from(row.start != Start::Calculated),
        is_element: i32::from(row.element_of.is_some()),
        element_of,
        element_index: u32::try_from(place).unwrap_or(u32::MAX),
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_variable_by_name(
    instance: Handle,
    name: Text,
    mut reference: Out<u32>,
) -> i32 {
    code(instance.call("sandgate_variable_by_name", Need::Any, |i| {
        let name = name.get("name")?;
        match i.component.variables().by_name(name) {
            Some(row) => reference.write(&[row.reference], "reference"),
            None => {
                i.refuses(&Asked::Name(name));
                Err(Fault::border(format!(
                    "no variable is called {name}; ask sandgate_variable_info for the names"
                )))
            }
        }
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set(
    instance: Handle,
    references: In<u32>,
    reference_count: usize,
    values: In<f64>,
    value_count: usize,
) -> i32 {
    code(instance.call("sandgate_set", Need::Sound, |i| {
        let references = references.slice(reference_count, "references")?;
        let values = values.slice(value_count, "values");
        let set = values.and_then(|values| i.set(references, values));
        set.inspect_err(|_| i.refused(references))
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get(
    instance: Handle,
    references: In<u32>,
    reference_count: usize,
    mut values: Out<f64>,
    value_count: usize,
) -> i32 {
    code(instance.call("sandgate_get", Need::Sound, |i| {
        let references = references.slice(reference_count, "references")?;
        let done = read(i, references, &mut values, value_count);
        done.inspect_err(|_| i.refused(references))
    }))
}

fn read(
    instance: &mut Instance,
    references: &[u32],
    values: &mut Out<f64>,
    count: usize,
) -> Result<(), Fault> {
    values.check(count, "values")?;
    let table = instance.table();
    table.check_length("get", references, count)?;
    let mut found = vec![0.0; count];
    instance.get(references, &mut found)?;
    values.write(&found, "values")
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_set_text(instance: Handle, reference: u32, value: Text) -> i32 {
    code(instance.call("sandgate_set_text", Need::Sound, |i| {
        let text = value.get("value");
        let set = text.and_then(|text| i.set_texts(&[reference], &[text]));
        set.inspect_err(|_| i.refused(&[reference]))
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_get_text(
    instance: Handle,
    reference: u32,
    mut value: Out<*const c_char>,
) -> i32 {
    code(instance.call("sandgate_get_text", Need::Sound, |i| {
        get_texts(i, &[reference], &mut value, 1)
    }))
}
