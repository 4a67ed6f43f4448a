//! Saved states as bytes: header, scene fingerprint, length, checksum, payload. The only module that uses bincode.
//!
//! Layout, little-endian: mark (8 bytes), format version (u32), fingerprint of the scene (32,
//! `Scene::identity`), payload length (u64), checksum (32, SHA-256 of all other bytes), payload. The payload is fixed-width
//! bincode of state only; gauges' definitions and scenes never travel in it. What is in it, `Component` decides.

use super::Error;
use crate::scene::MOST_PARTICLES;
use crate::units::hex;
use bincode::error::DecodeError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::io::Read;

/// First bytes of every saved state.
const MARK: &[u8; 8] = b"SANDGATE";
/// Counts up whenever the payload's layout changes; other versions are refused, never guessed.
const VERSION: u32 = 10;
/// Bytes before the checksum.
const PREFIX: usize = 8 + 4 + 32 + 8;
/// Bytes before the payload.
const HEADER: usize = PREFIX + 32;
/// Bytes of a particle in space that keeps all that can be kept; a test counts them.
const PARTICLE: u64 = 370;
/// Largest payload [bytes]: twice the particles that a scene may begin with, as inflows bring more. A damaged length
/// claims no more than that.
const MOST: u64 = 2 * MOST_PARTICLES as u64 * PARTICLE;
/// The same, or all that an address can tell.
const LIMIT: usize = if MOST < usize::MAX as u64 {
    MOST as usize
} else {
    usize::MAX
};

/// Little-endian, fixed width, bounded.
fn config() -> impl bincode::config::Config {
    bincode::config::standard()
        .with_little_endian()
        .with_fixed_int_encoding()
        .with_limit::<LIMIT>()
}

/// A value as bytes of fixed width.
///
/// # Errors
/// The value is too large.
pub(super) fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    let bytes = bincode::serde::encode_to_vec(value, config()).map_err(|e| e.to_string())?;
    if bytes.len() > LIMIT {
        return Err(format!(
            "the state has {} bytes, at most {LIMIT} are allowed",
            bytes.len()
        ));
    }
    Ok(bytes)
}

/// The value that [`encode`] gave these bytes for.
///
/// # Errors
/// The bytes are cut short, too long, or of something else.
pub(super) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (value, used) =
        bincode::serde::decode_from_slice(bytes, config()).map_err(|error| match error {
            DecodeError::UnexpectedEnd { .. } => "it ends too early".to_owned(),
            other => format!("found bytes that no state has: {other}"),
        })?;
    if used != bytes.len() {
        return Err(format!("{} bytes too many at the end", bytes.len() - used));
    }
    Ok(value)
}

/// A value and raw bytes behind it as one payload.
///
/// # Errors
/// As [`encode`].
pub(super) fn join<T: Serialize>(value: &T, raw: &[u8]) -> Result<Vec<u8>, String> {
    let head = encode(value)?;
    let mut payload = (head.len() as u64).to_le_bytes().to_vec();
    payload.extend_from_slice(&head);
    payload.extend_from_slice(raw);
    Ok(payload)
}

/// What [`join`] joined.
///
/// # Errors
/// The payload is something else.
pub(super) fn split<T: DeserializeOwned>(payload: &[u8]) -> Result<(T, &[u8]), String> {
    let cut = || "the payload is cut short".to_owned();
    let (length, rest) = payload.split_at_checked(8).ok_or_else(cut)?;
    let length = usize::try_from(u64::from_le_bytes(array(length))).map_err(|_| cut())?;
    let (head, raw) = rest.split_at_checked(length).ok_or_else(cut)?;
    Ok((decode(head)?, raw))
}

/// The checksum within saved bytes (SHA-256): states with the same one are the same. None if the bytes are too short.
#[must_use]
pub fn saved_checksum(bytes: &[u8]) -> Option<[u8; 32]> {
    bytes.get(PREFIX..HEADER)?.try_into().ok()
}

