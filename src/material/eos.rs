//! Pressure of a dense granular medium with dilatancy and grain compressibility ([A] eqs. 8, 41, 43, 44).
//!
//! Symbols: x = rho_s/rho_s0 compression of the grains, r = rho/(rho_s0 phi_max), q = phi_min/phi_max, gamma shear rate,
//! D dimension, G = gamma^2 rho_s0 K_t d0^2, B = (1 - q)^2 G, e = 0 in the plane and 1/3 in space.
//!
//! rho = phi(I) rho_s with phi = max(phi_min, phi_max - (phi_max - phi_min) I), p = (x - 1)/K_t and
//! d = d0 x^(-1/D) give I^2 = G x^e/(x - 1) and
//!
//!   (x - 1)(x - r)^2 = B x^(2 + e)     where I <= 1 (A.44 in the plane; A.43 with the cube root in space),
//!   x = r/q                            where I >= 1: the grains stand at phi_min, whatever the shear rate.
//!
//! x phi(I(x)) grows with x, from phi_min at x -> 1, so: for r <= q there is no pressure (x = 1: grains do not touch,
//! the material has parted); above, one root, x >= max(1, r), the smaller of the two. Pressure is continuous in r and B.

use crate::math::{Four, Lanes, Quad};

/// The root x >= 1 of the closing relation for r >= 0, B >= 0 and 0 < q < 1 in D dimensions.
#[inline]
#[must_use]
pub fn grain_compression<const D: usize>(r: f64, b: f64, q: f64) -> f64 {
    in_closed_form::<D>(r, b, q).unwrap_or_else(|| unclamped::<D>(r, b))
}

/// x where it needs no iteration: parted grains, grains that do not shear, grains at phi_min.
#[inline(always)]
fn in_closed_form<const D: usize>(r: f64, b: f64, q: f64) -> Option<f64> {
    let loosest = r / q;
    if loosest <= 1.0 {
        return Some(1.0);
    }
    if b <= 0.0 {
        return Some(r.max(1.0));
    }
    let root = if D == 2 { 1.0 } else { loosest.cbrt() };
    // I >= 1 at phi_min.
    let clamped = b * root >= (1.0 - q) * (1.0 - q) * (loosest - 1.0);
    clamped.then_some(loosest)
}

/// Largest root x for phi = phi_max - (phi_max - phi_min) I, r >= 0 and B > 0.
///
/// The left side grows from 0 at max(1, r), so the root exists and is unique there. Newton from the root without the
/// smaller terms; the logarithm of the left over the right side is concave and rising on the branch, and every iterate
/// is kept above max(1, r), so it cannot leave it. It stops when the step is so small that the next would be rounding.
fn unclamped<const D: usize>(r: f64, b: f64) -> f64 {
    let low = r.max(1.0);
    // Work with y = x - low > 0 to keep digits when x is close to 1.
    let (c1, c2) = (low - 1.0, low - r);
    // (y + c1)(y + c2)^2 = B low^2 but for factors that matter at large B; one of c1, c2 is 0.
    let right = b * low * low;
    let both = rough_cube_root(right);
    let near = if c1 > 0.0 {
        (right / (c1 + both)).sqrt()
    } else {
        right / ((c2 + both) * (c2 + both))
    };
    // Large B: x = B in the plane, B^(3/2) in space.
    let far = if D == 2 {
        b
    } else {
        b * (1.0 + 1.5 * b.sqrt())
    };
    let mut y = near + far;
    for _ in 0..60 {
        let x = low + y;
        let (right, slope) = if D == 2 {
            (b * x * x, 2.0 * b * x)
        } else {
            let power = x * x.cbrt();
            (b * x * power, 7.0 / 3.0 * b * power)
        };
        let (u, v) = (y + c1, y + c2);
        let f = u * v * v - right;
        let df = v * v + 2.0 * u * v - slope;
        let next = if df > 0.0 { y - f / df } else { 0.5 * y };
        let next = if next > 0.0 { next } else { 0.5 * y };
        if (next - y).abs() <= 1e-8 * next {
            return low + next;
        }
        y = next;
    }
    low + y
}

/// As [`grain_compression`] in the plane, of four particles side by side. Halley's iteration in place of Newton's: four of it always
/// do, so that no lane waits for another, and what a particle gets does not depend on its companions.
#[inline(always)]
pub fn grain_compressions<L: Lanes>(lanes: L, r: &Quad, b: &Quad, q: &Quad) -> Quad {
    let splat = |a| Four::splat(lanes, a);
    let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
    let (density, shear) = (Four::load(lanes, r), Four::load(lanes, b));
    let low = density.max(one);
    let (c1, c2) = (low - one, low - density);
    let right = shear * low * low;
    let both = Four::load(lanes, &Quad(right.store().0.map(rough_cube_root)));
    let loose = c2 + both;
    let near = right.over(loose * loose);
    let dense = right.over(c1 + both).sqrt();
    let mut y = near + c1.where_greater(zero, dense - near) + shear;
    for _ in 0..4 {
        let (x, u, v) = (low + y, y + c1, y + c2);
        let f = u * v * v - shear * x * x;
        let df = v * v + two * (u * v - shear * x);
        let curvature = two * v + u - shear;
        y -= (f * df).over(df * df - f * curvature);
    }
    let x = (low + y).store();
    Quad(std::array::from_fn(|k| {
        in_closed_form::<2>(r.0[k], b.0[k], q.0[k]).unwrap_or(x.0[k])
    }))
}

