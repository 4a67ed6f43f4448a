//! Second sweep: accelerations, density diffusion, shifting; and the force on walls.
//!
//! Symbols: sigma = -p I + tau; p_s pressure on an element, the mean of what the particles in front of it have, each carried to
//! the element hydrostatically: p_s = sum_j V_j W_sj (p_j + rho_j g.(x_s - x_j))/sum_j V_j W_sj.

use crate::math::{CHUNK, Vector, add, apply, dot, norm, scale, sub};
use crate::solver::Solver;
use crate::state::State;

use super::response::Response;
use super::sums::{Near, Sums};
use super::walls::Seen;
use super::{ALONE, PaperB};

/// Smallest eigenvalue below which a particle is at a surface ([B] after eq. 19) [1].
const AT_SURFACE: f64 = 0.7;

/// Sums and responses of the particles, pressures of the elements.
pub(super) type Known<'a, const D: usize> = (&'a [Sums<D>], &'a [Response<D>], &'a [f64]);

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forces<const D: usize> {
    /// a [m/s^2].
    pub(super) acceleration: Vector<D>,
    /// Density diffusion ([B] eq. 15) [kg/(m^3 s)].
    pub(super) diffusion: f64,
    /// Largest rate pi_ij at which a neighbour comes nearer, over its distance [1/s].
    pub(super) approach_rate: f64,
    /// dt du [m]; of the corrector only.
    pub(super) shift: Vector<D>,
}

impl<const D: usize> Default for Forces<D> {
    fn default() -> Self {
        Self {
            acceleration: [0.0; D],
            diffusion: 0.0,
            approach_rate: 0.0,
            shift: [0.0; D],
        }
    }
}

