//! Pore pressure of saturated material (docs/theory.md, "Pore pressure"): steady seepage through a bed of even permeability,
//! div (grad p_w - rho_w g) = 0, which is hydrostatic where nothing flows, whatever the bed's shape.
//!
//! p_w is the fluid's own pressure where a fluid touches the bed, 0 at a dry surface; nothing seeps through walls. What is
//! left, p - p_w >= 0, presses grain on grain: the effective pressure, which friction is made of ([B] section 2 has a
//! column's weight in its place, its eq. 10).
//!
//! This file is the equation and its rows; `solve` solves it, `effective` is what is left to press grain on grain,
//! `follow` what a change of it does to material at rest, `rise` what becomes of water that a bed has run over.
//!
//! Symbols: k_ij = 2 V_i V_j |F|; sum_j k_ij (p_i - p_j - rho_w g.x_ij) = 0, x_ij = x_i - x_j; Dirichlet rows: p_j of fluids.

mod air;
mod closed;
mod effective;
mod follow;
mod rise;
mod solve;

use crate::kernel::WendlandC2;
use crate::math::{Four, LANES, Lanes, Quad, Vector, dot, in_lanes, norm};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// Share of a lattice's sum of |F| below which a particle is at a dry surface [1]: at a flat surface it is 0.63 to 0.68 in the
/// first row and 0.91 to 0.99 in the second, for h/dp of 2 to 1.3.
const SURFACE: f64 = 0.8;

/// What the residual may be, over that of an error of a spacing's buoyant weight [1].
const TOLERANCE: f64 = 1e-3;

/// Work arrays of the solve; empty in scenes without saturated material.
#[derive(Debug, Default)]
pub(super) struct Work {
    /// sum_j k_ij and what a dry surface adds; 0 for what has no pores.
    diagonal: Vec<f64>,
    residual: Vec<f64>,
    /// m of (F9) of each particle [1]; empty with schemes that do without.
    transmitted: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// What rows look up of a neighbour.
    near: Vec<Quad>,
}

/// Places of a square lattice, `spacing` apart, around one of them, out to the support and beyond it in its corners [m].
fn lattice<const D: usize>(
    kernel: &WendlandC2<D>,
    spacing: f64,
) -> impl Iterator<Item = Vector<D>> {
    let reach = (kernel.support() / spacing).ceil() as i64;
    let side = 2 * reach + 1;
    (0..side.pow(D as u32)).map(move |n| {
        let mut rest = n;
        std::array::from_fn(|_| {
            let c = rest % side - reach;
            rest /= side;
            c as f64 * spacing
        })
    })
}

/// sum_j 2 V_j |F| inside a square lattice of particles `spacing` apart [1/m^2].
pub(super) fn lattice_sum<const D: usize>(kernel: &WendlandC2<D>, spacing: f64) -> f64 {
    let mut sum = 0.0;
    for x in lattice(kernel, spacing) {
        if norm(&x) > 0.0 {
            sum += kernel.f(norm(&x)).abs();
        }
    }
    2.0 * spacing.powi(D as i32) * sum
}

/// What one row is made of.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    /// sum_j k_ij over all neighbours, surface included.
    diagonal: f64,
    /// sum over fluids of k_ij p_j, and sum_j k_ij rho_w g.x_ij over all.
    given: f64,
    /// sum over saturated neighbours of k_ij p_j.
    known: f64,
    /// Whether air or a fluid joins it.
    open: bool,
}

/// Four neighbours of a row: what was looked up of them, k = 2 V_j |F| [1/m^2] and g.grad W_ij V_j [1/s^2].
struct Near<L: Lanes> {
    of: [Four<L>; LANES],
    k: Four<L>,
    down: Four<L>,
}

impl<const D: usize> Solver<D> {
    /// Finds the pore pressure of the state's positions and densities, from the last one.
    pub(super) fn seep(&mut self, state: &mut State<D>) {
        if !self.has_pores {
            return;
        }
        self.load_all(state);
        let n = state.grains.len();
        let mut work = std::mem::take(&mut self.pore);
        for values in [
            &mut work.diagonal,
            &mut work.residual,
            &mut work.direction,
            &mut work.product,
        ] {
            values.resize(n, 0.0);
        }
        let mut pore = std::mem::take(&mut state.grains.pore_pressure);
        let (limit2, open) = self.start_seepage(state, &pore, &mut work);
        self.iterate(&mut pore, &mut work, limit2);
        self.pin_closed(state, &open, &mut pore);
        state.grains.pore_pressure = pore;
        self.pore = work;
    }

    /// Calls `visit` for the neighbours of a row, four at a time. Only before the coefficients are multiplied by viscosity.
    #[inline(always)]
    fn for_each_four<L: Lanes>(
        &self,
        lanes: L,
        near: &[Quad],
        block: &Block<D>,
        row: usize,
        mut visit: impl FnMut(Near<L>),
    ) {
        let over = Four::splat(lanes, 1.0 / (D as f64 + 2.0));
        let range = block.groups(row);
        let (j, g) = (&block.j[range.clone()], &block.g[range.clone()]);
        for ((j, g), c) in j.iter().zip(g).zip(&block.c[range]) {
            let of = Four::transpose(
                lanes,
                [
                    &near[j[0] as usize],
                    &near[j[1] as usize],
                    &near[j[2] as usize],
                    &near[j[3] as usize],
                ],
            );
            let zero = Four::splat(lanes, 0.0);
            let (mut g2, mut down) = (zero, zero);
            for a in 0..D {
                let g_a = Four::load(lanes, &g[a]);
                g2 += g_a * g_a;
                down += Four::splat(lanes, self.gravity[a]) * g_a;
            }
            let k = over * g2 * Four::load(lanes, c);
            visit(Near { of, k, down });
        }
    }

