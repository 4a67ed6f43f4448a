//! The solve of the seepage equation: conjugate gradients over all saturated particles.

use crate::math::{Four, Lanes, in_lanes};
use crate::solver::Solver;
use crate::solver::pair::Block;

use super::Work;

/// Most iterations in a step: the next goes on from there.
const MOST_ITERATIONS: u32 = 200;

impl<const D: usize> Solver<D> {
    /// sum_j 2 V_j |F| d_j: d is 0 for what has no pores.
    #[inline(always)]
    fn weighted_sum<L: Lanes>(&self, lanes: L, d: &[f64], block: &Block<D>, row: usize) -> f64 {
        let mut sum = Four::splat(lanes, 0.0);
        let range = block.groups(row);
        let (j, g) = (&block.j[range.clone()], &block.g[range.clone()]);
        for ((j, g), c) in j.iter().zip(g).zip(&block.c[range]) {
            let mut g2 = Four::splat(lanes, 0.0);
            for g in g {
                let g = Four::load(lanes, g);
                g2 += g * g;
            }
            let other = Four::gather(lanes, |m| d[j[m] as usize]);
            sum += g2 * Four::load(lanes, c) * other;
        }
        sum.sum() / (D as f64 + 2.0)
    }

    /// product = A direction: a_i d_i - V_i sum_j 2 V_j |F| d_j, a_i the diagonal; returns direction.product.
    fn seepage_product(&self, work: &mut Work) -> f64 {
        let Work {
            diagonal,
            direction,
            product,
            ..
        } = work;
        let d = &*direction;
        self.workers
            .blocks_sum(&self.lists.blocks, product, |block, first, out| {
                let mut sum = 0.0;
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let i = first + row;
                        *o = 0.0;
                        if diagonal[i] > 0.0 {
                            let others = self.weighted_sum(lanes, d, block, row);
                            *o = diagonal[i] * d[i] - self.volume[i] * others;
                            sum += d[i] * *o;
                        }
                    }
                );
                sum
            })
    }

    /// Conjugate gradients with the diagonal.
    pub(super) fn iterate(&self, pore: &mut [f64], work: &mut Work, limit2: f64) {
        let n = pore.len();
        let [mut norm2, mut rz] = self.workers.sums(n, |i| work.squares(i));
        // The last solve's directions are no part of the state.
        work.direction.fill(0.0);
        let mut beta = 0.0;
        for _ in 0..MOST_ITERATIONS {
            if norm2 <= limit2 || rz <= 0.0 {
                return;
            }
            let (a, r) = (&work.diagonal, &work.residual);
            self.workers.each(&mut work.direction, |i, d| {
                *d = descent(a[i], r[i]) + beta * *d;
            });
            let curvature = self.seepage_product(work);
            if curvature.is_nan() || curvature <= 0.0 {
                return;
            }
            let step = rz / curvature;
            let (d, q) = (&work.direction, &work.product);
            self.workers.both(pore, &mut work.residual, |i, p, r| {
                *p += step * d[i];
                *r -= step * q[i];
                []
            });
            let [next2, next] = self.workers.sums(n, |i| work.squares(i));
            (norm2, beta, rz) = (next2, next / rz, next);
        }
    }
}

impl Work {
    /// Particle i's parts of r.r and r.z, r the residual and z the descent.
    #[inline]
    fn squares(&self, i: usize) -> [f64; 2] {
        let r = self.residual[i];
        [r * r, r * descent(self.diagonal[i], r)]
    }
}

/// A residual over the diagonal, 0 for what has no pores.
#[inline]
fn descent(diagonal: f64, residual: f64) -> f64 {
    if diagonal > 0.0 {
        residual / diagonal
    } else {
        0.0
    }
}
