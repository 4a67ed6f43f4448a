//! Rank 1: materials. One readable file per friction law, one enum that lists them, and what all materials share:
//! grains ([`Grains`]), cohesion, viscosity ([`Viscous`]), bulk friction, what happens beyond the dense regime, the
//! pressure law. A fluid is a material without friction, its cohesion the yield stress.
//!
//! Add a law: a file with its parameters, equations, `impl Friction` and tests, and one line in [`Law`].

mod bagnold;
mod barker_gray;
mod bulk_friction;
mod constant_friction;
mod eos;
mod grains;
mod law;
#[cfg(test)]
mod laws_tests;
mod mu_i;
mod regularised;
mod rheology;
mod viscous;
mod well_posed;

pub use bagnold::Bagnold;
pub use barker_gray::BarkerGray;
pub use bulk_friction::bulk_pressure;
pub use constant_friction::{AngleMatch, ConstantFriction};
pub use eos::{grain_compression, grain_compressions};
pub use grains::Grains;
pub use law::{Friction, Law};
pub use mu_i::{MuI, SAND_LAYER_FACTOR};
pub use rheology::Rheology;
pub use viscous::Viscous;
pub use well_posed::{ill_posedness, neutral_inertial_numbers};

use std::f64::consts::PI;

/// Default of [`Material::parted_density`]. A flat face that parts from another loses half its support in the sum that
/// density follows; what lies lower is corners and single grains. They carry no stress, but volumes m/rho would grow
/// without bound when the last neighbours leave, and with them every weight.
pub const PARTED_DENSITY: f64 = 0.5;

/// phi_min and phi_max of a material whose grains nobody states: only says at which density it parts, 5/6 of that at rest.
pub const FLUID_PACKING: (f64, f64) = (0.5, 0.6);

