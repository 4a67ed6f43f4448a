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
#[cfg(test)]
mod laws_tests;
mod mu_i;
mod regularised;
mod viscous;
mod well_posed;

pub use bagnold::Bagnold;
pub use barker_gray::BarkerGray;
pub use bulk_friction::bulk_pressure;
pub use constant_friction::{AngleMatch, ConstantFriction};
pub use eos::{grain_compression, grain_compressions};
pub use grains::Grains;
pub use mu_i::{MuI, SAND_LAYER_FACTOR};
pub use viscous::Viscous;
pub use well_posed::{ill_posedness, neutral_inertial_numbers};

use std::f64::consts::PI;

/// A friction law mu(I): shear stress over pressure against the inertial number I >= 0. Dimensionless.
pub trait Friction {
    /// mu(I) [1].
    fn friction(&self, inertial_number: f64) -> f64;
    /// d mu/dI [1].
    fn slope(&self, inertial_number: f64) -> f64;
    /// What people call the static friction coefficient [1]: mu(0), or of a law that vanishes at rest the one it is
    /// made from. Scales the cap of the viscosity.
    fn static_friction(&self) -> f64;
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
    /// Mohr-Coulomb's angle, no rate dependence.
    ConstantFriction(ConstantFriction),
    /// mu(I) without a yield stress, well-posed at low I.
    BarkerGray(BarkerGray),
}

/// Calls a method of whichever law it is: a branch per particle, no pointer.
macro_rules! of_law {
    ($self:ident, $law:ident => $call:expr) => {
        match $self {
            Law::MuI($law) => $call,
            Law::ConstantFriction($law) => $call,
            Law::BarkerGray($law) => $call,
        }
    };
}

impl Friction for Law {
    #[inline]
    fn friction(&self, inertial_number: f64) -> f64 {
        of_law!(self, law => law.friction(inertial_number))
    }

    #[inline]
    fn slope(&self, inertial_number: f64) -> f64 {
        of_law!(self, law => law.slope(inertial_number))
    }

    #[inline]
    fn static_friction(&self) -> f64 {
        of_law!(self, law => law.static_friction())
    }

    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        of_law!(self, law => law.resolvent(a, y))
    }
}

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
    /// Artificial viscosity alpha that a Newtonian fluid's viscosity is made up to, between its own particles [1].
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
            law: Law::ConstantFriction(ConstantFriction { mu: 0.0 }),
            cohesion: yield_stress,
            viscous,
            artificial_viscosity: 0.0,
            sound_speed: None,
            bulk_friction: 0.0,
            parted_density: PARTED_DENSITY,
        }
    }

    /// Whether stress does not depend on pressure.
    #[inline]
    #[must_use]
    pub fn is_fluid(&self) -> bool {
        matches!(self.law, Law::ConstantFriction(ConstantFriction { mu }) if mu == 0.0)
    }

    /// Whether shear stress is proportional to the shear rate: Newton's fluid.
    #[inline]
    #[must_use]
    pub fn is_newtonian(&self) -> bool {
        self.flows() && self.viscous.is_linear()
    }

    /// Whether its pores are full of a fluid that carries part of the pressure.
    #[inline]
    #[must_use]
    pub fn is_saturated(&self) -> bool {
        self.grains.pore_density > 0.0
    }

    /// Whether it cannot rest under uneven pressure: a fluid without yield stress.
    #[inline]
    #[must_use]
    pub fn flows(&self) -> bool {
        self.is_fluid() && self.cohesion == 0.0
    }

    /// How it ranks where materials meet: the stress there is to be looked for in what ranks lowest (docs/theory.md, F6). 0: without
    /// yield stress, 1: fluids with one, 2: grains.
    #[inline]
    #[must_use]
    pub fn rank(&self) -> u8 {
        match (self.is_fluid(), self.flows()) {
            (_, true) => 0,
            (true, _) => 1,
            _ => 2,
        }
    }

    /// Whether its particles' volumes are m/rho_0, so that density stands for pressure alone: fluids and saturated beds.
    #[inline]
    #[must_use]
    pub fn keeps_volume(&self) -> bool {
        self.is_fluid() || self.is_saturated()
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

    /// The stress that scales the cap of the viscosity [Pa]: cohesion + mu_s p. It is the yield stress for laws that
    /// have one.
    #[inline]
    #[must_use]
    pub fn strength(&self, p: f64) -> f64 {
        self.cohesion + self.law.static_friction() * p.max(0.0)
    }

    /// Viscosity tau/gamma [Pa s], that of what yields at most `cap_time` [s] times [`Material::strength`]; that of
    /// shear-thinning fluids at most the one at gamma = 1/cap_time. R and p as in [`Rheology`].
    #[inline]
    #[must_use]
    pub fn capped_viscosity(&self, gamma: f64, p: f64, correction: f64, cap_time: f64) -> f64 {
        let cap = cap_time * self.strength(p);
        let plastic = if gamma > STILL {
            (self.plastic_stress(gamma, p, correction) / gamma).min(cap)
        } else {
            cap
        };
        plastic + self.viscous.viscosity(gamma, 1.0 / cap_time)
    }

    /// Cohesion and friction [Pa].
    #[inline]
    fn plastic_stress(&self, gamma: f64, p: f64, correction: f64) -> f64 {
        if p <= 0.0 {
            return self.cohesion;
        }
        let time = correction * self.grains.inertial_time(p);
        self.cohesion + p * self.law.friction(time * gamma)
    }
}

