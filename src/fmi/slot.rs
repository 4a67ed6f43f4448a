//! Where a scene lives inside the shared library: a reserved block that packing overwrites.
//!
//! One library serves every scene, an FMU must start without reading any file, and an importer passes nothing but a
//! token. So the library carries an empty block with a marker, and [`fill`] writes the scene's text into the copy that
//! goes into the archive. No linker is needed, and the code stays the same byte for byte.
//!
//! Layout, little-endian: marker (32 bytes), capacity (u64), length (u64), SHA-256 of the text (32 bytes), text.

use sha2::{Digest, Sha256};

/// Longest scene text [bytes].
pub const CAPACITY: usize = 256 * 1024;
/// Bytes before the text.
pub const HEADER: usize = 32 + 8 + 8 + 32;
/// Bytes of the whole block.
pub const SIZE: usize = HEADER + CAPACITY;

const MARKER: [u8; 32] = *b"\x7fsandgate-scene-slot-1\xa5\x5a\xe1\x1e\x96\x69\xc3\x3c\0\0";

/// What is wrong with a slot.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum SlotError {
    /// Nobody has put a scene in.
    #[error(
        "this library holds no scene; pack an FMU with `sandgate fmu`, or create the instance from scene text"
    )]
    Empty,
    /// The text does not have the checksum beside it, or the header is not one.
    #[error("the scene inside this library is damaged; pack the FMU again")]
    Damaged,
    /// No slot, or more than one, among the bytes.
    #[error("found {0} scene slots, a library has 1")]
    Count(usize),
    /// Longer than [`CAPACITY`].
    #[error("scene text of {0} bytes, a slot holds up to {CAPACITY}")]
    TooLong(usize),
}

/// What stands behind the marker. The two must not stand side by side among a library's constants, where they would be a slot.
const CAPACITY_BYTES: [u8; 8] = (CAPACITY as u64).to_le_bytes();

/// An empty slot, for the library's static. When a program runs it is no value to have: threads with less stack than it are
/// ordinary ones.
#[must_use]
pub const fn empty() -> [u8; SIZE] {
    let mut slot = [0; SIZE];
    let (marker, rest) = slot.split_at_mut(MARKER.len());
    marker.copy_from_slice(&MARKER);
    rest.split_at_mut(CAPACITY_BYTES.len())
        .0
        .copy_from_slice(&CAPACITY_BYTES);
    slot
}

/// Writes a scene's text into the one slot among the bytes of a library.
///
/// # Errors
/// [`SlotError::Count`] and [`SlotError::TooLong`].
pub fn fill(library: &mut [u8], text: &str) -> Result<(), SlotError> {
    if text.len() > CAPACITY {
        return Err(SlotError::TooLong(text.len()));
    }
    // The marker alone may stand among a library's constants; a slot has its capacity behind it.
    let found: Vec<usize> = memory_find(library, &[&MARKER[..], &CAPACITY_BYTES].concat());
    let &[at] = found.as_slice() else {
        return Err(SlotError::Count(found.len()));
    };
    let Some(slot) = library.get_mut(at..at + SIZE) else {
        return Err(SlotError::Count(0));
    };
    slot[40..48].copy_from_slice(&(text.len() as u64).to_le_bytes());
    slot[48..80].copy_from_slice(&Sha256::digest(text.as_bytes()));
    slot[HEADER..].fill(0);
    slot[HEADER..HEADER + text.len()].copy_from_slice(text.as_bytes());
    Ok(())
}

/// Length of the text that a header announces [bytes].
///
/// # Errors
/// [`SlotError::Empty`], [`SlotError::Damaged`].
pub fn length(header: &[u8; HEADER]) -> Result<usize, SlotError> {
    if header[..32] != MARKER || header[32..40] != CAPACITY_BYTES {
        return Err(SlotError::Damaged);
    }
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&header[40..48]);
    match usize::try_from(u64::from_le_bytes(bytes)) {
        Ok(0) => Err(SlotError::Empty),
        Ok(length) if length <= CAPACITY => Ok(length),
        _ => Err(SlotError::Damaged),
    }
}

/// The text behind a header, checked.
///
/// # Errors
/// [`SlotError::Damaged`].
pub fn text(header: &[u8; HEADER], bytes: Vec<u8>) -> Result<String, SlotError> {
    if Sha256::digest(&bytes).as_slice() != &header[48..80] {
        return Err(SlotError::Damaged);
    }
    String::from_utf8(bytes).map_err(|_| SlotError::Damaged)
}

fn memory_find(bytes: &[u8], wanted: &[u8]) -> Vec<usize> {
    let first = wanted[0];
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(step) = bytes[at..].iter().position(|b| *b == first) {
        at += step;
        if bytes[at..].starts_with(wanted) {
            found.push(at);
        }
        at += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(slot: &[u8]) -> [u8; HEADER] {
        slot[..HEADER]
            .try_into()
            .expect("a slot starts with its header")
    }

    #[test]
    fn a_scene_put_into_a_library_reads_back() {
        let mut library = vec![0x7f; 1000];
        library.extend(MARKER); // a marker alone, as among constants
        library.extend(empty());
        library.extend([1, 2, 3]);
        for scene in ["name = \"ü\"", &"x".repeat(CAPACITY)] {
            fill(&mut library, scene).expect("it fits");
            let slot = &library[1032..1032 + SIZE];
            let n = length(&header(slot)).expect("filled");
            assert_eq!(
                text(&header(slot), slot[HEADER..HEADER + n].to_vec()).as_deref(),
                Ok(scene)
            );
        }
        assert_eq!(library[1032 + SIZE..], [1, 2, 3]);
    }

    #[test]
    fn empty_damaged_missing_double_and_overfull_slots_are_told_apart() {
        let mut one = empty().to_vec();
        assert_eq!(length(&header(&one)), Err(SlotError::Empty));
        assert_eq!(
            fill(&mut one, &"x".repeat(CAPACITY + 1)),
            Err(SlotError::TooLong(CAPACITY + 1))
        );
        fill(&mut one, "abc").expect("it fits");
        assert_eq!(
            text(&header(&one), b"abd".to_vec()),
            Err(SlotError::Damaged)
        );
        one[0] ^= 1;
        assert_eq!(length(&header(&one)), Err(SlotError::Damaged));
        assert_eq!(fill(&mut one, "abc"), Err(SlotError::Count(0)));
        let mut two = [empty(), empty()].concat();
        assert_eq!(fill(&mut two, "abc"), Err(SlotError::Count(2)));
        let mut cut = empty()[..SIZE - 1].to_vec();
        assert_eq!(fill(&mut cut, "abc"), Err(SlotError::Count(0)));
    }
}
