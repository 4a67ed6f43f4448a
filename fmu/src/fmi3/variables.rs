//! Values and derivatives of variables in FMI 3.0, of the types that variables have; `absent` answers for the others.

use std::ffi::c_char;

use crate::access::{Above, Flag, get, get_texts, output_derivatives, set, set_texts};
use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out, Text};

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetFloat64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetFloat64", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            |v: f64| v,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetInt64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<i64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetInt64", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            |v: i64| v,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<u8>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetBoolean", |i| {
        get(
            i,
            vr.slice(n, "valueReferences")?,
            &mut values,
            n_values,
            Flag::number,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetFloat64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetFloat64", |i| {
        set::<f64, _>(
            i,
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values"),
            Ok,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetInt64(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<i64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetInt64", |i| {
        set::<i64, _>(
            i,
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values"),
            Ok,
        )
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<u8>,
    n_values: usize,
) -> Status {
    c.visit("fmi3SetBoolean", |i| {
        let (vr, values) = (
            vr.slice(n, "valueReferences")?,
            values.slice(n_values, "values"),
        );
        set(i, vr, values, |v| Flag::from_number(v.into()))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut values: Out<*const c_char>,
    n_values: usize,
) -> Status {
    c.call("fmi3GetString", Need::Sound, |i| {
        get_texts(i, vr.slice(n, "valueReferences")?, &mut values, n_values)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    values: In<Text>,
    n_values: usize,
) -> Status {
    c.call("fmi3SetString", Need::Sound, |i| {
        let references = vr.slice(n, "valueReferences")?;
        set_texts(i, references, values.slice(n_values, "values"))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetOutputDerivatives(
    c: Handle,
    vr: In<u32>,
    n: usize,
    orders: In<i32>,
    mut values: Out<f64>,
    n_values: usize,
) -> Status {
    c.visit("fmi3GetOutputDerivatives", |i| {
        let (vr, orders) = (vr.slice(n, "valueReferences")?, orders.slice(n, "orders"));
        output_derivatives(i, vr, orders, Above::IsRefused, &mut values, n_values)
    })
    .into()
}
