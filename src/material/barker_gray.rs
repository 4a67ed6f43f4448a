//! Barker & Gray's well-posed mu(I) (J. Fluid Mech. 828 (2017) 5, doi 10.1017/jfm.2017.428, eqs. 6.3 and 6.4).
//!
//!   mu(I) = sqrt(alpha / ln(A/I))                                    for I <= I1
//!         = (mu_s I0 + mu_2 I + mu_inf I^2)/(I0 + I)                 above,
//!
//! I1 the lower neutral inertial number of mu(I) (`well_posed`), A = I1 exp(alpha/mu(I1)^2) by continuity, alpha = 1.9.
//! Any alpha < 2 is well-posed at low I. The price: mu(0) = 0. There is no yield stress, and material creeps under any load,
//! little where mu_s is small (glass: mu(1e-3) = 0.357 for mu_s = 0.382), much where it is large (sand of 0.4 mm: 0.433 for 0.589).

use super::law::gauss;
use super::{Friction, MuI, neutral_inertial_numbers};

/// alpha of the low branch [1], below 2.
const ALPHA: f64 = 1.9;

/// Barker & Gray's friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarkerGray {
    high: MuI,
    i1: f64,
    a: f64,
}

impl BarkerGray {
    /// From mu(I) with its growing part; `None` if mu(I) is ill-posed at every I, so that there is no I1 to join at.
    #[must_use]
    pub fn new(high: MuI) -> Option<Self> {
        let (i1, _) = neutral_inertial_numbers(&MuI {
            mu_inf: 0.0,
            ..high
        })?;
        let mu = high.friction(i1);
        Some(Self {
            high,
            i1,
            a: i1 * (ALPHA / (mu * mu)).exp(),
        })
    }

    /// The mu(I) above I1.
    #[must_use]
    pub fn high(&self) -> &MuI {
        &self.high
    }

    /// I1 [1], where the branches join.
    #[must_use]
    pub fn joint(&self) -> f64 {
        self.i1
    }

    /// I of the low branch at friction m > 0.
    fn low_inertial_number(&self, m: f64) -> f64 {
        self.a * (-ALPHA / (m * m)).exp()
    }

    /// The friction m in (0, y] with m + a I(m) = y on the low branch: Newton on the increasing
    /// ln(a A) - alpha/m^2 - ln(y - m), kept in a bracket.
    fn low_friction(&self, a: f64, y: f64) -> f64 {
        let scale = (a * self.a).ln();
        if a <= 0.0 || a * self.low_inertial_number(y) <= 1e-17 * y {
            return y;
        }
        let (mut low, mut high) = (0.0, y);
        // Where a I is small, m is y less it; where it is large, ln(y - m) is about ln y.
        let steep = (scale - y.ln()).max(0.0);
        let mut m = if steep > ALPHA / (y * y) {
            (ALPHA / steep).sqrt().min(0.999 * y)
        } else {
            0.5 * y
        };
        for _ in 0..100 {
            let f = scale - ALPHA / (m * m) - (y - m).ln();
            if f > 0.0 {
                high = m;
            } else {
                low = m;
            }
            let next = m - f / (2.0 * ALPHA / (m * m * m) + 1.0 / (y - m));
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - m).abs() <= 1e-16 * y {
                return next;
            }
            m = next;
        }
        m
    }
}

impl Friction for BarkerGray {
    #[inline]
    fn friction(&self, i: f64) -> f64 {
        if i > self.i1 {
            self.high.friction(i)
        } else if i > 0.0 {
            (ALPHA / (self.a.ln() - i.ln())).sqrt()
        } else {
            0.0
        }
    }

    /// Infinite at I = 0.
    #[inline]
    fn slope(&self, i: f64) -> f64 {
        if i > self.i1 {
            self.high.slope(i)
        } else if i > 0.0 {
            self.friction(i).powi(3) / (2.0 * ALPHA * i)
        } else {
            f64::INFINITY
        }
    }

