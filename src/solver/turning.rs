//! What turns as one is not strained (docs/theory.md, T1): the part of a velocity gradient that a rigid rotation has.
//!
//! G of v = W x is W M, and M of (E2) is not the identity where neighbours lack on one side: G is not skew there, and what holds
//! together would be held back from turning by its own surface. So
//!
//!   e_i = dev sym (G - P G),   sigma_i = tau_i - P tau_i,   P A = W M with |A - W M| the least over skew W           (T1)
//!
//! P is an orthogonal projection, so that the force of sigma stays minus the adjoint of e: the matrix of (E9) stays symmetric and positive,
//! momentum is kept, and angular momentum, too, since sigma M is symmetric. Where M is the identity P A is the skew part of A.
//!
//! Between materials G and M have the weights m_ij of `meeting`, and the force of sigma those of the force of tau: grains turn among a fluid as in air.
//!
//! For what has strength without pressure, away from walls and from what is as one to it (grains beside a fluid). Sand without cohesion has no stress where it is loose, and
//! in a surface that flows shear stress would be up to 1.2 of friction times the pressure that goes through the same sums.
//!
//! Symbols: G velocity gradient (E1), M moment (E2), W skew, tau stress, g_ij = V_j grad W_ij.

use std::ops::Range;

use crate::material::Material;
use crate::math::{
    Four, Geometry, Lanes, Tensor, Vector, apply, in_lanes, inverse, multiply, trace,
};
use crate::state::State;

use super::fluid_row::Row;
use super::meeting::share;
use super::pair::Block;
use super::record::Record;
use super::{Numerics, Rotation, Scheme, Solver};

/// For each material whether (T1) is for it; empty where it is for none.
pub(super) fn who_turns(
    numerics: &Numerics,
    geometry: Geometry,
    materials: &[Material],
) -> Vec<bool> {
    let turns: Vec<bool> = materials
        .iter()
        .map(|m| match numerics.rotation {
            Rotation::Cohesive => m.cohesion > 0.0,
            Rotation::All => true,
            Rotation::Off => false,
        })
        .collect();
    // Rings do not turn as one.
    let any = numerics.scheme == Scheme::Implicit && !geometry.is_axisymmetric();
    if any && turns.contains(&true) {
        turns
    } else {
        Vec::new()
    }
}

impl<const D: usize> Solver<D> {
    /// Takes from a row's gradient what a rigid rotation has, if (T1) is for it; M of the row then, else 0. `alone`: it sees no wall, of
    /// points or of grains.
    pub(super) fn turn(&self, sums: &mut Row<D>, phase: u8, alone: bool) -> Tensor<D> {
        if !(alone && self.turns[phase as usize]) {
            return [[0.0; D]; D];
        }
        let mut gradient = sums.gradient;
        for (row, images) in gradient.iter_mut().zip(&sums.images) {
            for (g, image) in row.iter_mut().zip(images) {
                *g += image;
            }
        }
        let mut moment = sums.moment;
        take(&mut moment, &sums.softer);
        take(&mut sums.gradient, &rigid_part(&moment, &gradient));
        moment
    }

