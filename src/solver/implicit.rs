//! The implicit viscous solve (docs/theory.md, E9, E12): (M - dt F) v = M v* by conjugate gradients with D x D Jacobi
//! blocks, started from the last step's change. With the exact yield it is solved a few times a step, each time with
//! the stress of the last projection beside it (`plastic`).

use crate::math::{Tensor, Vector, apply, dot, dot_rows, sub, sum_rows};
use crate::state::State;

use super::lists::mean;
use super::numerics::YieldForm;
use super::{Solver, SolverError};

/// Work arrays of the solve.
#[derive(Debug, Default)]
pub(super) struct Viscous<const D: usize> {
    /// Stress that is linear in the velocity, (1 - share) 2 eta e(v), kept up to date with the velocity [Pa].
    pub(super) linear: Vec<Tensor<D>>,
    /// Whole stress of the adjoint form; between solves that of the last one [Pa].
    pub(super) tau: Vec<Tensor<D>>,
    /// Stress of a search direction.
    searched: Vec<Tensor<D>>,
    jacobi: Vec<Tensor<D>>,
    residual: Vec<Vector<D>>,
    direction: Vec<Vector<D>>,
    product: Vec<Vector<D>>,
    /// The unknown; after the solve the new velocity [m/s].
    pub(super) velocity: Vec<Vector<D>>,
    /// What of the wall friction of each of its rows does not follow the velocity [Pa].
    pub(super) held: Vec<Vector<D>>,
}

impl<const D: usize> Viscous<D> {
    fn resize(&mut self, n: usize) {
        for t in [
            &mut self.linear,
            &mut self.tau,
            &mut self.searched,
            &mut self.jacobi,
        ] {
            t.resize(n, [[0.0; D]; D]);
        }
        for v in [
            &mut self.residual,
            &mut self.direction,
            &mut self.product,
            &mut self.velocity,
        ] {
            v.resize(n, [0.0; D]);
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Solves for the new velocities (left in `self.viscous.velocity`); returns the iterations used.
    pub(super) fn solve_viscous(
        &mut self,
        state: &mut State<D>,
        dt: f64,
    ) -> Result<u32, SolverError> {
        self.find_friction(state);
        let mut work = std::mem::take(&mut self.viscous);
        work.resize(state.grains.len());
        let result = self.solve_with_yield(state, dt, &mut work);
        if result.is_ok() {
            self.restore_momentum(state, &mut work.velocity);
        }
        self.viscous = work;
        result
    }

    /// One linear solve with the plain cap; with the exact yield a few, each followed by the projection.
    fn solve_with_yield(
        &self,
        state: &mut State<D>,
        dt: f64,
        work: &mut Viscous<D>,
    ) -> Result<u32, SolverError> {
        let acceleration = &state.grains.viscous_acceleration;
        self.workers.each(&mut work.velocity, |i, v| {
            let (start, a) = (&self.prediction[i].velocity, &acceleration[i]);
            *v = std::array::from_fn(|k| start[k] + dt * a[k]);
        });
        self.stress(&work.velocity, &mut work.linear, true);
        self.jacobi_blocks(state, dt, &mut work.jacobi);
        self.grip_blocks(dt, &mut work.jacobi);
        let limit = self.solver_limit(state, dt);
        match self.numerics.yield_form {
            YieldForm::Capped => {
                work.tau.clone_from(&work.linear);
                self.hold_friction(state, &mut work.held);
                let spent = self.conjugate_gradients(state, dt, limit, work)?;
                self.project_friction(state, work);
                Ok(spent)
            }
            YieldForm::Exact { iterations } => {
                let mut spent = 0;
                for _ in 0..iterations {
                    self.add_plastic_stress(state, work);
                    self.hold_friction(state, &mut work.held);
                    spent += self.conjugate_gradients(state, dt, limit, work)?;
                    self.project(state, work);
                    self.project_friction(state, work);
                }
                Ok(spent)
            }
        }
    }

    /// From `work.velocity` with its stress `work.tau`, in place; `work.linear` follows.
    fn conjugate_gradients(
        &self,
        state: &State<D>,
        dt: f64,
        limit: f64,
        work: &mut Viscous<D>,
    ) -> Result<u32, SolverError> {
        let n = state.grains.len();
        let (workers, mass) = (&self.workers, &state.grains.mass);
        let Viscous {
            linear,
            tau,
            searched,
            jacobi,
            residual,
            direction,
            product,
            velocity,
            held,
        } = work;
        // residual = M (v* - v) + dt F(v), walls moving.
        self.force(velocity, tau, product, true);
        self.add_friction_force(velocity, product, Some(held));
        workers.each(residual, |i, r| {
            let start = &self.prediction[i].velocity;
            *r =
                std::array::from_fn(|k| mass[i] * (start[k] - velocity[i][k]) + dt * product[i][k]);
        });
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
                dot(&residual[i], &apply(&jacobi[i], &residual[i]))
            });
            let beta = if iterations == 0 { 0.0 } else { next / rz };
            rz = next;
            workers.each(direction, |i, d| {
                let z = apply(&jacobi[i], &residual[i]);
                *d = std::array::from_fn(|k| z[k] + beta * d[k]);
            });
            self.stress(direction, searched, false);
            self.force(direction, searched, product, false);
            self.add_friction_force(direction, product, None);
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
            workers.each(linear, |i, t| add_scaled(t, step, &searched[i]));
            workers.each(tau, |i, t| add_scaled(t, step, &searched[i]));
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
        let mut frame = if touched {
            mean(&self.walls.velocity, &self.walls.weight)
        } else {
            let rows: Vec<Vector<D>> = self.prediction.iter().map(|p| p.velocity).collect();
            mean(&rows, mass)
        };
        if self.geometry.is_axisymmetric() {
            // The axis stands still.
            frame[0] = 0.0;
        }
        let fall = dt * self.gravity_norm;
        let scale2 = sum_rows(&self.workers, mass.len(), |i| {
            let d = sub(&self.prediction[i].velocity, &frame);
            mass[i] * mass[i] * (dot(&d, &d) + fall * fall)
        });
        // The floor is the rounding of velocities that are all the same.
        self.numerics.solver_tolerance * scale2.sqrt()
            + 1e-15 * self.numerics.sound_speed * mass.iter().fold(0.0, |s, m| s + m)
    }

    /// Pieces that touch no wall get back the momentum of v* exactly: the solve keeps it only to its tolerance.
    fn restore_momentum(&self, state: &State<D>, velocity: &mut [Vector<D>]) {
        if self.lists.free_pieces == 0 {
            return;
        }
        // Rings keep momentum along their axis only.
        let first = usize::from(self.geometry.is_axisymmetric());
        let mut lost = vec![([0.0; D], 0.0); self.lists.free_pieces];
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            let Some(piece) = piece else { continue };
            let m = state.grains.mass[i];
            let (momentum, mass) = &mut lost[*piece as usize];
            for k in first..D {
                momentum[k] += m * (self.prediction[i].velocity[k] - velocity[i][k]);
            }
            *mass += m;
        }
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            let Some(piece) = piece else { continue };
            let (momentum, mass) = &lost[*piece as usize];
            for k in first..D {
                velocity[i][k] += momentum[k] / mass;
            }
        }
    }
}

/// t += s u.
#[inline(always)]
fn add_scaled<const D: usize>(t: &mut Tensor<D>, s: f64, u: &Tensor<D>) {
    for a in 0..D {
        for b in 0..D {
            t[a][b] += s * u[a][b];
        }
    }
}
