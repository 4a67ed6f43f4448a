//! Viscous stress that depends on the shear rate alone: K gamma^n of Herschel and Bulkley ([B] eqs. 11 and 12), which has
//! Newton's law (n = 1) and power laws in it. What yields, `cohesion` and friction, stands beside it in [`super::Material`].
//!
//! Symbols: K consistency [Pa s^n], n flow index [1], gamma shear rate [1/s]. [B] Table 1 swaps the two names.

/// Viscous stress K gamma^n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous {
    /// Consistency K >= 0 [Pa s^n]: the viscosity where n is 1.
    pub consistency: f64,
    /// Flow index n > 0 [1]: below 1 shear-thinning, above 1 shear-thickening.
    pub flow_index: f64,
}

impl Viscous {
    /// No viscous stress.
    pub const NONE: Self = Self::newtonian(0.0);

    /// Viscosity >= 0 that does not depend on the shear rate [Pa s].
    #[must_use]
    pub const fn newtonian(viscosity: f64) -> Self {
        Self {
            consistency: viscosity,
            flow_index: 1.0,
        }
    }

    /// Whether stress is proportional to the shear rate.
    #[inline]
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.flow_index == 1.0
    }

    /// Stress K gamma^n [Pa], gamma >= 0 [1/s].
    #[inline]
    #[must_use]
    pub fn stress(&self, gamma: f64) -> f64 {
        if self.is_linear() {
            self.consistency * gamma
        } else {
            self.consistency * gamma.powf(self.flow_index)
        }
    }

    /// Its slope n K gamma^(n-1) [Pa s]; infinite at gamma = 0 where n is below 1.
    #[inline]
    #[must_use]
    pub fn slope(&self, gamma: f64) -> f64 {
        if self.is_linear() {
            self.consistency
        } else {
            self.flow_index * self.consistency * gamma.powf(self.flow_index - 1.0)
        }
    }

    /// Viscosity K gamma^(n-1) [Pa s]. Where n is below 1 it would be infinite at rest: slower shear than `least_rate`
    /// [1/s] counts as that.
    #[inline]
    #[must_use]
    pub fn viscosity(&self, gamma: f64, least_rate: f64) -> f64 {
        if self.is_linear() {
            self.consistency
        } else if self.flow_index < 1.0 {
            self.consistency * gamma.max(least_rate).powf(self.flow_index - 1.0)
        } else {
            self.consistency * gamma.powf(self.flow_index - 1.0)
        }
    }

    /// The q >= 0 with K q^n + r q = y, y > 0 [Pa], r > 0 [Pa s]: [1/s].
    ///
    /// Newton's steps from a side where they cannot overshoot: the sum is concave for n < 1, where both terms at y/2 give a
    /// q below the root, and convex for n > 1, where the smaller of the two roots of one term alone is above it.
    #[inline]
    #[must_use]
    pub fn resolvent(&self, y: f64, r: f64) -> f64 {
        let (k, n) = (self.consistency, self.flow_index);
        if self.is_linear() || k <= 0.0 {
            return y / (r + k);
        }
        let share = if n < 1.0 { 0.5 } else { 1.0 };
        let mut q = (share * y / k).powf(1.0 / n).min(share * y / r);
        for _ in 0..MOST_STEPS {
            if q <= 0.0 {
                return 0.0;
            }
            let viscous = k * q.powf(n);
            let step = (viscous + r * q - y) / (n * viscous / q + r);
            q -= step;
            if step.abs() <= 1e-15 * q {
                break;
            }
        }
        q
    }
}

/// Newton converges quadratically; 5 to 8 steps are usual.
const MOST_STEPS: u32 = 50;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolvent_solves_its_equation_for_any_index() {
        for n in [0.2, 0.472, 0.9, 1.0, 1.3, 2.0] {
            for k in [1e-3, 4.472, 1e4] {
                let fluid = Viscous {
                    consistency: k,
                    flow_index: n,
                };
                for r in [1e-6, 0.1, 1e5] {
                    for y in [1e-9, 1e-3, 30.0, 1e5] {
                        let q = fluid.resolvent(y, r);
                        let back = fluid.stress(q) + r * q;
                        assert!((back / y - 1.0).abs() < 1e-12, "{n} {k} {r} {y}: {back}");
                    }
                }
            }
        }
    }

    #[test]
    fn viscosity_is_stress_over_rate_above_the_least_rate() {
        for n in [0.5, 1.0, 1.5] {
            let fluid = Viscous {
                consistency: 4.0,
                flow_index: n,
            };
            let gamma = 7.0;
            assert!((fluid.viscosity(gamma, 0.1) * gamma - fluid.stress(gamma)).abs() < 1e-12);
            let slope = (fluid.stress(7.000_1) - fluid.stress(6.999_9)) / 2e-4;
            assert!((fluid.slope(gamma) - slope).abs() < 1e-6);
            assert!(fluid.viscosity(0.0, 0.1).is_finite());
        }
    }
}
