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

    /// 1/(2 h) [1/m].
    #[inline(always)]
    #[must_use]
    pub fn inverse_support(&self) -> f64 {
        self.inverse_2h
    }

    /// s with F(r) = -s (1 - q/2)^3 [1/m^(D+2)].
    #[inline(always)]
    #[must_use]
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// W(r) [1/m^D].
    #[inline(always)]
    #[must_use]
    pub fn w(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        let t2 = t * t;
        self.a * t2 * t2 * (1.0 + 4.0 * r * self.inverse_2h)
    }

    /// Share of the kernel outside of radius r, int_{|x| > r} W dx, 1 at r = 0 and 0 at the support [1].
    #[inline]
    #[must_use]
    pub fn share_outside(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        let t5 = t * t * t * t * t;
        if D == 2 {
            t5 * (14.0 - t * (21.0 - 8.0 * t))
        } else {
            t5 * (42.0 - t * (98.0 - t * (78.0 - 21.0 * t)))
        }
    }

    /// F(r) = W'(r)/r <= 0 [1/m^(D+2)].
    #[inline(always)]
    #[must_use]
    pub fn f(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        -self.slope * t * t * t
    }

    /// F'(r) >= 0 [1/m^(D+3)].
    #[inline(always)]
    #[must_use]
    pub fn f_slope(&self, r: f64) -> f64 {
        let t = (1.0 - r * self.inverse_2h).max(0.0);
        3.0 * self.slope * self.inverse_2h * t * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integral_is_one_in_plane_and_space() {
        let (k2, k3) = (WendlandC2::<2>::new(0.7), WendlandC2::<3>::new(0.7));
        let n = 20_000;
        let dr = 1.4 / f64::from(n);
        let (mut s2, mut s3) = (0.0, 0.0);
        for i in 0..n {
            let r = (f64::from(i) + 0.5) * dr;
            s2 += k2.w(r) * 2.0 * PI * r * dr;
            s3 += k3.w(r) * 4.0 * PI * r * r * dr;
        }
        assert!(
            (s2 - 1.0).abs() < 1e-8 && (s3 - 1.0).abs() < 1e-8,
            "{s2} {s3}"
        );
    }

    #[test]
    fn what_is_outside_a_radius_is_the_integral_there() {
        let (k2, k3) = (WendlandC2::<2>::new(0.7), WendlandC2::<3>::new(0.7));
        for r in [0.0_f64, 0.2, 0.7, 1.1, 1.5] {
            let n = 20_000;
            let dr = (1.4 - r).max(0.0) / f64::from(n);
            let (mut s2, mut s3) = (0.0, 0.0);
            for i in 0..n {
                let s = r + (f64::from(i) + 0.5) * dr;
                s2 += k2.w(s) * 2.0 * PI * s * dr;
                s3 += k3.w(s) * 4.0 * PI * s * s * dr;
            }
            assert!((k2.share_outside(r) - s2).abs() < 1e-7, "{r}");
            assert!((k3.share_outside(r) - s3).abs() < 1e-7, "{r}");
        }
    }

    #[test]
    fn slope_is_the_derivative() {
        let k = WendlandC2::<2>::new(1.3);
        for r in [0.1, 0.9, 1.7, 2.5] {
            let d = (k.w(r + 1e-6) - k.w(r - 1e-6)) / 2e-6;
            assert!((k.f(r) * r - d).abs() < 1e-8);
            let d = (k.f(r + 1e-6) - k.f(r - 1e-6)) / 2e-6;
            assert!((k.f_slope(r) - d).abs() < 1e-8);
        }
    }
}
