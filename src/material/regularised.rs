//! [A]'s regularised viscosity (its section 4.2, eqs. 47 to 55, corrected in docs/theory.md).

use super::{Friction, Material, Rheology};

impl Material {
    /// eta0 + tau_y (1 - exp(-m_p gamma))/gamma, eta0 = (tau - tau_y)/gamma, with
    /// exp(-m_p gamma) = exp(-m0 gamma) (1 + eta0(tau_0)/tau_0 gamma)/(1 + eta0(tau_y)/tau_y gamma) [Pa s]:
    /// the differential equation (52) solved in closed form. gamma >= 0 [1/s], p [Pa], m0 > 0 [s], tau_0 > 0 [Pa].
    #[must_use]
    pub fn regularised_viscosity(&self, gamma: f64, p: f64, m0: f64, tau_0: f64) -> f64 {
        let tau_y = self.yield_stress(p);
        if p <= 0.0 || tau_y <= 0.0 {
            return 0.0;
        }
        let eta0 = self.viscosity_above_yield(gamma, p);
        let p_0 = ((tau_0 - self.cohesion) / self.law.static_friction()).max(f64::MIN_POSITIVE);
        let reference = self.viscosity_above_yield(gamma, p_0) / tau_0;
        // ln of the factor that makes the relative error independent of pressure; m_p >= 0.
        let shift = (reference * gamma).ln_1p() - (eta0 / tau_y * gamma).ln_1p();
        let exponent = (-m0 * gamma + shift).min(0.0);
        let scaled = if gamma > 1e-9 {
            -exponent.exp_m1() / gamma
        } else {
            (m0 + eta0 / tau_y - reference).max(0.0)
        };
        eta0 + tau_y * scaled
    }

    /// (tau - tau_y)/gamma; its limit, the slope of tau, at gamma = 0 [Pa s].
    fn viscosity_above_yield(&self, gamma: f64, p: f64) -> f64 {
        if gamma > 1e-9 {
            (self.shear_stress(gamma, p, 1.0) - self.yield_stress(p)) / gamma
        } else {
            self.shear_stress_slope(0.0, p, 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Grains;

    #[test]
    fn regularised_viscosity_has_the_papers_largest_value() {
        // [A] Table 3 row 3: tau_0 = 795 Pa, m_0 = 1.2 s, eta_max = 961 Pa s (eq. 53).
        let sand = Material::sand_04();
        let m = Material {
            grains: Grains {
                diameter: 0.32e-3,
                ..sand.grains
            },
            ..sand
        };
        let p = 795.0 / m.law.friction(0.0);
        let eta = m.regularised_viscosity(0.0, p, 1.2, 795.0);
        assert!((eta - 961.0).abs() < 10.0, "{eta}");
        // Far above the regularisation it is mu(I) p / gamma.
        let g = 60.0;
        let ratio = m.regularised_viscosity(g, p, 1.2, 795.0) * g / m.shear_stress(g, p, 1.0);
        assert!((ratio - 1.0).abs() < 1e-3);
    }
}
