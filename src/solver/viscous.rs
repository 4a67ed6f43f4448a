//! The viscous force as an operator (docs/theory.md, E10 and E11); its solve is in `implicit`.
//!
//! Adjoint stress form: e = dev sym G(v), tau = 2 eta e, force on i: V_i [sum_j (tau_i + tau_j) g_ij + 2 K_i : tau_i].
//! It is minus the adjoint of G, with the very weights that pressure is transmitted with, so tau/p arrives as it should
//! and the operator is symmetric and positive. A share of eta goes through the pair form, which sees the zero-energy
//! modes that G does not. Between materials m_ij tau_i + m_ji tau_j stand for tau_i + tau_j (`meeting`).

use std::ops::Range;

use crate::math::{Four, Lanes, Tensor, Vector, apply, in_lanes, inverse, scale};
use crate::state::State;

use super::Solver;
use super::meeting::{HARDER, LIKE, OTHER, SOFTER, add_differences, share};
use super::mirror::{add_image_gradient, image_drag, image_force};
use super::pair::{Block, WallRow};
use super::record::{Record, Stresses, stresses};
use super::reflect::{add_reflected_gradient, reflected_drag, reflected_force};

impl<const D: usize> Solver<D> {
    /// Records of v_i and tau_i = 2 (1 - share) eta_i e_i(v); tau_i = 0 for the rows that `skipped` names, if it is not empty.
    pub(super) fn stress(
        &self,
        v: &[Vector<D>],
        out: &mut [Record],
        with_walls: bool,
        skipped: &[bool],
    ) {
        self.workers
            .blocks_read(&self.lists.blocks, out, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let i = first + row;
                        let wall = walls.next_if(|w| w.row as usize == row);
                        if self.viscosity[i] != 0.0 && !is_among(skipped, i) {
                            let mut gradient =
                                wall.map_or([[0.0; D]; D], |w| w.gradient(&v[i], with_walls));
                            self.add_gradient(lanes, block, row, i, v, &mut gradient);
                            if let Some(w) = wall {
                                add_image_gradient(block.images_of(w), i, v, &mut gradient);
                                add_reflected_gradient(
                                    block.reflections_of(w),
                                    i,
                                    v,
                                    &mut gradient,
                                );
                            }
                            self.unturned(i, &mut gradient);
                            *o = Record::of_stress(&self.row_stress(i, &v[i], &gradient), &v[i]);
                        } else {
                            *o = Record::of_stress(&[[0.0; D]; D], &v[i]);
                        }
                    }
                );
            });
    }

    /// gradient += sum_j m_ij (v_j - v_i) (x) g_ij.
    #[inline(always)]
    fn add_gradient<L: Lanes>(
        &self,
        lanes: L,
        block: &Block<D>,
        row: usize,
        i: usize,
        v: &[Vector<D>],
        gradient: &mut Tensor<D>,
    ) {
        let zero = Four::splat(lanes, 0.0);
        let mut sums = [[zero; D]; D];
        let mut own = [zero; D];
        for k in 0..D {
            own[k] = Four::splat(lanes, v[i][k]);
        }
        let of = (lanes, block, i, &self.viscosity[..]);
        let [like, other, harder, _] = block.kinds(row);
        add_differences::<_, D, LIKE>(of, like, &own, v, &mut sums);
        if !other.is_empty() {
            add_differences::<_, D, OTHER>(of, other, &own, v, &mut sums);
        }
        if !harder.is_empty() {
            add_differences::<_, D, HARDER>(of, harder, &own, v, &mut sums);
        }
        for a in 0..D {
            for b in 0..D {
                gradient[a][b] += sums[a][b].sum();
            }
        }
    }

    /// 2 (1 - share) eta_i e of a velocity gradient.
    #[inline(always)]
    pub(super) fn row_stress(&self, i: usize, v: &Vector<D>, gradient: &Tensor<D>) -> Tensor<D> {
        let mut gradient = *gradient;
        gradient[0][0] += self.axis_rate(i, v);
        let hoop = self.hoop_rate(i, v);
        let e = self.geometry.strain_deviator(&gradient, hoop);
        let f = 2.0 * (1.0 - self.numerics.pair_viscosity_share) * self.viscosity[i];
        e.map(|r| scale(f, &r))
    }

    /// out_i from the viscous force F_i [N] of records of stress and velocity, the pair form's share included; and the
    /// sum of what `finish(i, F_i)` returns beside it, in a fixed order. F_i = 0 for the rows that `skipped` names.
    pub(super) fn force(
        &self,
        records: &[Record],
        out: &mut [Vector<D>],
        with_walls: bool,
        skipped: &[bool],
        finish: impl Fn(usize, &Vector<D>) -> (Vector<D>, f64) + Sync,
    ) -> f64 {
        let share = self.numerics.pair_viscosity_share;
        let turned = self.turned_stress(records);
        self.workers
            .blocks_sum(&self.lists.blocks, out, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                let mut sum = 0.0;
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        let i = first + row;
                        let wall = walls.next_if(|w| w.row as usize == row);
                        if is_among(skipped, i) {
                            *o = finish(i, &[0.0; D]).0;
                            continue;
                        }
                        let mut f = if self.geometry.is_axisymmetric() {
                            self.row_force::<_, true>(lanes, block, row, i, records)
                        } else {
                            self.row_force::<_, false>(lanes, block, row, i, records)
                        };
                        if !turned.is_empty() {
                            self.add_turned_force(lanes, block, (row, i), &turned, &mut f);
                        }
                        let own = &records[i];
                        if self.geometry.is_axisymmetric() {
                            f[0] -= self.ring_drag(i, &own.velocity(), &own.stress(), share);
                        }
                        if let Some(w) = wall {
                            let walls = self.wall_force(i, w, block, records, with_walls);
                            for k in 0..D {
                                f[k] += walls[k];
                            }
                        }
                        let (value, part) = finish(i, &scale(self.width * self.volume[i], &f));
                        *o = value;
                        sum += part;
                    }
                );
                sum
            })
    }

    /// What walls give row i, images across flat ones included.
    #[inline(always)]
    fn wall_force(
        &self,
        i: usize,
        w: &WallRow<D>,
        block: &Block<D>,
        records: &[Record],
        with_walls: bool,
    ) -> Vector<D> {
        let (v, tau) = (records[i].velocity(), records[i].stress());
        let stress_of = |j: usize| records[j].stress();
        let other = |j: usize| (records[j].velocity(), self.between(i, j));
        let (images, reflections) = (block.images_of(w), block.reflections_of(w));
        let stress = w.stress_force(&tau);
        let image = image_force(images, &tau, stress_of);
        let ahead = reflected_force(reflections, &tau, stress_of);
        let drag = apply(&w.c, &v);
        let less = image_drag(images, &v, other);
        let sheared = reflected_drag(reflections, &v, other);
        let share = self.numerics.pair_viscosity_share;
        let mut f = [0.0; D];
        for k in 0..D {
            let drive = if with_walls { w.cv[k] } else { 0.0 };
            let pairs = 2.0 * (drag[k] - drive) - less[k] + sheared[k];
            f[k] = stress[k] + image[k] + ahead[k] - share * pairs;
        }
        f
    }

    /// The pair form's viscosity between two particles, 0 where both have none: the harmonic mean [Pa s].
    #[inline(always)]
    pub(super) fn between(&self, i: usize, j: usize) -> f64 {
        let (a, b) = (self.pair_viscosity[i], self.pair_viscosity[j]);
        2.0 * a * b / (a + b).max(f64::MIN_POSITIVE)
    }

    /// sum_j (m_ij tau_i + m_ji tau_j) g_ij and the pair form's share.
    #[inline(always)]
    fn row_force<L: Lanes, const RINGS: bool>(
        &self,
        lanes: L,
        block: &Block<D>,
        row: usize,
        i: usize,
        records: &[Record],
    ) -> Vector<D> {
        let share = Four::splat(lanes, self.numerics.pair_viscosity_share);
        let own = stresses::<L, D, RINGS>(lanes, records, &[i as u32; 4]);
        let mut f = [Four::splat(lanes, 0.0); D];
        let [like, other, harder, softer] = block.kinds(row);
        let of = (lanes, block, i, &own, records);
        self.add_forces::<_, RINGS, LIKE>(of, share, like, &mut f);
        if !other.is_empty() {
            self.add_forces::<_, RINGS, OTHER>(of, share, other, &mut f);
        }
        if !harder.is_empty() {
            self.add_forces::<_, RINGS, HARDER>(of, share, harder, &mut f);
        }
        if !softer.is_empty() {
            self.add_forces::<_, RINGS, SOFTER>(of, share, softer, &mut f);
        }
        let mut sums = [0.0; D];
        for (sum, f) in sums.iter_mut().zip(f) {
            *sum = f.sum();
        }
        sums
    }

    /// f += sum_j (m_ij tau_i + m_ji tau_j) g_ij, and the pair form's share, over groups of one KIND.
    #[inline(always)]
    fn add_forces<L: Lanes, const RINGS: bool, const KIND: u8>(
        &self,
        (lanes, block, i, own, records): (L, &Block<D>, usize, &Stresses<L, D>, &[Record]),
        pair_share: Four<L>,
        range: Range<usize>,
        f: &mut [Four<L>; D],
    ) {
        let zero = Four::splat(lanes, 0.0);
        let (j, g) = (&block.j[range.clone()], &block.g[range.clone()]);
        for ((j, g), c) in j.iter().zip(g).zip(&block.c[range]) {
            let other = stresses::<L, D, RINGS>(lanes, records, j);
            let mut m_ij = zero;
            if KIND == OTHER {
                let eta = Four::gather(lanes, |m| self.viscosity[j[m] as usize]);
                m_ij = share(lanes, Four::splat(lanes, self.viscosity[i]), eta);
            }
            let mut g_ij = [zero; D];
            let mut along = zero;
            for k in 0..D {
                g_ij[k] = Four::load(lanes, &g[k]);
                along += (other.v[k] - own.v[k]) * g_ij[k];
            }
            let pair = pair_share * Four::load(lanes, c) * along;
            for a in 0..D {
                let mut s = pair * g_ij[a];
                for b in 0..D {
                    let (own, other) = (own.tau[a][b], other.tau[a][b]);
                    let tau = match KIND {
                        OTHER => m_ij * own + (Four::splat(lanes, 2.0) - m_ij) * other,
                        HARDER => own + own,
                        SOFTER => other + other,
                        _ => own + other,
                    };
                    s += tau * g_ij[b];
                }
                f[a] += s;
            }
        }
    }

    /// Inverse Jacobi blocks (docs/theory.md, E17): the matrix's own, but for the pair form's share, which counts twice, and what
    /// the stress of the row itself adds, which is left out.
    pub(super) fn jacobi_blocks(&self, state: &State<D>, dt: f64, jacobi: &mut [Tensor<D>]) {
        let share = self.numerics.pair_viscosity_share;
        self.workers
            .blocks_read(&self.lists.blocks, jacobi, |block, first, out| {
                for (row, b) in out.iter_mut().enumerate() {
                    *b = self.prediction[first + row].resistance;
                }
                for w in &block.wall_rows {
                    let b = &mut out[w.row as usize];
                    for r in 0..D {
                        for c in 0..D {
                            b[r][c] += 4.0 * share * w.c[r][c];
                        }
                    }
                }
                for (row, b) in out.iter_mut().enumerate() {
                    let i = first + row;
                    if self.geometry.is_axisymmetric() {
                        b[0][0] += self.ring_stiffness(i);
                    }
                    let f = dt * self.width * self.volume[i];
                    for r in 0..D {
                        for c in 0..D {
                            b[r][c] *= f;
                        }
                        b[r][r] += state.grains.mass[i];
                        if let Some(lean) = self.lean.get(i) {
                            for c in 0..D {
                                b[r][c] -= state.grains.mass[i] * lean[r][c];
                            }
                        }
                    }
                    *b = inverse(b);
                }
            });
    }
}

/// Whether `rows` names row i; empty: none.
#[inline(always)]
fn is_among(rows: &[bool], i: usize) -> bool {
    rows.get(i).is_some_and(|r| *r)
}
