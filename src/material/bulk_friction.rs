//! Friction against changes of volume (Heyman et al., J. Fluid Mech. 830 (2017) 553, doi 10.1017/jfm.2017.612).
//!
//!   p_bulk = -mu_b p div v / gamma,   added to the pressure in the momentum equation.
//!
//! With mu_b > 1 - 7 mu/6 the compressible equations are well-posed at every I. gamma stands in the denominator, so
//! three limits keep the term harmless: gamma + w in place of gamma (it vanishes with div v at rest), at most
//! mu_b p in size (no tension while mu_b <= 1, and never below p = 0), and a viscosity zeta = mu_b p/(gamma + w)
//! that an explicit step bears, zeta <= 0.2 rho h c0: more would damp nothing but the shortest waves any further.

/// Largest zeta over rho h c0 [1].
const BEARABLE: f64 = 0.2;

/// p_bulk [Pa]: mu_b >= 0 [1], p >= 0 [Pa], div v [1/s], rho h c0 [Pa s]; `rate` is gamma + w [1/s], w far below shear rates of flow
/// and far above those of a pile at rest.
#[inline]
#[must_use]
pub fn bulk_pressure(mu_b: f64, p: f64, divergence: f64, rate: f64, rho_h_c0: f64) -> f64 {
    let zeta = (mu_b * p / rate).min(BEARABLE * rho_h_c0);
    (-zeta * divergence).clamp(-p, mu_b * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_published_law_in_flow() {
        let p = bulk_pressure(0.5, 1000.0, -0.2, 1e4, 1e9);
        assert!((p - 0.5 * 1000.0 * 0.2 / 1e4).abs() < 2e-4 * p, "{p}");
    }

    #[test]
    fn resists_both_ways_and_vanishes_at_rest() {
        assert!(bulk_pressure(1.0, 100.0, 0.1, 5.0, 1e3) < 0.0);
        assert!(bulk_pressure(1.0, 100.0, -0.1, 5.0, 1e3) > 0.0);
        assert_eq!(bulk_pressure(1.0, 100.0, 0.0, 1.0, 1e3), 0.0);
        assert!(bulk_pressure(1.0, 100.0, 1e-9, 1.0, 1e3).abs() < 1e-6);
        assert_eq!(bulk_pressure(1.0, 0.0, 5.0, 5.0, 1e3), 0.0);
    }

    #[test]
    fn is_bounded_by_the_pressure_and_the_step() {
        assert_eq!(bulk_pressure(2.0, 100.0, 1e9, 1.0, 1e9), -100.0);
        assert_eq!(bulk_pressure(0.7, 100.0, -1e9, 1.0, 1e9), 70.0);
        assert_eq!(bulk_pressure(1.0, 1e6, -1.0, 1.0, 10.0), 2.0);
    }
}
