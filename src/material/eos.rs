//! Pressure of a dense granular medium with dilatancy and grain compressibility ([A] eqs. 41, 43, 44).
//!
//! Symbols: x = rho_s/rho_s0 compression of the grains, r = rho/(rho_s0 phi_max), gamma shear rate, D dimension,
//! B = gamma^2 rho_s0 K_t (phi_max - phi_min)^2 d0^2 / phi_max^2.
//!
//! (x - 1)(x - r)^2 = B x^2 in the plane (A.44), B x^(7/3) in space (A.43 with the cube root); p = (x - 1)/K_t.
//! The physical root is the largest one, x >= max(1, r): there the left side grows from 0, so it exists and is unique.

/// Largest root x of the closing relation for r >= 0 and B >= 0 in D dimensions.
///
/// Newton from an upper bound: the logarithm of the left over the right side is concave and rising on the branch, and
/// every iterate is kept above max(1, r), so it cannot leave it.
#[inline]
#[must_use]
pub fn grain_compression<const D: usize>(r: f64, b: f64) -> f64 {
    let low = r.max(1.0);
    if b <= 0.0 {
        return low;
    }
    // Work with y = x - low > 0 to keep digits when x is close to 1.
    let (c1, c2) = (low - 1.0, low - r);
    // Large B: x = B in the plane, B^(3/2) in space.
    let far = if D == 2 {
        b
    } else {
        b * (1.0 + 1.5 * b.sqrt())
    };
    let mut y = low * (1.5 * (b.cbrt() + b.sqrt()) + far);
    for _ in 0..60 {
        let x = low + y;
        let (right, slope) = if D == 2 {
            (b * x * x, 2.0 * b * x)
        } else {
            (b * x.powf(7.0 / 3.0), 7.0 / 3.0 * b * x.powf(4.0 / 3.0))
        };
        let (u, v) = (y + c1, y + c2);
        let f = u * v * v - right;
        let df = v * v + 2.0 * u * v - slope;
        let next = if df > 0.0 { y - f / df } else { 0.5 * y };
        let next = if next > 0.0 { next } else { 0.5 * y };
        if (next - y).abs() <= 1e-14 * (next + low * 1e-6) {
            return low + next;
        }
        y = next;
    }
    low + y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn residual<const D: usize>(r: f64, b: f64, x: f64) -> f64 {
        let e = if D == 2 { 2.0 } else { 7.0 / 3.0 };
        ((x - 1.0) * (x - r).powi(2) - b * x.powf(e)) / (b * x.powf(e))
    }

    #[test]
    fn root_is_on_the_physical_branch_over_the_whole_range() {
        for k in 0..300 {
            let r = 0.3 + 0.9 * f64::from(k) / 299.0;
            for m in 0..60 {
                let b = 10f64.powf(-14.0 + 15.0 * f64::from(m) / 59.0);
                for (x, res) in [
                    (
                        grain_compression::<2>(r, b),
                        residual::<2>(r, b, grain_compression::<2>(r, b)),
                    ),
                    (
                        grain_compression::<3>(r, b),
                        residual::<3>(r, b, grain_compression::<3>(r, b)),
                    ),
                ] {
                    assert!(x > r.max(1.0), "r {r} B {b}: {x}");
                    // x - 1 carries the digits that the stored x has lost: 1e-16/(x-1) relative.
                    let lost = 1e-15 / (x - 1.0) + 2e-15 / (x - r);
                    assert!(res.abs() < 1e-9 + 4.0 * lost, "r {r} B {b}: {res}");
                }
            }
        }
    }

    #[test]
    fn without_shear_the_grains_carry_only_compression() {
        assert_eq!(grain_compression::<2>(0.9, 0.0), 1.0);
        assert_eq!(grain_compression::<2>(1.02, 0.0), 1.02);
    }
}
