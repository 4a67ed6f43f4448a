//! Values between the typed functions of the standards and the component's plain f64.

use std::ffi::{CString, c_char};

use sandgate::component::{ValueKind, VariableTable};

use crate::fault::Fault;
use crate::guard::{Out, Plain, Text};
use crate::instance::Instance;
use crate::log::text;

/// A type that values of one kind of variable have at the border.
pub(crate) trait Value: Copy {
    /// Variables that take it.
    const KIND: ValueKind;
    /// Into the component; refuses what the kind does not hold.
    fn enter(self) -> Result<f64, String>;
    /// Out of the component.
    fn leave(value: f64) -> Result<Self, String>;
}

impl Value for f64 {
    const KIND: ValueKind = ValueKind::Real;

    fn enter(self) -> Result<f64, String> {
        Ok(self)
    }

    fn leave(value: f64) -> Result<Self, String> {
        Ok(value)
    }
}

/// FMI 2's Integer and Enumeration.
impl Value for i32 {
    const KIND: ValueKind = ValueKind::Integer;

    fn enter(self) -> Result<f64, String> {
        Ok(f64::from(self))
    }

    fn leave(value: f64) -> Result<Self, String> {
        let inside = (f64::from(Self::MIN)..=f64::from(Self::MAX)).contains(&value);
        if inside {
            // In range and whole: nothing is lost.
            Ok(value as Self)
        } else {
            Err(format!(
                "{value} does not fit FMI 2's Integer; FMI 3 has Int64"
            ))
        }
    }
}

/// FMI 3's Int64 and Enumeration.
impl Value for i64 {
    const KIND: ValueKind = ValueKind::Integer;

    fn enter(self) -> Result<f64, String> {
        let value = self as f64;
        if self.unsigned_abs() <= 1 << 53 {
            Ok(value)
        } else {
            Err(format!("{self} is beyond 2^53"))
        }
    }

    fn leave(value: f64) -> Result<Self, String> {
        // Counts stay far below 2^53: whole and in range.
        Ok(value as Self)
    }
}

/// A Boolean as the number it is in C: `int` in FMI 2, `bool` (one byte) in FMI 3.
#[derive(Clone, Copy)]
pub(crate) struct Flag(bool);

impl Flag {
    /// 0 or 1.
    pub(crate) fn from_number(number: i64) -> Result<Self, String> {
        match number {
            0 => Ok(Self(false)),
            1 => Ok(Self(true)),
            other => Err(format!("found {other}, a Boolean is 0 or 1")),
        }
    }

    /// 0 or 1.
    pub(crate) fn number(self) -> u8 {
        u8::from(self.0)
    }
}

impl Value for Flag {
    const KIND: ValueKind = ValueKind::Boolean;

    fn enter(self) -> Result<f64, String> {
        Ok(f64::from(self.number()))
    }

    fn leave(value: f64) -> Result<Self, String> {
        Ok(Self(value != 0.0))
    }
}

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
    let fits = out.check(count, "values");
    let fits = fits.and_then(|()| check(from.table(), "get", references, V::KIND, count));
    fits.inspect_err(|_| from.refused(references))?;
    let mut values = vec![0.0; count];
    let got = from.get(references, &mut values);
    got.inspect_err(|_| from.refused(references))?;
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
    values: &[C],
    make: impl Fn(C) -> Result<V, String>,
) -> Result<(), Fault> {
    let fits = check(into.table(), "set", references, V::KIND, values.len());
    fits.inspect_err(|_| into.refused(references))?;
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
    texts: &[Text],
) -> Result<(), Fault> {
    let texts: Result<Vec<&str>, Fault> = texts.iter().map(|text| text.get("values")).collect();
    instance.set_texts(references, &texts?)
}

/// Reads texts: pointers that are good until texts are read again.
pub(crate) fn get_texts(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_do_not_fit_are_refused() {
        assert_eq!(<i32 as Value>::leave(-3.0), Ok(-3));
        assert!(<i32 as Value>::leave(3e9).is_err());
        assert_eq!(<i64 as Value>::leave(3e9), Ok(3_000_000_000));
        assert_eq!(<i64 as Value>::enter(7), Ok(7.0));
        assert!(<i64 as Value>::enter(i64::MAX).is_err());
        assert!(Flag::from_number(2).is_err());
        assert_eq!(Flag::from_number(1).map(Flag::number), Ok(1));
    }
}
