//! The scene inside this library's file, put there when the FMU was packed.

use sandgate::fmi::slot::{self, HEADER, SlotError};

/// Overwritten in the file by `sandgate fmu`; see `sandgate::fmi::slot`.
#[used]
#[unsafe(link_section = ".sandgate_scene")]
static SLOT: [u8; slot::SIZE] = slot::empty();

/// The scene's text.
pub(crate) fn embedded_scene() -> Result<String, SlotError> {
    let mut header = [0; HEADER];
    read(0, &mut header);
    let mut bytes = vec![0; slot::length(&header)?];
    read(HEADER, &mut bytes);
    slot::text(&header, bytes)
}

/// Copies bytes of the slot as they are in memory now: the compiler knows only the empty slot.
fn read(from: usize, into: &mut [u8]) {
    for (byte, place) in into.iter_mut().zip(&SLOT[from..]) {
        // SAFETY: `place` is a reference into a static array.
        *byte = unsafe { std::ptr::read_volatile(place) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_that_nobody_packed_says_so() {
        assert_eq!(embedded_scene(), Err(SlotError::Empty));
    }
}
