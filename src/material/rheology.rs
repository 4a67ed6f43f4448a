//! Stress of a material at a shear rate and a pressure: cohesion, friction and viscous stress together, their viscosity with
//! its cap, and the resolvent that the yield step solves.

use super::{Friction, Material};

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
    /// The same of a cell through which stress changes evenly from tau - half to tau + half at the mean rate q, half > 0 [Pa].
    fn cell_resolvent(&self, x: f64, r: f64, p: f64, correction: f64, half: f64) -> f64;
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

    #[inline]
    fn cell_resolvent(&self, x: f64, r: f64, p: f64, correction: f64, half: f64) -> f64 {
        let excess = x - self.yield_stress(p);
        if self.is_fluid() {
            return self.viscous.mean_resolvent(excess, r, half);
        }
        let time = if p > 0.0 {
            correction * self.grains.inertial_time(p)
        } else {
            0.0
        };
        if time <= 0.0 {
            return self.viscous.mean_resolvent(excess, r, half);
        }
        debug_assert!(self.viscous.is_linear(), "mu(I) and a power law at once");
        let of_number = |r: f64| r / (time * p);
        let a = (of_number(r), of_number(self.viscous.consistency));
        self.law
            .cell_resolvent(a, (x - self.cohesion) / p, half / p)
            / time
    }
}

impl Material {
    /// Grains with a strength or a viscosity of their own, as the sums over neighbours see them: R [c + K (R gamma)^n] beside
    /// friction (docs/theory.md, E6b). R as in [`Rheology`]. None where that is the material itself.
    #[inline]
    #[must_use]
    pub fn as_summed(&self, correction: f64) -> Option<Self> {
        if !self.holds_by_itself() {
            return None;
        }
        let mut summed = self.clone();
        summed.cohesion *= correction;
        summed.viscous.consistency *= correction.powf(1.0 + self.viscous.flow_index);
        Some(summed)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{BarkerGray, ConstantFriction, Grains, Law, MuI, Viscous};

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
    fn a_small_cell_is_a_point_and_a_large_one_yields_where_its_edge_does() {
        for m in materials() {
            let p = 500.0;
            let strength = m.strength(p);
            if strength == 0.0 {
                continue;
            }
            for x in [1.2, 2.0] {
                let x = x * strength;
                let point = m.resolvent(x, 10.0, p, 1.1);
                let cell = m.cell_resolvent(x, 10.0, p, 1.1, 1e-5 * strength);
                assert!(
                    (cell - point).abs() <= 1e-4 * point,
                    "{m:?}: {cell}, {point}"
                );
            }
            let half = 0.3 * strength;
            let cell =
                |over: f64| m.cell_resolvent(m.yield_stress(p) - half + over, 10.0, p, 1.1, half);
            assert_eq!(cell(-1e-6 * strength), 0.0);
            // Barker and Gray's friction is nothing to speak of below a third of its static one.
            assert!(cell(0.5 * strength) > 0.0, "{m:?}");
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
    fn what_does_not_follow_pressure_is_that_of_the_corrected_rate() {
        for m in materials() {
            let Some(summed) = m.as_summed(1.3) else {
                assert!(m.is_fluid() || m.cohesion == 0.0, "{m:?}");
                continue;
            };
            let own = |m: &Material, g: f64| m.cohesion + m.viscous.stress(g);
            for g in [0.01, 1.0, 50.0] {
                let friction = m.shear_stress(g, 300.0, 1.1) - own(&m, g);
                let wanted = friction + 1.3 * own(&m, 1.3 * g);
                let got = summed.shear_stress(g, 300.0, 1.1);
                assert!((got / wanted - 1.0).abs() < 1e-12, "{m:?}: {got}, {wanted}");
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