/// Shear rates below this count as none [1/s]: far below any that matters, far above rounding.
const STILL: f64 = 1e-12;

impl Rheology for Material {
    #[inline]
    fn shear_stress(&self, gamma: f64, p: f64, correction: f64) -> f64 {
        self.plastic_stress(gamma, p, correction) + self.viscous.stress(gamma)
    }

    #[inline]
    fn shear_stress_slope(&self, gamma: f64, p: f64, correction: f64) -> f64 {
        let viscous = self.viscous.slope(gamma);
        if p <= 0.0 {
            return viscous;
        }
        let time = correction * self.grains.inertial_time(p);
        viscous + p * time * self.law.slope(time * gamma)
    }

    #[inline]
    fn yield_stress(&self, p: f64) -> f64 {
        self.cohesion + self.law.friction(0.0) * p.max(0.0)
    }

    /// With t = R d sqrt(rho_s/p) and I = t q: mu(I) + ((r + K)/(t p)) I = (x - cohesion)/p where the viscous part is linear.
    #[inline]
    fn resolvent(&self, x: f64, r: f64, p: f64, correction: f64) -> f64 {
        let excess = x - self.yield_stress(p);
        if excess <= 0.0 {
            return 0.0;
        }
        let time = correction * self.grains.inertial_time(p);
        if p <= 0.0 || time <= 0.0 {
            // No pressure or no rate dependence of friction: what yields is the yield stress.
            return self.viscous.resolvent(excess, r);
        }
        debug_assert!(self.viscous.is_linear(), "mu(I) and a power law at once");
        let r = r + self.viscous.consistency;
        self.law.resolvent(r / (time * p), (x - self.cohesion) / p) / time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every law, dry and sticky.
    fn materials() -> Vec<Material> {
        let sand = Material::sand_04();
        let high = MuI {
            mu_inf: 0.05,
            ..MuI::glass_beads()
        };
        let laws = [
            sand.law,
            Law::MuI(high),
            Law::MuI(MuI::sand_08().of_layer(0.2)),
            Law::ConstantFriction(ConstantFriction { mu: 0.34 }),
            Law::BarkerGray(BarkerGray::new(high).unwrap()),
        ];
        let of = |law| {
            [0.0, 40.0].map(|cohesion| Material {
                law,
                cohesion,
                viscous: Viscous::newtonian(0.1 * cohesion),
                ..sand.clone()
            })
        };
        let clay = Viscous {
            consistency: 4.472,
            flow_index: 0.472,
        };
        let silt = Material {
            law: Law::ConstantFriction(ConstantFriction { mu: 0.5 }),
            grains: Grains {
                diameter: 0.0,
                ..sand.grains
            },
            viscous: clay,
            ..sand.clone()
        };
        let fluids = [
            Material::fluid(1000.0, Viscous::newtonian(1e-3), 0.0),
            Material::fluid(1540.0, clay, 30.0),
            silt,
        ];
        laws.into_iter().flat_map(of).chain(fluids).collect()
    }

    #[test]
    fn resolvent_solves_its_equation() {
        for m in materials() {
            for p in [0.0, 1e-3, 1.0, 100.0, 5000.0] {
                for r in [0.1, 10.0, 1e4] {
                    for correction in [0.8, 1.0, 3.0] {
                        let mut last = 0.0;
                        for x in [0.2, 0.5, 0.7, 1.0, 3.0] {
                            let x = x * p + (0.9 + x) * m.cohesion;
                            let q = m.resolvent(x, r, p, correction);
                            assert!(q >= last, "{m:?} {p} {r} {x}: {last} to {q}");
                            last = q;
                            if x <= m.yield_stress(p) {
                                assert_eq!(q, 0.0);
                            } else {
                                let back = m.shear_stress(q, p, correction) + r * q;
                                assert!(
                                    (back / x - 1.0).abs() < 1e-12,
                                    "{m:?} {p} {r} {x}: {back}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_stress() {
        for m in materials() {
            for g in [0.01, 1.0, 50.0] {
                let at = |g| m.shear_stress(g, 300.0, 1.1);
                let d = (at(g * 1.000_01) - at(g * 0.999_99)) / (g * 2e-5);
                let slope = m.shear_stress_slope(g, 300.0, 1.1);
                assert!(
                    (slope - d).abs() <= 1e-6 * d + 1e-8 / g,
                    "{m:?}: {slope} for {d}"
                );
            }
        }
    }

    #[test]
    fn cohesion_is_the_strength_without_pressure() {
        for m in materials() {
            assert_eq!(m.yield_stress(0.0), m.cohesion);
            assert_eq!(m.yield_stress(-5.0), m.cohesion);
            assert_eq!(m.strength(0.0), m.cohesion);
            assert!(m.strength(100.0) >= m.yield_stress(100.0));
        }
    }
}
