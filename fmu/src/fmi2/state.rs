//! States in FMI 2.0: taken, gone back to, freed, as bytes.

use crate::fault::Status;
use crate::guard::{Handle, In, Need, Out, StateHandle, StateSlot};

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2GetFMUstate(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi2GetFMUstate", Need::Sound, |i| state.put(i.save()?))
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SetFMUstate(c: Handle, state: StateHandle) -> Status {
    c.call("fmi2SetFMUstate", Need::Any, |i| {
        let state = state.get()?;
        i.restore(&state.bytes, state.experiment)?;
        // An instance that comes to its time by a state was told of its end before.
        i.component.set_stop_time(i.experiment.stop);
        Ok(())
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2FreeFMUstate(c: Handle, mut state: StateSlot) -> Status {
    c.call("fmi2FreeFMUstate", Need::Any, |_| state.free())
        .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SerializedFMUstateSize(
    c: Handle,
    state: StateHandle,
    mut size: Out<usize>,
) -> Status {
    c.call("fmi2SerializedFMUstateSize", Need::Any, |_| {
        size.write(&[state.get()?.bytes.len()], "size")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2SerializeFMUstate(
    c: Handle,
    state: StateHandle,
    mut bytes: Out<u8>,
    size: usize,
) -> Status {
    c.call("fmi2SerializeFMUstate", Need::Any, |_| {
        bytes.write(state.get()?.sized(size)?, "serializedState")
    })
    .into()
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi2DeSerializeFMUstate(
    c: Handle,
    bytes: In<u8>,
    size: usize,
    mut state: StateSlot,
) -> Status {
    c.call("fmi2DeSerializeFMUstate", Need::Any, |i| {
        state.put(i.deserialize(bytes.slice(size, "serializedState")?)?)
    })
    .into()
}
