//! How far a flow is from what its model holds for: shares of mass and the creep of what should rest. Computed when
//! somebody asks, once a communication step.

use crate::material::{Friction, Material, Rheology, ill_posedness};
use crate::math::{dot, sub};
use crate::state::State;

use super::Solver;
use super::lists::mean;

/// Material with I above this is outside the dense regime ([A] section 2).
const DENSE_LIMIT: f64 = 0.3;

/// Speed over sound speed above which its own dynamic pressure, rho v^2/2, compresses material by more than 2 %.
const FAST: f64 = 0.2;

/// Pressure over rho c^2 above which material is squeezed [1]: it has given way by as much, where its grains or its water would not.
const SQUEEZED: f64 = 0.05;

/// Rounding of viscosity times shear rate.
const ROUNDING: f64 = 1e-9;

/// Figures over loaded mass, p > 0; but for `share_fast` and `share_squeezed` of what has friction, p the effective one: without
/// pressure it carries no stress, whatever its I. 0 without load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Validity {
    /// Share with I > 0.3 [1].
    pub share_dilute: f64,
    /// Share that yields where the friction law is ill-posed, C > 0, and bulk friction does not mend it [1] (docs/theory.md, M6).
    pub share_ill_posed: f64,
    /// Root mean square, by mass, of the shear rate of material whose shear stress is below its static strength [1/s]:
    /// 0 if all that should rest does.
    pub creep_rate: f64,
    /// Share of all material that moves faster than a fifth of its sound speed against walls, or against its own mean where
    /// there are none [1].
    pub share_fast: f64,
    /// Share of all material whose pressure is above a twentieth of rho c^2 [1].
    pub share_squeezed: f64,
}

/// Whether grains that yield at an inertial number have no well-posed equations: C > 0, unless bulk friction mends it (M6, M7).
fn is_ill_posed(material: &Material, inertial_number: f64) -> bool {
    let mu = material.law.friction(inertial_number);
    let mended = material.bulk_friction > 1.0 - 7.0 * mu / 6.0;
    !mended && ill_posedness(&material.law, inertial_number) > 0.0
}

impl<const D: usize> Solver<D> {
    /// The figures of a state that this solver has just stepped, started or resumed.
    #[must_use]
    pub fn validity(&self, state: &State<D>) -> Validity {
        let grains = &state.grains;
        let (mut loaded, mut dilute, mut ill_posed) = (0.0, 0.0, 0.0);
        let (mut below, mut creep) = (0.0, 0.0);
        let (mut pressed, mut fast, mut squeezed) = (0.0, 0.0, 0.0);
        let frame = if self.walls.is_empty() {
            mean(&grains.velocity, &grains.mass)
        } else {
            mean(&self.walls.velocity, &self.walls.weight)
        };
        for i in (0..grains.len()).filter(|&i| !grains.drained[i]) {
            let p = self.yield_pressure(i);
            let m = grains.mass[i];
            let material = &self.materials[grains.phase[i] as usize];
            if self.pressure[i] > 0.0 {
                pressed += m;
                let v = sub(&grains.velocity[i], &frame);
                let c2 = self.sound_speed_of(material).powi(2);
                if dot(&v, &v) > FAST * FAST * c2 {
                    fast += m;
                }
                if self.pressure[i] > SQUEEZED * material.rest_density() * c2 {
                    squeezed += m;
                }
            }
            if p <= 0.0 || material.is_fluid() {
                continue;
            }
            loaded += m;
            if self.inertial_number[i] > DENSE_LIMIT {
                dilute += m;
            }
            let shear = self.kinematics[i].shear;
            let (yields, strong) = self.yields(state, (i, p), material);
            if yields && is_ill_posed(material, self.inertial_number[i]) {
                ill_posed += m;
            }
            if strong {
                below += m;
                creep += m * shear * shear;
            }
        }
        let over = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        Validity {
            share_dilute: over(dilute, loaded),
            share_ill_posed: over(ill_posed, loaded),
            creep_rate: over(creep, below).sqrt(),
            share_fast: over(fast, pressed),
            share_squeezed: over(squeezed, pressed),
        }
    }

    /// Whether grains under a pressure p yield, and whether they should not, their stress being below the static strength.
    fn yields(&self, state: &State<D>, (i, p): (usize, f64), material: &Material) -> (bool, bool) {
        if state.grains.exact_yield {
            let flows = self.geometry.size(&state.grains.plastic_rate[i]) > 0.0;
            return (flows, !flows);
        }
        let k = &self.kinematics[i];
        let stress = (1.0 + ROUNDING) * self.viscosity[i] * k.shear;
        let summed = material.as_summed(k.correction);
        let law = summed.as_ref().unwrap_or(material);
        (stress >= law.yield_stress(p), stress < law.strength(p))
    }
}
