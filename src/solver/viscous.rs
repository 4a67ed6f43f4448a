//! The viscous force and its implicit solve (docs/theory.md, E9 to E12).
//!
//! Adjoint stress form: e = dev sym G(v), tau = 2 eta e, force on i: V_i [sum_j (tau_i + tau_j) g_ij + 2 K_i : tau_i].
//! It is minus the adjoint of G, with the very weights that pressure is transmitted with, so tau/p arrives as it should
//! and the operator is symmetric and positive. A share of eta goes through the pair form, which sees the zero-energy
//! modes that G does not.
//!
//! (M - dt F) v = M v*, by conjugate gradients with D x D Jacobi blocks, started from the last step's change.

use crate::math::{Tensor, Vector, add_outer, dot, dot_rows, inverse, scale, sub, sum_rows};
use crate::state::State;

use super::lists::mean;
use super::pair::Block;
use super::{Solver, SolverError};

/// Work arrays of the solve.
#[derive(Debug, Default)]
pub(super) struct Viscous<const D: usize> {
    tau: Vec<Tensor<D>>,
    jacobi: Vec<Tensor<D>>,
    residual: Vec<Vector<D>>,
    direction: Vec<Vector<D>>,
    product: Vec<Vector<D>>,
    /// The unknown; after the solve the new velocity [m/s].
    pub(super) velocity: Vec<Vector<D>>,
}

impl<const D: usize> Solver<D> {
    /// Solves for the new velocities (left in `self.viscous.velocity`); returns the iterations used.
    pub(super) fn solve_viscous(&mut self, state: &State<D>, dt: f64) -> Result<u32, SolverError> {
        let mut work = std::mem::take(&mut self.viscous);
        let result = self.conjugate_gradients(state, dt, &mut work);
        if result.is_ok() {
            self.restore_momentum(state, &mut work.velocity);
        }
        self.viscous = work;
        result
    }

