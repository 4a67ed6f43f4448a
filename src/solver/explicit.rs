//! Rows that need no implicit solve: where viscosity does next to nothing in one step (water), the viscous force is taken as it
//! is, and the conjugate gradients leave the row out (docs/theory.md, E9).
//!
//! Symbols: e = dt eta sum_j 2 (D + 2) V_j |F|/(D rho), how much of a lone particle's motion against its neighbours viscosity
//! takes in one step; J Jacobi block, r residual.

use crate::math::{apply, dot};
use crate::state::State;

use super::Solver;
use super::implicit::Viscous;

/// Largest e of a row that may be left out [1]: what is left of its residual then is at most about this share.
pub(super) const MOST: f64 = 0.02;

/// e of a viscosity over dt eta/rho, from a lattice's sum_j 2 V_j |F| [1/m^2].
pub(super) fn rate<const D: usize>(lattice_sum: f64) -> f64 {
    (D as f64 + 2.0) / D as f64 * lattice_sum
}

impl<const D: usize> Solver<D> {
    /// Names in `work.explicit` the rows of Newtonian fluids that, like all fluids among their neighbours, have a small e.
    pub(super) fn find_explicit(&self, state: &State<D>, dt: f64, work: &mut Viscous<D>) {
        let (explicit, quick) = (&mut work.explicit, &mut work.quick);
        explicit.clear();
        if !self.materials.iter().any(|m| m.is_newtonian()) {
            return;
        }
        let grains = &state.grains;
        let rate = rate::<D>(self.lattice_sum);
        quick.resize(grains.len(), false);
        self.workers.each(quick, |i, quick| {
            let material = &self.materials[grains.phase[i] as usize];
            *quick =
                material.is_newtonian() && dt * rate * self.viscosity[i] < MOST * grains.density[i];
        });
        explicit.resize(grains.len(), false);
        let quick = &*quick;
        self.workers
            .blocks_read(&self.lists.blocks, explicit, |block, first, out| {
                for (row, explicit) in out.iter_mut().enumerate() {
                    let i = first + row;
                    // Between fluid and grains the fluid's stress acts, twice (F6), and that is quick.
                    let [like, other, harder, _] = block.kinds(row);
                    let is_quick = harder.is_empty()
                        || 2.0 * dt * rate * self.viscosity[i] < MOST * grains.density[i];
                    let mut near = block.j[like.start..other.end].iter().flatten();
                    *explicit = quick[i] && is_quick && near.all(|&j| quick[j as usize]);
                }
            });
    }

    /// Moves the explicit rows by what their residual asks for and takes it from them; returns the square of what residual is
    /// left to the solve. Where the explicit rows' own error would be more than the solve's `limit`, none stays explicit.
    pub(super) fn settle_explicit(&self, norm2: f64, limit: f64, work: &mut Viscous<D>) -> f64 {
        let Viscous {
            current,
            jacobi,
            residual,
            explicit,
            ..
        } = work;
        if explicit.is_empty() {
            return norm2;
        }
        let [solved, settled] = self.workers.sums(residual.len(), |i| {
            let r2 = dot(&residual[i], &residual[i]);
            if explicit[i] { [0.0, r2] } else { [r2, 0.0] }
        });
        if MOST * MOST * settled > 0.25 * limit * limit {
            explicit.clear();
            return norm2;
        }
        self.workers.both(current, residual, |i, current, r| {
            if explicit[i] {
                current.add_velocity(&apply(&jacobi[i], r));
                *r = [0.0; D];
            }
            []
        });
        solved
    }
}
