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

    /// Mean shear rate of a cell through which stress changes evenly from `over - half` to `over + half` beyond the yield stress, and
    /// its slope: of (t/K)^(1/n) where t > 0, half > 0 [Pa].
    fn mean_rate(&self, over: f64, half: f64) -> (f64, f64) {
        let m = 1.0 / self.flow_index;
        let rate = |t: f64| (t.max(0.0) / self.consistency).powf(m);
        let whole = |t: f64| t.max(0.0) * rate(t) / (m + 1.0);
        let (top, bottom) = (over + half, over - half);
        let width = 2.0 * half;
        (
            (whole(top) - whole(bottom)) / width,
            (rate(top) - rate(bottom)) / width,
        )
    }

    /// The q >= 0 of such a cell with t + r q = y, t its mean stress beyond the yield stress and q the mean rate, r > 0 [Pa s]; 0
    /// where y <= -half: nothing of it yields [1/s]. Differences of rates lose digits where half is far less than y.
    #[must_use]
    pub fn mean_resolvent(&self, y: f64, r: f64, half: f64) -> f64 {
        if y <= -half {
            return 0.0;
        }
        let (k, m) = (self.consistency, 1.0 / self.flow_index);
        if k <= 0.0 {
            // Where any of it yields it is all the yield stress.
            return (y + half) / r;
        }
        // Newton's steps come down from any t that is too large, since q is convex in t. Of the upper half at least rate(t) yields;
        // where not all of the cell does, q is a power of what does.
        let mut t = if y > 0.0 {
            y.min(k * (2.0 * y / r).powf(self.flow_index))
        } else {
            y
        };
        let yielding = ((y + half) / r * 2.0 * half * (m + 1.0) * k.powf(m)).powf(1.0 / (m + 1.0));
        if yielding <= 2.0 * half {
            t = t.min(yielding - half);
        }
        for _ in 0..MOST_STEPS {
            let (q, slope) = self.mean_rate(t, half);
            let step = (t + r * q - y) / (1.0 + r * slope);
            t -= step;
            if step.abs() <= 1e-15 * (t + half) {
                break;
            }
        }
        self.mean_rate(t, half).0
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
    fn a_cells_resolvent_solves_its_equation_and_is_that_of_a_point_for_a_small_cell() {
        for n in [0.2, 0.472, 1.0, 2.0] {
            for k in [1e-3, 4.472, 1e4] {
                let fluid = Viscous {
                    consistency: k,
                    flow_index: n,
                };
                for r in [1e-6, 0.1, 1e5] {
                    for half in [1e-3, 0.5, 40.0] {
                        for y in [-0.999 * half, -0.1 * half, 1e-3, 30.0, 1e5] {
                            let q = fluid.mean_resolvent(y, r, half);
                            // Its stress by halving.
                            let (mut low, mut high) = (-half, y);
                            for _ in 0..200 {
                                let t = 0.5 * (low + high);
                                let beyond = t + r * fluid.mean_rate(t, half).0 > y;
                                *(if beyond { &mut high } else { &mut low }) = t;
                            }
                            let exact = fluid.mean_rate(low, half).0;
                            let apart = (q - exact).abs();
                            // What halving leaves of t moves q by its slope.
                            let rounding = 1e-13 * (y.abs() + half) * fluid.mean_rate(high, half).1;
                            assert!(
                                apart <= 1e-6 * exact + rounding,
                                "{n} {k} {r} {half} {y}: {q} {exact}"
                            );
                        }
                    }
                    let (point, cell) = (
                        fluid.resolvent(30.0, r),
                        fluid.mean_resolvent(30.0, r, 1e-6),
                    );
                    assert!(
                        (cell / point - 1.0).abs() < 1e-6,
                        "{n} {k} {r}: {cell} {point}"
                    );
                }
            }
        }
        let plastic = Viscous::newtonian(0.0);
        assert_eq!(plastic.mean_resolvent(3.0, 2.0, 1.0), 2.0);
        assert_eq!(plastic.mean_resolvent(-1.0, 2.0, 1.0), 0.0);
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