    /// M of fluids beside other fluids with the weights that the solve's G has there, from this step's viscosities.
    pub(super) fn weigh_turning(&mut self, state: &State<D>) {
        if self.turns.is_empty() || !self.has_meetings {
            return;
        }
        let mut turning = std::mem::take(&mut self.turning);
        self.workers
            .blocks_read(&self.lists.blocks, &mut turning, |block, first, out| {
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let [like, other, ..] = block.kinds(row);
                        if !other.is_empty() && *o != [[0.0; D]; D] {
                            *o = self.weighed_moment(
                                lanes,
                                state,
                                block,
                                first + row,
                                [like, other],
                            );
                        }
                    }
                );
            });
        self.turning = turning;
    }

    /// -sum_j m_ij x_ij (x) g_ij over neighbours of the first two kinds.
    #[inline(always)]
    fn weighed_moment<L: Lanes>(
        &self,
        lanes: L,
        state: &State<D>,
        block: &Block<D>,
        i: usize,
        [like, other]: [Range<usize>; 2],
    ) -> Tensor<D> {
        let x = &state.grains.position;
        let mut sums = [[Four::splat(lanes, 0.0); D]; D];
        for n in like.start..other.end {
            let j = &block.j[n];
            let away = j.map(|j| self.periodic.difference(&x[i], &x[j as usize]));
            let mut m = Four::splat(lanes, 1.0);
            if n >= other.start {
                let eta = Four::gather(lanes, |m| self.viscosity[j[m] as usize]);
                m = share(lanes, Four::splat(lanes, self.viscosity[i]), eta);
            }
            for a in 0..D {
                let x = m * Four::gather(lanes, |m| away[m][a]);
                for b in 0..D {
                    sums[a][b] -= x * Four::load(lanes, &block.g[n][b]);
                }
            }
        }
        sums.map(|row| row.map(Four::sum))
    }

    /// Gathers M of every particle after a sweep; nothing in scenes that do without.
    pub(super) fn note_turning(&mut self, state: &State<D>) {
        if self.turns.is_empty() {
            return;
        }
        self.turning.resize(state.grains.len(), [[0.0; D]; D]);
        let mut turning = std::mem::take(&mut self.turning);
        self.workers
            .blocks_read(&self.lists.blocks, &mut turning, |block, _, out| {
                out.copy_from_slice(&block.turning);
            });
        self.turning = turning;
    }

    /// G less what of it a rigid rotation has.
    #[inline(always)]
    pub(super) fn unturned(&self, i: usize, gradient: &mut Tensor<D>) {
        if let Some(moment) = self.turning.get(i) {
            take(gradient, &rigid_part(moment, gradient));
        }
    }

    /// -P tau of every record; empty in scenes that do without.
    pub(super) fn turned_stress(&self, records: &[Record]) -> Vec<Tensor<D>> {
        let mut less = vec![[[0.0; D]; D]; self.turning.len()];
        self.workers.each(&mut less, |i, less| {
            take(less, &rigid_part(&self.turning[i], &records[i].stress()));
        });
        less
    }
}

impl<const D: usize> Solver<D> {
    /// f += sum_j (m_ij t_i + m_ji t_j) g_ij. What sees grains as a wall has no t, and to grains what a fluid has counts nothing.
    #[inline(always)]
    pub(super) fn add_turned_force<L: Lanes>(
        &self,
        lanes: L,
        block: &Block<D>,
        (row, i): (usize, usize),
        t: &[Tensor<D>],
        f: &mut Vector<D>,
    ) {
        let mut sums = [Four::splat(lanes, 0.0); D];
        let [like, other, ..] = block.kinds(row);
        for (j, g) in block.j[like.clone()].iter().zip(&block.g[like]) {
            for b in 0..D {
                let g = Four::load(lanes, &g[b]);
                for a in 0..D {
                    let both = Four::gather(lanes, |m| t[i][a][b] + t[j[m] as usize][a][b]);
                    sums[a] += both * g;
                }
            }
        }
        for (j, g) in block.j[other.clone()].iter().zip(&block.g[other]) {
            let eta = Four::gather(lanes, |m| self.viscosity[j[m] as usize]);
            let own = share(lanes, Four::splat(lanes, self.viscosity[i]), eta);
            let others = Four::splat(lanes, 2.0) - own;
            for b in 0..D {
                let g = Four::load(lanes, &g[b]);
                for a in 0..D {
                    let far = Four::gather(lanes, |m| t[j[m] as usize][a][b]);
                    sums[a] += (own * Four::splat(lanes, t[i][a][b]) + others * far) * g;
                }
            }
        }
        for k in 0..D {
            f[k] += sums[k].sum();
        }
    }
}

