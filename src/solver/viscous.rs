//! The viscous force as an operator (docs/theory.md, E10 and E11); its solve is in `implicit`.
//!
//! Adjoint stress form: e = dev sym G(v), tau = 2 eta e, force on i: V_i [sum_j (tau_i + tau_j) g_ij + 2 K_i : tau_i].
//! It is minus the adjoint of G, with the very weights that pressure is transmitted with, so tau/p arrives as it should
//! and the operator is symmetric and positive. A share of eta goes through the pair form, which sees the zero-energy
//! modes that G does not.

use crate::math::{Tensor, Vector, add_outer, inverse, scale, sub};
use crate::state::State;

use super::Solver;
use super::pair::Block;

impl<const D: usize> Solver<D> {
    /// tau_i = 2 (1 - share) eta_i e_i(v).
    pub(super) fn stress(&self, v: &[Vector<D>], tau: &mut [Tensor<D>], with_walls: bool) {
        let share = self.numerics.pair_viscosity_share;
        self.workers
            .blocks_read(&self.lists.blocks, tau, |block, first, out| {
                for t in out.iter_mut() {
                    *t = [[0.0; D]; D];
                }
                for w in &block.wall_rows {
                    out[w.row as usize] = w.gradient(&v[first + w.row as usize], with_walls);
                }
                for (row, t) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let eta = self.viscosity[i];
                    if eta == 0.0 {
                        *t = [[0.0; D]; D];
                        continue;
                    }
                    let mut gradient = *t;
                    let vi = &v[i];
                    for pair in block.pairs_of(row) {
                        let d = sub(&v[pair.j as usize], vi);
                        for a in 0..D {
                            for c in 0..D {
                                gradient[a][c] += d[a] * pair.g[c];
                            }
                        }
                    }
                    let f = 2.0 * (1.0 - share) * eta;
                    gradient[0][0] += self.axis_rate(i, vi);
                    let e = self
                        .geometry
                        .strain_deviator(&gradient, self.hoop_rate(i, vi));
                    *t = e.map(|r| scale(f, &r));
                }
            });
    }

    /// F_i [N]: stress form with tau, and the pair form's share.
    pub(super) fn force(
        &self,
        v: &[Vector<D>],
        tau: &[Tensor<D>],
        force: &mut [Vector<D>],
        with_walls: bool,
    ) {
        let share = self.numerics.pair_viscosity_share;
        self.workers
            .blocks_read(&self.lists.blocks, force, |block, first, out| {
                for (row, f) in out.iter_mut().enumerate() {
                    let i = first + row;
                    *f = self.row_force(block, row, i, v, tau, share);
                }
                for w in &block.wall_rows {
                    let i = first + w.row as usize;
                    let stress = w.stress_force(&tau[i]);
                    let drag = crate::math::apply(&w.c, &v[i]);
                    let f = &mut out[w.row as usize];
                    for k in 0..D {
                        let drive = if with_walls { w.cv[k] } else { 0.0 };
                        f[k] += self.width
                            * self.volume[i]
                            * (stress[k] - 2.0 * share * (drag[k] - drive));
                    }
                }
            });
    }

    #[inline(always)]
    fn row_force(
        &self,
        block: &Block<D>,
        row: usize,
        i: usize,
        v: &[Vector<D>],
        tau: &[Tensor<D>],
        share: f64,
    ) -> Vector<D> {
        let (vi, ti) = (&v[i], &tau[i]);
        let mut f = [0.0; D];
        for pair in block.pairs_of(row) {
            let j = pair.j as usize;
            let tj = &tau[j];
            let mut along = 0.0;
            for k in 0..D {
                along += (v[j][k] - vi[k]) * pair.g[k];
            }
            let c = share * pair.c * along;
            for a in 0..D {
                let mut s = c * pair.g[a];
                for b in 0..D {
                    s += (ti[a][b] + tj[a][b]) * pair.g[b];
                }
                f[a] += s;
            }
        }
        if self.geometry.is_axisymmetric() {
            f[0] -= self.ring_drag(i, vi, ti, share);
        }
        scale(self.width * self.volume[i], &f)
    }

    /// Inverse Jacobi blocks: m I + dt V_i sum c g g^T, the pair form with the whole viscosity.
    pub(super) fn jacobi_blocks(&self, state: &State<D>, dt: f64, jacobi: &mut [Tensor<D>]) {
        self.workers
            .blocks_read(&self.lists.blocks, jacobi, |block, first, out| {
                for (row, b) in out.iter_mut().enumerate() {
                    *b = [[0.0; D]; D];
                    for pair in block.pairs_of(row) {
                        add_outer(b, pair.c, &pair.g, &pair.g);
                    }
                }
                for w in &block.wall_rows {
                    let b = &mut out[w.row as usize];
                    for r in 0..D {
                        for c in 0..D {
                            b[r][c] += 2.0 * w.c[r][c];
                        }
                    }
                }
                if self.geometry.is_axisymmetric() {
                    for (row, b) in out.iter_mut().enumerate() {
                        b[0][0] += self.ring_stiffness(first + row);
                    }
                }
                for (row, b) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let f = dt * self.width * self.volume[i];
                    for r in 0..D {
                        for c in 0..D {
                            b[r][c] *= f;
                        }
                        b[r][r] += state.grains.mass[i];
                    }
                    *b = inverse(b);
                }
            });
    }
}
