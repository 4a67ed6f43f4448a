//! The mu(I) friction of dense granular flow ([A] eqs. 6 to 12, corrected in docs/theory.md).
//!
//! mu(I) = mu_s + (mu_2 - mu_s) / (1 + I0/I): from mu_s at rest to mu_2 at large I.

use super::Friction;

/// Parameters of mu(I).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuI {
    /// Friction coefficient at vanishing I, mu_s [1], 0 to 3.
    pub mu_s: f64,
    /// Friction coefficient at large I, mu_2 >= mu_s [1].
    pub mu_2: f64,
    /// Inertial number scale I0 > 0 [1].
    pub inertial_number_scale: f64,
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
        }
    }
}

impl Friction for MuI {
    #[inline]
    fn friction(&self, i: f64) -> f64 {
        self.mu_s + (self.mu_2 - self.mu_s) * i / (i + self.inertial_number_scale)
    }

    #[inline]
    fn slope(&self, i: f64) -> f64 {
        let s = i + self.inertial_number_scale;
        (self.mu_2 - self.mu_s) * self.inertial_number_scale / (s * s)
    }

    /// a I^2 + (a I0 + mu_2 - y) I - (y - mu_s) I0 = 0: the positive root, without cancellation.
    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        let excess = y - self.mu_s;
        if excess <= 0.0 {
            return 0.0;
        }
        let i0 = self.inertial_number_scale;
        let b = a * i0 + self.mu_2 - y;
        let c = excess * i0;
        let root = (b * b + 4.0 * a * c).sqrt();
        if b > 0.0 {
            2.0 * c / (b + root)
        } else {
            (root - b) / (2.0 * a)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_grows_from_mu_s_to_mu_2() {
        let m = MuI::glass_beads();
        assert!((m.friction(0.0) - m.mu_s).abs() < 1e-15);
        assert!((m.friction(1e9) - m.mu_2).abs() < 1e-8);
        assert!((m.friction(m.inertial_number_scale) - 0.5 * (m.mu_s + m.mu_2)).abs() < 1e-15);
    }
}
