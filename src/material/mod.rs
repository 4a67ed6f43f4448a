//! Rank 1: materials. One readable file per friction law, one enum that lists them, and what all materials share:
//! grains ([`Grains`]), cohesion, the pressure law.
//!
//! Add a law: a file with its parameters, equations, `impl Friction` and tests, and one line in [`Law`].

mod eos;
mod grains;
mod mu_i;
mod regularised;

pub use eos::grain_compression;
pub use grains::Grains;
pub use mu_i::MuI;

/// A friction law mu(I): shear stress over pressure against the inertial number I >= 0. Dimensionless.
pub trait Friction {
    /// mu(I) [1].
    fn friction(&self, inertial_number: f64) -> f64;
    /// d mu/dI [1].
    fn slope(&self, inertial_number: f64) -> f64;
    /// The I >= 0 with mu(I) + a I = y for a > 0; 0 where y <= mu(0) [1].
    fn resolvent(&self, a: f64, y: f64) -> f64;
}

/// What a viscous or plastic material answers, per particle. Symbols: gamma = sqrt(2 e:e) shear rate [1/s], p >= 0
/// pressure [Pa], R > 0 the factor on gamma inside the inertial number [1] (the discrete gradient's correction): I = R gamma d sqrt(rho_s/p).
pub trait Rheology {
    /// Shear stress tau(gamma, p) [Pa], yield stress included.
    fn shear_stress(&self, gamma: f64, p: f64, correction: f64) -> f64;
    /// d tau / d gamma at fixed p [Pa s].
    fn shear_stress_slope(&self, gamma: f64, p: f64, correction: f64) -> f64;
    /// Stress below which nothing shears [Pa].
    fn yield_stress(&self, p: f64) -> f64;
    /// Resolvent of the yield step: the shear rate q >= 0 with tau(q, p) + r q = x, r > 0 [Pa s] (0 if x is under the
    /// yield stress) [1/s].
    fn resolvent(&self, x: f64, r: f64, p: f64, correction: f64) -> f64;
}

/// The friction laws a scene can choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Dense granular flow, mu(I) ([A]).
    MuI(MuI),
}

impl Friction for Law {
    #[inline]
    fn friction(&self, inertial_number: f64) -> f64 {
        match self {
            Law::MuI(law) => law.friction(inertial_number),
        }
    }

    #[inline]
    fn slope(&self, inertial_number: f64) -> f64 {
        match self {
            Law::MuI(law) => law.slope(inertial_number),
        }
    }

    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        match self {
            Law::MuI(law) => law.resolvent(a, y),
        }
    }
}

/// A material: grains, a friction law, and what is added to it. tau = cohesion + mu(I) p.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Size, density and packing of the grains.
    pub grains: Grains,
    /// Friction law.
    pub law: Law,
    /// Shear strength without pressure >= 0 [Pa].
    pub cohesion: f64,
}

impl Material {
    /// Glass beads of [A] Table 1 (d = 0.5 mm, rho_s0 = 2500).
    #[must_use]
    pub fn glass_beads() -> Self {
        Self::of_table(MuI::glass_beads(), 0.5e-3, 2500.0)
    }

    /// Sand of 0.8 mm of [A] Table 1 (rho_s0 = 2600).
    #[must_use]
    pub fn sand_08() -> Self {
        Self::of_table(MuI::sand_08(), 0.8e-3, 2600.0)
    }

    /// Sand of 0.4 mm of [A] Table 1 (rho_s0 = 2600).
    #[must_use]
    pub fn sand_04() -> Self {
        Self::of_table(MuI::sand_04(), 0.4e-3, 2600.0)
    }

    fn of_table(law: MuI, diameter: f64, density: f64) -> Self {
        Self {
            grains: Grains {
                diameter,
                density,
                phi_max: 0.6,
                phi_min: 0.5,
            },
            law: Law::MuI(law),
            cohesion: 0.0,
        }
    }

    /// Density of the material at rest without load [kg/m^3].
    #[must_use]
    pub fn rest_density(&self) -> f64 {
        self.grains.rest_density()
    }

    /// Density at rest under a load p >= 0 [Pa], for the artificial sound speed c0 [m/s]: [kg/m^3].
    #[must_use]
    pub fn density_under(&self, load: f64, sound_speed: f64) -> f64 {
        self.rest_density() + load / (sound_speed * sound_speed)
    }

    /// The stress that scales the cap of the viscosity [Pa]: the yield stress.
    #[inline]
    #[must_use]
    pub fn strength(&self, p: f64) -> f64 {
        self.yield_stress(p)
    }
}

impl Rheology for Material {
    #[inline]
    fn shear_stress(&self, gamma: f64, p: f64, correction: f64) -> f64 {
        if p <= 0.0 {
            return self.cohesion;
        }
        let time = correction * self.grains.inertial_time(p);
        self.cohesion + p * self.law.friction(time * gamma)
    }

    #[inline]
    fn shear_stress_slope(&self, gamma: f64, p: f64, correction: f64) -> f64 {
        if p <= 0.0 {
            return 0.0;
        }
        let time = correction * self.grains.inertial_time(p);
        p * time * self.law.slope(time * gamma)
    }

    #[inline]
    fn yield_stress(&self, p: f64) -> f64 {
        self.cohesion + self.law.friction(0.0) * p.max(0.0)
    }

    /// With t = R d sqrt(rho_s/p) and I = t q: mu(I) + (r/(t p)) I = (x - cohesion)/p.
    #[inline]
    fn resolvent(&self, x: f64, r: f64, p: f64, correction: f64) -> f64 {
        let excess = x - self.yield_stress(p);
        if excess <= 0.0 {
            return 0.0;
        }
        let time = correction * self.grains.inertial_time(p);
        if p <= 0.0 || time <= 0.0 {
            // No pressure or no rate dependence: tau is the yield stress.
            return excess / r;
        }
        self.law.resolvent(r / (time * p), (x - self.cohesion) / p) / time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolvent_solves_its_equation() {
        let dry = Material::sand_04();
        let sticky = Material {
            cohesion: 40.0,
            ..dry.clone()
        };
        for m in [dry, sticky] {
            for p in [0.0, 1e-3, 1.0, 100.0, 5000.0] {
                for r in [0.1, 10.0, 1e4] {
                    for x in [0.5, 0.7, 1.0, 3.0] {
                        for correction in [0.8, 1.0, 3.0] {
                            let x = x * p + 0.9 * m.cohesion;
                            let q = m.resolvent(x, r, p, correction);
                            if x <= m.yield_stress(p) {
                                assert_eq!(q, 0.0);
                            } else {
                                let back = m.shear_stress(q, p, correction) + r * q;
                                assert!((back / x - 1.0).abs() < 1e-12, "{p} {r} {x}: {back}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_stress() {
        let m = Material::sand_08();
        for g in [0.01, 1.0, 50.0] {
            let at = |g| m.shear_stress(g, 300.0, 1.1);
            let d = (at(g * 1.000_01) - at(g * 0.999_99)) / (g * 2e-5);
            assert!((m.shear_stress_slope(g, 300.0, 1.1) / d - 1.0).abs() < 1e-6);
        }
    }
}
