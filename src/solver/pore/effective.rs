//! Effective pressure: what presses grain on grain, the pressure without that of the pores, evened over neighbours.
//!
//! The sums of (E7) carry a pressure with the weight M of (E2), which is half a percent below 1 where grains flow, so that it stands as much above the
//! load. Friction goes through the same sums, and mu p is right all the same; but the pores' pressure (F2) is the load's own, and the whole
//! excess would press grain on grain. So where a bed flows as much of p_w is taken from p as stands in it,
//!
//!   p' = p - p_w [1 + chi (1/m - 1)],   m = n.M n, n along gravity,   chi = 10 T_d gamma - 1 within 0 and 1          (F9)
//!
//! What rests holds whatever pressure it came to rest with, and keeps it.

use crate::math::{Four, Lanes, Quad, Tensor, apply, dot, in_lanes};
use crate::solver::Solver;
use crate::solver::pair::Block;
use crate::state::State;

/// How far m of (F9) may be from 1: beside what has no neighbours it says nothing.
const FARTHEST: f64 = 0.02;

/// How much earlier than that of (E8) the gate opens [1]: slow flow has the excess, too, and what rests trembles far more slowly.
const EARLIER: f64 = 10.0;

impl<const D: usize> Solver<D> {
    /// n.M n of a row, n along gravity; 1 without gravity.
    #[inline(always)]
    pub(in crate::solver) fn transmitted(&self, moment: &Tensor<D>) -> f64 {
        let g = &self.gravity;
        let square = dot(g, g);
        if square == 0.0 {
            return 1.0;
        }
        dot(g, &apply(moment, g)) / square
    }

    /// Gathers it from the sweep; nothing in scenes without pores.
    pub(in crate::solver) fn note_transmitted(&mut self, state: &State<D>) {
        if !self.has_pores {
            return;
        }
        let mut transmitted = std::mem::take(&mut self.pore.transmitted);
        transmitted.resize(state.grains.len(), 1.0);
        self.workers
            .blocks_read(&self.lists.blocks, &mut transmitted, |block, _, out| {
                out.copy_from_slice(&block.transmitted);
            });
        self.pore.transmitted = transmitted;
    }

    /// What of the pressure of row i the pores' stands for (F9) [Pa].
    #[inline]
    fn pores_part(&self, state: &State<D>, i: usize) -> f64 {
        let m = self.pore.transmitted.get(i).map_or(1.0, |m| *m);
        let m = m.clamp(1.0 - FARTHEST, 1.0 + FARTHEST);
        let gate = EARLIER * self.numerics.diffusion_gate_time;
        let flows = (gate * self.kinematics[i].shear - 1.0).clamp(0.0, 1.0);
        self.pore_pressure(state, i) * (1.0 + flows * (1.0 / m - 1.0))
    }

    /// Effective pressures from the pressures and the state's pore pressures.
    pub(in crate::solver) fn subtract_pore_pressure(&mut self, state: &State<D>) {
        let grains = &state.grains;
        let mut own = std::mem::take(&mut self.pore.residual);
        own.resize(grains.len(), 0.0);
        self.workers.each(&mut own, |i, p| {
            let material = &self.materials[grains.phase[i] as usize];
            *p = if material.is_saturated() {
                self.pressure[i] - self.pores_part(state, i)
            } else if material.is_fluid() {
                0.0
            } else {
                self.pressure[i]
            };
        });
        let mut near = std::mem::take(&mut self.pore.near);
        near.resize(grains.len(), Quad::default());
        self.workers.each(&mut near, |i, of| {
            let porous = f64::from(u8::from(self.is_porous(state, i)));
            *of = Quad([porous, porous * own[i], 0.0, 0.0]);
        });
        let mut effective = std::mem::take(&mut self.effective);
        effective.resize(grains.len(), 0.0);
        self.workers
            .blocks_read(&self.lists.blocks, &mut effective, |block, first, out| {
                in_lanes!(
                    self.arch,
                    |lanes| for (row, p) in out.iter_mut().enumerate() {
                        let i = first + row;
                        *p = if self.is_porous(state, i) {
                            let own = (i, own[i]);
                            self.smoothed(lanes, state, &near, own, block, row).max(0.0)
                        } else {
                            own[i]
                        };
                    }
                );
            });
        self.effective = effective;
        self.pore.near = near;
        self.pore.residual = own;
    }

    /// Mean of the effective pressures of a particle and its saturated neighbours, each carried to the particle's place with
    /// the buoyant weight: the packing's own forces, which a bed at rest holds, are no friction.
    #[inline(always)]
    fn smoothed<L: Lanes>(
        &self,
        lanes: L,
        state: &State<D>,
        near: &[Quad],
        (i, own): (usize, f64),
        block: &Block<D>,
        row: usize,
    ) -> f64 {
        let grains = &self.materials[state.grains.phase[i] as usize].grains;
        let buoyant = grains.rest_density() - grains.pore_density;
        let zero = Four::splat(lanes, 0.0);
        let (mut sum, mut weights, mut fall) = (zero, zero, zero);
        self.for_each_four(lanes, near, block, row, |four| {
            let [porous, pressure, ..] = four.of;
            sum += four.k * pressure;
            weights += four.k * porous;
            fall += four.down * porous;
        });
        // The particle's own cell counts as |F| at r = 0 does, of a ring by its section as its neighbours' do; k x_ij = -2 g_ij.
        let ring = self.rings.get(i);
        let section = self.volume[i] * ring.map_or(1.0, |r| r.hoop / std::f64::consts::TAU);
        let own_weight = 2.0 * section * self.kernel.f(0.0).abs();
        let sum = own_weight * own + sum.sum() - 2.0 * buoyant * fall.sum();
        sum / (own_weight + weights.sum())
    }

    /// Pressure that presses grain on grain, or on a wall: that of the particle but for pores and fluids [Pa].
    #[must_use]
    pub fn effective_pressure(&self) -> &[f64] {
        if self.effective.is_empty() {
            self.normal_pressure()
        } else {
            &self.effective
        }
    }
}
