//! The mu(I) rheology of dense granular flow ([A] eqs. 6 to 12, corrected in docs/theory.md).
//!
//! Symbols: gamma shear rate, p pressure, d grain size, rho_s grain density, I inertial number.
//!
//! I = gamma d sqrt(rho_s/p), mu(I) = mu_s + (mu_2 - mu_s) / (1 + I0/I), tau = mu(I) p.
//! At fixed p, with k = (I0/d) sqrt(p/rho_s): mu = mu_s + (mu_2 - mu_s) gamma/(gamma + k).

use super::Rheology;

/// Parameters of mu(I) sand.
#[derive(Clone, Debug, PartialEq)]
pub struct MuI {
    /// Friction coefficient at vanishing I, mu_s [1], 0 to 3.
    pub mu_s: f64,
    /// Friction coefficient at large I, mu_2 >= mu_s [1].
    pub mu_2: f64,
    /// Inertial number scale I0 > 0 [1].
    pub inertial_number_scale: f64,
    /// Grain diameter d0 > 0 [m].
    pub grain_diameter: f64,
    /// Grain density rho_s0 > 0 [kg/m^3].
    pub grain_density: f64,
    /// Largest volume fraction phi_max [1].
    pub phi_max: f64,
    /// Smallest volume fraction phi_min < phi_max [1].
    pub phi_min: f64,
}

impl MuI {
    /// Glass beads of [A] Table 1 (d = 0.5 mm, rho_s0 = 2500).
    #[must_use]
    pub fn glass_beads() -> Self {
        Self::table(20.90, 32.76, 0.279, 0.5e-3, 2500.0)
    }

    /// Sand of 0.8 mm of [A] Table 1 (rho_s0 = 2600).
    #[must_use]
    pub fn sand_08() -> Self {
        Self::table(27.00, 43.40, 1.09, 0.8e-3, 2600.0)
    }

    /// Sand of 0.4 mm of [A] Table 1 (rho_s0 = 2600).
    #[must_use]
    pub fn sand_04() -> Self {
        Self::table(30.50, 51.30, 2.65, 0.4e-3, 2600.0)
    }

    fn table(angle_s: f64, angle_2: f64, i0: f64, d: f64, rho: f64) -> Self {
        Self {
            mu_s: angle_s.to_radians().tan(),
            mu_2: angle_2.to_radians().tan(),
            inertial_number_scale: i0,
            grain_diameter: d,
            grain_density: rho,
            phi_max: 0.6,
            phi_min: 0.5,
        }
    }

    /// mu(I) [1] for I >= 0.
    #[inline]
    #[must_use]
    pub fn friction(&self, inertial_number: f64) -> f64 {
        self.mu_s
            + (self.mu_2 - self.mu_s) * inertial_number
                / (inertial_number + self.inertial_number_scale)
    }

    /// k = (I0/d) sqrt(p/rho_s): the shear rate at which friction is half-way [1/s].
    fn half_way(&self, p: f64) -> f64 {
        self.inertial_number_scale / self.grain_diameter * (p.max(0.0) / self.grain_density).sqrt()
    }

    /// B / gamma^2 of the closing relation for the grain compressibility K_t [s^2]; see `eos`.
    #[must_use]
    pub fn dilatancy_factor(&self, compressibility: f64) -> f64 {
        let s = (self.phi_max - self.phi_min) * self.grain_diameter / self.phi_max;
        self.grain_density * compressibility * s * s
    }

    /// Largest viscosity times gamma-free part of the regularised law: the viscosity eta0 ([A] eq. 47, corrected) [Pa s].
    fn eta0(&self, gamma: f64, tau_y: f64) -> f64 {
        let k = self.inertial_number_scale / self.grain_diameter
            * (tau_y / (self.mu_s * self.grain_density)).sqrt();
        (self.mu_2 / self.mu_s - 1.0) * tau_y / (gamma + k)
    }

