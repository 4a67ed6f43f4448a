//! Dry grains at walls without slip: their friction goes on into the wall (docs/theory.md, W14).
//!
//! A wall point takes pressure and stress of the particle that sees it. Where both change alike towards the wall, as on a slope,
//! friction, their ratio, is right there, and (W4) and (W7) have nothing to add. Where the ratio changes, the first row has the
//! wall's friction half a spacing inside. With t = P tau n the traction along the wall, its slope is what momentum says, rho (a - a*),
//! and that at an even ratio t/p is the part that pressure makes,
//!
//!   b = (t/p) n.(g - a*),   rho (g - a*) = grad p but for what walls push,
//!
//! so that what is left of it is carried on, and grains at an even ratio feel nothing:
//!
//!   m (I - K)(a - a*) = F - m K b,   K that of (W4).                                                       (W14)
//!
//! The wall gets m K (a* + b - a) beside -F. t is that of the last step, at most [`SPARE`] times what the law bears at its rate, and of it
//! the part that is friction, t mu p/tau: cohesion does not go with pressure, and over a pressure that trembles about 0 it would be any
//! force. In corners, of whose faces K is the sum, n n^T is what is left of 1, and b with it a part of that of each face.
//!
//! Where fluids meet grains or fill their pores dp/dn is not that of the pressure between grains: there it is left as it was.

use crate::material::{Friction, Rheology};
use crate::math::{Vector, apply, scale, trace};
use crate::state::State;

use super::Solver;
use super::plastic::SPARE;

impl<const D: usize> Solver<D> {
    /// b of every particle for a step whose sums of pressure and gravity are done; nothing in scenes where friction is not carried on.
    pub(super) fn find_even_slope(&mut self, state: &State<D>, dt: f64) {
        if !self.friction_goes_on {
            return;
        }
        let mut even = std::mem::take(&mut self.even_slope);
        even.clear();
        even.resize(state.grains.len(), [0.0; D]);
        self.workers
            .blocks_read(&self.lists.blocks, &mut even, |block, first, out| {
                for w in &block.wall_rows {
                    out[w.row as usize] = self.even_slope_of(state, first + w.row as usize, dt);
                }
            });
        self.even_slope = even;
    }

    fn even_slope_of(&self, state: &State<D>, i: usize, dt: f64) -> Vector<D> {
        let grains = &state.grains;
        let (k, p) = (&self.lean[i], self.yield_pressure(i));
        // Of one face K is this times I - n n^T.
        let size = trace(k) / (D as f64 - 1.0);
        if size <= 0.0 || p <= 0.0 {
            return [0.0; D];
        }
        let (before, now) = (&grains.velocity[i], &self.prediction[i].velocity);
        let slope: Vector<D> = std::array::from_fn(|a| self.gravity[a] - (now[a] - before[a]) / dt);
        let along = apply(k, &slope);
        let across: Vector<D> = std::array::from_fn(|a| slope[a] - along[a] / size);
        let tau = &grains.stress[i];
        let material = &self.materials[grains.phase[i] as usize];
        let correction = self.kinematics[i].correction;
        let summed = material.as_summed(correction);
        let law = summed.as_ref().unwrap_or(material);
        let rate = self.geometry.size(&grains.plastic_rate[i]);
        let bears = law.shear_stress(rate, p, correction);
        if bears <= 0.0 {
            return [0.0; D];
        }
        let number = correction * law.grains.inertial_time(p) * rate;
        let borne = (SPARE * bears / self.geometry.size(tau)).min(1.0);
        scale(
            borne * law.law.friction(number) / bears,
            &apply(tau, &across),
        )
    }
}
