//! Values between the typed functions of the standards and the component's plain f64.
//!
//! Each tells which variables a refused call asked for, whatever it was refused for: arrays of values come as what their
//! pointers gave, so that a bad one is told with them.

mod value;

use std::ffi::{CString, c_char};

use sandgate::component::{ValueKind, VariableTable};

use crate::fault::Fault;
use crate::guard::{Out, Plain, Text};
use crate::instance::Instance;
use crate::log::text;
pub(crate) use value::{Flag, Value};

/// Whose variables are got and set: an instance's, or those of a step that is running.
pub(crate) trait Values {
    /// For names, kinds and lengths.
    fn table(&self) -> &VariableTable;
    /// As `Component::get`.
    fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault>;
    /// As `Component::set`.
    fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), Fault>;
    /// As `Component::output_derivatives`.
    fn slopes(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault>;
    /// The call that is running is going to be refused.
    fn refused(&mut self, _: &[u32]) {}
}

/// Reads variables of kind `V` into `count` places; `make` turns each value into what C holds.
pub(crate) fn get<V: Value, C: Plain>(
    from: &mut (impl Values + ?Sized),
    references: &[u32],
    out: &mut Out<C>,
    count: usize,
    make: impl Fn(V) -> C,
) -> Result<(), Fault> {
    let got = read(from, references, out, count, make);
    got.inspect_err(|_| from.refused(references))
}

fn read<V: Value, C: Plain>(
    from: &mut (impl Values + ?Sized),
    references: &[u32],
    out: &mut Out<C>,
    count: usize,
    make: impl Fn(V) -> C,
) -> Result<(), Fault> {
    out.check(count, "values")?;
    check(from.table(), "get", references, V::KIND, count)?;
    let mut values = vec![0.0; count];
    from.get(references, &mut values)?;
    let made: Result<Vec<C>, String> = values
        .iter()
        .map(|value| V::leave(*value).map(&make))
        .collect();
    out.write(&made.map_err(Fault::Border)?, "values")
}

/// Sets variables of kind `V`, all or none; `make` turns what C holds into a value.
pub(crate) fn set<V: Value, C: Copy>(
    into: &mut (impl Values + ?Sized),
    references: &[u32],
    values: Result<&[C], Fault>,
    make: impl Fn(C) -> Result<V, String>,
) -> Result<(), Fault> {
    let set = values.and_then(|values| write(into, references, values, make));
    set.inspect_err(|_| into.refused(references))
}

fn write<V: Value, C: Copy>(
    into: &mut (impl Values + ?Sized),
    references: &[u32],
    values: &[C],
    make: impl Fn(C) -> Result<V, String>,
) -> Result<(), Fault> {
    check(into.table(), "set", references, V::KIND, values.len())?;
    let entered: Result<Vec<f64>, String> = values
        .iter()
        .map(|value| make(*value).and_then(V::enter))
        .collect();
    into.set(references, &entered.map_err(Fault::Border)?)
}

/// Sets texts, all or none.
pub(crate) fn set_texts(
    instance: &mut Instance,
    references: &[u32],
    texts: Result<&[Text], Fault>,
) -> Result<(), Fault> {
    let texts: Result<Vec<&str>, Fault> =
        texts.and_then(|texts| texts.iter().map(|text| text.get("values")).collect());
    let set = texts.and_then(|texts| instance.set_texts(references, &texts));
    set.inspect_err(|_| instance.refused(references))
}

/// Reads texts: pointers that are good until texts are read again.
pub(crate) fn get_texts(
    instance: &mut Instance,
    references: &[u32],
    out: &mut Out<*const c_char>,
    count: usize,
) -> Result<(), Fault> {
    let got = read_texts(instance, references, out, count);
    got.inspect_err(|_| instance.refused(references))
}

fn read_texts(
    instance: &mut Instance,
    references: &[u32],
    out: &mut Out<*const c_char>,
    count: usize,
) -> Result<(), Fault> {
    out.check(count, "values")?;
    let found = instance.component.texts(references)?;
    if found.len() != count {
        return Err(Fault::border(format!(
            "number of values: found {count}, allowed {}, one each reference",
            found.len()
        )));
    }
    let texts: Vec<CString> = found.into_iter().map(text).collect();
    let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
    instance.texts = texts;
    out.write(&pointers, "values")
}

/// What a derivative of an order above 1 is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Above {
    /// 0.
    IsZero,
    /// A mistake.
    IsRefused,
}

/// Slopes of outputs: derivatives of order 1.
pub(crate) fn output_derivatives(
    from: &mut (impl Values + ?Sized),
    references: &[u32],
    orders: Result<&[i32], Fault>,
    above: Above,
    out: &mut Out<f64>,
    count: usize,
) -> Result<(), Fault> {
    let got = orders.and_then(|orders| read_slopes(from, references, orders, above, out, count));
    got.inspect_err(|_| from.refused(references))
}

fn read_slopes(
    from: &mut (impl Values + ?Sized),
    references: &[u32],
    orders: &[i32],
    above: Above,
    out: &mut Out<f64>,
    count: usize,
) -> Result<(), Fault> {
    let fits = |order: i32| order == 1 || (order > 1 && above == Above::IsZero);
    if let Some(order) = orders.iter().find(|order| !fits(**order)) {
        return Err(Fault::border(format!(
            "order: found {order}, allowed 1 (maxOutputDerivativeOrder)"
        )));
    }
    out.check(count, "values")?;
    // Before room is made for what a caller claims.
    let call = "get_output_derivatives";
    from.table().check_length(call, references, count)?;
    let mut slopes = vec![0.0; count];
    from.slopes(references, &mut slopes)?;
    if above == Above::IsZero {
        // FMI 2 has no arrays: a value each reference.
        for (slope, _) in slopes
            .iter_mut()
            .zip(orders)
            .filter(|(_, order)| **order > 1)
        {
            *slope = 0.0;
        }
    }
    out.write(&slopes, "values")
}

/// For functions of a type that no variable has: fine for none, an error for any.
pub(crate) fn no_variable_of_type(name: &str, count: usize) -> Result<(), Fault> {
    if count == 0 {
        return Ok(());
    }
    Err(Fault::border(format!(
        "no variable is of type {name}; the types used are real (Float64), integer (Int64), Enumeration, Boolean and String"
    )))
}

/// Refuses variables of other kinds, and a count that is not theirs, before room is made for what a caller claims.
fn check(
    table: &VariableTable,
    call: &'static str,
    references: &[u32],
    kind: ValueKind,
    count: usize,
) -> Result<(), Fault> {
    for reference in references {
        if let Some(row) = table.by_reference(*reference)
            && row.kind != kind
        {
            return Err(Fault::border(format!(
                "variable {} is {}; this call is for {} variables",
                row.name,
                kind_name(row.kind),
                kind_name(kind)
            )));
        }
    }
    Ok(table.check_length(call, references, count)?)
}

fn kind_name(kind: ValueKind) -> &'static str {
    match kind {
        ValueKind::Real => "real",
        ValueKind::Integer => "integer",
        ValueKind::Boolean => "Boolean",
        ValueKind::Text => "text",
    }
}
