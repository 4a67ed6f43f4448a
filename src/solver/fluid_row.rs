//! Particle i against its neighbours, four at a time: pair coefficients and sums (docs/theory.md, E1 to E4).
//!
//! Symbols: F = W'(r)/r <= 0, g = V_j F x, x = x_i - x_j, v = v_i - v_j, gamma shear rate.

mod pairs;
mod sums;

use crate::math::{Four, LANES, Lanes, Tensor, Vector, dot};

use super::Solver;
use super::directions;
use super::meeting::Neighbours;
use super::pair::Block;
use super::record::{Record, motions};
use pairs::Own;
use sums::Sums;

/// Least r^2 over h^2 that a pair form divides by: what fills the last group of a row has r = 0.
pub(super) const LEAST_DISTANCE2: f64 = 1e-12;

/// Sums of one row while it is swept.
pub(super) struct Row<const D: usize> {
    /// sum (v_j - v_i) (x) g, walls twice [1/s].
    pub(super) gradient: Tensor<D>,
    /// What images across flat walls, and grains and fluids to each other, add to it for the shear rate alone [1/s].
    pub(super) images: Tensor<D>,
    /// What fluids among a grain's neighbours have of `moment` [1].
    pub(super) softer: Tensor<D>,
    /// -sum x_ij (x) g: the identity far from surfaces [1].
    pub(super) moment: Tensor<D>,
    /// gamma_pair^2 = (D + 2) sum V_j |F| (v_ij . x_ij)^2/r^2 [1/s^2].
    pub(super) pair_shear2: f64,
    /// How neighbours lie otherwise than M says (`directions`); 0 in scenes without fluids [1].
    pub(super) directions: [f64; directions::COUNT],
    /// sum V_j v_ij.(grad grad W_ij) v_ij: second derivative of sum V_j W_ij along straight ways; 0 in scenes without fluids
    /// [1/s^2].
    pub(super) curvature: f64,
    /// Largest |v_ij|^2 [m^2/s^2].
    pub(super) speed2: f64,
    /// sum_j g_ij, walls once [1/m].
    pub(super) side: Vector<D>,
    /// sum_j V_j |F|, walls once [1/m^2].
    pub(super) nearness: f64,
}

impl<const D: usize> Row<D> {
    /// Of a particle without neighbours.
    pub(super) const NONE: Self = Self {
        gradient: [[0.0; D]; D],
        images: [[0.0; D]; D],
        softer: [[0.0; D]; D],
        moment: [[0.0; D]; D],
        pair_shear2: 0.0,
        directions: [0.0; directions::COUNT],
        curvature: 0.0,
        speed2: 0.0,
        side: [0.0; D],
        nearness: 0.0,
    };

    /// Adds a neighbour at x_i - x_j = x of w = V_j |F|, at v_i - v_j with v.x = vx, to what the pair form's bias is made of.
    #[inline(always)]
    pub(super) fn add_pair(&mut self, x: &Vector<D>, vx: f64, w: f64, fluids: bool) {
        let weight = w / dot(x, x);
        self.pair_shear2 += (D as f64 + 2.0) * weight * vx * vx;
        if fluids {
            let own = directions::of_neighbour(x, weight, 0.0);
            self.directions
                .iter_mut()
                .zip(own)
                .for_each(|(sum, own)| *sum += own);
        }
    }

    /// gamma_pair^2 as it would be if velocities were linear with this deviator of the strain rate, a ring's hoop included [1/s^2].
    pub(super) fn even_pair_shear2(&self, e: &Tensor<D>) -> f64 {
        directions::pair_shear2(&self.directions, &self.moment, e)
    }
}

impl<const D: usize> Solver<D> {
    /// Writes the neighbours of particle i within the support to the front of `near`, filled up with i to whole groups;
    /// returns their number.
    #[inline(always)]
    pub(super) fn find_near<L: Lanes>(
        &self,
        lanes: L,
        records: &[Record],
        i: usize,
        x: &Vector<D>,
        listed: &[u32],
        near: &mut [u32],
    ) -> usize {
        let support = self.kernel.support();
        // Just inside: the kernel vanishes there to the third order, and what is divided by it must not. At 0 is no neighbour.
        let limit = Four::splat(lanes, (1.0 - 1e-9) * support * support);
        let mut here = [Four::splat(lanes, 0.0); D];
        for k in 0..D {
            here[k] = Four::splat(lanes, x[k]);
        }
        let mut count = 0;
        for j in listed.as_chunks::<LANES>().0 {
            let there = motions::<L, D>(lanes, records, j).x;
            let mut r2 = Four::splat(lanes, 0.0);
            for k in 0..D {
                let d = self.periodic.nearest(lanes, k, here[k] - there[k]);
                r2 += d * d;
            }
            let (kept, more) = r2.pack_between(limit, j);
            near[count..count + LANES].copy_from_slice(&kept);
            count += more;
        }
        let full = count.next_multiple_of(LANES);
        near[count..full].fill(i as u32);
        full
    }

    /// Coefficients, appended to the block, and sums of particle i against its neighbours. RINGS: particles are rings; FLUIDS:
    /// some material is a fluid; MEET: it meets others.
    #[inline(always)]
    pub(super) fn fluid_row<L: Lanes, const RINGS: bool, const FLUIDS: bool, const MEET: bool>(
        &self,
        lanes: L,
        records: &[Record],
        (i, x, v): (usize, &Vector<D>, &Vector<D>),
        block: &mut Block<D>,
        near: Neighbours<'_>,
    ) -> Row<D> {
        let hoop = if RINGS { self.rings[i].hoop } else { 0.0 };
        let own = Own::<L, D>::new(self, lanes, (x, v, hoop));
        let mut sums = Sums::<L, D>::new(lanes);
        let groups = near.groups();
        let (g, c) = block.next_row(groups);
        for (n, ((j, g), c)) in groups.iter().zip(g).zip(c).enumerate() {
            if MEET {
                sums.note_kinds(n, &near.kinds);
            }
            let pairs = own.beside::<RINGS>(&motions::<L, D>(lanes, records, j));
            sums.add(&pairs);
            if FLUIDS {
                sums.add_for_fluids(&pairs, own.curvature(&pairs));
            }
            for k in 0..D {
                g[k] = pairs.g[k].store();
            }
            *c = own.pair_form(&pairs).store();
        }
        let mut row = sums.of_all();
        if MEET {
            sums.note_kinds(groups.len(), &near.kinds);
            sums.set_apart(&mut row);
        }
        row
    }
}