fn take<const D: usize>(from: &mut Tensor<D>, what: &Tensor<D>) {
    for (row, what) in from.iter_mut().zip(what) {
        for (a, b) in row.iter_mut().zip(what) {
            *a -= b;
        }
    }
}

/// P A = W M (T1).
#[inline(always)]
pub(super) fn rigid_part<const D: usize>(moment: &Tensor<D>, a: &Tensor<D>) -> Tensor<D> {
    let square = multiply(moment, moment);
    multiply(&rotation(&square, &multiply(a, moment)), moment)
}

/// The skew W with skew (W S) = skew B for a symmetric S >= 0: N w = b, b the axial vector of B, N = tr(S) I - S; in the plane tr(S) w = b.
/// 0 where S is.
#[inline(always)]
pub(super) fn rotation<const D: usize>(s: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    let size = trace(s);
    let mut skew = [[0.0; D]; D];
    if size <= 0.0 {
        return skew;
    }
    if D == 2 {
        skew[1][0] = (b[1][0] - b[0][1]) / size;
        skew[0][1] = -skew[1][0];
        return skew;
    }
    let mut n = [[0.0; 3]; 3];
    let mut axial = [0.0; 3];
    for k in 0..3 {
        for l in 0..3 {
            n[k][l] = -s[k][l];
        }
        // What lies along one line has no rotation about it.
        n[k][k] += (1.0 + 1e-13) * size;
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        axial[k] = b[q][p] - b[p][q];
    }
    let w = apply(&inverse(&n), &axial);
    for k in 0..3 {
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        skew[q][p] = w[k];
        skew[p][q] = -w[k];
    }
    skew
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOMENT: Tensor<3> = [[0.9, 0.1, 0.05], [0.1, 0.6, -0.02], [0.05, -0.02, 1.0]];
    const ANY: Tensor<3> = [[0.3, -1.2, 0.7], [0.4, 0.9, 2.0], [-0.6, 0.1, -1.1]];

    fn contract<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> f64 {
        a.iter()
            .flatten()
            .zip(b.iter().flatten())
            .map(|(a, b)| a * b)
            .sum()
    }

    fn plane(t: &Tensor<3>) -> Tensor<2> {
        std::array::from_fn(|r| std::array::from_fn(|c| t[r][c]))
    }

    /// The gradient of a rotation is its own rigid part, to rounding.
    fn check_rotation<const D: usize>(moment: &Tensor<D>, skew: &Tensor<D>) {
        let gradient = multiply(skew, moment);
        let found = rigid_part(moment, &gradient);
        let error = found.as_flattened().iter().zip(gradient.as_flattened());
        assert!(error.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-12);
    }

    /// P is an orthogonal projection: A.PB = PA.PB = PA.B.
    fn check_projection<const D: usize>(moment: &Tensor<D>, a: &Tensor<D>, b: &Tensor<D>) {
        let (pa, pb) = (rigid_part(moment, a), rigid_part(moment, b));
        let both = contract(&pa, &pb);
        assert!((contract(a, &pb) - both).abs() < 1e-12, "{both}");
        assert!((contract(&pa, b) - both).abs() < 1e-12, "{both}");
        assert!(both.abs() > 1e-3);
    }

    #[test]
    fn what_turns_is_taken_out_and_nothing_else() {
        let skew = [[0.0, -1.3, 0.4], [1.3, 0.0, 2.1], [-0.4, -2.1, 0.0]];
        check_rotation(&MOMENT, &skew);
        check_rotation(&plane(&MOMENT), &plane(&skew));
        let other = multiply(&ANY, &MOMENT);
        check_projection(&MOMENT, &ANY, &other);
        check_projection(&plane(&MOMENT), &plane(&ANY), &plane(&other));
        // Two particles: no rotation about their line.
        let line = [[0.2, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        check_rotation(&line, &skew);
        assert_eq!(rigid_part(&[[0.0; 3]; 3], &ANY), [[0.0; 3]; 3]);
    }
}
