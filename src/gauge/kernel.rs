//! Wendland's C2 kernel ([A] eq. 20, which calls it C4).
//!
//! Symbols: q = r/h.
//!
//! W = a (1 - q/2)^4 (1 + 2 q), a = 7/(4 pi h^2) in the plane, 21/(16 pi h^3) in space; W'(r)/r = -5 a/h^2 (1 - q/2)^3.

use std::f64::consts::PI;

/// The kernel for a fixed smoothing length in D dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WendlandC2<const D: usize> {
    /// Smoothing length h [m].
    pub h: f64,
    /// Normalisation a [1/m^D].
    a: f64,
    inverse_2h: f64,
    /// 5 a / h^2 [1/m^(D+2)].
    slope: f64,
}

impl<const D: usize> WendlandC2<D> {
    /// Kernel of smoothing length `h` > 0 [m].
    #[must_use]
    pub fn new(h: f64) -> Self {
        let a = if D == 2 {
            7.0 / (4.0 * PI * h * h)
        } else {
            21.0 / (16.0 * PI * h * h * h)
        };
        Self {
            h,
            a,
            inverse_2h: 0.5 / h,
            slope: 5.0 * a / (h * h),
        }
    }

    /// Radius of support 2 h [m].
    #[inline(always)]
    #[must_use]
    pub fn support(&self) -> f64 {
        2.0 * self.h
    }

    /// W(r) [1/m^D].
    #[inline(always)]
    #[must_use]
    pub fn w(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        let t2 = t * t;
        self.a * t2 * t2 * (1.0 + 4.0 * r * self.inverse_2h)
    }

    /// F(r) = W'(r)/r <= 0 [1/m^(D+2)].
    #[inline(always)]
    #[must_use]
    pub fn f(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        -self.slope * t * t * t
    }
}
