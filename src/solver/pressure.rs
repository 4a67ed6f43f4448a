//! Pressure and gravity: v* = v + dt (g + a_p), and the diffusion of density on pressure (docs/theory.md, E7, E8).
//!
//! Symbols: g_ij = V_j grad W_ij; a_i = -(1/rho_i) [sum_j (p_i + p_j) g_ij + sum_walls 2 p_i g_iw].

use crate::math::{Vector, dot, sub};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction<const D: usize> {
    /// v* [m/s].
    pub(super) velocity: Vector<D>,
    /// d rho/dt by diffusion [kg/(m^3 s)].
    pub(super) diffusion: f64,
}

impl<const D: usize> Default for Prediction<D> {
    fn default() -> Self {
        Self {
            velocity: [0.0; D],
            diffusion: 0.0,
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Fills `self.prediction`, and multiplies the pairs' coefficients by their viscosity.
    pub(super) fn sweep_pressure(&mut self, state: &State<D>, dt: f64) {
        self.prediction
            .resize(state.grains.len(), Prediction::default());
        let mut prediction = std::mem::take(&mut self.prediction);
        let mut blocks = std::mem::take(&mut self.lists.blocks);
        self.workers
            .blocks(&mut blocks, &mut prediction, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    *o = self.predict(state, dt, block, first + row, row);
                }
                let mut rows = std::mem::take(&mut block.wall_rows);
                for w in &mut rows {
                    let i = first + w.row as usize;
                    let p = self.normal_pressure()[i];
                    let a = -2.0 * p * dt * self.specific_volume(state, i);
                    let o = &mut out[w.row as usize];
                    let eta = self.pair_viscosity[i];
                    for k in 0..D {
                        o.velocity[k] += a * w.s[k];
                        w.cv[k] *= eta;
                        for c in 0..D {
                            w.c[k][c] *= eta;
                        }
                    }
                }
                block.wall_rows = rows;
            });
        self.lists.blocks = blocks;
        self.prediction = prediction;
    }

    /// 1/rho with the very volume that pair coefficients hold, so that forces cancel pair by pair.
    #[inline(always)]
    pub(super) fn specific_volume(&self, state: &State<D>, i: usize) -> f64 {
        self.width * self.volume[i] / state.grains.mass[i]
    }

    fn predict(
        &self,
        state: &State<D>,
        dt: f64,
        block: &mut Block<D>,
        i: usize,
        row: usize,
    ) -> Prediction<D> {
        let grains = &state.grains;
        let numerics = &self.numerics;
        let c0 = numerics.sound_speed;
        let (pi, rho, eta_i) = (self.pressure[i], grains.density[i], self.pair_viscosity[i]);
        let diffuse = numerics.density_diffusion > 0.0;
        // grad W = F x: |g|^2 c = 2 (D + 2) V |F|.
        let to_f = -1.0 / (2.0 * (D as f64 + 2.0));
        let damp = numerics.artificial_viscosity * self.kernel.h * c0;
        let gate = 0.5 * numerics.diffusion_gate_time;
        let head = 1.0 / (rho * self.gravity_norm * numerics.spacing).max(f64::MIN_POSITIVE);
        let normal = self.normal_pressure();
        let ni = normal[i];
        let mut force = [0.0; D];
        let mut diffusion = 0.0;
        let range = block.pair_range(row);
        for pair in &mut block.pairs[range] {
            let j = pair.j as usize;
            let pj = self.pressure[j];
            let sum = pi + pj;
            let push = ni + normal[j];
            for k in 0..D {
                force[k] -= push * pair.g[k];
            }
            if numerics.artificial_viscosity > 0.0 {
                // [A] eq. 38: (v.x)/r^2 = (v.g) F/|g|^2, on approaching and receding pairs alike.
                let v = sub(&grains.velocity[i], &grains.velocity[j]);
                let mean_rho = 0.5 * (rho + grains.density[j]);
                let damping = damp * mean_rho * dot(&v, &pair.g) * to_f * pair.c;
                for k in 0..D {
                    force[k] += damping * pair.g[k];
                }
            }
            if diffuse && sum > 0.0 {
                let vf = to_f * dot(&pair.g, &pair.g) * pair.c;
                let open = (gate * (self.kinematics[i].shear + self.kinematics[j].shear)).min(1.0);
                // The hydrostatic part is taken out where there is a hydrostatic load to speak of.
                let loaded = (sum * head).min(1.0);
                let still = 0.5 * (rho + grains.density[j]) * dot(&self.gravity, &pair.g) * loaded;
                diffusion += open * ((pi - pj) * vf - still);
            }
            let eta_j = self.pair_viscosity[j];
            let both = eta_i + eta_j;
            pair.c *= if both > 0.0 {
                2.0 * eta_i * eta_j / both
            } else {
                0.0
            };
        }
        if self.geometry.is_axisymmetric() {
            let ring = &self.rings[i];
            force[0] += ni * (ring.hoop + ring.axis);
        }
        let specific = self.specific_volume(state, i);
        let mut velocity = grains.velocity[i];
        for k in 0..D {
            velocity[k] += dt * (self.gravity[k] + specific * force[k]);
        }
        Prediction {
            velocity,
            diffusion: 2.0 * numerics.density_diffusion * self.kernel.h / c0 * diffusion,
        }
    }
}