    /// [A]'s regularised viscosity, sections 4.2 and eqs. 47 to 55 as corrected: eta0 + tau_y (1 - exp(-m_p gamma))/gamma,
    /// with exp(-m_p gamma) = exp(-m0 gamma) (1 + eta0(tau_0)/tau_0 gamma)/(1 + eta0(tau_y)/tau_y gamma) [Pa s].
    #[must_use]
    pub fn regularised_viscosity(&self, gamma: f64, p: f64, m0: f64, tau_0: f64) -> f64 {
        let tau_y = self.mu_s * p;
        if tau_y <= 0.0 {
            return 0.0;
        }
        let eta0 = self.eta0(gamma, tau_y);
        let reference = self.eta0(gamma, tau_0) / tau_0;
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
}

impl Rheology for MuI {
    fn shear_stress(&self, gamma: f64, p: f64) -> f64 {
        let k = self.half_way(p);
        let share = if gamma > 0.0 {
            gamma / (gamma + k)
        } else {
            0.0
        };
        (self.mu_s + (self.mu_2 - self.mu_s) * share) * p.max(0.0)
    }

    fn shear_stress_slope(&self, gamma: f64, p: f64) -> f64 {
        let k = self.half_way(p);
        if k <= 0.0 {
            return 0.0;
        }
        (self.mu_2 - self.mu_s) * p * k / ((gamma + k) * (gamma + k))
    }

    fn yield_stress(&self, p: f64) -> f64 {
        self.mu_s * p.max(0.0)
    }

    fn resolvent(&self, x: f64, r: f64, p: f64) -> f64 {
        let excess = x - self.yield_stress(p);
        if excess <= 0.0 {
            return 0.0;
        }
        // r q^2 + (r k + Delta - excess) q - excess k = 0, positive root without cancellation.
        let k = self.half_way(p);
        let b = r * k + (self.mu_2 - self.mu_s) * p.max(0.0) - excess;
        let root = (b * b + 4.0 * r * excess * k).sqrt();
        if b > 0.0 {
            2.0 * excess * k / (b + root)
        } else {
            (root - b) / (2.0 * r)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_grows_from_mu_s_to_mu_2() {
        let m = MuI::glass_beads();
        assert!((m.friction(0.0) - m.mu_s).abs() < 1e-15);
        assert!((m.friction(1e9) - m.mu_2).abs() < 1e-8);
        assert!((m.friction(m.inertial_number_scale) - 0.5 * (m.mu_s + m.mu_2)).abs() < 1e-15);
    }

    #[test]
    fn resolvent_solves_its_equation() {
        let m = MuI::sand_04();
        for p in [1.0, 100.0, 5000.0] {
            for r in [0.1, 10.0, 1e4] {
                for x in [0.5, 0.7, 1.0, 3.0] {
                    let q = m.resolvent(x * p, r, p);
                    if x * p <= m.yield_stress(p) {
                        assert_eq!(q, 0.0);
                    } else {
                        let back = m.shear_stress(q, p) + r * q;
                        assert!((back / (x * p) - 1.0).abs() < 1e-12, "{p} {r} {x}: {back}");
                    }
                }
            }
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_stress() {
        let m = MuI::sand_08();
        for g in [0.01, 1.0, 50.0] {
            let d = (m.shear_stress(g * 1.000_01, 300.0) - m.shear_stress(g * 0.999_99, 300.0))
                / (g * 2e-5);
            assert!((m.shear_stress_slope(g, 300.0) / d - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn regularised_viscosity_has_the_papers_largest_value() {
        // [A] Table 3 row 3: tau_0 = 795 Pa, m_0 = 1.2 s, eta_max = 961 Pa s (eq. 53).
        let m = MuI {
            grain_diameter: 0.32e-3,
            ..MuI::sand_04()
        };
        let p = 795.0 / m.mu_s;
        let eta = m.regularised_viscosity(0.0, p, 1.2, 795.0);
        assert!((eta - 961.0).abs() < 10.0, "{eta}");
        // Far above the regularisation it is mu(I) p / gamma.
        let g = 60.0;
        assert!(
            (m.regularised_viscosity(g, p, 1.2, 795.0) * g / m.shear_stress(g, p) - 1.0).abs()
                < 1e-3
        );
    }
}
