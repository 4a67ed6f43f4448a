//! Sums of a row while it is swept, lane by lane.
//!
//! Symbols as in `fluid_row`.

use crate::math::{Four, Lanes};
use crate::solver::directions;
use crate::solver::meeting::KINDS;

use super::Row;
use super::pairs::Pairs;

/// [`Row`] in lanes.
pub(super) struct Sums<L: Lanes, const D: usize> {
    zero: Four<L>,
    shear: Shear<L, D>,
    /// That without harder and softer neighbours, and without softer ones; nothing where materials do not meet.
    without: [Shear<L, D>; 2],
    directions: [Four<L>; directions::COUNT],
    curvature: Four<L>,
    speed2: Four<L>,
    side: [Four<L>; D],
    nearness: Four<L>,
}

/// What a particle tells its shear rate from: what neighbours add to it depends on their kind (`meeting`).
#[derive(Clone, Copy)]
struct Shear<L: Lanes, const D: usize> {
    gradient: [[Four<L>; D]; D],
    /// Symmetric: the half with a <= b.
    moment: [[Four<L>; D]; D],
    /// Over D + 2.
    pair_shear2: Four<L>,
}

impl<L: Lanes, const D: usize> Sums<L, D> {
    #[inline(always)]
    pub(super) fn new(lanes: L) -> Self {
        let zero = Four::splat(lanes, 0.0);
        let shear = Shear {
            gradient: [[zero; D]; D],
            moment: [[zero; D]; D],
            pair_shear2: zero,
        };
        Self {
            zero,
            shear,
            without: [shear; 2],
            directions: [zero; directions::COUNT],
            curvature: zero,
            speed2: zero,
            side: [zero; D],
            nearness: zero,
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, pairs: &Pairs<L, D>) {
        let (x, v, g) = (&pairs.x, &pairs.v, &pairs.g);
        for b in 0..D {
            self.side[b] += g[b];
            for a in 0..D {
                self.shear.gradient[a][b] -= v[a] * g[b];
                if a <= b {
                    self.shear.moment[a][b] -= x[a] * g[b];
                }
            }
        }
        self.shear.pair_shear2 -= pairs.weight * pairs.vx * pairs.vx;
        self.speed2 = self.speed2.max(pairs.v2);
        // Groups are filled up with i itself.
        self.nearness -= pairs.r2.where_greater(self.zero, pairs.vf);
    }

    /// Adds what scenes with fluids need besides.
    #[inline(always)]
    pub(super) fn add_for_fluids(&mut self, pairs: &Pairs<L, D>, curvature: Four<L>) {
        self.curvature += curvature;
        let parts = directions::of_neighbour(&pairs.x, pairs.weight, self.zero);
        for (sum, part) in self.directions.iter_mut().zip(parts) {
            *sum -= part;
        }
    }

    /// Before group n, and behind the last: keeps the sums where a kind of neighbours ends. `kinds` as neighbours
    /// have them (`meeting`).
    #[inline(always)]
    pub(super) fn note_kinds(&mut self, n: usize, kinds: &[usize; KINDS - 1]) {
        for (without, &end) in self.without.iter_mut().zip(&kinds[1..]) {
            if n == end {
                *without = self.shear;
            }
        }
    }

    /// What the lanes come to where neighbours of all kinds count alike.
    #[inline(always)]
    pub(super) fn of_all(&self) -> Row<D> {
        let mut row = Row {
            pair_shear2: (D as f64 + 2.0) * self.shear.pair_shear2.sum(),
            directions: self.directions.map(Four::sum),
            curvature: self.curvature.sum(),
            speed2: self.speed2.largest(),
            side: self.side.map(Four::sum),
            nearness: self.nearness.sum(),
            ..Row::NONE
        };
        for a in 0..D {
            for b in 0..D {
                row.gradient[a][b] = self.shear.gradient[a][b].sum();
                row.moment[a][b] = self.shear.moment[a.min(b)][a.max(b)].sum();
            }
        }
        row
    }

    /// Sets apart what harder and softer neighbours add.
    #[inline(always)]
    pub(super) fn set_apart(&self, row: &mut Row<D>) {
        let all = &self.shear;
        let [own, harder] = &self.without;
        // What the shear rate is compared with is of the same neighbours.
        row.pair_shear2 = (D as f64 + 2.0) * harder.pair_shear2.sum();
        for a in 0..D {
            for b in 0..D {
                // Harder ones twice, softer ones not at all.
                let once_more = harder.gradient[a][b] - own.gradient[a][b];
                let softer = all.gradient[a][b] - harder.gradient[a][b];
                row.images[a][b] = (once_more - softer).sum();
                let (low, high) = (a.min(b), a.max(b));
                row.softer[a][b] = (all.moment[low][high] - harder.moment[low][high]).sum();
            }
        }
    }
}
