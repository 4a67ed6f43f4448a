//! The mu(I) friction of dense granular flow ([A] eqs. 6, 7 and 18, corrected in docs/theory.md).
//!
//! mu(I) = mu_s + (mu_2 - mu_s) / (1 + I0/I): from mu_s at rest to mu_2 at large I. Two additions, off by default:
//! - thin layers (A.18): I + s in place of I, s = 2.61 d/H. That is the same law with other constants ([`MuI::of_layer`]);
//! - growth at large I: + mu_inf I^2/(I0 + I), so that friction rises like mu_inf I (Barker & Gray 2017, eq. 6.3).

use super::Friction;
use super::law::gauss;

/// s H/d of (A.18) for sand: 5 gamma/(2 sqrt(phi cos theta)) with gamma = 0.77 of [A] Table 1, phi = 0.6 and
/// theta = 25 deg. Glass beads have gamma = 0: no correction.
pub const SAND_LAYER_FACTOR: f64 = 2.61;

/// Parameters of mu(I).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuI {
    /// Friction coefficient at vanishing I, mu_s [1], 0 to 3.
    pub mu_s: f64,
    /// Friction coefficient of the law's saturating part at large I, mu_2 >= mu_s [1].
    pub mu_2: f64,
    /// Inertial number scale I0 > 0 [1].
    pub inertial_number_scale: f64,
    /// Growth at large I, mu_inf >= 0 [1]; 0 is (A.7).
    pub mu_inf: f64,
}

impl MuI {
    /// Glass beads of [A] Table 1.
    #[must_use]
    pub fn glass_beads() -> Self {
        Self::of_angles(20.90, 32.76, 0.279)
    }

    /// Sand of 0.8 mm of [A] Table 1.
    #[must_use]
    pub fn sand_08() -> Self {
        Self::of_angles(27.00, 43.40, 1.09)
    }

    /// Sand of 0.4 mm of [A] Table 1.
    #[must_use]
    pub fn sand_04() -> Self {
        Self::of_angles(30.50, 51.30, 2.65)
    }

    fn of_angles(angle_s: f64, angle_2: f64, inertial_number_scale: f64) -> Self {
        Self {
            mu_s: angle_s.to_radians().tan(),
            mu_2: angle_2.to_radians().tan(),
            inertial_number_scale,
            mu_inf: 0.0,
        }
    }

    /// The law with I + s in place of I (A.18), s >= 0 [1]: mu_s grows to mu(s), I0 to I0 + s, since
    /// (I + s)/(I + s + I0) = s/(I0 + s) + I0/(I0 + s) I/(I + I0 + s). The growing part keeps I.
    #[must_use]
    pub fn of_layer(self, s: f64) -> Self {
        let scale = self.inertial_number_scale + s;
        Self {
            mu_s: self.mu_s + (self.mu_2 - self.mu_s) * s / scale,
            inertial_number_scale: scale,
            ..self
        }
    }
}

impl Friction for MuI {
    #[inline]
    fn friction(&self, i: f64) -> f64 {
        self.mu_s + (self.mu_2 - self.mu_s + self.mu_inf * i) * i / (i + self.inertial_number_scale)
    }

    #[inline]
    fn slope(&self, i: f64) -> f64 {
        let i0 = self.inertial_number_scale;
        ((self.mu_2 - self.mu_s) * i0 + self.mu_inf * i * (i + 2.0 * i0)) / ((i + i0) * (i + i0))
    }

    #[inline]
    fn static_friction(&self) -> f64 {
        self.mu_s
    }

    /// (a + mu_inf) I^2 + (a I0 + mu_2 - y) I - (y - mu_s) I0 = 0: the positive root, without cancellation.
    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        let excess = y - self.mu_s;
        if excess <= 0.0 {
            return 0.0;
        }
        let i0 = self.inertial_number_scale;
        let b = a * i0 + self.mu_2 - y;
        let c = excess * i0;
        let root = (b * b + 4.0 * (a + self.mu_inf) * c).sqrt();
        if b > 0.0 {
            2.0 * c / (b + root)
        } else {
            (root - b) / (2.0 * (a + self.mu_inf))
        }
    }

    /// mu_inf s^2/2 + I0 (mu_2 - mu_s - mu_inf I0) (ln(s + I0) - s/(s + I0)), where that loses no digits.
    fn rate_integral(&self, lower: f64, upper: f64) -> f64 {
        let i0 = self.inertial_number_scale;
        let (grown, saturating) = (
            0.5 * self.mu_inf * (upper - lower) * (upper + lower),
            i0 * (self.mu_2 - self.mu_s - self.mu_inf * i0),
        );
        let span = (upper - lower) / (lower + i0);
        if upper < 0.1 * i0 {
            let shape = |s: f64| s / (s + i0).powi(2);
            return grown + saturating * gauss(lower, upper, shape);
        }
        grown + saturating * (span.ln_1p() - span * i0 / (upper + i0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::laws_tests::check;

    #[test]
    fn is_a_friction_law() {
        for law in [MuI::glass_beads(), MuI::sand_08(), MuI::sand_04()] {
            check(&law);
            check(&law.of_layer(0.3));
            check(&MuI {
                mu_inf: 0.05,
                ..law
            });
        }
    }

    #[test]
    fn friction_grows_from_mu_s_to_mu_2() {
        let m = MuI::glass_beads();
        assert!((m.friction(0.0) - m.mu_s).abs() < 1e-15);
        assert!((m.friction(1e9) - m.mu_2).abs() < 1e-8);
        assert!((m.friction(m.inertial_number_scale) - 0.5 * (m.mu_s + m.mu_2)).abs() < 1e-15);
    }

    #[test]
    fn in_a_layer_the_inertial_number_is_shifted() {
        let m = MuI::sand_04();
        let s = SAND_LAYER_FACTOR / 20.0;
        for i in [0.0, 1e-3, 0.2, 5.0] {
            let shifted = m.of_layer(s).friction(i);
            assert!((shifted - m.friction(i + s)).abs() < 1e-15, "{i}");
        }
        // The paper's Fig. 1: the error of leaving the term out is largest at rest and falls with H/d.
        let error = |h: f64, i: f64| m.of_layer(SAND_LAYER_FACTOR / h).friction(i) / m.friction(i);
        assert!(error(10.0, 0.0) > error(10.0, 1.0) && error(10.0, 0.0) > error(100.0, 0.0));
        // 5 gamma/(2 sqrt(phi cos theta)).
        let factor = 2.5 * 0.77 / (0.6 * 25f64.to_radians().cos()).sqrt();
        assert!((factor - SAND_LAYER_FACTOR).abs() < 0.005, "{factor}");
    }

    #[test]
    fn the_scales_of_the_table_follow_from_its_other_rows() {
        // (A.17) with the root over cos theta: I0 = 5 beta d/(2 L sqrt(phi cos theta)).
        let i0 = |beta: f64, l: f64| 2.5 * beta / (l * (0.6 * 25f64.to_radians().cos()).sqrt());
        for (law, beta, l) in [
            (MuI::glass_beads(), 0.136, 1.65),
            (MuI::sand_08(), 0.650, 2.03),
            (MuI::sand_04(), 0.650, 0.83),
        ] {
            let ratio = i0(beta, l) / law.inertial_number_scale;
            assert!((ratio - 1.0).abs() < 5e-3, "{ratio}");
        }
    }

    #[test]
    fn with_growth_friction_rises_like_mu_inf_i() {
        let m = MuI {
            mu_inf: 0.05,
            ..MuI::glass_beads()
        };
        assert!((m.friction(1e6) / 5e4 - 1.0).abs() < 1e-4);
    }
}
