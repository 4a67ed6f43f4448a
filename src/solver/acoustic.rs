//! Pressure, gravity and density in shorter steps than everything else (docs/theory.md, E18).
//!
//! Symbols: g_ij = V_j grad W_ij of the places at the start of the step; a the viscous acceleration of the last step.
//! Of n acoustic steps of length dt/n all but the last do, t after the start,
//!
//!   u = v*(t) + t a,   x' += (dt/n) u,   rho *= exp(-(dt/n) div u),   v* += (dt/n) (g + a_p(rho))               (E18)
//!
//! The last is the step's own: its velocity is that of the viscous solve, and its div v that at the new places. Sound bounds dt/n,
//! and lists, pairs, viscosity and motion are for dt. Sums are those of (E1) and (E7): momentum is kept pair by pair. Rings take one:
//! beside the axis they ring at a frequency that friction, which these steps leave out, has to damp.

use crate::math::{Four, Lanes, Vector, in_lanes};
use crate::state::State;

use super::Solver;
use super::pair::Block;
use super::reflect::{reflected_divergence, reflected_pressure};

/// What the acoustic steps before the last one leave; empty where there is one.
#[derive(Debug, Default)]
pub(super) struct Acoustic<const D: usize> {
    /// Acoustic steps of this step.
    count: u32,
    /// Way that each particle went in them [m].
    way: Vec<Vector<D>>,
    /// Mean pressure of the step that momentum felt [Pa].
    pub(super) pressure: Vec<f64>,
    /// u [m/s] and its divergence [1/s].
    velocity: Vec<Vector<D>>,
    divergence: Vec<f64>,
}

impl<const D: usize> Acoustic<D> {
    /// Acoustic steps of this step, 1 before the first one.
    pub(super) fn count(&self) -> u32 {
        self.count.max(1)
    }

    /// What particles went before the last acoustic step [m]; empty if there was one.
    pub(super) fn way(&self) -> &[Vector<D>] {
        &self.way
    }
}

impl<const D: usize> Solver<D> {
    /// v* of the whole step in `self.prediction`, density at the start of its last acoustic step; the length of that step [s].
    pub(super) fn step_sound(&mut self, state: &mut State<D>, dt: f64) -> f64 {
        // Steps are no longer than the bound but for rounding, of which no further acoustic step may come.
        let most = f64::from(self.numerics.acoustic_steps);
        let count = (dt / self.numerics.acoustic_step() - 1e-9).ceil();
        let count = count.clamp(1.0, most);
        let small = dt / count;
        self.acoustic.count = count as u32;
        self.sweep_pressure(state, small);
        let mut work = std::mem::take(&mut self.acoustic);
        work.way.clear();
        work.pressure.clear();
        if count > 1.0 {
            let n = state.grains.len();
            work.way.resize(n, [0.0; D]);
            work.velocity.resize(n, [0.0; D]);
            work.pressure.extend_from_slice(&self.pressure);
            for done in 1..work.count {
                let (prediction, t) = (&self.prediction, f64::from(done) * small);
                let a = &state.grains.viscous_acceleration;
                self.workers.each(&mut work.velocity, |i, u| {
                    let start = &prediction[i].velocity;
                    *u = std::array::from_fn(|k| start[k] + t * a[i][k]);
                });
                self.follow_sound(state, small, &mut work);
                self.load_all(state);
                self.push_on(state, small);
                let pressure = &self.pressure;
                self.workers
                    .each(&mut work.pressure, |i, sum| *sum += pressure[i]);
            }
            self.workers
                .each(&mut work.pressure, |_, sum| *sum /= count);
        }
        self.acoustic = work;
        small
    }

    /// Mean pressure of the step that momentum felt [Pa].
    pub(super) fn mean_pressure(&self, i: usize) -> f64 {
        let mean = self.acoustic.pressure.get(i);
        mean.map_or_else(|| self.normal_pressure()[i], |p| *p)
    }

