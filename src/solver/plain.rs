//! The sweeps over pairs as one would write them first: one pair after the other, no lanes. The fast sweeps are tested
//! against these and timed against them ([`super::Passes`]); no scene uses them.

use crate::math::{Tensor, Vector, add_outer, dot, scale, sub};
use crate::state::State;

use super::Solver;
use super::fluid_row::Row;
use super::pressure::Prediction;

/// Particle i against neighbour j.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<const D: usize> {
    j: u32,
    /// V_j grad_i W_ij [1/m].
    g: Vector<D>,
    /// 2 (D + 2)/(|g| r) [m^2].
    c: f64,
}

/// Pairs row after row, and where each row ends.
#[derive(Clone, Debug, Default)]
pub(super) struct PlainPairs<const D: usize> {
    pairs: Vec<Pair<D>>,
    ends: Vec<usize>,
}

impl<const D: usize> PlainPairs<D> {
    /// Number of pairs, each counted from both sides.
    #[must_use]
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    fn row(&self, i: usize) -> &[Pair<D>] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.pairs[start..self.ends[i]]
    }
}

impl<const D: usize> Solver<D> {
    /// Pair coefficients and sums over neighbours of every particle (docs/theory.md, E1 to E4), walls left out.
    pub(super) fn plain_pairs(&self, state: &State<D>, into: &mut PlainPairs<D>) -> Vec<Row<D>> {
        into.pairs.clear();
        into.ends.clear();
        let mut rows = Vec::with_capacity(state.grains.len());
        for block in &self.lists.blocks {
            for row in 0..block.rows() {
                rows.push(self.plain_row(state, rows.len(), block.row(row), &mut into.pairs));
                into.ends.push(into.pairs.len());
            }
        }
        rows
    }

    fn plain_row(
        &self,
        state: &State<D>,
        i: usize,
        near: &[u32],
        pairs: &mut Vec<Pair<D>>,
    ) -> Row<D> {
        let grains = &state.grains;
        let support2 = self.kernel.support() * self.kernel.support();
        let dissipation = D as f64 + 2.0;
        let mut sums = Row::NONE;
        for &j in near {
            let n = j as usize;
            let x = self
                .periodic
                .difference(&grains.position[i], &grains.position[n]);
            let r2 = dot(&x, &x);
            if r2 >= support2 || r2 == 0.0 {
                continue;
            }
            let r = r2.sqrt();
            let mut volume = self.volume[n];
            if self.geometry.is_axisymmetric() {
                volume *= (self.rings[i].hoop + self.rings[n].hoop) * (0.5 / std::f64::consts::TAU);
            }
            let vf = volume * self.kernel.f(r);
            let g = scale(vf, &x);
            let v = sub(&grains.velocity[i], &grains.velocity[n]);
            if self.has_fluids {
                let along = dot(&v, &x);
                sums.curvature +=
                    vf * dot(&v, &v) + volume * self.kernel.f_slope(r) / r * along * along;
            }
            add_outer(&mut sums.gradient, -1.0, &v, &g);
            add_outer(&mut sums.moment, -1.0, &x, &g);
            for (side, g) in sums.side.iter_mut().zip(&g) {
                *side += g;
            }
            sums.nearness -= vf;
            sums.add_pair(&x, dot(&v, &x), -vf, self.has_fluids);
            sums.speed2 = sums.speed2.max(dot(&v, &v));
            pairs.push(Pair {
                j,
                g,
                c: 2.0 * dissipation / (-vf * r2),
            });
        }
        sums
    }

