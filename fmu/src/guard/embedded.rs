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
    #[cfg(test)]
    if let Some(slot) = packed::SLOT.take() {
        into.copy_from_slice(&slot[from..from + into.len()]);
        packed::SLOT.set(Some(slot));
        return;
    }
    for (byte, place) in into.iter_mut().zip(&SLOT[from..]) {
        // SAFETY: `place` is a reference into a static array.
        *byte = unsafe { std::ptr::read_volatile(place) };
    }
}

/// Tests have no packed file: they fill a slot of their own.
#[cfg(test)]
pub(crate) mod packed {
    use std::cell::Cell;

    use sandgate::fmi::slot;

    thread_local! {
        pub(super) static SLOT: Cell<Option<Vec<u8>>> = const { Cell::new(None) };
    }

    /// From here on this thread's library holds this scene.
    pub(crate) fn pack(scene: &str) {
        let mut library = super::SLOT.to_vec();
        slot::fill(&mut library, scene).expect("the scene fits");
        SLOT.set(Some(library));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_says_whether_it_was_packed() {
        assert_eq!(embedded_scene(), Err(SlotError::Empty));
        packed::pack("name = \"x\"");
        assert_eq!(embedded_scene().as_deref(), Ok("name = \"x\""));
    }

    #[test]
    fn a_scene_is_read_by_threads_with_little_stack() {
        let thread = std::thread::Builder::new().stack_size(64 * 1024);
        let thread = thread.spawn(|| {
            packed::pack("name = \"x\"");
            embedded_scene()
        });
        let read = thread.expect("it starts").join().expect("it ends");
        assert_eq!(read.as_deref(), Ok("name = \"x\""));
    }
}
