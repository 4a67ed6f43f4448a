//! Fluids at walls: their stress goes on into the wall as momentum says (docs/theory.md, W4).
//!
//! A wall point takes the stress of the particle that sees it. Across the face grad sigma.n = rho (a - g), so that it would be
//! sigma_i.n + (x_w - x_i).n rho (a - g), which is worth a part K of the particle's own momentum:
//!
//!   m (I - K) (a - g) = F,   K = sum_walls P |F_iw| V (n.x_iw)^2,                                         (W4)
//!
//! F the surface forces without it, P = n n^T at free slip (a traction has no part along such a wall) and I at no slip. In the
//! first row of a flat wall K is 0.5 P. Without it the sum of stresses that a wall gets is that of about 0.7 dp inside, and
//! rows there shear too fast: by 5 % of the stress at 20 rows, which is a fourth of a yield stress fluid's rate. The wall
//! gets m K (g - a) beside -F, so that momentum balances.
//!
//! Only fluids: in sand both pressure and friction would gain by the same factor.

use crate::math::{Tensor, Vector, apply, inverse, scale, trace};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// Most of a particle's momentum that walls are given [1]: corners and slits would ask for all of it.
const MOST: f64 = 0.8;

impl<const D: usize> Solver<D> {
    /// Gathers K of every particle after a sweep; nothing in scenes without fluids.
    pub(super) fn note_lean(&mut self, state: &State<D>) {
        if !self.has_fluids {
            return;
        }
        self.lean.clear();
        self.lean.resize(state.grains.len(), [[0.0; D]; D]);
        let mut lean = std::mem::take(&mut self.lean);
        self.workers
            .blocks_read(&self.lists.blocks, &mut lean, |block, _, out| {
                for w in &block.wall_rows {
                    out[w.row as usize] = bounded(&w.lean);
                }
            });
        self.lean = lean;
    }

    /// m (I - K) a.
    #[inline(always)]
    pub(super) fn inertia(&self, mass: f64, i: usize, a: &Vector<D>) -> Vector<D> {
        match self.lean.get(i) {
            None => scale(mass, a),
            Some(k) => {
                let part = apply(k, a);
                std::array::from_fn(|c| mass * (a[c] - part[c]))
            }
        }
    }

    /// Divides the velocity changes that surface forces made by I - K; gravity acts on all.
    pub(super) fn lean_on_walls(
        &self,
        state: &State<D>,
        dt: f64,
        block: &Block<D>,
        first: usize,
        out: &mut [super::pressure::Prediction<D>],
    ) {
        if self.lean.is_empty() {
            return;
        }
        for w in &block.wall_rows {
            let i = first + w.row as usize;
            let k = &self.lean[i];
            if trace(k) <= 0.0 {
                continue;
            }
            let rest: Tensor<D> = std::array::from_fn(|a| {
                std::array::from_fn(|b| f64::from(u8::from(a == b)) - k[a][b])
            });
            let o = &mut out[w.row as usize];
            let free: Vector<D> =
                std::array::from_fn(|a| state.grains.velocity[i][a] + dt * self.gravity[a]);
            let change: Vector<D> = std::array::from_fn(|a| o.velocity[a] - free[a]);
            let change = apply(&inverse(&rest), &change);
            for a in 0..D {
                o.velocity[a] = free[a] + change[a];
            }
        }
    }

    /// m (a - g) dt [N s], times what of K was kept: what each wall point's part of K makes an impulse of.
    pub(super) fn leant(
        &self,
        state: &State<D>,
        i: usize,
        whole: &Tensor<D>,
        dt: f64,
    ) -> Vector<D> {
        let Some(k) = self.lean.get(i) else {
            return [0.0; D];
        };
        let kept = if trace(whole) > 0.0 {
            trace(k) / trace(whole)
        } else {
            0.0
        };
        let m = kept * state.grains.mass[i];
        std::array::from_fn(|a| {
            let change = self.viscous.velocity[i][a] - state.grains.velocity[i][a];
            m * (change - dt * self.gravity[a])
        })
    }
}

/// K, less of it where its largest eigenvalue would be more than [`MOST`].
fn bounded<const D: usize>(k: &Tensor<D>) -> Tensor<D> {
    // Row sums bound eigenvalues.
    let rows = k.map(|row| row.iter().map(|c| c.abs()).sum::<f64>());
    let most = rows.iter().copied().fold(0.0, f64::max);
    if most <= MOST {
        return *k;
    }
    k.map(|row| scale(MOST / most, &row))
}
