//! The grains of a material: size, density and packing ([A] eqs. 6, 8, 9).

/// Grains. Symbols: d0 diameter, rho_s0 density of their own material, phi volume fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grains {
    /// Diameter d0 [m]; 0 for a material without rate dependence and dilatancy.
    pub diameter: f64,
    /// Density rho_s0 > 0 without load [kg/m^3].
    pub density: f64,
    /// Largest volume fraction phi_max, at rest [1].
    pub phi_max: f64,
    /// Smallest volume fraction phi_min < phi_max of grains in contact [1].
    pub phi_min: f64,
    /// Density of the fluid that fills the pores [kg/m^3]; 0 for dry grains.
    pub pore_density: f64,
}

impl Grains {
    /// Bulk density at rest without load, phi_max rho_s0 + (1 - phi_max) rho_pore [kg/m^3].
    #[inline]
    #[must_use]
    pub fn rest_density(&self) -> f64 {
        self.bulk_density(self.phi_max)
    }

    /// Bulk density of the loosest grains that touch [kg/m^3].
    #[inline]
    #[must_use]
    pub fn loosest_density(&self) -> f64 {
        self.bulk_density(self.phi_min)
    }

    #[inline]
    fn bulk_density(&self, phi: f64) -> f64 {
        phi * self.density + (1.0 - phi) * self.pore_density
    }

    /// d0 sqrt(rho_s0/p): the inertial number is this time the shear rate ([A] eq. 6) [s]. p > 0 [Pa].
    #[inline]
    #[must_use]
    pub fn inertial_time(&self, p: f64) -> f64 {
        self.diameter * (self.density / p).sqrt()
    }

    /// B / gamma^2 of the closing relation for the grain compressibility K_t [s^2]; see `eos`. 0 for saturated grains:
    /// they would have to draw fluid in, and the mixture keeps its volume.
    #[inline]
    #[must_use]
    pub fn dilatancy_factor(&self, compressibility: f64) -> f64 {
        if self.pore_density > 0.0 {
            return 0.0;
        }
        let s = (self.phi_max - self.phi_min) * self.diameter / self.phi_max;
        self.density * compressibility * s * s
    }

    /// What compressed grains change in the inertial number ([A] eqs. 6 and 43), x = rho_s/rho_s0 >= 1:
    /// (d/d0) sqrt(x) = x^(1/2 - 1/D): nothing in the plane, x^(1/6) in space [1].
    #[inline]
    #[must_use]
    pub fn compressed_time_factor<const D: usize>(x: f64) -> f64 {
        if D == 2 { 1.0 } else { x.powf(1.0 / 6.0) }
    }
}
