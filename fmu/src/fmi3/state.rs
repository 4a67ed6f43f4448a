//! States in FMI 3.0: taken, gone back to, freed, as bytes.

use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out, StateHandle, StateSlot};

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetFMUState(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi3GetFMUState", Need::Sound, |i| state.put(i.save()?))
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SetFMUState(c: Handle, state: StateHandle) -> Status {
    c.call("fmi3SetFMUState", Need::Any, |i| {
        let state = state.get()?;
        i.restore(&state.bytes, state.experiment)
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3FreeFMUState(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi3FreeFMUState", Need::Any, |_| state.free())
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SerializedFMUStateSize(
    c: Handle,
    state: StateHandle,
    mut size: Out<usize>,
) -> Status {
    c.call("fmi3SerializedFMUStateSize", Need::Any, |_| {
        size.write(&[state.get()?.bytes.len()], "size")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3SerializeFMUState(
    c: Handle,
    state: StateHandle,
    mut bytes: Out<u8>,
    size: usize,
) -> Status {
    c.call("fmi3SerializeFMUState", Need::Any, |_| {
        bytes.write(state.get()?.sized(size)?, "serializedState")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3DeserializeFMUState(
    c: Handle,
    bytes: In<u8>,
    size: usize,
    mut state: StateSlot,
) -> Status {
    c.call("fmi3DeserializeFMUState", Need::Any, |i| {
        state.put(i.deserialize(bytes.slice(size, "serializedState")?)?)
    })
    .into()
}
