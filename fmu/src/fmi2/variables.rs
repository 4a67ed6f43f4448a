//! Values, slopes and derivatives of variables in FMI 2.0.

use std::ffi::c_char;

use crate::access::{Above, Flag, Values as _, get, get_texts, output_derivatives, set, set_texts};
use crate::fault::{Fault, Status};
use crate::guard::{Handle, In, Need, Out, Text};

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetReal(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut value: Out<f64>,
) -> Status {
    c.call("fmi2GetReal", Need::Sound, |i| {
        get(i, vr.slice(n, "vr")?, &mut value, n, |v: f64| v)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetInteger(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut value: Out<i32>,
) -> Status {
    c.call("fmi2GetInteger", Need::Sound, |i| {
        get(i, vr.slice(n, "vr")?, &mut value, n, |v: i32| v)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut value: Out<i32>,
) -> Status {
    c.call("fmi2GetBoolean", Need::Sound, |i| {
        get(i, vr.slice(n, "vr")?, &mut value, n, |v: Flag| {
            i32::from(v.number())
        })
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    mut value: Out<*const c_char>,
) -> Status {
    c.call("fmi2GetString", Need::Sound, |i| {
        get_texts(i, vr.slice(n, "vr")?, &mut value, n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetReal(c: Handle, vr: In<u32>, n: usize, value: In<f64>) -> Status {
    c.call("fmi2SetReal", Need::Sound, |i| {
        set::<f64, _>(i, vr.slice(n, "vr")?, value.slice(n, "value"), Ok)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetInteger(
    c: Handle,
    vr: In<u32>,
    n: usize,
    value: In<i32>,
) -> Status {
    c.call("fmi2SetInteger", Need::Sound, |i| {
        set::<i32, _>(i, vr.slice(n, "vr")?, value.slice(n, "value"), Ok)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetBoolean(
    c: Handle,
    vr: In<u32>,
    n: usize,
    value: In<i32>,
) -> Status {
    c.call("fmi2SetBoolean", Need::Sound, |i| {
        let (vr, value) = (vr.slice(n, "vr")?, value.slice(n, "value"));
        set(i, vr, value, |v| Flag::from_number(v.into()))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetString(
    c: Handle,
    vr: In<u32>,
    n: usize,
    value: In<Text>,
) -> Status {
    c.call("fmi2SetString", Need::Sound, |i| {
        set_texts(i, vr.slice(n, "vr")?, value.slice(n, "value"))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetDirectionalDerivative(
    c: Handle,
    _unknown: In<u32>,
    _n_unknown: usize,
    _known: In<u32>,
    _n_known: usize,
    _dv_known: In<f64>,
    _dv_unknown: Out<f64>,
) -> Status {
    c.not_provided(
        "fmi2GetDirectionalDerivative",
        "providesDirectionalDerivative",
    )
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetRealInputDerivatives(
    c: Handle,
    vr: In<u32>,
    n: usize,
    order: In<i32>,
    value: In<f64>,
) -> Status {
    c.call("fmi2SetRealInputDerivatives", Need::Sound, |i| {
        let vr = vr.slice(n, "vr")?;
        let slopes = order.slice(n, "order").and_then(|orders| {
            if let Some(order) = orders.iter().find(|order| **order != 1) {
                return Err(Fault::border(format!(
                    "order: found {order}, allowed 1 (a slope over the next step)"
                )));
            }
            value.slice(n, "value")
        });
        let set = slopes.and_then(|slopes| i.set_slopes(vr, slopes));
        set.inspect_err(|_| i.refused(vr))
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetRealOutputDerivatives(
    c: Handle,
    vr: In<u32>,
    n: usize,
    order: In<i32>,
    mut value: Out<f64>,
) -> Status {
    c.call("fmi2GetRealOutputDerivatives", Need::Sound, |i| {
        let (vr, order) = (vr.slice(n, "vr")?, order.slice(n, "order"));
        // Above the highest order that there is, a derivative is 0, says FMI 2.0.4, section 4.2.1.
        output_derivatives(i, vr, order, Above::IsZero, &mut value, n)
    })
    .into()
}
