//! What has a yield stress beside walls without slip: where the wall yields them (docs/theory.md, W8).
//!
//! Near its yield a fluid slides over a wall in a layer thinner than a spacing, at the stress of the wall. Here the strain that a wall
//! without slip makes is that of rows at half a spacing from it and more, 2 |S| u of a row at the speed u, and works on their stress;
//! what stress is more at the wall, (W4) takes from them as momentum, m K (a - a*). So what slides over a floor lost the weight of 0.7
//! of a row before it came to yield: a layer of nine rows stood up to 1.08 times the load that it bears. As a stress on that strain
//! it is
//!
//!   D = rho |K (a - a*)| / (2 |S|),   S = sum_walls g_iw,                                                   (W8)
//!
//! |S| added up over faces without slip, as between two walls it would cancel: 0.8 and 0.4 of what stress changes over a spacing in the
//! first two rows. They yield as a cell does through which stress changes from tau - D to tau + D: at the mean of the law's rates. A layer as a whole then slides where the wall's stress is the yield stress
//! and not before, and fast flow, where all of the cell yields, is what it was but for D^2.
//!
//! a - a* is that of the last step. Exact yield only.
//!
//! Of dry grains what the wall's stress is more is rho |K (a - a* - b)|, b of (W14), and such a row yields at the mean of the rates of
//! its law from (tau - c - D)/p to (tau - c + D)/p. D has no sign, and waves of pressure add to it. Without images grains see walls from
//! three rows, where K is 1e-3 and D, which goes as K over |S|, largest: it fades with K there.

use crate::math::{apply, norm, sub, trace};
use crate::state::State;

use super::{Solver, YieldForm};

/// Most of the strength (the yield stress, of grains c + mu_s p) that D is [1].
const MOST: f64 = 0.5;

/// K/(D - 1) from which on D of grains is whole [1]: 0.5 in the first row and 0.19 in the second.
const NEAR: f64 = 0.1;

/// Less of it is none [1]: it would change the rate by its square.
const LEAST: f64 = 1e-3;

impl<const D: usize> Solver<D> {
    /// D of every particle; nothing in scenes where nothing that yields has (W4) or (W14).
    pub(super) fn find_wall_share(&mut self, state: &State<D>) {
        let yields = self.materials.iter().any(|m| m.is_fluid() && !m.flows());
        if !(yields || self.friction_goes_on) || self.numerics.yield_form == YieldForm::Capped {
            return;
        }
        let grains = &state.grains;
        let mut shares = std::mem::take(&mut self.wall_share);
        shares.clear();
        shares.resize(grains.len(), 0.0);
        self.workers
            .blocks_read(&self.lists.blocks, &mut shares, |block, first, out| {
                for w in &block.wall_rows {
                    let i = first + w.row as usize;
                    let material = &self.materials[grains.phase[i] as usize];
                    let reach = trace(&w.lean);
                    let side = w.sticking;
                    if reach == 0.0 || side == 0.0 {
                        continue;
                    }
                    let a = &grains.viscous_acceleration[i];
                    let uneven = self.even_slope.get(i).map_or(*a, |b| sub(a, b));
                    let handed = norm(&apply(&self.lean[i], &uneven));
                    let share = handed / (2.0 * side * self.specific_volume(state, i));
                    let strength = material.strength(self.yield_pressure(i));
                    let near = if material.is_fluid() {
                        1.0
                    } else {
                        (reach / ((D as f64 - 1.0) * NEAR)).min(1.0)
                    };
                    let share = near * share.min(MOST * strength);
                    if share > LEAST * strength {
                        out[w.row as usize] = share;
                    }
                }
            });
        self.wall_share = shares;
    }
}