    /// v*, diffusion of density and resistance of every particle (docs/theory.md, E7, E8), without walls, bulk friction and
    /// artificial viscosity.
    pub(super) fn plain_pressure(
        &self,
        state: &State<D>,
        pairs: &PlainPairs<D>,
        dt: f64,
        out: &mut [Prediction<D>],
    ) {
        let numerics = &self.numerics;
        let strength = self.diffusion_strength(numerics.sound_speed, dt);
        for (i, o) in out.iter_mut().enumerate() {
            *o = Prediction::default();
            let mut force = [0.0; D];
            for pair in pairs.row(i) {
                let j = pair.j as usize;
                for k in 0..D {
                    force[k] -= (self.pressure[i] + self.pressure[j]) * pair.g[k];
                }
                if let Some(own) = self.uneven_pressure.get(i) {
                    let other = &self.uneven_pressure[j];
                    for a in 0..D {
                        for b in 0..D {
                            force[a] += (own[a][b] + other[a][b]) * pair.g[b];
                        }
                    }
                }
                o.diffusion += strength * self.plain_diffusion(state, i, pair);
                let share = numerics.pair_viscosity_share;
                let stress = (1.0 - share) * self.pair_viscosity[j];
                let both = self.pair_viscosity[i] + self.pair_viscosity[j];
                let mut twice = (1.0 - 2.0 / D as f64) * stress;
                if both > 0.0 {
                    let mean = 2.0 * self.pair_viscosity[i] * self.pair_viscosity[j] / both;
                    twice += 2.0 * share * mean * pair.c;
                }
                add_outer(&mut o.resistance, twice, &pair.g, &pair.g);
                for k in 0..D {
                    o.resistance[k][k] += stress * dot(&pair.g, &pair.g);
                }
            }
            if self.geometry.is_axisymmetric() {
                force[0] += self.pressure[i] * (self.rings[i].hoop + self.rings[i].axis);
            }
            let specific = self.specific_volume(state, i);
            for k in 0..D {
                let a = self.gravity[k] + specific * force[k];
                o.velocity[k] = state.grains.velocity[i][k] + dt * a;
            }
        }
    }

    /// What a pair adds to the diffusion of density, gated at rest and without the hydrostatic part.
    fn plain_diffusion(&self, state: &State<D>, i: usize, pair: &Pair<D>) -> f64 {
        let numerics = &self.numerics;
        let j = pair.j as usize;
        let sum = self.pressure[i] + self.pressure[j];
        if sum <= 0.0 {
            return 0.0;
        }
        let (rho_i, rho_j) = (state.grains.density[i], state.grains.density[j]);
        let shear = 0.5 * (self.kinematics[i].shear + self.kinematics[j].shear);
        let open = (numerics.diffusion_gate_time * shear).min(1.0);
        let loaded = (sum / (rho_i * self.gravity_norm * numerics.spacing)).min(1.0);
        let still = 0.5 * (rho_i + rho_j) * dot(&self.gravity, &pair.g) * loaded;
        // V F = -|g|^2 c/(2 (D + 2)).
        let vf = -dot(&pair.g, &pair.g) * pair.c / (2.0 * (D as f64 + 2.0));
        open * ((self.pressure[i] - self.pressure[j]) * vf - still)
    }

    /// Velocity gradients sum_j (v_j - v_i) (x) g_ij.
    pub(super) fn plain_gradients(
        &self,
        pairs: &PlainPairs<D>,
        v: &[Vector<D>],
        out: &mut [Tensor<D>],
    ) {
        for (i, gradient) in out.iter_mut().enumerate() {
            *gradient = [[0.0; D]; D];
            for pair in pairs.row(i) {
                add_outer(gradient, 1.0, &sub(&v[pair.j as usize], &v[i]), &pair.g);
            }
        }
    }

    /// sum_j (tau_i + tau_j) g_ij and the pair form's share, with the harmonic mean of the pair viscosities.
    pub(super) fn plain_forces(
        &self,
        pairs: &PlainPairs<D>,
        v: &[Vector<D>],
        tau: &[Tensor<D>],
        out: &mut [Vector<D>],
    ) {
        let share = self.numerics.pair_viscosity_share;
        for (i, force) in out.iter_mut().enumerate() {
            *force = [0.0; D];
            let eta = self.pair_viscosity[i];
            for pair in pairs.row(i) {
                let j = pair.j as usize;
                let both = eta + self.pair_viscosity[j];
                if both > 0.0 {
                    let mean = 2.0 * eta * self.pair_viscosity[j] / both;
                    let along = dot(&sub(&v[j], &v[i]), &pair.g);
                    for k in 0..D {
                        force[k] += share * mean * pair.c * along * pair.g[k];
                    }
                }
                for a in 0..D {
                    for b in 0..D {
                        force[a] += (tau[i][a][b] + tau[j][a][b]) * pair.g[b];
                    }
                }
            }
        }
    }
}
