//! Rank 1: materials. One readable file per rheology, one enum that lists them, pressure laws they share.
//!
//! Add a rheology: a file with its parameters, equations, `impl Rheology` and tests, and one line in [`Material`].

mod eos;
mod mu_i;

pub use eos::grain_compression;
pub use mu_i::MuI;

/// What a viscous or plastic law answers, per particle. Symbols: gamma = sqrt(2 e:e) shear rate [1/s], p pressure [Pa].
pub trait Rheology {
    /// Shear stress tau(gamma, p) [Pa], yield stress included.
    fn shear_stress(&self, gamma: f64, p: f64) -> f64;
    /// d tau / d gamma at fixed p [Pa s].
    fn shear_stress_slope(&self, gamma: f64, p: f64) -> f64;
    /// Stress below which nothing shears [Pa].
    fn yield_stress(&self, p: f64) -> f64;
    /// Resolvent of the yield step: the shear rate q >= 0 with tau(q, p) + r q = x (0 if x is under the yield stress) [1/s].
    fn resolvent(&self, x: f64, r: f64, p: f64) -> f64;
}

/// The materials a scene can choose from.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Dense granular flow, mu(I) with dilatancy and grain compressibility ([A]).
    MuI(MuI),
}

impl Material {
    /// Density of the material at rest without load [kg/m^3].
    #[must_use]
    pub fn rest_density(&self) -> f64 {
        match self {
            Material::MuI(m) => m.grain_density * m.phi_max,
        }
    }

    /// Density at rest under a load p >= 0 [Pa], for the artificial sound speed c0 [m/s]: [kg/m^3].
    #[must_use]
    pub fn density_under(&self, load: f64, sound_speed: f64) -> f64 {
        self.rest_density() + load / (sound_speed * sound_speed)
    }
}
