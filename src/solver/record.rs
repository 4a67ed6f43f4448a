//! What sweeps look up of a neighbour, packed in one cache line and read by four neighbours at a time.
//!
//! A record holds velocity v and either place, volume V and hoop 1/r, or the stress tau. Words in the plane: x y vx vy V
//! 1/r and xx xy vx vy yy; in space: x y z V vx vy vz and xx xy xz yy yz vx vy vz (zz is minus the others).

use crate::math::{Four, LANES, Lanes, Quad, Tensor, Vector};

/// Two groups of four words.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Record([Quad; 2]);

/// Where a tensor's component stands; none for zz in space.
const fn word<const D: usize>(a: usize, b: usize) -> usize {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    match (D, low, high) {
        (_, 0, k) => k,
        (2, ..) => 4,
        (_, 1, k) => 2 + k,
        _ => usize::MAX,
    }
}

/// First word of the velocity beside a place.
const fn moving<const D: usize>() -> usize {
    if D == 2 { 2 } else { 4 }
}

/// First word of the velocity beside a stress.
const fn stressed<const D: usize>() -> usize {
    if D == 2 { 2 } else { 5 }
}

impl Record {
    /// Place, velocity, volume and 1/r of a particle.
    #[inline(always)]
    pub(super) fn of_motion<const D: usize>(
        x: &Vector<D>,
        v: &Vector<D>,
        volume: f64,
        hoop: f64,
    ) -> Self {
        let mut words = [0.0; 2 * LANES];
        words[..D].copy_from_slice(x);
        words[moving::<D>()..moving::<D>() + D].copy_from_slice(v);
        words[if D == 2 { 4 } else { 3 }] = volume;
        if D == 2 {
            words[5] = hoop;
        }
        Self::from_words(&words)
    }

    /// Stress and velocity of a particle.
    #[inline(always)]
    pub(super) fn of_stress<const D: usize>(tau: &Tensor<D>, v: &Vector<D>) -> Self {
        let mut words = [0.0; 2 * LANES];
        for a in 0..D {
            for b in a..D {
                if word::<D>(a, b) < 2 * LANES {
                    words[word::<D>(a, b)] = tau[a][b];
                }
            }
        }
        words[stressed::<D>()..stressed::<D>() + D].copy_from_slice(v);
        Self::from_words(&words)
    }

    /// Of words in any order.
    #[inline(always)]
    pub(super) fn from_words(w: &[f64; 2 * LANES]) -> Self {
        Self([
            Quad([w[0], w[1], w[2], w[3]]),
            Quad([w[4], w[5], w[6], w[7]]),
        ])
    }

    #[inline(always)]
    fn word(&self, k: usize) -> f64 {
        self.0[k / LANES].0[k % LANES]
    }

    /// The stress of a record of stress.
    #[inline(always)]
    pub(super) fn stress<const D: usize>(&self) -> Tensor<D> {
        let mut tau = [[0.0; D]; D];
        for a in 0..D {
            for b in 0..D {
                tau[a][b] = if word::<D>(a, b) < 2 * LANES {
                    self.word(word::<D>(a, b))
                } else {
                    -(self.word(0) + self.word(3))
                };
            }
        }
        tau
    }

    /// The velocity of a record of stress.
    #[inline(always)]
    pub(super) fn velocity<const D: usize>(&self) -> Vector<D> {
        let mut v = [0.0; D];
        for (k, c) in v.iter_mut().enumerate() {
            *c = self.word(stressed::<D>() + k);
        }
        v
    }

    /// Adds to the velocity of a record of stress.
    #[inline(always)]
    pub(super) fn add_velocity<const D: usize>(&mut self, dv: &Vector<D>) {
        for (k, dv) in dv.iter().enumerate() {
            let word = stressed::<D>() + k;
            self.0[word / LANES].0[word % LANES] += dv;
        }
    }

    /// self += s other, all words.
    #[inline(always)]
    pub(super) fn add_scaled(&mut self, s: f64, other: &Self) {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            for (a, b) in a.0.iter_mut().zip(&b.0) {
                *a += s * b;
            }
        }
    }
}

/// Places and velocities of four neighbours.
pub(super) struct Motions<L: Lanes, const D: usize> {
    pub(super) x: [Four<L>; D],
    pub(super) v: [Four<L>; D],
    pub(super) volume: Four<L>,
    pub(super) hoop: Four<L>,
}