/// Reads saved bytes to the end that their header tells, and one more if there is one, so that what is too long is refused as
/// such. Of what is no saved state, and of what says that it is larger than any, only the header is read: devices and pipes
/// need not end.
///
/// # Errors
/// Those of the source.
pub fn read_saved(mut source: impl Read) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source
        .by_ref()
        .take(HEADER as u64)
        .read_to_end(&mut bytes)?;
    if bytes.len() == HEADER && bytes.starts_with(MARK) {
        let length = u64::from_le_bytes(array(&bytes[44..52]));
        if length <= MOST {
            source.take(length + 1).read_to_end(&mut bytes)?;
        }
    }
    Ok(bytes)
}

/// SHA-256, hex.
pub(super) fn hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Puts header and checksum before a payload.
pub(super) fn seal(fingerprint: &[u8; 32], payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + payload.len());
    bytes.extend_from_slice(MARK);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(fingerprint);
    bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    let checksum = checksum(&bytes, payload);
    bytes.extend_from_slice(&checksum);
    bytes.extend_from_slice(payload);
    bytes
}

/// The payload of a saved state of the scene with this fingerprint.
///
/// # Errors
/// [`Error::Snapshot`]: not a state, another version, cut short, changed, or of another scene.
pub(super) fn open<'a>(fingerprint: &[u8; 32], bytes: &'a [u8]) -> Result<&'a [u8], Error> {
    let refuse = |why: String| Err(Error::Snapshot(why));
    if bytes.len() < 8 || &bytes[..8] != MARK {
        return refuse("the bytes do not begin with the mark of a saved state (\"SANDGATE\"); give what save returned".to_owned());
    }
    let Some((prefix, rest)) = bytes.split_at_checked(PREFIX) else {
        return refuse(format!(
            "cut short: found {} bytes, the header alone has {HEADER}; give all bytes that save returned",
            bytes.len()
        ));
    };
    let version = u32::from_le_bytes(array(&prefix[8..12]));
    if version != VERSION {
        return refuse(format!(
            "found format version {version}, allowed {VERSION}; save anew with this version of the program"
        ));
    }
    let Some((found_checksum, payload)) = rest.split_at_checked(32) else {
        return refuse(format!(
            "cut short: found {} bytes, the header alone has {HEADER}; give all bytes that save returned",
            bytes.len()
        ));
    };
    let length = u64::from_le_bytes(array(&prefix[44..52]));
    if payload.len() as u64 != length {
        let what = if (payload.len() as u64) < length {
            "cut short"
        } else {
            "too long"
        };
        return refuse(format!(
            "{what}: found {} bytes after the header, which says {length}; give all bytes that save returned and no more",
            payload.len()
        ));
    }
    if checksum(prefix, payload) != found_checksum {
        return refuse(
            "the checksum does not match: bytes were changed since they were saved; give an earlier state, or save anew"
                .to_owned(),
        );
    }
    if &prefix[12..44] != fingerprint {
        return refuse(format!(
            "saved from another scene: found fingerprint {}, allowed {} (this scene's); give a state that was saved from this scene, or build \
             the component from the scene that it was saved from; only comments, blanks, title, [run], [[schedule]] and [log] may differ",
            &hex(&prefix[12..44])[..12],
            &hex(fingerprint)[..12]
        ));
    }
    Ok(payload)
}

fn checksum(prefix: &[u8], payload: &[u8]) -> [u8; 32] {
    let mut sum = Sha256::new();
    sum.update(prefix);
    sum.update(payload);
    sum.finalize().into()
}

