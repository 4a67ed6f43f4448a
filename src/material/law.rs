//! Friction laws mu(I): what a law answers ([`Friction`]), and the enum of those that a scene can choose from ([`Law`]).

use super::{BarkerGray, ConstantFriction, MuI};

/// A friction law mu(I): shear stress over pressure against the inertial number I >= 0. Dimensionless.
pub trait Friction {
    /// mu(I) [1].
    fn friction(&self, inertial_number: f64) -> f64;
    /// d mu/dI [1].
    fn slope(&self, inertial_number: f64) -> f64;
    /// What people call the static friction coefficient [1]: mu(0), or of a law that vanishes at rest the one it is
    /// made from. Scales the cap of the viscosity.
    fn static_friction(&self) -> f64;
    /// The I >= 0 with mu(I) + a I = y for a >= 0; 0 where y <= mu(0) [1].
    fn resolvent(&self, a: f64, y: f64) -> f64;

    /// Integral of s mu'(s) ds [1], lower <= upper: by Gauss's points unless a law has a closed form.
    fn rate_integral(&self, lower: f64, upper: f64) -> f64 {
        // Laws bend over decades of s.
        let middle = lower.max(0.25 * upper);
        gauss(lower, middle, |s| s * self.slope(s)) + gauss(middle, upper, |s| s * self.slope(s))
    }

    /// The mean inertial number I of a cell through which T = mu(I) + k I changes evenly from t - half to t + half, where t + a I = y;
    /// a > 0, k >= 0, half > 0; 0 where y + half <= mu(0): nothing of it yields [1].
    ///
    /// With i at its upper end, I = 1/(2 half) integral of s T'(s) ds up to i from where T is 2 half less.
    fn cell_resolvent(&self, (a, k): (f64, f64), y: f64, half: f64) -> f64 {
        // As if all of it were as its upper end: too small.
        let least = self.resolvent(a + k, y + half);
        if least <= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (least, f64::INFINITY);
        let mut i = least;
        let mut mean = 0.0;
        for _ in 0..MOST_STEPS {
            let t = self.friction(i) + k * i - half;
            let lower = self.resolvent(k, t - half);
            let viscous = 0.5 * k * (i - lower) * (i + lower);
            mean = (self.rate_integral(lower, i) + viscous) / (2.0 * half);
            let f = t + a * mean - y;
            let slope = self.slope(i) + k;
            if f < 0.0 && i > FAR * least && slope * i < LEVEL * half {
                // Its end is at the law's largest friction.
                return (y - t) / a;
            }
            *(if f < 0.0 { &mut low } else { &mut high }) = i;
            let mut next = i - f / (slope * (1.0 + a * (i - lower) / (2.0 * half)));
            if (next - i).abs() <= 1e-10 * i {
                break;
            }
            if !(next > low && next < high) {
                next = if high.is_finite() {
                    0.5 * (low + high)
                } else {
                    10.0 * i
                };
            }
            i = next;
        }
        // Where a law jumps there may be no such i.
        mean.min((y + half) / a)
    }
}

/// Newton converges quadratically; 4 to 8 steps are usual.
const MOST_STEPS: u32 = 60;

/// Inertial number at the end of a cell, over what is less than it, and what friction may still grow by there, over half of the cell, from
/// which on the number is as good as infinite [1].
const FAR: f64 = 1e6;
const LEVEL: f64 = 1e-6;

/// Integral by Gauss's five points.
pub(super) fn gauss(lower: f64, upper: f64, of: impl Fn(f64) -> f64) -> f64 {
    const POINTS: [(f64, f64); 5] = [
        (0.0, 128.0 / 225.0),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let (middle, reach) = (0.5 * (lower + upper), 0.5 * (upper - lower));
    let sum: f64 = POINTS.iter().map(|(x, w)| w * of(middle + reach * x)).sum();
    reach * sum
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
    /// None: stress does not depend on pressure, and what has strength hangs together. Grains without friction are not this.
    Fluid,
}

/// Calls a method of whichever law it is: a branch per particle, no pointer.
macro_rules! of_law {
    ($self:ident, $law:ident => $call:expr) => {
        match $self {
            Law::MuI($law) => $call,
            Law::ConstantFriction($law) => $call,
            Law::BarkerGray($law) => $call,
            Law::Fluid => {
                let $law = ConstantFriction { mu: 0.0 };
                $call
            }
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

    #[inline]
    fn rate_integral(&self, lower: f64, upper: f64) -> f64 {
        of_law!(self, law => law.rate_integral(lower, upper))
    }

    #[inline]
    fn cell_resolvent(&self, a: (f64, f64), y: f64, half: f64) -> f64 {
        of_law!(self, law => law.cell_resolvent(a, y, half))
    }
}
