//! Materials: one readable file per rheology, one enum that lists them.
mod mu_i;

pub use mu_i::MuI;

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
}
