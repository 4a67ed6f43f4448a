//! Effective pressure by columns ([B] eq. 10, corrected): at rest p_eff = (rho_sat - rho_w) g times the depth below the sediment's
//! surface, which [B]'s single rho cannot say.
//!
//! A column is two spacings wide across gravity's main axis. Its surface is half a spacing above its highest particle that is not
//! alone among others; pores carry the weight of their own fluid from there. Dry material carries all of its pressure, fluids have no
//! grains.
//!
//! What is above counts with its own weight w, also of other materials ([B] has one): buoyant if it is saturated, whole if it is
//! dry. p_eff = g int w dz up to the surface, by trapezoids from grain to grain: a layer ends halfway between its last grain and
//! the other's first. What hangs more than [`GAP`] above does not bear on what is below.

use std::collections::BTreeMap;

use crate::math::{Vector, dot};
use crate::solver::Solver;
use crate::state::State;

use super::ALONE;
use super::sums::Sums;

/// Spacings between two grains of a column above which nothing lies between that carries [1].
const GAP: f64 = 3.0;

/// Grains of a column from the highest on: head [m^2/s^2], phase, p_eff [Pa].
type Stack = Vec<(f64, u8, f64)>;

impl<const D: usize> Solver<D> {
    /// p_eff of each particle [Pa].
    pub(super) fn find_effective_pressure(
        &self,
        state: &State<D>,
        sums: &[Sums<D>],
        out: &mut Vec<f64>,
    ) {
        let grains = &state.grains;
        let stacks = self.stacks(state, sums);
        out.clear();
        out.extend((0..grains.len()).map(|i| {
            let material = &self.materials[grains.phase[i] as usize];
            if material.is_fluid() {
                return 0.0;
            }
            if !material.is_saturated() {
                return self.pressure_of(state, i).max(0.0);
            }
            let x = &grains.position[i];
            let stack = stacks.get(&self.column(x));
            let stack = stack.map_or(&[][..], |stack| stack);
            self.bearing(stack, self.head(x), grains.phase[i])
        }));
    }

    /// Columns of grains.
    fn stacks(&self, state: &State<D>, sums: &[Sums<D>]) -> BTreeMap<[i64; D], Stack> {
        let mut stacks: BTreeMap<[i64; D], Stack> = BTreeMap::new();
        if !self.has_pores {
            return stacks;
        }
        let grains = &state.grains;
        for (i, x) in grains.position.iter().enumerate() {
            let phase = grains.phase[i];
            if !self.materials[phase as usize].is_fluid() && sums[i].lambda >= ALONE {
                let stack = stacks.entry(self.column(x)).or_default();
                stack.push((self.head(x), phase, 0.0));
            }
        }
        for stack in stacks.values_mut() {
            // Stable: grains as high as each other stay in their order.
            stack.sort_by(|a, b| b.0.total_cmp(&a.0));
            for k in 0..stack.len() {
                let (head, phase, _) = stack[k];
                stack[k].2 = self.bearing(&stack[..k], head, phase);
            }
        }
        stacks
    }

    /// p_eff of a grain of `phase` at a head under those of a stack that are above it [Pa].
    fn bearing(&self, stack: &[(f64, u8, f64)], head: f64, phase: u8) -> f64 {
        let weight = |phase: u8| {
            let material = &self.materials[phase as usize];
            let fluid = if material.is_saturated() {
                material.grains.pore_density
            } else {
                0.0
            };
            (material.rest_density() - fluid).max(0.0)
        };
        let spacing = self.numerics.spacing * self.gravity_norm;
        let own = weight(phase);
        let above = stack.partition_point(|grain| grain.0 > head);
        match stack[..above].last() {
            Some((over, other, load)) if over - head <= GAP * spacing => {
                load + 0.5 * (own + weight(*other)) * (over - head)
            }
            _ => 0.5 * own * spacing,
        }
    }

    /// -g.x [m^2/s^2].
    fn head(&self, x: &Vector<D>) -> f64 {
        -dot(&self.gravity, x)
    }

    /// Where a column stands: two spacings wide across gravity's main axis.
    fn column(&self, x: &Vector<D>) -> [i64; D] {
        let down = (0..D).fold(0, |best, k| {
            if self.gravity[k].abs() > self.gravity[best].abs() {
                k
            } else {
                best
            }
        });
        let width = 2.0 * self.numerics.spacing;
        std::array::from_fn(|k| {
            if k == down {
                0
            } else {
                (x[k] / width).floor() as i64
            }
        })
    }
}
