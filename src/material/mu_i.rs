//! The mu(I) rheology of dense granular flow ([A] eqs. 6 to 12, corrected).

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
}
