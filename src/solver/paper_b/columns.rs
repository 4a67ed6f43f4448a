//! Effective pressure by columns ([B] eq. 10, corrected): at rest p_eff = (rho_sat - rho_w) g times the depth below the sediment's
//! surface, which [B]'s single rho cannot say.
//!
//! A column is two spacings wide across gravity's main axis. The surface of a saturated material there is half a spacing above
//! its highest particle that is not alone among others; pores carry the weight of their own fluid from there. Dry material
//! carries all of its pressure, fluids have no grains.

use std::collections::BTreeMap;

use crate::math::{Vector, dot};
use crate::solver::Solver;
use crate::state::State;

use super::ALONE;
use super::sums::Sums;

/// Place of a column across gravity, and its phase.
type Column<const D: usize> = ([i64; D], u8);

impl<const D: usize> Solver<D> {
    /// p_eff of each particle [Pa].
    pub(super) fn find_effective_pressure(
        &self,
        state: &State<D>,
        sums: &[Sums<D>],
        out: &mut Vec<f64>,
    ) {
        let grains = &state.grains;
        let tops = if self.has_pores {
            self.tops(state, sums)
        } else {
            BTreeMap::new()
        };
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
            let top = tops.get(&(self.column(x), grains.phase[i]));
            let buoyant = material.rest_density() - material.grains.pore_density;
            // Height times g; what is alone has nothing above it.
            let above = top.map_or(0.0, |top| top - self.head(x));
            let half = 0.5 * self.numerics.spacing * self.gravity_norm;
            (buoyant * (above + half)).max(0.0)
        }));
    }

    /// g times the height of the highest particle of each column and phase [m^2/s^2].
    fn tops(&self, state: &State<D>, sums: &[Sums<D>]) -> BTreeMap<Column<D>, f64> {
        let grains = &state.grains;
        let mut tops = BTreeMap::new();
        for (i, x) in grains.position.iter().enumerate() {
            let saturated = self.materials[grains.phase[i] as usize].is_saturated();
            if saturated && sums[i].lambda >= ALONE {
                let top = tops
                    .entry((self.column(x), grains.phase[i]))
                    .or_insert(f64::NEG_INFINITY);
                *top = f64::max(*top, self.head(x));
            }
        }
        tops
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
