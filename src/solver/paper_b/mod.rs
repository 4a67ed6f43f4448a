//! [B]'s own scheme, kept as the reference that the default is measured against with several phases (docs/theory.md, "Scheme
//! paper_b").
//!
//! Plain scalar sweeps over neighbour lists; walls are boundary integrals over elements of their surface. This file is the time
//! scheme; `walls` is what a particle sees of walls, `sums` the rates of density and strain, `columns` the effective pressure,
//! `response` pressure law, viscosity and yield, `forces` accelerations, diffusion and shifting.
//!
//! Symbols: D rho/Dt = R, Du/Dt = a, du shift velocity. [B] says "predictor-corrector"; Heun's, from x, u, rho at n:
//!
//! x' = x + dt u,  u' = u + dt a,  rho' = rho + dt R                                                        (PB1)
//! u(n+1) = (u + u' + dt a')/2,  rho(n+1) = (rho + rho' + dt R')/2,  x(n+1) = (x + x' + dt u')/2 + dt du'    (PB2)

mod columns;
mod forces;
mod response;
mod sums;
mod walls;

use crate::math::Vector;
use crate::state::{Grains, State};

use super::kinematics::Kinematics;
use super::{OnMove, Solver, SolverError, StepBound, SubStep};
use forces::Forces;
use response::Response;
use sums::Sums;

/// Smallest eigenvalue below which a particle is spray: it is not shifted and no column's top ([B] after eq. 19) [1].
const ALONE: f64 = 0.2;

/// What only this scheme needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperB {
    /// Factor K_R on the acceleration of material that does not yield, above 0 and at most 1 ([B] Table 2) [1]. Below 1 it
    /// takes momentum out of the scene: what does not yield falls at K_R g.
    pub relaxation_factor: f64,
    /// Stiffening time m > 0 of Papanastasiou's viscosity, which [B] calls K in its Table 2 [s].
    pub stiffening_time: f64,
}

/// Work arrays, one entry a particle or element; empty in other schemes. Nothing here outlives a step but through [`State`].
#[derive(Debug, Default)]
pub(super) struct Work<const D: usize> {
    sums: Vec<Sums<D>>,
    effective: Vec<f64>,
    response: Vec<Response<D>>,
    /// p_s of each element [Pa].
    wall_pressure: Vec<f64>,
    forces: Vec<Forces<D>>,
}

impl<const D: usize> Solver<D> {
    /// One step of length `dt` (PB1, PB2).
    pub(super) fn step_paper_b(
        &mut self,
        choices: &PaperB,
        state: &mut State<D>,
        (dt, bound): (f64, StepBound),
        on_move: &mut OnMove<'_, D>,
    ) -> Result<SubStep, SolverError> {
        self.predict_paper_b(state, dt)?;
        // u and rho are the predicted ones from here on, a and rho at n lie beside them.
        self.move_by(state, on_move, |grains, i| {
            let (u, a) = (&grains.velocity[i], &grains.viscous_acceleration[i]);
            std::array::from_fn(|k| dt * (u[k] - dt * a[k]))
        })?;
        let rest = self.rest_of_the_way(choices, state, dt);
        self.correct(state, dt)?;
        self.bounce(state);
        self.move_by(state, on_move, |_, i| rest[i])?;
        self.evaluate(choices, state, dt, false);
        self.react_paper_b(state, 0.5 * dt);
        self.show(state);
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
    pub(super) fn derive_paper_b(&mut self, choices: &PaperB, state: &State<D>) {
        self.evaluate(choices, state, 0.0, false);
        self.show(state);
    }

    /// Everything that follows from positions, velocities and densities.
    fn evaluate(&mut self, choices: &PaperB, state: &State<D>, dt: f64, shift: bool) {
        let mut work = std::mem::take(&mut self.paper_b);
        self.sum_rates(state, &mut work.sums);
        self.find_effective_pressure(state, &work.sums, &mut work.effective);
        self.respond_paper_b(
            choices,
            state,
            (&work.sums, &work.effective),
            &mut work.response,
        );
        self.find_wall_pressure(state, &work.response, &mut work.wall_pressure);
        let known = (&work.sums[..], &work.response[..], &work.wall_pressure[..]);
        self.sum_forces(choices, state, known, &mut work.forces);
        if shift {
            self.sum_shifts(state, &work.sums, dt, &mut work.forces);
        }
        self.paper_b = work;
    }

    /// u' and rho' (PB1); a and rho at n are kept in `viscous_acceleration` and `swept_density`.
    fn predict_paper_b(&self, state: &mut State<D>, dt: f64) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        grains.swept_density.clone_from(&grains.density);
        for (i, forces) in self.paper_b.forces.iter().enumerate() {
            grains.viscous_acceleration[i] = forces.acceleration;
            for k in 0..D {
                grains.velocity[i][k] += dt * forces.acceleration[k];
            }
            grains.density[i] += dt * (self.paper_b.sums[i].density_rate + forces.diffusion);
        }
        self.check_paper_b(state)
    }

