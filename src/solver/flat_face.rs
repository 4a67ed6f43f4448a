//! Sums over the points of one flat face along which material slides, with friction or without, rid of what the lattices' phase makes of
//! them (docs/theory.md, W3b).
//!
//! Along a face that goes on all round, g adds up to nothing but for 1e-3/dp, with a sign that changes with every spacing slid. It is left out
//! of S: that is rough, and shakes what slides, a few times gravity's hundredth under ten rows. Beside an end of the face (a lip, a wall's upper edge) S has a part along it that is no noise, 0.05 to 0.2/dp: it holds up the pressure that
//! the wall bears behind. What goes out there would be held back without.
//! Rings see wall points by the mean of both lengths, which adds a part along the face as well that pressure on rings needs.

use crate::math::{Vector, along, dot, norm, scale, sub};

use super::face_sums::FaceSums;
use super::pair::WallRow;
use super::wall_contact::same_normal;

/// |S| along a face times the spacing up to which it is the lattices' phase [1]: 2e-3 at most, 5e-3 at h = 1.3 dp. All of twice as much counts.
const NOISE: f64 = 5e-3;

/// What a particle sees of walls, as far as it tells whether that is one flat face that material slides along.
#[derive(Clone, Copy, Debug)]
enum Seen<const D: usize> {
    /// Nothing yet.
    Nothing,
    /// Points of such faces with this normal only.
    Flat(Vector<D>),
    /// Something else, too.
    Other,
}

/// The flat face that a particle slides along and that is all it sees of walls, while it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlatFace<const D: usize> {
    seen: Seen<D>,
    /// sum g without what the lengths of rings make of it.
    s: Vector<D>,
    /// v_w.s along the face, of what comes along with its wall.
    slid: f64,
}

impl<const D: usize> FlatFace<D> {
    pub(super) const NONE: Self = Self {
        seen: Seen::Nothing,
        s: [0.0; D],
        slid: 0.0,
    };

    /// With one more face; `moves`: its points come along with the wall.
    pub(super) fn add(&mut self, face: &FaceSums<D>, moves: bool) {
        let n = &face.normal;
        let slides = face.free_slip && face.bend.is_none();
        self.seen = match self.seen {
            Seen::Nothing if slides => Seen::Flat(*n),
            Seen::Flat(m) if slides && same_normal(&m, n) => self.seen,
            _ => Seen::Other,
        };
        if !matches!(self.seen, Seen::Flat(_)) {
            return;
        }
        let s = sub(&face.s, &face.by_length);
        for k in 0..D {
            self.s[k] += s[k];
        }
        if moves {
            self.slid += dot(&face.velocity, &along(n, &s));
        }
    }

    /// Takes from a row's sums what the lattices' phase makes of them.
    pub(super) fn smooth(&self, w: &mut WallRow<D>, spacing: f64) {
        let Seen::Flat(n) = self.seen else {
            return;
        };
        let phase = along(&n, &self.s);
        let kept = norm(&phase) * spacing / NOISE - 1.0;
        let noise = 1.0 - kept.clamp(0.0, 1.0);
        w.phase = scale(noise, &phase);
        w.s = sub(&w.s, &w.phase);
        w.drive -= noise * self.slid;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::WendlandC2;

    const DP: f64 = 0.1;
    const UP: [f64; 2] = [0.0, 1.0];

    /// A floor of points from `from` to `to` spacings beside a particle half a spacing above it, as the floor comes along at 2 m/s; `length`:
    /// what of each point's g is there by the lengths of rings, to a spacing of distance.
    fn floor(from: i32, to: i32, length: f64) -> WallRow<2> {
        let kernel = WendlandC2::<2>::new(1.6 * DP);
        let mut face = FaceSums::new(0, UP, true, None);
        face.velocity = [2.0, 0.0];
        for a in from..to {
            for b in 0..4 {
                // Off the lattice's symmetry, so that its phase shows.
                let x = [-DP * (f64::from(a) + 0.3), DP * (f64::from(b) + 0.6)];
                let r = norm(&x);
                if r < kernel.support() {
                    let part = -length * x[0] / DP;
                    let g = scale(DP * DP * kernel.f(r) / (1.0 - part), &x);
                    face.add(&g, 0.0, &[2.0, 0.0]);
                    face.add_length(part, &g);
                }
            }
        }
        let mut row = WallRow::new(0);
        row.s = face.s;
        row.drive = dot(&face.velocity, &face.s);
        let mut flat = FlatFace::NONE;
        flat.add(&face, true);
        flat.smooth(&mut row, DP);
        row
    }

    #[test]
    fn a_floor_that_goes_on_all_round_pushes_along_its_normal_alone() {
        let row = floor(-6, 6, 0.0);
        assert!(row.phase[0].abs() * DP > 1e-4, "{row:?}");
        // To rounding of sums of 1/dp.
        assert!(row.s[0].abs() < 1e-12 && row.drive.abs() < 1e-12, "{row:?}");
        assert!(row.s[1] * DP < -0.3);
    }

    /// What stands above the last spacing of a floor is held up from behind alone: 0.1/dp, twenty times the phase.
    #[test]
    fn beside_an_end_a_face_pushes_along_itself() {
        for (row, sign) in [(floor(-6, 0, 0.0), -1.0), (floor(0, 6, 0.0), 1.0)] {
            assert_eq!(row.phase, [0.0; 2]);
            assert!(sign * row.s[0] * DP > 0.08, "{row:?}");
            assert!((row.drive - 2.0 * row.s[0]).abs() < 1e-12);
        }
    }

    /// As an end comes nearer what counts of it grows from nothing without a jump.
    #[test]
    fn an_end_that_comes_nearer_counts_more_and_more() {
        let kept = |to| {
            let row = floor(-6, to, 0.0);
            row.s[0] / (row.s[0] + row.phase[0])
        };
        let kept: Vec<f64> = (0..6).map(kept).collect();
        assert!(kept.windows(2).all(|w| w[0] >= w[1] - 1e-9), "{kept:?}");
        assert!(kept[0] == 1.0 && kept[5].abs() < 1e-9, "{kept:?}");
    }

    /// Rings are pushed along a floor by its being longer outside.
    #[test]
    fn what_the_lengths_of_rings_push_along_a_face_stays() {
        let (even, row) = (floor(-6, 6, 0.0), floor(-6, 6, 0.05));
        assert!((even.phase[0] - row.phase[0]).abs() < 1e-12);
        assert!(row.s[0].abs() * DP > 1e-2, "{row:?}");
        // Across it but for the square of that.
        assert!((row.s[1] / even.s[1] - 1.0).abs() < 0.05_f64.powi(2));
    }
}
