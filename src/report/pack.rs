//! Particle snapshots in 14 bytes a particle: what a screen can show, not what a computation needs.

use crate::wire::foxglove::PointCloud;
use std::fmt::Write as _;

/// Bytes of a particle in a page before base64: six 16-bit numbers, material and asleep.
pub(super) const PACKED: usize = 14;

/// The columns of a cloud.
pub(super) struct Cloud {
    /// x, y, z [m].
    pub(super) position: [Vec<f32>; 3],
    /// Speed [m/s].
    pub(super) speed: Vec<f32>,
    /// Pressure [Pa].
    pub(super) pressure: Vec<f32>,
    /// Inertial number.
    pub(super) inertial: Vec<f32>,
    phase: Vec<u8>,
    asleep: Vec<u8>,
}

impl Cloud {
    pub(super) fn of(cloud: &PointCloud) -> Self {
        let column = |name: &str| cloud.column(name);
        let small = |name: &str| column(name).iter().map(|&v| v as u8).collect();
        let (vx, vy, vz) = (column("vx"), column("vy"), column("vz"));
        let speed = (0..vx.len()).map(|i| (vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i]).sqrt());
        Self {
            speed: speed.collect(),
            position: ["x", "y", "z"].map(column),
            pressure: column("pressure"),
            inertial: column("inertial_number"),
            phase: small("phase"),
            asleep: small("asleep"),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.speed.len()
    }
}

/// What the largest 16-bit number stands for; the smallest is 0, or the lower corner.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    pub(super) lower: [f32; 3],
    pub(super) upper: [f32; 3],
    pub(super) speed: f32,
    pub(super) pressure: f32,
    pub(super) inertial: f32,
}

impl Default for Scale {
    /// Of no particle.
    fn default() -> Self {
        Self {
            lower: [f32::INFINITY; 3],
            upper: [f32::NEG_INFINITY; 3],
            speed: 0.0,
            pressure: 0.0,
            inertial: 0.0,
        }
    }
}

impl Scale {
    /// What a cloud needs.
    pub(super) fn of(mut cloud: Cloud) -> Self {
        let mut scale = Self::default();
        for axis in 0..3 {
            for &x in &cloud.position[axis] {
                scale.lower[axis] = scale.lower[axis].min(x);
                scale.upper[axis] = scale.upper[axis].max(x);
            }
        }
        scale.speed = scale.speed.max(high(&mut cloud.speed));
        scale.pressure = scale.pressure.max(high(&mut cloud.pressure));
        scale.inertial = scale.inertial.max(high(&mut cloud.inertial));
        scale
    }

    /// Has room for `other`, too.
    pub(super) fn extend(&mut self, other: &Self) {
        for axis in 0..3 {
            self.lower[axis] = self.lower[axis].min(other.lower[axis]);
            self.upper[axis] = self.upper[axis].max(other.upper[axis]);
        }
        self.speed = self.speed.max(other.speed);
        self.pressure = self.pressure.max(other.pressure);
        self.inertial = self.inertial.max(other.inertial);
    }

    /// Base64 of a cloud: columns of 16-bit little-endian numbers, then materials, then asleep.
    pub(super) fn pack(&self, cloud: &Cloud) -> String {
        let mut bytes = Vec::with_capacity(PACKED * cloud.len());
        let mut column = |values: &[f32], low: f32, high: f32, by_root: bool| {
            let span = if high > low { high - low } else { 1.0 };
            for value in values {
                let share = ((value - low) / span).clamp(0.0, 1.0);
                let share = if by_root { share.sqrt() } else { share };
                // NaN, which a log does not have, would become 0.
                bytes.extend(((share * 65535.0).round() as u16).to_le_bytes());
            }
        };
        for axis in 0..3 {
            column(
                &cloud.position[axis],
                self.lower[axis],
                self.upper[axis],
                false,
            );
        }
        column(&cloud.speed, 0.0, self.speed, false);
        column(&cloud.pressure, 0.0, self.pressure, false);
        column(&cloud.inertial, 0.0, self.inertial, true);
        bytes.extend(&cloud.phase);
        bytes.extend(&cloud.asleep);
        base64(&bytes)
    }
}

/// The value that all but a hundredth of the values are below: single fast grains do not take the colours of the rest.
fn high(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let place = (values.len() - 1) * 99 / 100;
    *values.select_nth_unstable_by(place, f32::total_cmp).1
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let word = at(0) << 16 | at(1) << 8 | at(2);
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k) & 63) as usize] as char;
            let digit = if k <= group.len() { digit } else { '=' };
            // Writing to a String does not fail.
            let _ = write!(text, "{digit}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_base64_as_the_standard_says() {
        // RFC 4648, section 10.
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[255, 254, 0]), "//4A");
    }

    #[test]
    fn a_few_fast_grains_do_not_set_the_scale() {
        let mut values: Vec<f32> = (0..1000).map(|i| i as f32).collect();
        values[3] = 1e9;
        assert!((980.0..1000.0).contains(&high(&mut values)));
        assert_eq!(high(&mut []), 0.0);
    }
}
