//! The sums of `sums`, four neighbours at a time: the same terms in another order, so that results differ by rounding.
//!
//! The sweep of the rates finds neighbours and keeps grad_i W = F x [1/m^(D+1)] and 1/(F r^2) of each pair; that of the
//! accelerations, at the same places, reads them. Ghosts are seen one by one, as there.
//!
//! Symbols: those of `sums`. Words of a record: x, v, m, m/rho in the first sweep, v, m, P, eta, rho, c in the second.

use crate::math::{Four, LANES, Lanes, Quad, Vector, in_lanes};
use crate::solver::Solver;
use crate::solver::fluid_row::LEAST_DISTANCE2;
use crate::solver::pair::Block;
use crate::solver::record::{Record, words};
use crate::state::State;

use super::PaperA;
use super::Work;
use super::response::Response;
use super::sums::{Gathered, Rates};

impl<const D: usize> Solver<D> {
    /// As `sweep_rates`.
    pub(super) fn sweep_rates_in_lanes(
        &mut self,
        choices: &PaperA,
        state: &State<D>,
        velocity: &[Vector<D>],
        density: &[f64],
        out: &mut [Rates],
    ) {
        let grains = &state.grains;
        let mut records = std::mem::take(&mut self.records);
        records.resize(grains.len(), Record::default());
        self.workers.each(&mut records, |i, record| {
            let mass = grains.mass[i] / self.width;
            let mut words = [0.0; 2 * LANES];
            words[..D].copy_from_slice(&grains.position[i]);
            words[D..2 * D].copy_from_slice(&velocity[i]);
            words[2 * D] = mass;
            words[2 * D + 1] = mass / density[i];
            *record = Record::from_words(&words);
        });
        let mut blocks = std::mem::take(&mut self.lists.blocks);
        self.workers.blocks(&mut blocks, out, |block, first, out| {
            block.forget_pairs(0);
            let mut near = std::mem::take(&mut block.near);
            in_lanes!(self.arch, |lanes| {
                for (row, rates) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let x = &grains.position[i];
                    let count = self.find_near(lanes, &records, i, x, block.row(row), &mut near);
                    let own = (x, &velocity[i]);
                    let mut sums = self.row_rates(lanes, &records, own, block, &near[..count]);
                    let walls = block.wall_row(row);
                    self.add_ghost_rates(choices, state, i, walls, (velocity, density), &mut sums);
                    *rates = sums.rates();
                }
            });
            block.near = near;
        });
        self.records = records;
        self.lists.blocks = blocks;
    }

    /// Sums of a particle at x, v over the neighbours `near`, and the block's coefficients of these pairs.
    #[inline(always)]
    fn row_rates<L: Lanes>(
        &self,
        lanes: L,
        records: &[Record],
        (x, v): (&Vector<D>, &Vector<D>),
        block: &mut Block<D>,
        near: &[u32],
    ) -> Gathered<D> {
        let zero = Four::splat(lanes, 0.0);
        let one = Four::splat(lanes, 1.0);
        let least = Four::splat(lanes, LEAST_DISTANCE2 * self.kernel.h * self.kernel.h);
        let inverse_2h = Four::splat(lanes, self.kernel.inverse_support());
        let slope = Four::splat(lanes, -self.kernel.slope());
        let (mut here, mut own) = ([zero; D], [zero; D]);
        for k in 0..D {
            here[k] = Four::splat(lanes, x[k]);
            own[k] = Four::splat(lanes, v[k]);
        }
        let (mut continuity, mut gradient) = (zero, [[zero; D]; D]);
        let groups = near.as_chunks::<LANES>().0;
        let (g, c) = block.next_row(groups);
        for ((j, g), c) in groups.iter().zip(g).zip(c) {
            let other = words(lanes, records, j);
            let (mass, volume) = (other[2 * D], other[2 * D + 1]);
            let (mut x, mut v, mut r2) = ([zero; D], [zero; D], zero);
            for k in 0..D {
                x[k] = self.periodic.nearest(lanes, k, here[k] - other[k]);
                v[k] = own[k] - other[D + k];
                r2 += x[k] * x[k];
            }
            let t = (one - r2.sqrt() * inverse_2h).max(zero);
            let f = slope * t * t * t;
            let mut weights = [Quad::default(); D];
            let mut vg = zero;
            for b in 0..D {
                let gb = f * x[b];
                weights[b] = gb.store();
                vg += v[b] * gb;
                let weight = volume * gb;
                for a in 0..D {
                    gradient[a][b] -= v[a] * weight;
                }
            }
            continuity += mass * vg;
            *g = weights;
            *c = one.over(f * r2.max(least)).store();
        }
        Gathered {
            continuity: continuity.sum(),
            gradient: gradient.map(|row| row.map(Four::sum)),
        }
    }

    /// As `sweep_accelerations`, over the pairs of the last sweep of the rates.
    pub(super) fn sweep_accelerations_in_lanes(
        &mut self,
        choices: &PaperA,
        state: &State<D>,
        work: &mut Work<D>,
    ) {
        let grains = &state.grains;
        let (velocity, response) = (&work.half_velocity, &work.response);
        let mut records = std::mem::take(&mut self.records);
        self.workers.each(&mut records, |i, record| {
            let r = &response[i];
            let mut words = [0.0; 2 * LANES];
            words[..D].copy_from_slice(&velocity[i]);
            words[D] = grains.mass[i] / self.width;
            words[D + 1..D + 5].copy_from_slice(&[
                r.pressure_term,
                r.viscosity,
                r.density,
                r.sound_speed,
            ]);
            *record = Record::from_words(&words);
        });
        self.workers.blocks_read(
            &self.lists.blocks,
            &mut work.acceleration,
            |block, first, out| {
                in_lanes!(self.arch, |lanes| {
                    for (row, a) in out.iter_mut().enumerate() {
                        let i = first + row;
                        let own = (&velocity[i], &response[i]);
                        let pairs = self.row_acceleration(lanes, &records, own, block, row);
                        *a = std::array::from_fn(|k| self.gravity[k] + pairs[k]);
                        let walls = block.wall_row(row);
                        self.add_ghost_acceleration(choices, state, i, walls, own, a);
                    }
                });
            },
        );
        self.records = records;
    }

    /// - sum m_j (...) grad_i W of a row of the block, for a particle of velocity v ([A] eq. 37, as `pair_stress` has it).
    #[inline(always)]
    fn row_acceleration<L: Lanes>(
        &self,
        lanes: L,
        records: &[Record],
        (v, own): (&Vector<D>, &Response),
        block: &Block<D>,
        row: usize,
    ) -> Vector<D> {
        let splat = |a: f64| Four::splat(lanes, a);
        let zero = splat(0.0);
        let (pressure, viscosity) = (splat(own.pressure_term), splat(own.viscosity));
        let (density, sound) = (splat(own.density), splat(own.sound_speed));
        // Twice the harmonic mean's two, and 2 (D + 2).
        let friction = splat(4.0 * (D as f64 + 2.0) * own.viscosity / own.density);
        let alpha = self.numerics.artificial_viscosity;
        let artificial = splat(alpha * self.kernel.h);
        // Where neither has a viscosity the mean is 0.
        let least = splat(f64::MIN_POSITIVE);
        let mut here = [zero; D];
        for k in 0..D {
            here[k] = splat(v[k]);
        }
        let mut a = [zero; D];
        let range = block.groups(row);
        let pairs = block.j[range.clone()].iter().zip(&block.g[range.clone()]);
        for ((j, g), c) in pairs.zip(&block.c[range]) {
            let other = words(lanes, records, j);
            let (mut weights, mut vg) = ([zero; D], zero);
            for k in 0..D {
                weights[k] = Four::load(lanes, &g[k]);
                vg += (here[k] - other[k]) * weights[k];
            }
            let stretch = vg * Four::load(lanes, c);
            let mean = (friction * other[D + 2]).over((viscosity + other[D + 2]).max(least));
            let mut stress = pressure + other[D + 1] - (mean * stretch).over(other[D + 3]);
            if alpha > 0.0 {
                let both = (sound + other[D + 4]).over(density + other[D + 3]);
                stress -= artificial * both * stretch;
            }
            let push = other[D] * stress;
            for k in 0..D {
                a[k] -= push * weights[k];
            }
        }
        a.map(Four::sum)
    }
}