    fn is_porous(&self, state: &State<D>, i: usize) -> bool {
        self.materials[state.grains.phase[i] as usize].is_saturated()
    }

    /// Diagonal and first residual; returns the square of what the residual may be, and which rows air or a fluid joins.
    fn start_seepage(&self, state: &State<D>, pore: &[f64], work: &mut Work) -> (f64, Vec<bool>) {
        let Work {
            diagonal,
            residual,
            near,
            ..
        } = work;
        near.resize(diagonal.len(), Quad::default());
        self.workers.each(near, |j, of| {
            let material = &self.materials[state.grains.phase[j] as usize];
            *of = if material.is_fluid() {
                Quad([1.0, self.pressure[j], 0.0, 1.0])
            } else if material.is_saturated() {
                Quad([1.0, 0.0, pore[j], 0.0])
            } else {
                Quad::default()
            };
        });
        let near = &*near;
        let air = self.find_air(state);
        let mut rows = vec![Row::default(); diagonal.len()];
        self.workers
            .blocks_read(&self.lists.blocks, &mut rows, |block, first, out| {
                in_lanes!(
                    self.arch,
                    |lanes| for (row, o) in out.iter_mut().enumerate() {
                        if self.is_porous(state, first + row) {
                            let i = first + row;
                            let dry = || air.reaches(&state.grains.position[i]);
                            *o = self.seepage_row(lanes, state, near, (block, row, i), dry);
                        }
                    }
                );
            });
        for (i, row) in rows.iter().enumerate() {
            diagonal[i] = row.diagonal;
            residual[i] = row.given + row.known - row.diagonal * pore[i];
        }
        let head = TOLERANCE * self.gravity_norm * self.numerics.spacing;
        let [limit2, given2] = self.workers.sums(rows.len(), |i| {
            let grains = &self.materials[state.grains.phase[i] as usize].grains;
            let buoyant = (grains.rest_density() - grains.pore_density).abs();
            [
                (rows[i].diagonal * head * buoyant).powi(2),
                rows[i].given.powi(2),
            ]
        });
        let open = rows.iter().map(|row| row.open).collect();
        (limit2.max(1e-24 * given2), open)
    }

    /// Sums of row i; `dry`: whether air reaches it.
    #[inline(always)]
    fn seepage_row<L: Lanes>(
        &self,
        lanes: L,
        state: &State<D>,
        near: &[Quad],
        (block, row, i): (&Block<D>, usize, usize),
        dry: impl Fn() -> bool,
    ) -> Row {
        let rho_w = self.materials[state.grains.phase[i] as usize]
            .grains
            .pore_density;
        let volume = self.volume[i];
        let zero = Four::splat(lanes, 0.0);
        let (mut diagonal, mut fluid, mut known, mut fall) = (zero, zero, zero, zero);
        let mut beside_fluid = zero;
        self.for_each_four(lanes, near, block, row, |four| {
            let [wet, pressure, pore, is_fluid] = four.of;
            diagonal += four.k * wet;
            fluid += four.k * pressure;
            known += four.k * pore;
            fall += four.down * wet;
            beside_fluid += four.k * is_fluid;
        });
        // k_ij x_ij = -2 V_i g_ij.
        let mut sums = Row {
            diagonal: volume * diagonal.sum(),
            given: volume * (fluid.sum() - 2.0 * rho_w * fall.sum()),
            known: volume * known.sum(),
            open: beside_fluid.sum() > 0.0,
        };
        // A grain alone has no bed, and air around it.
        sums.open |= sums.diagonal <= 0.0;
        if sums.diagonal > 0.0 && sums.diagonal < SURFACE * volume * self.lattice_sum && dry() {
            self.join_air(state, rho_w, &mut sums, (block, row, i));
        }
        sums
    }

    /// Joins a particle at a dry surface to air at pressure 0, half a spacing away along the surface's normal.
    fn join_air(
        &self,
        state: &State<D>,
        rho_w: f64,
        sums: &mut Row,
        (block, row, i): (&Block<D>, usize, usize),
    ) {
        let volume = self.volume[i];
        let x = &state.grains.position[i];
        let mut filled = sums.diagonal;
        // sum_j V_j grad W: away from the air.
        let mut inwards = [0.0; D];
        block.for_each_pair(row, |j, _, g| {
            let material = &self.materials[state.grains.phase[j as usize] as usize];
            if material.holds_fluid() {
                for a in 0..D {
                    inwards[a] += g[a];
                }
            }
        });
        for &wall in block.wall_row(row) {
            let (offset, r) = self.wall_offset(x, wall);
            let weight = self.walls.weight[wall as usize];
            if r < self.kernel.support() && weight > 0.0 {
                let f = self.wall_volume(i, wall, weight) * self.kernel.f(r);
                filled -= 2.0 * volume * f;
                for a in 0..D {
                    inwards[a] += f * offset[a];
                }
            }
        }
        let size = norm(&inwards);
        let full = volume * self.lattice_sum;
        if filled < SURFACE * full && size > 0.0 {
            let joint = full - filled;
            sums.open = true;
            sums.diagonal += joint;
            // rho_w g.(x - air).
            let head = 0.5 * self.numerics.spacing * rho_w * dot(&self.gravity, &inwards) / size;
            sums.given += joint * head;
        }
    }
}