    fn conjugate_gradients(
        &self,
        state: &State<D>,
        dt: f64,
        work: &mut Viscous<D>,
    ) -> Result<u32, SolverError> {
        let n = state.grains.len();
        let (workers, mass) = (&self.workers, &state.grains.mass);
        let Viscous {
            tau,
            jacobi,
            residual,
            direction,
            product,
            velocity,
        } = work;
        tau.resize(n, [[0.0; D]; D]);
        jacobi.resize(n, [[0.0; D]; D]);
        for v in [
            &mut *residual,
            &mut *direction,
            &mut *product,
            &mut *velocity,
        ] {
            v.resize(n, [0.0; D]);
        }
        let predicted = |i: usize| &self.prediction[i].velocity;
        workers.each(velocity, |i, v| {
            let a = &state.grains.viscous_acceleration[i];
            *v = std::array::from_fn(|k| predicted(i)[k] + dt * a[k]);
        });
        // residual = M (v* - v) + dt F(v), walls moving.
        self.stress(velocity, tau, true);
        self.force(velocity, tau, product, true);
        workers.each(residual, |i, r| {
            *r = std::array::from_fn(|k| {
                mass[i] * (predicted(i)[k] - velocity[i][k]) + dt * product[i][k]
            });
        });
        self.jacobi_blocks(state, dt, jacobi);
        let limit = self.solver_limit(state, dt);
        let mut norm2 = dot_rows(workers, residual, residual);
        if !norm2.is_finite() {
            return Err(self.not_finite(state, "viscous force", |i| {
                residual[i].iter().all(|v| v.is_finite())
            }));
        }
        let mut rz = 0.0;
        let mut iterations = 0;
        while norm2 > limit * limit {
            if iterations == self.numerics.solver_max_iterations {
                return Err(SolverError::NotConverged {
                    time: state.time,
                    iterations,
                    residual: norm2.sqrt(),
                    allowed: limit,
                });
            }
            let next = sum_rows(workers, n, |i| {
                dot(&residual[i], &crate::math::apply(&jacobi[i], &residual[i]))
            });
            let beta = if iterations == 0 { 0.0 } else { next / rz };
            rz = next;
            workers.each(direction, |i, d| {
                let z = crate::math::apply(&jacobi[i], &residual[i]);
                *d = std::array::from_fn(|k| z[k] + beta * d[k]);
            });
            self.stress(direction, tau, false);
            self.force(direction, tau, product, false);
            workers.each(product, |i, q| {
                *q = std::array::from_fn(|k| mass[i] * direction[i][k] - dt * q[k])
            });
            let curvature = dot_rows(workers, direction, product);
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(self.not_finite(state, "viscous solve", |i| {
                    product[i].iter().all(|v| v.is_finite())
                }));
            }
            let step = rz / curvature;
            workers.each(velocity, |i, v| {
                *v = std::array::from_fn(|k| v[k] + step * direction[i][k])
            });
            workers.each(residual, |i, r| {
                *r = std::array::from_fn(|k| r[k] - step * product[i][k])
            });
            norm2 = dot_rows(workers, residual, residual);
            iterations += 1;
        }
        Ok(iterations)
    }

    /// tolerance x |M (v* - u)|, at least that of one step's fall; u is the walls' mean velocity where walls are touched,
    /// else the mean of v*: the same in every inertial frame.
    fn solver_limit(&self, state: &State<D>, dt: f64) -> f64 {
        let mass = &state.grains.mass;
        let touched = self.lists.blocks.iter().any(|b| !b.wall_rows.is_empty());
        let frame = if touched {
            mean(&self.walls.velocity, &self.walls.weight)
        } else {
            let rows: Vec<Vector<D>> = self.prediction.iter().map(|p| p.velocity).collect();
            mean(&rows, mass)
        };
        let fall = dt * self.gravity_norm;
        let scale2 = sum_rows(&self.workers, mass.len(), |i| {
            let d = sub(&self.prediction[i].velocity, &frame);
            mass[i] * mass[i] * (dot(&d, &d) + fall * fall)
        });
        // The floor is the rounding of velocities that are all the same.
        self.numerics.solver_tolerance * scale2.sqrt()
            + 1e-15 * self.numerics.sound_speed * mass.iter().fold(0.0, |s, m| s + m)
    }

    /// tau_i = 2 (1 - share) eta_i e_i(v).
    fn stress(&self, v: &[Vector<D>], tau: &mut [Tensor<D>], with_walls: bool) {
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
                    let e = self.geometry.strain_deviator(&gradient, 0.0);
                    *t = e.map(|r| scale(f, &r));
                }
            });
    }

    /// F_i [N]: stress form with tau, and the pair form's share.
    fn force(&self, v: &[Vector<D>], tau: &[Tensor<D>], force: &mut [Vector<D>], with_walls: bool) {
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
        scale(self.width * self.volume[i], &f)
    }

    /// Inverse Jacobi blocks: m I + dt V_i sum c g g^T, the pair form with the whole viscosity.
    fn jacobi_blocks(&self, state: &State<D>, dt: f64, jacobi: &mut [Tensor<D>]) {
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

    /// Viscous force of walls on particle i by the last solve [N] (for reactions): needs the stress of that velocity.
    pub(super) fn last_stress(&mut self, state: &State<D>) -> Vec<Tensor<D>> {
        let mut tau = vec![[[0.0; D]; D]; state.grains.len()];
        self.stress(&self.viscous.velocity, &mut tau, true);
        tau
    }

    /// Pieces that touch no wall get back the momentum of v* exactly: the solve keeps it only to its tolerance.
    fn restore_momentum(&self, state: &State<D>, velocity: &mut [Vector<D>]) {
        if self.lists.free_pieces == 0 {
            return;
        }
        let mut lost = vec![([0.0; D], 0.0); self.lists.free_pieces];
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            let Some(piece) = piece else { continue };
            let m = state.grains.mass[i];
            let (momentum, mass) = &mut lost[*piece as usize];
            for k in 0..D {
                momentum[k] += m * (self.prediction[i].velocity[k] - velocity[i][k]);
            }
            *mass += m;
        }
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            let Some(piece) = piece else { continue };
            let (momentum, mass) = &lost[*piece as usize];
            for k in 0..D {
                velocity[i][k] += momentum[k] / mass;
            }
        }
    }
}
