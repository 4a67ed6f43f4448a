//! [A]'s regularised viscosity (its section 4.2, eqs. 47 to 55, corrected in docs/theory.md).

use super::{Friction, Material, Rheology};

impl Material {
    /// eta0 + tau_y (1 - exp(-m_p gamma))/gamma, eta0 = (tau - tau_y)/gamma, with
    /// exp(-m_p gamma) = exp(-m0 gamma) (1 + eta0(tau_y)/tau_y gamma)/(1 + eta0(tau_0)/tau_0 gamma) [Pa s]:
    /// the differential equation (52) solved in closed form. gamma >= 0 [1/s], p [Pa], m0 > 0 [s], tau_0 > 0 [Pa].
    #[must_use]
    pub fn regularised_viscosity(&self, gamma: f64, p: f64, m0: f64, tau_0: f64) -> f64 {
        let tau_y = self.yield_stress(p);
        if p > 0.0 && tau_y <= 0.0 {
            // A law without yield stress: nothing to regularise but its own steep start, by the plain cap.
            let cap = m0 * self.strength(p);
            return if gamma > 0.0 {
                cap.min(self.shear_stress(gamma, p, 1.0) / gamma)
            } else {
                cap
            };
        }
        if p <= 0.0 {
            // Cohesion alone: no pressure that m_p could follow.
            return self.cohesion * delivered(-m0 * gamma, gamma, m0);
        }
        let eta0 = self.viscosity_above_yield(gamma, p);
        let p_0 = ((tau_0 - self.cohesion) / self.law.static_friction()).max(f64::MIN_POSITIVE);
        let reference = self.viscosity_above_yield(gamma, p_0) / tau_0;
        // ln of the factor that makes the relative error independent of pressure; m_p >= 0.
        let own = eta0 / tau_y;
        let shift = (own * gamma).ln_1p() - (reference * gamma).ln_1p();
        let exponent = (-m0 * gamma + shift).min(0.0);
        let start = (m0 + reference - own).max(0.0);
        eta0 + tau_y * delivered(exponent, gamma, start)
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

/// (1 - exp(exponent))/gamma [s]; `start` is its limit at gamma = 0.
fn delivered(exponent: f64, gamma: f64, start: f64) -> f64 {
    if gamma > 1e-9 {
        -exponent.exp_m1() / gamma
    } else {
        start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{BarkerGray, Grains, Law, MuI};

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

    /// [A] (51): what exp(-m_p gamma) leaves of the shear stress is the same share at every pressure.
    #[test]
    fn the_share_that_is_missing_is_the_same_at_every_pressure() {
        let m = Material::sand_04();
        let mu_s = m.law.static_friction();
        for gamma in [1e-3, 1.0, 5.0] {
            let missing = |tau_y: f64| {
                let p = tau_y / mu_s;
                let stress = m.regularised_viscosity(gamma, p, 1.2, 795.0) * gamma;
                1.0 - stress / m.shear_stress(gamma, p, 1.0)
            };
            let at_reference = missing(795.0);
            assert!(at_reference > 1e-4, "{at_reference}");
            for tau_y in [10.0, 100.0, 3000.0] {
                let ratio = missing(tau_y) / at_reference;
                assert!((ratio - 1.0).abs() < 1e-6, "{gamma} {tau_y}: {ratio}");
            }
        }
        // At rest (A.55): m_p = m0 + eta0(tau_0)/tau_0 - eta0(tau_y)/tau_y.
        let eta0 = |tau: f64| m.shear_stress_slope(0.0, tau / mu_s, 1.0);
        let tau_y = 100.0;
        let m_p = 1.2 + eta0(795.0) / 795.0 - eta0(tau_y) / tau_y;
        let found = m.regularised_viscosity(0.0, tau_y / mu_s, 1.2, 795.0);
        assert!(
            (found / (eta0(tau_y) + tau_y * m_p) - 1.0).abs() < 1e-9,
            "{found}"
        );
    }

    #[test]
    fn other_materials_get_their_stress_in_flow_and_no_more_than_the_cap_at_rest() {
        let sticky = Material {
            cohesion: 100.0,
            ..Material::sand_04()
        };
        let gray = Material {
            law: Law::BarkerGray(BarkerGray::new(MuI::glass_beads()).unwrap()),
            ..Material::glass_beads()
        };
        for (m, p) in [(&sticky, 500.0), (&sticky, 0.0), (&gray, 500.0)] {
            let eta = |gamma: f64| m.regularised_viscosity(gamma, p, 1.2, 795.0);
            let flow = eta(60.0) * 60.0 / m.shear_stress(60.0, p, 1.0);
            assert!((flow - 1.0).abs() < 1e-3, "{flow}");
            // At rest: m0 times the strength, and eta0 of the law's slope.
            let most = 1.2 * m.strength(p) + 400.0;
            assert!(eta(0.0) > 0.0 && eta(0.0) <= most, "{}", eta(0.0));
            assert!((eta(1e-8) / eta(0.0) - 1.0).abs() < 1e-3);
        }
    }
}