impl<const D: usize> Solver<D> {
    /// [B] eq. 3 (momentum) with K_R, and eqs. 15 and 16.
    pub(super) fn sum_forces(
        &self,
        choices: &PaperB,
        state: &State<D>,
        (sums, response, walls): Known<'_, D>,
        out: &mut Vec<Forces<D>>,
    ) {
        out.resize(state.grains.len(), Forces::default());
        self.workers
            .blocks_read(&self.lists.blocks, out, |block, first, out| {
                for (row, forces) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let near = (block.row(row), block.wall_row(row));
                    *forces = self.forces_on(state, (sums, response, walls), i, near);
                    if response[i].held {
                        let k = choices.relaxation_factor;
                        forces.acceleration = scale(k, &forces.acceleration);
                    }
                }
            });
    }

    fn forces_on(
        &self,
        state: &State<D>,
        (sums, response, wall_pressure): Known<'_, D>,
        i: usize,
        (near, walls): (&[u32], &[u32]),
    ) -> Forces<D> {
        let grains = &state.grains;
        let (own, h) = (&response[i], self.kernel.h);
        let c = self.sound_speed_of(&self.materials[grains.phase[i] as usize]);
        let artificial = h * self.artificial_density(state, i);
        let mut forces = Forces::default();
        // (1/V_i) times the force on i, of neighbours, then of walls.
        let mut push = [0.0; D];
        for &j in near {
            let j = j as usize;
            let Some(at) = self.near(state, i, j) else {
                continue;
            };
            let other = &response[j];
            let both = own.pressure + other.pressure;
            let stress = std::array::from_fn(|k| add(&own.shear_stress[k], &other.shear_stress[k]));
            let tau = apply(&stress, &at.slope);
            let du = sub(&grains.velocity[j], &grains.velocity[i]);
            let approach = dot(&du, &at.offset) / (at.r * at.r + 0.01 * h * h);
            forces.approach_rate = forces.approach_rate.max(-approach);
            let mut press = -both;
            if grains.phase[j] == grains.phase[i] {
                press += artificial * approach;
                let jump = grains.density[j] - grains.density[i];
                forces.diffusion += psi(&at, jump, &sums[i], &sums[j]);
            }
            for k in 0..D {
                push[k] += tau[k] + press * at.slope[k];
            }
        }
        forces.diffusion *= h * c * self.numerics.density_diffusion;
        let over = 1.0 / (grains.density[i] * sums[i].shepard);
        for element in self.elements(&grains.position[i], walls) {
            let wall = self.wall_push(own, wall_pressure[element.index], &element);
            push = add(&push, &wall);
        }
        forces.acceleration = std::array::from_fn(|k| self.gravity[k] + over * push[k]);
        forces
    }

    /// alpha c rho_0 between particles of one Newtonian fluid ("light artificial viscosity used on the linear phase only",
    /// [B] section 3.2), 0 of others [kg/(m^2 s)].
    fn artificial_density(&self, state: &State<D>, i: usize) -> f64 {
        let material = &self.materials[state.grains.phase[i] as usize];
        if material.is_newtonian() {
            material.artificial_viscosity * self.sound_speed_of(material) * material.rest_density()
        } else {
            0.0
        }
    }

    /// (sigma_i + sigma_s) n_s W_is S_s, without shear stress where material slips [Pa/m]. Walls push, they do not pull: in thin
    /// layers particles in tension were pulled through them.
    #[inline(always)]
    fn wall_push(&self, own: &Response<D>, wall_pressure: f64, element: &Seen<D>) -> Vector<D> {
        let area = element.area();
        let push = scale(-(own.pressure + wall_pressure).max(0.0), &area);
        if self.slips(element) {
            push
        } else {
            add(&push, &scale(2.0, &apply(&own.shear_stress, &area)))
        }
    }

    /// p_s of each element [Pa]; 0 of those that nothing is in front of. Sums run from the first particle to the last.
    pub(super) fn find_wall_pressure(
        &self,
        state: &State<D>,
        response: &[Response<D>],
        out: &mut Vec<f64>,
    ) {
        let grains = &state.grains;
        let mut weights = vec![0.0; self.walls.len()];
        out.clear();
        out.resize(self.walls.len(), 0.0);
        for (b, block) in self.lists.blocks.iter().enumerate() {
            for row in 0..block.rows() {
                let i = b * CHUNK + row;
                for element in self.elements(&grains.position[i], block.wall_row(row)) {
                    let weight = self.volume[i] * element.weight;
                    let head = grains.density[i] * dot(&self.gravity, &element.offset);
                    out[element.index] += weight * (response[i].pressure + head);
                    weights[element.index] += weight;
                }
            }
        }
        for (p, weight) in out.iter_mut().zip(&weights) {
            if *weight > 0.0 {
                *p /= weight;
            }
        }
    }

    /// Impulse of the material on walls whose force somebody reads, over `time` [N s]: the pressure on their elements, and what
    /// shear stress the particles before them give up.
    pub(super) fn react_paper_b(&self, state: &mut State<D>, time: f64) {
        let groups = &self.walls.groups;
        if !groups.iter().any(|g| g.wants_force) {
            return;
        }
        let dp = self.numerics.spacing;
        for (w, p) in self.paper_b.wall_pressure.iter().enumerate() {
            let group = self.walls.group[w] as usize;
            if groups[group].wants_force {
                let area = self.walls.weight[w] * dp.powi(D as i32 - 1) * self.width;
                let push = time * area * p.max(0.0);
                for k in 0..D {
                    state.impulse[group][k] -= push * self.walls.normal[w][k];
                }
            }
        }
        for (b, block) in self.lists.blocks.iter().enumerate() {
            for row in 0..block.rows() {
                let i = b * CHUNK + row;
                for element in self.elements(&state.grains.position[i], block.wall_row(row)) {
                    if groups[element.group].wants_force && !self.slips(&element) {
                        let own = &self.paper_b.response[i];
                        let stress = apply(&own.shear_stress, &element.area());
                        // Without the Shepard factor the kernel before a wall sums up to a half, which the 2 makes whole.
                        let over = 2.0 * time * self.volume[i] * self.width;
                        for k in 0..D {
                            state.impulse[element.group][k] -= over * stress[k];
                        }
                    }
                }
            }
        }
    }

    /// dt du of each particle ([B] eqs. 17 to 20, the second branch normalised so that the two meet).
    pub(super) fn sum_shifts(
        &self,
        state: &State<D>,
        sums: &[Sums<D>],
        dt: f64,
        out: &mut [Forces<D>],
    ) {
        self.workers
            .blocks_read(&self.lists.blocks, out, |block, first, out| {
                for (row, forces) in out.iter_mut().enumerate() {
                    let near = (block.row(row), block.wall_row(row));
                    let du = self.shift_of(state, sums, first + row, near);
                    forces.shift = scale(dt * self.numerics.shifting, &du);
                }
            });
    }

    fn shift_of(
        &self,
        state: &State<D>,
        sums: &[Sums<D>],
        i: usize,
        (near, walls): (&[u32], &[u32]),
    ) -> Vector<D> {
        let grains = &state.grains;
        let own = &sums[i];
        if own.lambda < ALONE {
            return [0.0; D];
        }
        let dp = self.numerics.spacing;
        let (mut concentration, mut inwards) = ([0.0; D], [0.0; D]);
        let mut speed: f64 = 0.0;
        let mut least = own.lambda;
        for &j in near {
            let j = j as usize;
            let Some(at) = self.near(state, i, j) else {
                continue;
            };
            let du = sub(&grains.velocity[j], &grains.velocity[i]);
            speed = speed.max(dot(&du, &at.offset).abs() / at.r);
            let same = grains.phase[j] == grains.phase[i];
            for k in 0..D {
                concentration[k] += at.slope[k];
                if same {
                    least = least.min(sums[j].lambda);
                    inwards[k] += (sums[j].lambda - own.lambda) * at.slope[k];
                }
            }
        }
        for element in self.elements(&grains.position[i], walls) {
            let area = element.area();
            for k in 0..D {
                concentration[k] += area[k];
            }
        }
        let mut slope = scale(1.0 / own.shepard, &concentration);
        // Every particle with one at the surface in its support: concentration falls towards it.
        if least < AT_SURFACE {
            let inwards = apply(&own.renormalisation, &inwards);
            let size = norm(&inwards);
            if size == 0.0 {
                return [0.0; D];
            }
            let along = dot(&slope, &inwards) / (size * size);
            slope = sub(&slope, &scale(along, &inwards));
        }
        let reach = self.kernel.support();
        let ratio = reach / dp;
        let size = ratio.powi(3) * reach * norm(&slope);
        let most = 0.5 * ratio;
        let cut = if size > most { most / size } else { 1.0 };
        scale(-0.5 * speed * cut * ratio.powi(3) * reach, &slope)
    }
}

/// psi_ji.grad W V_j ([B] eq. 16) [kg/m^5].
#[inline(always)]
fn psi<const D: usize>(at: &Near<D>, jump: f64, own: &Sums<D>, other: &Sums<D>) -> f64 {
    let mean = add(&own.density_gradient, &other.density_gradient);
    let excess = jump - 0.5 * dot(&mean, &at.offset);
    // r_ji.grad W = -F r^2.
    -2.0 * excess * at.steepness
}
