//! One linear solve: conjugate gradients with D x D Jacobi blocks (docs/theory.md, E12).

use crate::math::{Vector, apply, dot, sub};
use crate::solver::record::Record;
use crate::solver::{Solver, SolverError};
use crate::state::State;

use super::{Limit, Viscous, add};

/// Share of the tolerance below which a solve needs no iteration at all [1]. Above it takes one, even where the first guess is
/// within the tolerance: what a solve leaves, the next one starts with, so that in steady flow it would add up step by step.
const SETTLED: f64 = 1e-3;

impl<const D: usize> Solver<D> {
    /// From the velocity of `work.current`, in place.
    pub(super) fn conjugate_gradients(
        &self,
        state: &State<D>,
        dt: f64,
        limit: &Limit,
        work: &mut Viscous<D>,
    ) -> Result<u32, SolverError> {
        let mut norm2 = self.first_residual(state, dt, work);
        let limit = limit.of(norm2.sqrt());
        if !norm2.is_finite() {
            return Err(self.not_finite(state, "viscous force", |i| {
                work.residual[i].iter().all(|v| v.is_finite())
            }));
        }
        norm2 = self.settle_explicit(norm2, limit, work);
        let (mut rz, mut beta) = (0.0, None);
        let mut iterations = 0;
        while norm2 > limit * limit || iterations == 0 && norm2 > (SETTLED * limit).powi(2) {
            if iterations == self.numerics.solver_max_iterations {
                return Err(SolverError::NotConverged {
                    time: state.time,
                    iterations,
                    residual: norm2.sqrt(),
                    allowed: limit,
                });
            }
            if iterations == 0 {
                rz = self.first_descent(work);
            }
            self.turn_direction(beta, work);
            let curvature = self.viscous_product(state, dt, work);
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(self.not_finite(state, "viscous solve", |i| {
                    work.product[i].iter().all(|v| v.is_finite())
                }));
            }
            let [r2, next] = self.advance(rz / curvature, work);
            (norm2, beta, rz) = (r2, Some(next / rz), next);
            iterations += 1;
        }
        Ok(iterations)
    }

    /// Jacobi blocks times the first residual; returns residual.descent.
    fn first_descent(&self, work: &mut Viscous<D>) -> f64 {
        let jacobi = &work.jacobi;
        let [rz] = self
            .workers
            .both(&mut work.descent, &mut work.residual, |i, z, r| {
                *z = apply(&jacobi[i], r);
                [dot(r, z)]
            });
        rz
    }

    /// direction = descent + beta direction; `None` at first: the last solve's directions are no part of the state.
    fn turn_direction(&self, beta: Option<f64>, work: &mut Viscous<D>) {
        let descent = &work.descent;
        self.workers.each(&mut work.direction, |i, d| {
            *d = match beta {
                None => descent[i],
                Some(beta) => std::array::from_fn(|k| descent[i][k] + beta * d[k]),
            };
        });
    }

    /// product = (M - dt F) direction, friction included, and the direction's stress; returns direction.product.
    fn viscous_product(&self, state: &State<D>, dt: f64, work: &mut Viscous<D>) -> f64 {
        let Viscous {
            explicit,
            searched,
            direction,
            product,
            ..
        } = work;
        let mass = &state.grains.mass;
        self.stress(direction, searched, false, explicit);
        let mut curvature = self.force(searched, product, false, explicit, |i, f| {
            let d = &direction[i];
            let own = self.inertia(mass[i], i, d);
            let q: Vector<D> = std::array::from_fn(|k| own[k] - dt * f[k]);
            (q, dot(d, &q))
        });
        self.each_friction(searched, None, |i, push| {
            for k in 0..D {
                product[i][k] += dt * push[k];
                curvature += dt * direction[i][k] * push[k];
            }
        });
        curvature
    }

    /// Goes `step` times the direction, residual and descent with it; returns residual.residual and residual.descent.
    fn advance(&self, step: f64, work: &mut Viscous<D>) -> [f64; 2] {
        let Viscous {
            current,
            searched,
            jacobi,
            residual,
            descent,
            product,
            ..
        } = work;
        self.workers
            .each(current, |i, c| c.add_scaled(step, &searched[i]));
        self.workers.both(descent, residual, |i, z, r| {
            *r = std::array::from_fn(|k| r[k] - step * product[i][k]);
            *z = apply(&jacobi[i], r);
            [dot(r, r), dot(r, z)]
        })
    }

    /// residual = M (v* - v) + dt F(v), walls moving, with what friction at an even ratio makes of M (W14); returns its square.
    fn first_residual(&self, state: &State<D>, dt: f64, work: &mut Viscous<D>) -> f64 {
        let Viscous {
            current,
            whole,
            fixed,
            residual,
            held,
            ..
        } = work;
        let start = if fixed.is_empty() {
            &*current
        } else {
            self.workers.each(whole, |i, w| {
                let mut tau = current[i].stress();
                add(&mut tau, &fixed[i]);
                *w = Record::of_stress(&tau, &current[i].velocity());
            });
            &*whole
        };
        let mass = &state.grains.mass;
        let norm2 = self.force(start, residual, true, &[], |i, f| {
            let (aim, v) = (&self.prediction[i].velocity, start[i].velocity::<D>());
            let change = self.inertia_to(mass[i], i, &sub(aim, &v), dt);
            let r: Vector<D> = std::array::from_fn(|k| change[k] + dt * f[k]);
            (r, dot(&r, &r))
        });
        if held.is_empty() {
            return norm2;
        }
        self.each_friction(start, Some(held), |i, push| {
            for k in 0..D {
                residual[i][k] -= dt * push[k];
            }
        });
        let [norm2] = self
            .workers
            .sums(residual.len(), |i| [dot(&residual[i], &residual[i])]);
        norm2
    }
}
