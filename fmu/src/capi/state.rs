//! States in the plain C interface: saved, gone back to, compared.

use super::code;
use crate::fault::Fault;
use crate::guard::{Handle, In, Need, Out};
use crate::log::text;

/// Digits of a hash.
const HASH: usize = 64;

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_save_size(instance: Handle, mut size: Out<usize>) -> i32 {
    code(instance.call("sandgate_save_size", Need::Sound, |i| {
        size.write(&[i.component.save()?.len()], "size")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_save(
    instance: Handle,
    mut bytes: Out<u8>,
    capacity: usize,
    mut size: Out<usize>,
) -> i32 {
    code(instance.call("sandgate_save", Need::Sound, |i| {
        let state = i.save_if(|needed| {
            if needed > capacity {
                return Err(Fault::border(format!(
                    "found room for {capacity} bytes, the state has {needed}"
                )));
            }
            size.check(1, "size")?;
            bytes.check(needed, "bytes")
        })?;
        bytes.write(&state.bytes, "bytes")?;
        size.write(&[state.bytes.len()], "size")
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_restore(instance: Handle, bytes: In<u8>, size: usize) -> i32 {
    code(instance.call("sandgate_restore", Need::Any, |i| {
        i.restore(bytes.slice(size, "bytes")?, None)
    }))
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn sandgate_state_hash(instance: Handle, mut hash: Out<u8>) -> i32 {
    code(instance.call("sandgate_state_hash", Need::Sound, |i| {
        let text = text(&i.component.state_hash());
        if text.as_bytes().len() != HASH {
            // The caller's buffer holds a hash and no more.
            return Err(Fault::border(text.to_string_lossy().into_owned()));
        }
        hash.write(text.as_bytes_with_nul(), "hash")
    }))
}
