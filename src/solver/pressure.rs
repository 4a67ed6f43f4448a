//! Pressure and gravity: v* = v + dt (g + a_p), and the diffusion of density on pressure (docs/theory.md, E7, E8).
//!
//! Symbols: g_ij = V_j grad W_ij; a_i = -(1/rho_i) [sum_j (p_i + p_j) g_ij + sum_walls 2 p_i g_iw]; F = W'(r)/r; p stands for the
//! tensor P of (F3) where a fluid's rows slide.

use crate::material::Material;
use crate::math::{Four, Lanes, Quad, Tensor, Vector, apply, in_lanes};
use crate::state::State;

use super::Solver;
use super::meeting::share;
use super::pair::Block;

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction<const D: usize> {
    /// v* [m/s].
    pub(super) velocity: Vector<D>,
    /// d rho/dt by diffusion [kg/(m^3 s)].
    pub(super) diffusion: f64,
    /// How viscosity resists a particle that moves alone, walls not counted (docs/theory.md, E17) [Pa s/m^2]:
    /// sum_j 2 s_p eta_ij c g g^T + m_ji^2 (1 - s_p) eta_j (|g|^2 I + (1 - 2/D) g g^T), m_ji of (F6).
    pub(super) resistance: Tensor<D>,
}

impl<const D: usize> Default for Prediction<D> {
    fn default() -> Self {
        Self {
            velocity: [0.0; D],
            diffusion: 0.0,
            resistance: [[0.0; D]; D],
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Fills `self.prediction`, and multiplies the pairs' coefficients by their viscosity.
    pub(super) fn sweep_pressure(&mut self, state: &State<D>, dt: f64) {
        let n = state.grains.len();
        let mut loads = std::mem::take(&mut self.loads);
        loads.resize(n, Quad::default());
        self.workers.each(&mut loads, |i, load| {
            // The weight that is diffused against is the one that the pressure force bears.
            let rho = if self.materials[state.grains.phase[i] as usize].is_fluid() {
                1.0 / self.specific_volume(state, i)
            } else {
                state.grains.density[i]
            };
            *load = Quad([
                self.pressure[i],
                self.kinematics[i].shear,
                rho,
                self.pair_viscosity[i],
            ]);
        });
        self.prediction.resize(n, Prediction::default());
        self.note_what_flows(state);
        self.find_uneven_pressure();
        let mut prediction = std::mem::take(&mut self.prediction);
        let mut blocks = std::mem::take(&mut self.lists.blocks);
        let plain = self.is_plain();
        self.workers
            .blocks(&mut blocks, &mut prediction, |block, first, out| {
                in_lanes!(self.arch, |lanes| {
                    for (row, o) in out.iter_mut().enumerate() {
                        let at = (first + row, row);
                        *o = if plain {
                            self.predict::<_, true>(lanes, state, &loads, dt, block, at)
                        } else {
                            self.predict::<_, false>(lanes, state, &loads, dt, block, at)
                        };
                    }
                });
                let mut rows = std::mem::take(&mut block.wall_rows);
                for w in &mut rows {
                    let i = first + w.row as usize;
                    let p = self.normal_pressure()[i];
                    let a = -2.0 * p * dt * self.specific_volume(state, i);
                    let o = &mut out[w.row as usize];
                    let eta = self.pair_viscosity[i];
                    for k in 0..D {
                        o.velocity[k] += a * w.s[k];
                    }
                    if let Some(uneven) = self.uneven_pressure.get(i) {
                        let less = apply(uneven, &w.s);
                        for k in 0..D {
                            o.velocity[k] += 2.0 * dt * self.specific_volume(state, i) * less[k];
                        }
                    }
                    if self.has_fluids {
                        self.carry_slope(&state.grains.velocity[i], dt, w, &mut o.velocity);
                    }
                    if w.barrier > 0.0 {
                        for k in 0..D {
                            o.velocity[k] += dt * w.push[k];
                        }
                        let whole = dt * f64::from(self.acoustic.count());
                        let slow = 2.0 * self.gravity_norm * whole;
                        w.grip = w.rub.grip(&w.push, &o.velocity, (whole, slow));
                    }
                    for k in 0..D {
                        o.velocity[k] += dt * w.grip[k];
                        w.cv[k] *= eta;
                        for c in 0..D {
                            w.c[k][c] *= eta;
                        }
                    }
                }
                block.wall_rows = rows;
            });
        self.loads = loads;
        self.lists.blocks = blocks;
        self.prediction = prediction;
    }

    /// Notes what has no yield stress: it cannot rest with another pressure than the hydrostatic one, so diffusion needs no
    /// gate there.
    fn note_what_flows(&mut self, state: &State<D>) {
        if !self.materials.iter().any(Material::flows) {
            return;
        }
        let phase = &state.grains.phase;
        self.flows.resize(phase.len(), 0.0);
        self.workers.each(&mut self.flows, |i, f| {
            *f = f64::from(u8::from(self.materials[phase[i] as usize].flows()));
        });
    }

    /// Whether pressure and the diffusion of density are all there is: no bulk friction, sliding rows, damping, or fluids.
    fn is_plain(&self) -> bool {
        self.normal_pressure.is_empty()
            && self.uneven_pressure.is_empty()
            && self.numerics.artificial_viscosity == 0.0
            && !self.has_fluids
    }

    /// alpha less what the material's own viscosity is worth: nu = alpha h c/(2 (D + 2)).
    fn missing_viscosity(&self, m: &Material) -> f64 {
        if m.artificial_viscosity == 0.0 || !m.is_newtonian() {
            return 0.0;
        }
        let own = 2.0 * (D as f64 + 2.0) * m.viscous.consistency
            / (m.rest_density() * self.kernel.h * self.sound_speed_of(m));
        (m.artificial_viscosity - own).max(0.0)
    }

    /// 1/rho with the very volume that pair coefficients hold, so that forces cancel pair by pair.
    #[inline(always)]
    pub(super) fn specific_volume(&self, state: &State<D>, i: usize) -> f64 {
        self.width * self.volume[i] / state.grains.mass[i]
    }

    /// Row i; PLAIN: see [`Self::is_plain`].
    #[inline(always)]
    fn predict<L: Lanes, const PLAIN: bool>(
        &self,
        lanes: L,
        state: &State<D>,
        loads: &[Quad],
        dt: f64,
        block: &mut Block<D>,
        (i, row): (usize, usize),
    ) -> Prediction<D> {
        let grains = &state.grains;
        let numerics = &self.numerics;
        let splat = |a: f64| Four::splat(lanes, a);
        let [pressure, shear, rho, eta] = loads[i].0;
        let material = &self.materials[grains.phase[i] as usize];
        let c0 = self.sound_speed_of(material);
        let flows = self.flows.get(i).is_some_and(|f| *f > 0.0);
        let diffuse = numerics.density_diffusion > 0.0;
        let damp = numerics.artificial_viscosity * self.kernel.h * c0;
        let own_damping = self.missing_viscosity(material) * self.kernel.h * c0;
        // grad W = F x: |g|^2 c = 2 (D + 2) V |F|.
        let to_f = splat(-1.0 / (2.0 * (D as f64 + 2.0)));
        let gate = splat(0.5 * numerics.diffusion_gate_time);
        let head = 1.0 / (rho * self.gravity_norm * numerics.spacing).max(f64::MIN_POSITIVE);
        let (zero, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        let (two, least) = (splat(2.0), splat(f64::MIN_POSITIVE));
        let by_pairs = numerics.pair_viscosity_share;
        let (by_pairs, by_stress) = (splat(2.0 * by_pairs), splat(1.0 - by_pairs));
        let along = splat(1.0 - 2.0 / D as f64);
        let normal =
            (!PLAIN && !self.normal_pressure.is_empty()).then_some(&self.normal_pressure[..]);
        let uneven = self.uneven_pressure.get(i).filter(|_| !PLAIN);
        let own_normal = normal.map_or(pressure, |n| n[i]);
        let mut force = [zero; D];
        let mut resistance = [[zero; D]; D];
        let mut diffusion = zero;
        let [like, other, harder, _] = block.kinds(row);
        let range = block.groups(row);
        let (j, g) = (&block.j[range.clone()], &block.g[range.clone()]);
        for (n, ((j, g), c)) in (range.start..).zip(j.iter().zip(g).zip(&mut block.c[range])) {
            let [pj, shear_j, rho_j, eta_j] = Four::transpose(
                lanes,
                [
                    &loads[j[0] as usize],
                    &loads[j[1] as usize],
                    &loads[j[2] as usize],
                    &loads[j[3] as usize],
                ],
            );
            let mut g_ij = [zero; D];
            for k in 0..D {
                g_ij[k] = Four::load(lanes, &g[k]);
            }
            let mut g2 = zero;
            for g in g_ij {
                g2 += g * g;
            }
            let geometric = Four::load(lanes, c);
            let push = normal.map_or(pj, |n| Four::gather(lanes, |m| n[j[m] as usize]));
            let push = splat(own_normal) + push;
            for k in 0..D {
                force[k] -= push * g_ij[k];
            }
            if let Some(own) = uneven {
                // Symmetric, and without a trace.
                let mut last = zero;
                for a in 0..D {
                    for b in a..D {
                        if a + 1 == D {
                            force[a] -= last * g_ij[a];
                            continue;
                        }
                        let other = |m: usize| self.uneven_pressure[j[m] as usize][a][b];
                        let both = splat(own[a][b]) + Four::gather(lanes, other);
                        force[a] += both * g_ij[b];
                        if a == b {
                            last += both;
                        } else {
                            force[b] += both * g_ij[a];
                        }
                    }
                }
            }
            let mean_rho = half * (splat(rho) + rho_j);
            if !PLAIN && (damp > 0.0 || own_damping > 0.0) {
                // [A] eq. 38: (v.x)/r^2 = (v.g) F/|g|^2, on approaching and receding pairs alike.
                let mut along = zero;
                for k in 0..D {
                    let vj = Four::gather(lanes, |m| grains.velocity[j[m] as usize][k]);
                    along += (splat(grains.velocity[i][k]) - vj) * g_ij[k];
                }
                let mut alpha = splat(damp);
                if own_damping > 0.0 {
                    // That of its own kind.
                    let same = |m: usize| {
                        f64::from(u8::from(grains.phase[j[m] as usize] == grains.phase[i]))
                    };
                    alpha += splat(own_damping) * Four::gather(lanes, same);
                }
                let damping = alpha * mean_rho * along * to_f * geometric;
                for k in 0..D {
                    force[k] += damping * g_ij[k];
                }
            }
            if diffuse {
                let mut down = zero;
                for k in 0..D {
                    down += splat(self.gravity[k]) * g_ij[k];
                }
                let sum = splat(pressure) + pj;
                let mut open = (gate * (splat(shear) + shear_j)).min(one);
                if !PLAIN && flows {
                    open = open.max(Four::gather(lanes, |m| self.flows[j[m] as usize]));
                }
                // The hydrostatic part is taken out where there is a hydrostatic load to speak of.
                let loaded = (sum * splat(head)).min(one);
                let still = mean_rho * down * loaded;
                let change = open * ((splat(pressure) - pj) * (to_f * g2 * geometric) - still);
                diffusion += sum.where_greater(zero, change);
            }
            // Harmonic mean of the viscosities; 0 if both are.
            let both = (splat(eta) + eta_j).max(least);
            let weighted = geometric * (two * splat(eta) * eta_j).over(both);
            let mut stress = by_stress * eta_j;
            if !PLAIN && n >= like.end {
                // m_ji is in the stress and in its force.
                let m = match n {
                    n if n < other.end => share(lanes, eta_j, splat(eta)),
                    n if n < harder.end => zero,
                    _ => two,
                };
                stress = m * m * stress;
            }
            let mut twice = by_pairs * weighted;
            if D > 2 {
                twice += along * stress;
            }
            for a in 0..D {
                let cg = twice * g_ij[a];
                for b in a..D {
                    resistance[a][b] += cg * g_ij[b];
                }
                resistance[a][a] += stress * g2;
            }
            *c = weighted.store();
        }
        let specific = self.specific_volume(state, i);
        let mut velocity = grains.velocity[i];
        for k in 0..D {
            let mut f = force[k].sum();
            if k == 0 && self.geometry.is_axisymmetric() {
                let ring = &self.rings[i];
                f += own_normal * (ring.hoop + ring.axis);
            }
            velocity[k] += dt * (self.gravity[k] + specific * f);
        }
        let mut sums = [[0.0; D]; D];
        for a in 0..D {
            for b in 0..D {
                sums[a][b] = resistance[a.min(b)][a.max(b)].sum();
            }
        }
        Prediction {
            velocity,
            diffusion: 2.0 * numerics.density_diffusion * self.kernel.h / c0 * diffusion.sum(),
            resistance: sums,
        }
    }
}