/// A slice of known length as an array; zero-filled or cut if the length is wrong, which no caller does.
fn array<const N: usize>(slice: &[u8]) -> [u8; N] {
    std::array::from_fn(|i| slice.get(i).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Grains;

    const SCENE: [u8; 32] = [7; 32];

    fn refusal(bytes: &[u8]) -> String {
        match open(&SCENE, bytes) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("accepted"),
        }
    }

    #[test]
    fn what_does_not_end_is_read_as_far_as_a_state_may_go() {
        let sealed = seal(&SCENE, &[0xAB; 5000]);
        assert_eq!(read_saved(&sealed[..]).unwrap(), sealed);
        let longer = read_saved(std::io::Read::chain(&sealed[..], std::io::repeat(0))).unwrap();
        assert_eq!(longer.len(), sealed.len() + 1);
        assert!(refusal(&longer).contains("too long"));
        let zeros = read_saved(std::io::repeat(0)).unwrap();
        assert!(refusal(&zeros).contains("do not begin with the mark"));
        let mut huge = sealed;
        huge[44..52].copy_from_slice(&u64::MAX.to_le_bytes());
        let read = read_saved(std::io::Read::chain(&huge[..], std::io::repeat(0)));
        assert_eq!(read.unwrap().len(), HEADER);
    }

    #[test]
    fn what_was_sealed_opens() {
        for payload in [&b""[..], b"x", &[0xAB; 5000]] {
            assert_eq!(open(&SCENE, &seal(&SCENE, payload)).unwrap(), payload);
        }
    }

    #[test]
    fn every_shortening_is_refused() {
        let whole = seal(&SCENE, &[3; 200]);
        for length in 0..whole.len() {
            let message = refusal(&whole[..length]);
            let expected = if length < 8 {
                "mark of a saved state"
            } else {
                "cut short"
            };
            assert!(message.contains(expected), "{length}: {message}");
        }
        let mut longer = whole;
        longer.push(0);
        assert!(refusal(&longer).contains("too long"));
    }

    #[test]
    fn every_flipped_bit_is_refused() {
        let whole = seal(&SCENE, b"some state of some scene");
        for bit in 0..8 * whole.len() {
            let mut changed = whole.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            let message = refusal(&changed);
            let expected = match bit / 8 {
                0..8 => "mark of a saved state",
                8..12 => "format version",
                44..52 => "after the header",
                _ => "checksum does not match",
            };
            assert!(message.contains(expected), "bit {bit}: {message}");
        }
    }

    #[test]
    fn another_scene_is_refused() {
        let message = refusal(&seal(&[8; 32], b"state"));
        assert!(
            message.contains("another scene") && message.contains("080808080808"),
            "{message}"
        );
    }

    #[test]
    fn no_particle_takes_more_room_than_the_limit_is_made_for() {
        let mut grains = Grains::<3> {
            implicit: true,
            exact_yield: true,
            wall_friction: true,
            saturated: true,
            ..Grains::default()
        };
        let none = encode(&grains).unwrap().len();
        grains.push(0, 0, [0.0; 3], [0.0; 3], 1.0, 1.0);
        assert!(grains.is_consistent(1));
        assert_eq!((encode(&grains).unwrap().len() - none) as u64, PARTICLE);
    }

    #[test]
    fn values_keep_every_bit_and_lengths_are_checked() {
        let value = (
            vec![0.1_f64, -0.0, f64::MIN_POSITIVE, f64::NAN],
            7_u64,
            Some(3_u8),
        );
        let bytes = encode(&value).unwrap();
        let back: (Vec<f64>, u64, Option<u8>) = decode(&bytes).unwrap();
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(
            (bits(&back.0), back.1, back.2),
            (bits(&value.0), value.1, value.2)
        );
        assert!(decode::<(Vec<f64>, u64, Option<u8>)>(&bytes[..bytes.len() - 1]).is_err());
        let mut longer = bytes;
        longer.push(0);
        assert!(
            decode::<(Vec<f64>, u64, Option<u8>)>(&longer)
                .unwrap_err()
                .contains("too many")
        );
        // A length that claims the whole memory.
        assert!(decode::<Vec<f64>>(&u64::MAX.to_le_bytes()).is_err());
    }
}