/// A material: grains, a friction law, and what is added to it. tau = cohesion + mu(I) p + K gamma^n, where p is the
/// effective pressure if the material is saturated.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Size, density and packing of the grains.
    pub grains: Grains,
    /// Friction law.
    pub law: Law,
    /// Shear strength without pressure >= 0 [Pa]; of grains it is no tensile strength: see [`Material::least_pressure`].
    pub cohesion: f64,
    /// Viscous stress beside them. With a flow index that is not 1 the law is one without rate dependence of its own.
    pub viscous: Viscous,
    /// Artificial viscosity alpha that a Newtonian fluid's viscosity is made up to where it is compressed or hardly moves, between its own
    /// particles [1].
    pub artificial_viscosity: f64,
    /// Artificial sound speed of its equation of state [m/s]; `None` is that of the scene. [B] eq. 3: c_k.
    pub sound_speed: Option<f64>,
    /// Bulk friction coefficient mu_b >= 0 [1]; 0 is none.
    pub bulk_friction: f64,
    /// Lowest density over rest density that is kept track of [1], above 0 and below phi_min/phi_max: see [`Material::is_dense`].
    pub parted_density: f64,
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
                pore_density: 0.0,
            },
            law: Law::MuI(law),
            cohesion: 0.0,
            viscous: Viscous::NONE,
            artificial_viscosity: 0.0,
            sound_speed: None,
            bulk_friction: 0.0,
            parted_density: PARTED_DENSITY,
        }
    }

    /// A fluid of density > 0 [kg/m^3] at rest, viscous stress and yield stress >= 0 [Pa]: tau = tau_0 + K gamma^n
    /// (Herschel and Bulkley; [B] eq. 11). Newton's fluid without yield stress, Bingham's with n = 1.
    #[must_use]
    pub fn fluid(density: f64, viscous: Viscous, yield_stress: f64) -> Self {
        Self {
            grains: Grains {
                diameter: 0.0,
                density: density / FLUID_PACKING.1,
                phi_max: FLUID_PACKING.1,
                phi_min: FLUID_PACKING.0,
                pore_density: 0.0,
            },
            law: Law::Fluid,
            cohesion: yield_stress,
            viscous,
            artificial_viscosity: 0.0,
            sound_speed: None,
            bulk_friction: 0.0,
            parted_density: PARTED_DENSITY,
        }
    }

    /// Whether it is a fluid by its law, which is not what grains are that happen to have no friction.
    #[inline]
    #[must_use]
    pub fn is_fluid(&self) -> bool {
        matches!(self.law, Law::Fluid)
    }

    /// Whether shear stress is proportional to the shear rate: Newton's fluid.
    #[inline]
    #[must_use]
    pub fn is_newtonian(&self) -> bool {
        self.flows() && self.viscous.is_linear()
    }

    /// Largest viscosity that a Newton's fluid has in scheme implicit [Pa s]: its own, or what its artificial viscosity is worth
    /// where that is more, alpha rho h c0/(2 (D + 2)), at a smoothing length h [m] and the scene's sound speed [m/s].
    #[must_use]
    pub fn computed_viscosity(&self, dimensions: f64, h: f64, sound_speed: f64) -> f64 {
        let c0 = self.sound_speed.unwrap_or(sound_speed);
        let least =
            self.artificial_viscosity * self.rest_density() * h * c0 / (2.0 * (dimensions + 2.0));
        if self.is_newtonian() {
            self.viscous.consistency.max(least)
        } else {
            self.viscous.consistency
        }
    }

    /// Whether its pores are full of a fluid that carries part of the pressure.
    #[inline]
    #[must_use]
    pub fn is_saturated(&self) -> bool {
        self.grains.pore_density > 0.0
    }

    /// Whether a fluid's pressure goes on all through it: fluids, and grains whose pores are full.
    #[inline]
    #[must_use]
    pub fn holds_fluid(&self) -> bool {
        self.is_fluid() || self.is_saturated()
    }

    /// Whether it cannot rest under uneven pressure: a fluid without yield stress.
    #[inline]
    #[must_use]
    pub fn flows(&self) -> bool {
        self.is_fluid() && self.cohesion == 0.0
    }

    /// Whether its particles' volumes are m/rho_0, so that density stands for pressure alone: fluids and saturated beds.
    #[inline]
    #[must_use]
    pub fn keeps_volume(&self) -> bool {
        self.holds_fluid()
    }

    /// Whether grains have shear stress that does not follow the pressure between them: cohesion, a viscous stress.
    #[inline]
    #[must_use]
    pub fn holds_by_itself(&self) -> bool {
        !self.is_fluid() && (self.cohesion > 0.0 || self.viscous.consistency > 0.0)
    }

    /// Density that a particle's volume in the sums is of, where its own is rho [kg/m^3]: what pressure adds is not in it for what
    /// keeps its volume, nor for grains whose stress would notice (docs/theory.md, "Phases").
    #[inline]
    #[must_use]
    pub fn density_of_volume(&self, rho: f64) -> f64 {
        let rest = self.rest_density();
        if self.keeps_volume() || self.holds_by_itself() && rho > rest {
            rest
        } else {
            rho
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

    /// Whether grains at this density [kg/m^3] touch: rho at least that of phi_min. Looser material is parted: p = 0 and tau = 0
    /// (its cohesion too) until it is this dense again.
    #[inline]
    #[must_use]
    pub fn is_dense(&self, density: f64) -> bool {
        density >= self.grains.loosest_density()
    }

    /// Lowest pressure that it bears at a shear rate gamma [Pa]; what is pulled more parts. Grains bear none, nor does what flows.
    /// A fluid with a yield stress hangs together: stretched along a free surface it has -tau, and between two deep notches, the
    /// most that its own stress can make, -(1 + pi) tau (Hill 1949, doi 10.1093/qjmam/2.1.40).
    #[inline]
    #[must_use]
    pub fn least_pressure(&self, gamma: f64) -> f64 {
        if self.is_fluid() && self.cohesion > 0.0 {
            -(1.0 + PI) * (self.cohesion + self.viscous.stress(gamma))
        } else {
            0.0
        }
    }
}