    /// Ways and density over one acoustic step at the velocity u.
    fn follow_sound(&self, state: &mut State<D>, dt: f64, work: &mut Acoustic<D>) {
        let Acoustic {
            way,
            velocity,
            divergence,
            ..
        } = work;
        let u = &*velocity;
        self.divergence(u, divergence);
        let grains = &mut state.grains;
        let (phase, prediction) = (&grains.phase, &self.prediction);
        self.workers.both(way, &mut grains.density, |i, way, rho| {
            for k in 0..D {
                way[k] += dt * u[i][k];
            }
            let material = &self.materials[phase[i] as usize];
            let new = *rho * (-dt * divergence[i]).exp() + dt * prediction[i].diffusion;
            let least = material.parted_density * material.rest_density();
            // NaN stays NaN, to be found in the velocity.
            *rho = if new < least { least } else { new };
            []
        });
    }

    /// div u of the places at the start of the step [1/s].
    pub(super) fn divergence(&self, u: &[Vector<D>], divergence: &mut Vec<f64>) {
        divergence.resize(u.len(), 0.0);
        self.workers
            .blocks_read(&self.lists.blocks, divergence, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let i = first + row;
                        *o = self.row_divergence(lanes, block, (i, row), u);
                        if let Some(w) = walls.next_if(|w| w.row as usize == row) {
                            *o += w.divergence(&u[i]);
                            if !self.has_fluids {
                                *o += reflected_divergence(block.reflections_of(w), i, u);
                            }
                        }
                    }
                );
            });
    }

    /// v* over one acoustic step at the pressure that density has now.
    fn push_on(&mut self, state: &State<D>, dt: f64) {
        let mut prediction = std::mem::take(&mut self.prediction);
        self.workers
            .blocks_read(&self.lists.blocks, &mut prediction, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let i = first + row;
                        let mut push = self.row_push(lanes, block, (i, row));
                        let seen = walls.next_if(|w| w.row as usize == row);
                        if let Some(w) = seen {
                            for k in 0..D {
                                push[k] -= 2.0 * self.pressure[i] * w.s[k];
                            }
                            if !self.has_fluids {
                                let along =
                                    reflected_pressure(block.reflections_of(w), i, &self.pressure);
                                for k in 0..D {
                                    push[k] -= along[k];
                                }
                            }
                        }
                        let specific = self.specific_volume(state, i);
                        for k in 0..D {
                            let barrier = seen.map_or(0.0, |w| w.push[k] + w.grip[k]);
                            let a = self.gravity[k] + specific * push[k] + barrier;
                            o.velocity[k] += dt * a;
                        }
                    }
                );
            });
        self.prediction = prediction;
    }

    /// sum_j (u_j - u_i) . g_ij.
    #[inline(always)]
    fn row_divergence<L: Lanes>(
        &self,
        lanes: L,
        block: &Block<D>,
        (i, row): (usize, usize),
        u: &[Vector<D>],
    ) -> f64 {
        let mut sum = Four::splat(lanes, 0.0);
        let range = block.groups(row);
        for (j, g) in block.j[range.clone()].iter().zip(&block.g[range]) {
            for k in 0..D {
                let other = Four::gather(lanes, |m| u[j[m] as usize][k]);
                sum += (other - Four::splat(lanes, u[i][k])) * Four::load(lanes, &g[k]);
            }
        }
        sum.sum()
    }

    /// -sum_j (p_i + p_j) g_ij.
    #[inline(always)]
    fn row_push<L: Lanes>(
        &self,
        lanes: L,
        block: &Block<D>,
        (i, row): (usize, usize),
    ) -> Vector<D> {
        let own = Four::splat(lanes, self.pressure[i]);
        let mut sums = [Four::splat(lanes, 0.0); D];
        let range = block.groups(row);
        for (j, g) in block.j[range.clone()].iter().zip(&block.g[range]) {
            let p = own + Four::gather(lanes, |m| self.pressure[j[m] as usize]);
            for k in 0..D {
                sums[k] -= p * Four::load(lanes, &g[k]);
            }
        }
        let mut push = [0.0; D];
        for (push, sum) in push.iter_mut().zip(sums) {
            *push = sum.sum();
        }
        push
    }
}