/// Cube root of a positive number within 6 %: the exponent divided by three.
fn rough_cube_root(a: f64) -> f64 {
    f64::from_bits(a.to_bits() / 3 + (1023 - 1023 / 3) * (1 << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Arch, Portable, in_lanes};

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
                        unclamped::<2>(r, b),
                        residual::<2>(r, b, unclamped::<2>(r, b)),
                    ),
                    (
                        unclamped::<3>(r, b),
                        residual::<3>(r, b, unclamped::<3>(r, b)),
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
    fn the_rough_cube_root_is_within_its_bound() {
        for k in -200..200 {
            let a = 10f64.powf(0.05 * f64::from(k));
            let ratio = rough_cube_root(a) / a.cbrt();
            assert!((ratio - 1.0).abs() < 0.06, "{a}: {ratio}");
        }
    }

    const Q: f64 = 0.5 / 0.6;

    #[test]
    fn without_shear_the_grains_carry_only_compression() {
        assert_eq!(grain_compression::<2>(0.9, 0.0, Q), 1.0);
        assert_eq!(grain_compression::<2>(1.02, 0.0, Q), 1.02);
    }

    /// Four side by side against one by one, of any packing and on both architectures.
    #[inline(always)]
    fn four<L: Lanes>(lanes: L) -> Vec<[u64; 4]> {
        let mut all = Vec::new();
        for q in [0.2, 0.5, 0.5 / 0.6, 0.95, 0.99] {
            for k in 0..300 {
                let r = 0.9 * q + (1.5 - 0.9 * q) * f64::from(k) / 299.0;
                for m in 0..60 {
                    let b = 10f64.powf(-14.0 + 15.0 * f64::from(m) / 59.0);
                    let (r, b) = (Quad([r, 1.0, r, 0.9]), Quad([b, b, 0.0, 1e-5]));
                    let x = grain_compressions(lanes, &r, &b, &Quad([q; 4])).0;
                    for (x, (r, b)) in x.iter().zip(r.0.into_iter().zip(b.0)) {
                        let one = grain_compression::<2>(r, b, q);
                        let error = (x - one).abs() / (one - 1.0).max(1e-3);
                        assert!(error < 1e-12, "{q} {r} {b}: {x} {one}");
                    }
                    all.push(x.map(f64::to_bits));
                }
            }
        }
        all
    }

    #[test]
    fn four_at_once_are_those_of_one_by_one() {
        let arch = Arch::detect();
        let fast = in_lanes!(arch, |lanes| four(lanes));
        assert_eq!(fast, four(Portable));
    }

    /// x phi(I(x)) = r phi_max with the clamped phi(I), over r phi_max.
    fn closing<const D: usize>(r: f64, b: f64, x: f64) -> f64 {
        let e = if D == 2 { 0.0 } else { 1.0 / 3.0 };
        let inertial = (b * x.powf(e) / (x - 1.0)).sqrt() / (1.0 - Q);
        let phi = (1.0 - (1.0 - Q) * inertial).max(Q);
        x * phi / r - 1.0
    }

    fn solves<const D: usize>() {
        for k in 0..200 {
            let r = Q + 1e-4 + 0.4 * f64::from(k) / 199.0;
            for m in 0..60 {
                let b = 10f64.powf(-14.0 + 15.0 * f64::from(m) / 59.0);
                let x = grain_compression::<D>(r, b, Q);
                assert!(x >= r.max(1.0), "{r} {b}: {x}");
                // x - 1 has lost digits in x: 1e-16/(x - 1) relative in I^2.
                let lost = 1e-15 / (x - 1.0);
                let residual = closing::<D>(r, b, x);
                assert!(residual.abs() < 1e-9 + lost, "{r} {b} {x}: {residual}");
                // Never looser than phi_min.
                assert!(r / x >= Q * (1.0 - 1e-14));
            }
        }
    }

    #[test]
    fn the_root_solves_the_law_with_the_smallest_volume_fraction() {
        solves::<2>();
        solves::<3>();
    }

    #[test]
    fn pressure_is_continuous_and_grows_with_density_and_shear() {
        let x = |r: f64, b: f64| grain_compression::<2>(r, b, Q);
        for b in [0.0, 1e-8, 1e-6, 1e-4, 1e-2] {
            let mut last = 1.0;
            for k in 0..20_000 {
                let r = 0.7 + 0.4 * f64::from(k) / 20_000.0;
                let now = x(r, b);
                // The steepest is x = r/q.
                assert!(now >= last && now - last <= 1.01 * 2e-5 / Q, "{r} {b}");
                last = now;
            }
        }
        for r in [0.8, 0.9, 1.01] {
            let mut last = 1.0;
            for k in 0..2000 {
                let now = x(r, 10f64.powf(-12.0 + 12.0 * f64::from(k) / 2000.0));
                assert!(now >= last * (1.0 - 1e-15), "{r}: {last} to {now}");
                last = now;
            }
        }
    }

    #[test]
    fn below_the_smallest_volume_fraction_there_is_no_pressure() {
        for b in [0.0, 1e-6, 1.0] {
            assert_eq!(grain_compression::<2>(Q, b, Q), 1.0);
            assert_eq!(grain_compression::<3>(0.5, b, Q), 1.0);
        }
    }
}
