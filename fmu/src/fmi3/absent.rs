//! FMI 3.0's functions for what is not there: types that no variable has, capabilities that are not claimed. They are exported all
//! the same, and answer Error with a message.

use crate::access::no_variable_of_type;
use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out};

/// Getters and setters of types that no variable has.
macro_rules! no_variables {
    ($($name:ident, $values:ty, $kind:literal;)*) => {$(
        #[unsafe(no_mangle)]
        pub(crate) extern "C" fn $name(
            c: Handle,
            _vr: In<u32>,
            n: usize,
            _values: $values,
            _n_values: usize,
        ) -> Status {
            c.call(stringify!($name), Need::Sound, |_| no_variable_of_type($kind, n))
                .into()
        }
    )*};
}

no_variables! {
    fmi3GetFloat32, Out<f32>, "Float32";
    fmi3SetFloat32, In<f32>, "Float32";
    fmi3GetInt8, Out<i8>, "Int8";
    fmi3SetInt8, In<i8>, "Int8";
    fmi3GetUInt8, Out<u8>, "UInt8";
    fmi3SetUInt8, In<u8>, "UInt8";
    fmi3GetInt16, Out<i16>, "Int16";
    fmi3SetInt16, In<i16>, "Int16";
    fmi3GetUInt16, Out<u16>, "UInt16";
    fmi3SetUInt16, In<u16>, "UInt16";
    fmi3GetInt32, Out<i32>, "Int32";
    fmi3SetInt32, In<i32>, "Int32";
    fmi3GetUInt32, Out<u32>, "UInt32";
    fmi3SetUInt32, In<u32>, "UInt32";
    fmi3GetUInt64, Out<u64>, "UInt64";
    fmi3SetUInt64, In<u64>, "UInt64";
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetBinary(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _sizes: Out<usize>,
    _values: Out<*const u8>,
    _n_values: usize,
) -> Status {
    c.call("fmi3GetBinary", Need::Sound, |_| {
        no_variable_of_type("Binary", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetBinary(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _sizes: In<usize>,
    _values: In<*const u8>,
    _n_values: usize,
) -> Status {
    c.call("fmi3SetBinary", Need::Sound, |_| {
        no_variable_of_type("Binary", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetClock(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _values: Out<u8>,
) -> Status {
    c.call("fmi3GetClock", Need::Sound, |_| {
        no_variable_of_type("Clock", n)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetClock(
    c: Handle,
    _vr: In<u32>,
    n: usize,
    _values: In<u8>,
) -> Status {
    c.call("fmi3SetClock", Need::Sound, |_| {
        no_variable_of_type("Clock", n)
    })
    .into()
}

/// Functions behind a capability that modelDescription.xml does not claim.
macro_rules! not_provided {
    ($($capability:literal: $name:ident($($argument:ty),*);)*) => {$(
        #[unsafe(no_mangle)]
        pub(crate) extern "C" fn $name(c: Handle, $(_: $argument),*) -> Status {
            c.not_provided(stringify!($name), $capability)
        }
    )*};
}

not_provided! {
    "providesPerElementDependencies": fmi3GetNumberOfVariableDependencies(u32, Out<usize>);
    "providesPerElementDependencies": fmi3GetVariableDependencies(
        u32, Out<usize>, Out<u32>, Out<usize>, Out<i32>, usize);
    "providesDirectionalDerivatives": fmi3GetDirectionalDerivative(
        In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    "providesAdjointDerivatives": fmi3GetAdjointDerivative(
        In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    "ModelVariables (no structural parameters)": fmi3EnterConfigurationMode();
    "ModelVariables (no structural parameters)": fmi3ExitConfigurationMode();
    "hasEventMode": fmi3EnterEventMode();
    "hasEventMode": fmi3EnterStepMode();
    "providesEvaluateDiscreteStates": fmi3EvaluateDiscreteStates();
    "hasEventMode": fmi3UpdateDiscreteStates(
        Out<u8>, Out<u8>, Out<u8>, Out<u8>, Out<u8>, Out<f64>);
    "ModelVariables (no clocks)": fmi3GetIntervalDecimal(In<u32>, usize, Out<f64>, Out<i32>);
    "ModelVariables (no clocks)": fmi3GetIntervalFraction(
        In<u32>, usize, Out<u64>, Out<u64>, Out<i32>);
    "ModelVariables (no clocks)": fmi3GetShiftDecimal(In<u32>, usize, Out<f64>);
    "ModelVariables (no clocks)": fmi3GetShiftFraction(In<u32>, usize, Out<u64>, Out<u64>);
    "ModelVariables (no clocks)": fmi3SetIntervalDecimal(In<u32>, usize, In<f64>);
    "ModelVariables (no clocks)": fmi3SetIntervalFraction(In<u32>, usize, In<u64>, In<u64>);
    "ModelVariables (no clocks)": fmi3SetShiftDecimal(In<u32>, usize, In<f64>);
    "ModelVariables (no clocks)": fmi3SetShiftFraction(In<u32>, usize, In<u64>, In<u64>);
    "CoSimulation (no model exchange)": fmi3EnterContinuousTimeMode();
    "CoSimulation (no model exchange)": fmi3CompletedIntegratorStep(u8, Out<u8>, Out<u8>);
    "CoSimulation (no model exchange)": fmi3SetTime(f64);
    "CoSimulation (no model exchange)": fmi3SetContinuousStates(In<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetContinuousStateDerivatives(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetEventIndicators(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetContinuousStates(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetNominalsOfContinuousStates(Out<f64>, usize);
    "CoSimulation (no model exchange)": fmi3GetNumberOfEventIndicators(Out<usize>);
    "CoSimulation (no model exchange)": fmi3GetNumberOfContinuousStates(Out<usize>);
    "CoSimulation (no scheduled execution)": fmi3ActivateModelPartition(u32, f64);
}
