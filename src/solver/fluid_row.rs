//! Particle i against its neighbours, four at a time: pair coefficients and sums (docs/theory.md, E1 to E4).
//!
//! Symbols: F = W'(r)/r <= 0, g = V_j F x, x = x_i - x_j, v = v_i - v_j, gamma shear rate.

use crate::math::{Four, LANES, Lanes, Quad, Tensor, Vector, dot};

use super::Solver;
use super::directions;
use super::meeting::KINDS;
use super::pair::Block;
use super::record::{Record, motions};

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

    /// Coefficients, appended to the block, and sums of particle i against the neighbours `near`. RINGS: particles are
    /// rings; FLUIDS: some material is a fluid; MEET: it meets others, and `kinds` says how many groups are of the first kind, of the
    /// first two, and so on.
    #[inline(always)]
    pub(super) fn fluid_row<L: Lanes, const RINGS: bool, const FLUIDS: bool, const MEET: bool>(
        &self,
        lanes: L,
        records: &[Record],
        (i, xi, vi): (usize, &Vector<D>, &Vector<D>),
        block: &mut Block<D>,
        (near, kinds): (&[u32], [usize; KINDS - 1]),
    ) -> Row<D> {
        let dissipation = D as f64 + 2.0;
        let zero = Four::splat(lanes, 0.0);
        let one = Four::splat(lanes, 1.0);
        let least = Four::splat(lanes, LEAST_DISTANCE2 * self.kernel.h * self.kernel.h);
        let inverse_2h = Four::splat(lanes, self.kernel.inverse_support());
        let slope = Four::splat(lanes, -self.kernel.slope());
        let pair_form = Four::splat(lanes, -2.0 * dissipation);
        let ring = if RINGS { self.rings[i].hoop } else { 0.0 };
        let ring = Four::splat(lanes, ring);
        let to_section = Four::splat(lanes, 0.5 / std::f64::consts::TAU);
        let (mut here, mut own) = ([zero; D], [zero; D]);
        for k in 0..D {
            here[k] = Four::splat(lanes, xi[k]);
            own[k] = Four::splat(lanes, vi[k]);
        }
        let (mut gradient, mut moment) = ([[zero; D]; D], [[zero; D]; D]);
        let (mut pair_shear2, mut speed2) = (zero, zero);
        let mut around = [zero; directions::COUNT];
        let (mut side, mut nearness, mut curvature) = ([zero; D], zero, zero);
        let falloff = Four::splat(lanes, -3.0 * self.kernel.inverse_support());
        // Sums without harder and softer neighbours, and without softer ones.
        let mut until = [(gradient, moment, pair_shear2); 2];
        let groups = near.as_chunks::<LANES>().0;
        let (g, c) = block.next_row(groups);
        for (n, ((j, g), c)) in groups.iter().zip(g).zip(c).enumerate() {
            if MEET {
                for (until, &end) in until.iter_mut().zip(&kinds[1..]) {
                    if n == end {
                        *until = (gradient, moment, pair_shear2);
                    }
                }
            }
            let other = motions::<L, D>(lanes, records, j);
            let (mut x, mut v) = ([zero; D], [zero; D]);
            let (mut r2, mut v2, mut vx) = (zero, zero, zero);
            for k in 0..D {
                x[k] = self.periodic.nearest(lanes, k, here[k] - other.x[k]);
                v[k] = own[k] - other.v[k];
                r2 += x[k] * x[k];
                v2 += v[k] * v[k];
                vx += v[k] * x[k];
            }
            let r = r2.sqrt();
            let t = (one - r * inverse_2h).max(zero);
            let mut volume = other.volume;
            if RINGS {
                volume = volume * ((ring + other.hoop) * to_section);
            }
            let vf = volume * (slope * t * t * t);
            // Groups are filled up with i itself.
            nearness -= r2.where_greater(zero, vf);
            let inverse = one.over(r2.max(least) * vf);
            let mut weights = [Quad::default(); D];
            for b in 0..D {
                let gb = vf * x[b];
                weights[b] = gb.store();
                side[b] += gb;
                for a in 0..D {
                    gradient[a][b] -= v[a] * gb;
                    if a <= b {
                        moment[a][b] -= x[a] * gb;
                    }
                }
            }
            // |g| r = |vf| r^2; (v.x)^2/r^2 = (v.x)^2 vf (1/(r^2 vf)).
            let weight = vf * vf * inverse;
            pair_shear2 -= weight * vx * vx;
            if FLUIDS {
                // F v^2 + F'/r (v.x)^2, with 1/r = r vf (1/(r^2 vf)).
                let steeper = volume * (slope * t * t) * falloff;
                curvature += vf * (v2 + steeper * r * inverse * vx * vx);
            }
            if FLUIDS {
                let own = directions::of_neighbour(&x, weight, zero);
                for (sum, own) in around.iter_mut().zip(own) {
                    *sum -= own;
                }
            }
            speed2 = speed2.max(v2);
            *g = weights;
            *c = (pair_form * inverse).store();
        }
        let mut sums = Row {
            pair_shear2: dissipation * pair_shear2.sum(),
            directions: around.map(Four::sum),
            curvature: curvature.sum(),
            speed2: speed2.largest(),
            side: side.map(Four::sum),
            nearness: nearness.sum(),
            ..Row::NONE
        };
        if MEET {
            for (until, &end) in until.iter_mut().zip(&kinds[1..]) {
                if end >= groups.len() {
                    *until = (gradient, moment, pair_shear2);
                }
            }
            // What the shear rate is compared with is of the same neighbours.
            sums.pair_shear2 = dissipation * until[1].2.sum();
        }
        for a in 0..D {
            for b in 0..D {
                sums.gradient[a][b] = gradient[a][b].sum();
                let m = moment[a.min(b)][a.max(b)];
                sums.moment[a][b] = m.sum();
                if MEET {
                    let [(own, ..), (harder, most, _)] = &until;
                    // Harder ones twice, softer ones not at all.
                    let once_more = harder[a][b] - own[a][b];
                    sums.images[a][b] = (once_more - (gradient[a][b] - harder[a][b])).sum();
                    sums.softer[a][b] = (m - most[a.min(b)][a.max(b)]).sum();
                }
            }
        }
        sums
    }
}
