//! [A]'s own scheme, kept as the reference that the default is measured against (docs/theory.md, "Scheme paper_a").
//!
//! No correction, no diffusion. This file is the time scheme of [A] section 3.5; `sums` are the sums over pairs and ghosts as
//! printed, pair by pair, `lanes` the same on the default's kernels, `response` the pressure law and the viscosity.
//!
//! Symbols: D rho/Dt = R, Dv/Dt = a. One step of length dt, from x, v, rho at n and a at n - 1/2:
//!
//! x' = x + dt/2 v,  v' = v + dt/2 a(n-1/2),  rho' = rho + dt/2 R(x, v)                                       (P1)
//! a(n+1/2) from x', v', rho';  v(n+1) = v + dt a(n+1/2),  x(n+1) = x' + dt/2 v(n+1)                          (P2)
//! rho(n+1) = rho' + dt/2 R(x(n+1), v(n+1))                                                                   (P3)

mod lanes;
mod response;
mod sums;

use crate::math::Vector;
use crate::state::State;

use super::kinematics::Kinematics;
use super::{OnMove, Solver, SolverError, StepBound, SubStep};
use response::Response;
use sums::Rates;

/// How sums over pairs run; the results differ by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweeps {
    /// Four neighbours at a time, over pairs that are found once for the rates and the accelerations.
    Lanes,
    /// One pair after the other, nothing kept.
    Plain,
}

/// What only this scheme needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperA {
    /// Yield stress tau_0 > 0 at which the scaling time is m_0 [Pa]: the largest that is expected ([A] section 4.2).
    pub reference_yield_stress: f64,
    /// Scaling time m_0 > 0 of the regularised viscosity there [s].
    pub scaling_time: f64,
    /// Largest factor beta_max >= 1 of the velocity that a ghost gives back ([A] eq. 36) [1].
    pub ghost_velocity_factor: f64,
    /// How sums over pairs run.
    pub sweeps: Sweeps,
}

/// Work arrays, one entry a particle; empty in other schemes. Nothing here outlives a step but through [`State`].
#[derive(Debug, Default)]
pub(super) struct Work<const D: usize> {
    rates: Vec<Rates>,
    response: Vec<Response>,
    /// v at n + 1/2 as predicted [m/s].
    half_velocity: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
}

impl<const D: usize> Solver<D> {
    /// One step of length `dt` ([A] section 3.5 with P1 to P3).
    pub(super) fn step_paper_a(
        &mut self,
        choices: &PaperA,
        state: &mut State<D>,
        (dt, bound): (f64, StepBound),
        on_move: &mut OnMove<'_, D>,
    ) -> Result<SubStep, SolverError> {
        let half = 0.5 * dt;
        self.advance_density_paper_a(state, half)?;
        self.drift(state, half, on_move)?;
        // Lists may have been built anew, in another order: from here on by the rows that they have now.
        let mut work = std::mem::take(&mut self.paper_a);
        predict(state, half, &mut work.half_velocity);
        self.sweep_rates(
            choices,
            state,
            &work.half_velocity,
            &state.grains.density,
            &mut work.rates,
        );
        self.respond_paper_a(choices, state, &work.rates, &mut work.response);
        self.sweep_accelerations(choices, state, &mut work);
        self.react_paper_a(choices, state, &work, dt);
        let grains = &mut state.grains;
        for (v, a) in grains.velocity.iter_mut().zip(&work.acceleration) {
            for (v, a) in v.iter_mut().zip(a) {
                *v += dt * a;
            }
        }
        grains.viscous_acceleration.clone_from(&work.acceleration);
        self.paper_a = work;
        if let Some(i) = (0..state.grains.len()).find(|&i| !finite(&state.grains.velocity[i])) {
            return Err(self.not_finite(state, "velocity", |n| n != i));
        }
        self.drift(state, half, on_move)?;
        // Strain rates at n + 1 are taken with the densities at n + 1/2, which a restored state needs again.
        let grains = &mut state.grains;
        grains.swept_density.clone_from(&grains.density);
        self.sweep_rates_at_points(choices, state);
        self.advance_density_paper_a(state, half)?;
        self.respond_at_points(choices, state);
        state.time += dt;
        state.steps += 1;
        state.step_size = dt;
        Ok(SubStep {
            dt,
            bound,
            iterations: 0,
        })
    }

    /// Derives rates, pressures and viscosities of a state between two steps, with the bits they had.
    pub(super) fn derive_paper_a(&mut self, choices: &PaperA, state: &State<D>) {
        self.sweep_rates_at_points(choices, state);
        self.respond_at_points(choices, state);
    }

    fn sweep_rates_at_points(&mut self, choices: &PaperA, state: &State<D>) {
        let mut rates = std::mem::take(&mut self.paper_a.rates);
        let grains = &state.grains;
        let (velocity, density) = (&grains.velocity, &grains.swept_density);
        self.sweep_rates(choices, state, velocity, density, &mut rates);
        self.paper_a.rates = rates;
    }

    /// What steps are bounded by and what gauges and validity figures read.
    fn respond_at_points(&mut self, choices: &PaperA, state: &State<D>) {
        let mut work = std::mem::take(&mut self.paper_a);
        self.respond_paper_a(choices, state, &work.rates, &mut work.response);
        self.pressure.clear();
        self.inertial_number.clear();
        self.viscosity.clear();
        self.kinematics.clear();
        for (response, rates) in work.response.iter().zip(&work.rates) {
            self.pressure.push(response.pressure);
            self.inertial_number.push(response.inertial_number);
            self.viscosity.push(response.viscosity);
            self.kinematics.push(Kinematics {
                shear: rates.shear,
                ..Kinematics::default()
            });
        }
        self.paper_a = work;
    }

    /// x += `time` v, then periodic sides and lists that still hold.
    fn drift(
        &mut self,
        state: &mut State<D>,
        time: f64,
        on_move: &mut OnMove<'_, D>,
    ) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        self.before.clone_from(&grains.position);
        for (x, v) in grains.position.iter_mut().zip(&grains.velocity) {
            for (x, v) in x.iter_mut().zip(v) {
                *x += time * v;
            }
        }
        on_move(&self.before, grains);
        self.settle(state)
    }

    /// rho += `time` R of the last sweep.
    fn advance_density_paper_a(&self, state: &mut State<D>, time: f64) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        let mut bad = None;
        for (i, (rho, rates)) in grains
            .density
            .iter_mut()
            .zip(&self.paper_a.rates)
            .enumerate()
        {
            let material = &self.materials[grains.phase[i] as usize];
            // [A] has no such floor; what lies there carries no pressure.
            let least = material.parted_density * material.rest_density();
            let new = *rho + time * rates.density;
            if !new.is_finite() {
                bad = Some(i);
                break;
            }
            *rho = new.max(least);
        }
        match bad {
            Some(i) => Err(self.not_finite(state, "density", |n| n != i)),
            None => Ok(()),
        }
    }
}

/// v' = v + `time` a(n - 1/2).
fn predict<const D: usize>(state: &State<D>, time: f64, out: &mut Vec<Vector<D>>) {
    let grains = &state.grains;
    out.clear();
    let rows = grains.velocity.iter().zip(&grains.viscous_acceleration);
    out.extend(rows.map(|(v, a)| -> Vector<D> { std::array::from_fn(|k| v[k] + time * a[k]) }));
}

fn finite<const D: usize>(v: &Vector<D>) -> bool {
    v.iter().all(|c| c.is_finite())
}
