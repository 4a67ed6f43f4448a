//! Effective pressure: what presses grain on grain, the pressure without that of the pores, evened over neighbours.

use crate::math::{Four, Lanes, Quad, in_lanes};
use crate::solver::Solver;
use crate::solver::pair::Block;
use crate::state::State;

impl<const D: usize> Solver<D> {
    /// Effective pressures from the pressures and the state's pore pressures.
    pub(in crate::solver) fn subtract_pore_pressure(&mut self, state: &State<D>) {
        let grains = &state.grains;
        let mut own = std::mem::take(&mut self.pore.residual);
        own.resize(grains.len(), 0.0);
        self.workers.each(&mut own, |i, p| {
            let material = &self.materials[grains.phase[i] as usize];
            *p = if material.is_saturated() {
                self.pressure[i] - self.pore_pressure(state, i)
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
