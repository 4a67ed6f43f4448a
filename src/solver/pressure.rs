//! Pressure and gravity: v* = v + dt (g + a_p), and the diffusion of density on pressure (docs/theory.md, E7, E8).
//!
//! This is the sweep and what walls do in it; `pressure_row` is one row.
//!
//! Symbols: g_ij = V_j grad W_ij; a_i = -(1/rho_i) [sum_j (p_i + p_j) g_ij + sum_walls 2 p_i g_iw]; F = W'(r)/r; p stands for the
//! tensor P of (F3) where a fluid's rows slide.

use crate::material::Material;
use crate::math::{Quad, Tensor, Vector, apply, in_lanes, trace};
use crate::state::State;

use super::Solver;
use super::pair::{Block, WallRow};
use super::reflect::reflected_pressure;

/// Weight of |div v| against the shear rate in the share of the made-up viscosity that a particle feels [1]: a plane wave has both.
const DAMPED: f64 = 4.0;

/// Shear rate over sqrt(g/H) below which noise is all there is [1].
const SLOW: f64 = 0.1;

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

/// rho_0 c of each material; empty where it is the same for all [Pa s/m].
pub(super) fn impedances(materials: &[Material], sound_speed: f64) -> Vec<f64> {
    let of = |m: &Material| m.rest_density() * m.sound_speed.unwrap_or(sound_speed);
    let all: Vec<f64> = materials.iter().map(of).collect();
    if all.windows(2).all(|pair| pair[0] == pair[1]) {
        return Vec::new();
    }
    all
}

impl<const D: usize> Solver<D> {
    /// 2 delta h/c of (E8) [s] at a sound speed [m/s] in acoustic steps of dt [s], (E8b): no more than evens a particle out with its neighbours, of whose pressures all are of
    /// the step's start. With more each goes past the others, and further every step.
    pub(super) fn diffusion_strength(&self, sound_speed: f64, dt: f64) -> f64 {
        let per_sound = self.kernel.h / sound_speed;
        let wanted = 2.0 * self.numerics.density_diffusion * per_sound;
        let whole = f64::from(self.acoustic.count()) * dt;
        let most = 1.0 / (sound_speed * sound_speed * whole * self.packing.lattice_sum());
        wanted.min(most)
    }

    /// Fills `self.prediction`, and multiplies the pairs' coefficients by their viscosity.
    pub(super) fn sweep_pressure(&mut self, state: &State<D>, dt: f64) {
        let n = state.grains.len();
        self.note_loads(state);
        self.prediction.resize(n, Prediction::default());
        self.note_what_flows(state);
        self.note_damped();
        self.find_uneven_pressure(state);
        let mut prediction = std::mem::take(&mut self.prediction);
        let loads = std::mem::take(&mut self.loads);
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
                    let row = w.row as usize;
                    let at = (first + row, row);
                    self.press_on_walls(state, dt, at, (block, w), &mut out[row]);
                }
                block.wall_rows = rows;
            });
        self.loads = loads;
        self.lists.blocks = blocks;
        self.prediction = prediction;
    }

    /// What walls do to particle i, whose row is swept: pressure, the fluid's slope there, and what pushes it out of them.
    /// Multiplies the wall row's coefficients by its viscosity.
    fn press_on_walls(
        &self,
        state: &State<D>,
        dt: f64,
        (i, row): (usize, usize),
        (block, w): (&Block<D>, &mut WallRow<D>),
        o: &mut Prediction<D>,
    ) {
        let p = self.normal_pressure()[i];
        let a = -2.0 * p * dt * self.specific_volume(state, i);
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
        if trace(&w.moment) > 0.0 {
            let before = &state.grains.velocity[i];
            let slope = if self.material_of(state, i).is_fluid() {
                self.slope_of_fluid(before, &o.velocity, dt)
            } else {
                self.slope_in_grains(state, block, (i, row))
            };
            self.carry_slope(&slope, before, dt, w, &mut o.velocity);
        }
        if !self.has_fluids {
            let along = reflected_pressure(block.reflections_of(w), i, self.normal_pressure());
            for k in 0..D {
                o.velocity[k] -= dt * self.specific_volume(state, i) * along[k];
            }
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

    /// Notes what the sweep looks up of each particle.
    fn note_loads(&mut self, state: &State<D>) {
        let mut loads = std::mem::take(&mut self.loads);
        loads.resize(state.grains.len(), Quad::default());
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
        self.loads = loads;
    }

    /// Shear rate below which noise is all there is, 0.1 sqrt(g/H) [1/s].
    pub(super) fn slow_rate(&self) -> f64 {
        SLOW * self.gravity_norm / self.numerics.fall_speed.max(f64::MIN_POSITIVE)
    }

    /// Notes how much of the viscosity made up to their own particles feel: what is sheared alone needs none (E21).
    fn note_damped(&mut self) {
        if !self
            .materials
            .iter()
            .any(|m| self.missing_viscosity(m) > 0.0)
        {
            return;
        }
        let slow = self.slow_rate();
        let kinematics = &self.kinematics;
        self.damped.resize(kinematics.len(), 0.0);
        self.workers.each(&mut self.damped, |i, share| {
            let squeezed = DAMPED * kinematics[i].divergence.abs() + slow;
            *share = squeezed / (squeezed + kinematics[i].shear).max(f64::MIN_POSITIVE);
        });
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

    /// Whether pressure and the diffusion of density are all there is: no bulk friction, sliding rows, damping, unlike materials, or fluids.
    fn is_plain(&self) -> bool {
        self.normal_pressure.is_empty()
            && self.impedances.is_empty()
            && self.uneven_pressure.is_empty()
            && self.numerics.artificial_viscosity == 0.0
            && !self.has_fluids
    }

    /// 1/rho with the very volume that pair coefficients hold, so that forces cancel pair by pair.
    #[inline(always)]
    pub(super) fn specific_volume(&self, state: &State<D>, i: usize) -> f64 {
        self.width * self.volume[i] / state.grains.mass[i]
    }
}