    /// How far each particle is still to go (PB2) [m], from the predicted state, which this evaluates.
    fn rest_of_the_way(
        &mut self,
        choices: &PaperB,
        state: &mut State<D>,
        dt: f64,
    ) -> Vec<Vector<D>> {
        self.evaluate(choices, state, dt, self.numerics.shifting > 0.0);
        self.react_paper_b(state, 0.5 * dt);
        let grains = &state.grains;
        let mut rest = vec![[0.0; D]; grains.len()];
        self.workers
            .blocks_read(&self.lists.blocks, &mut rest, |block, first, out| {
                for (row, way) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let a = &grains.viscous_acceleration[i];
                    let shift = &self.paper_b.forces[i].shift;
                    // (x + x' + dt u')/2 - x' = dt (u' - u)/2.
                    *way = std::array::from_fn(|k| 0.5 * dt * dt * a[k] + shift[k]);
                    self.keep_out(&grains.position[i], block.wall_row(row), way);
                }
            });
        rest
    }

    /// u and rho at n + 1 (PB2).
    fn correct(&self, state: &mut State<D>, dt: f64) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        for (i, forces) in self.paper_b.forces.iter().enumerate() {
            let a = grains.viscous_acceleration[i];
            for k in 0..D {
                grains.velocity[i][k] += 0.5 * dt * (forces.acceleration[k] - a[k]);
            }
            let rate = self.paper_b.sums[i].density_rate + forces.diffusion;
            let material = &self.materials[grains.phase[i] as usize];
            // [B] has no such floor; below it is spray.
            let least = material.parted_density * material.rest_density();
            let rho = 0.5 * (grains.swept_density[i] + grains.density[i] + dt * rate);
            grains.density[i] = if rho < least { least } else { rho };
        }
        grains.swept_density.clone_from(&grains.density);
        self.check_paper_b(state)
    }

    fn check_paper_b(&self, state: &State<D>) -> Result<(), SolverError> {
        let grains = &state.grains;
        let moving = |i: usize| grains.velocity[i].iter().all(|c| c.is_finite());
        let n = grains.len();
        if self.workers.first_bad(n, |i| !moving(i)).is_some() {
            return Err(self.not_finite(state, "velocity", moving));
        }
        // Written so that a density that is not a number is refused too.
        let dense = |i: usize| grains.density[i] > 0.0 && grains.density[i].is_finite();
        if self.workers.first_bad(n, |i| !dense(i)).is_some() {
            return Err(self.not_finite(state, "density", dense));
        }
        Ok(())
    }

    /// x += `way`, then periodic sides and lists that still hold.
    fn move_by(
        &mut self,
        state: &mut State<D>,
        on_move: &mut OnMove<'_, D>,
        way: impl Fn(&Grains<D>, usize) -> Vector<D>,
    ) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        self.before.clone_from(&grains.position);
        for i in 0..grains.len() {
            let step = way(grains, i);
            for k in 0..D {
                grains.position[i][k] += step[k];
            }
        }
        on_move(&self.before, grains);
        self.settle(state)
    }

    /// What gauges and validity figures read.
    fn show(&mut self, state: &State<D>) {
        let work = std::mem::take(&mut self.paper_b);
        self.pressure.clear();
        self.viscosity.clear();
        self.inertial_number.clear();
        self.kinematics.clear();
        self.effective.clone_from(&work.effective);
        for (i, response) in work.response.iter().enumerate() {
            let grains = &self.materials[state.grains.phase[i] as usize].grains;
            // Nothing bears nothing, whatever its rate.
            let p = work.effective[i];
            let time = if p > 0.0 {
                grains.inertial_time(p)
            } else {
                0.0
            };
            self.pressure.push(response.pressure);
            self.viscosity.push(response.viscosity);
            self.inertial_number.push(response.shear * time);
            self.kinematics.push(Kinematics {
                shear: response.shear,
                ..Kinematics::default()
            });
        }
        self.paper_b = work;
    }
}