    #[inline]
    fn static_friction(&self) -> f64 {
        self.high.mu_s
    }

    fn resolvent(&self, a: f64, y: f64) -> f64 {
        if y <= 0.0 {
            return 0.0;
        }
        if y >= self.high.friction(self.i1) + a * self.i1 {
            return self.high.resolvent(a, y);
        }
        let m = self.low_friction(a, y);
        // Of two equal expressions the one that loses fewer digits.
        if y - m > m {
            (y - m) / a
        } else {
            // Where A is too large for a number all of the branch is at 0, and steps up at its end.
            self.low_inertial_number(m).min(self.i1)
        }
    }

    /// s mu' = mu^3/(2 alpha) on the low branch.
    fn rate_integral(&self, lower: f64, upper: f64) -> f64 {
        let low = |s: f64| self.friction(s).powi(3) / (2.0 * ALPHA);
        let (joint, middle) = (upper.min(self.i1), 0.1 * upper.min(self.i1));
        let mut sum = 0.0;
        if lower < joint {
            sum += gauss(lower, lower.max(middle), low) + gauss(lower.max(middle), joint, low);
        }
        if upper > self.i1 {
            sum += self.high.rate_integral(lower.max(self.i1), upper);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::ill_posedness;
    use crate::material::laws_tests::check;

    fn law(high: MuI) -> BarkerGray {
        BarkerGray::new(MuI {
            mu_inf: 0.05,
            ..high
        })
        .unwrap()
    }

    #[test]
    fn is_a_friction_law() {
        for high in [MuI::glass_beads(), MuI::sand_08(), MuI::sand_04()] {
            check(&law(high));
        }
    }

    #[test]
    fn has_the_constants_of_the_published_formulas() {
        // I1, A and mu(1e-3), computed from the same formulas by another program (design notes, numerics).
        for (high, i1, a, mu) in [
            (MuI::glass_beads(), 0.01935, 2969.0, 0.357),
            (MuI::sand_04(), 0.4315, 24.93, 0.433),
        ] {
            let law = law(high);
            assert!((law.i1 / i1 - 1.0).abs() < 3e-4, "{}", law.i1);
            assert!((law.a / a - 1.0).abs() < 3e-4, "{}", law.a);
            assert!((law.friction(1e-3) - mu).abs() < 5e-4);
        }
        // Barker & Gray's own set, (0.342, 0.557, 0.069): I1 = 0.003972.
        let law = law(MuI {
            mu_s: 0.342,
            mu_2: 0.557,
            inertial_number_scale: 0.069,
            mu_inf: 0.0,
        });
        assert!((law.i1 - 0.003_972).abs() < 1e-6, "{}", law.i1);
    }

    #[test]
    fn branches_join_and_vanish_at_rest() {
        let law = law(MuI::glass_beads());
        let (below, above) = (law.i1 * (1.0 - 1e-12), law.i1 * (1.0 + 1e-12));
        assert!((law.friction(below) - law.friction(above)).abs() < 1e-11);
        assert_eq!(law.friction(0.0), 0.0);
        assert!(law.friction(1e-12) < 0.25);
    }

    #[test]
    fn is_well_posed_from_rest_to_where_growth_ends_it() {
        for (high, to) in [
            (MuI::glass_beads(), 14.9),
            (MuI::sand_08(), 4.0),
            (MuI::sand_04(), 3.3),
        ] {
            let law = law(high);
            for k in 0..400 {
                let i = 10f64.powf(-12.0 + 12.0 * f64::from(k) / 400.0) * to;
                assert!(ill_posedness(&law, i) <= 1e-12, "{i}");
            }
            assert!(ill_posedness(&law, 1.1 * to) > 0.0);
        }
    }

    #[test]
    fn a_law_that_is_ill_posed_everywhere_has_no_joint() {
        let flat = MuI {
            mu_s: 0.5,
            mu_2: 0.52,
            inertial_number_scale: 0.3,
            mu_inf: 0.0,
        };
        assert!(BarkerGray::new(flat).is_none());
    }
}