/// Stresses and velocities of four neighbours.
pub(super) struct Stresses<L: Lanes, const D: usize> {
    pub(super) tau: [[Four<L>; D]; D],
    pub(super) v: [Four<L>; D],
}

/// The words of four records, one group for each word. What is not used costs nothing once inlined.
#[inline(always)]
pub(super) fn words<L: Lanes>(lanes: L, of: &[Record], j: &[u32; LANES]) -> [Four<L>; 2 * LANES] {
    let r = [
        &of[j[0] as usize],
        &of[j[1] as usize],
        &of[j[2] as usize],
        &of[j[3] as usize],
    ];
    let first = Four::transpose(lanes, [&r[0].0[0], &r[1].0[0], &r[2].0[0], &r[3].0[0]]);
    let second = Four::transpose(lanes, [&r[0].0[1], &r[1].0[1], &r[2].0[1], &r[3].0[1]]);
    [
        first[0], first[1], first[2], first[3], second[0], second[1], second[2], second[3],
    ]
}

/// Looks up four neighbours in records of motion.
#[inline(always)]
pub(super) fn motions<L: Lanes, const D: usize>(
    lanes: L,
    of: &[Record],
    j: &[u32; LANES],
) -> Motions<L, D> {
    let w = words(lanes, of, j);
    let (mut x, mut v) = ([w[0]; D], [w[0]; D]);
    for k in 0..D {
        x[k] = w[k];
        v[k] = w[moving::<D>() + k];
    }
    Motions {
        x,
        v,
        volume: w[if D == 2 { 4 } else { 3 }],
        hoop: w[5],
    }
}

/// Looks up four neighbours in records of stress. RINGS: in the plane yy is not minus xx.
#[inline(always)]
pub(super) fn stresses<L: Lanes, const D: usize, const RINGS: bool>(
    lanes: L,
    of: &[Record],
    j: &[u32; LANES],
) -> Stresses<L, D> {
    let w = words(lanes, of, j);
    let zero = Four::splat(lanes, 0.0);
    let (mut tau, mut v) = ([[zero; D]; D], [zero; D]);
    for a in 0..D {
        v[a] = w[stressed::<D>() + a];
        for b in 0..D {
            tau[a][b] = match (D, a, b) {
                (2, 1, 1) if !RINGS => zero - w[0],
                (3, 2, 2) => zero - (w[0] + w[3]),
                _ => w[word::<D>(a, b)],
            };
        }
    }
    Stresses { tau, v }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Portable;

    #[test]
    fn what_goes_in_comes_out() {
        let space = [[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, -5.0]];
        let record = Record::of_stress(&space, &[6.0, 7.0, 8.0]);
        assert_eq!(record.stress::<3>(), space);
        assert_eq!(record.velocity::<3>(), [6.0, 7.0, 8.0]);
        let ring = [[1.0, 2.0], [2.0, 9.0]];
        let flat = Record::of_stress(&ring, &[6.0, 7.0]);
        assert_eq!(flat.stress::<2>(), ring);
        assert_eq!(flat.velocity::<2>(), [6.0, 7.0]);
        let four = stresses::<_, 3, false>(Portable, &[record, flat], &[0, 0, 1, 0]);
        for a in 0..3 {
            assert_eq!(four.v[a].store().0[1], 6.0 + a as f64);
            for b in 0..3 {
                assert_eq!(four.tau[a][b].store().0[3], space[a][b]);
            }
        }
        let motion = Record::of_motion(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0], 7.0, 0.0);
        let four = motions::<_, 3>(Portable, &[motion], &[0; 4]);
        assert_eq!(four.x.map(|x| x.store().0[2]), [1.0, 2.0, 3.0]);
        assert_eq!(four.v.map(|v| v.store().0[2]), [4.0, 5.0, 6.0]);
        assert_eq!(four.volume.store().0[0], 7.0);
        let motion = Record::of_motion(&[1.0, 2.0], &[4.0, 5.0], 7.0, 8.0);
        let four = motions::<_, 2>(Portable, &[motion], &[0; 4]);
        assert_eq!(four.v.map(|v| v.store().0[2]), [4.0, 5.0]);
        assert_eq!([four.volume, four.hoop].map(|v| v.store().0[0]), [7.0, 8.0]);
    }
}
