//! Rank 0: small vectors and tensors as plain arrays, order-fixed sums, the thread pool. No physics.
//!
//! Arrays instead of nalgebra types here because these sit in the hot loops; nalgebra serves the edges.
#![allow(
    clippy::needless_range_loop,
    reason = "textbook index notation: sums over components 0..D"
)]

mod geometry;
mod lanes;
mod launch;
mod panicked;
mod workers;

pub use geometry::Geometry;
#[cfg(target_arch = "x86_64")]
pub use lanes::Inlined;
pub(crate) use lanes::in_lanes;
pub use lanes::{Arch, Four, LANES, Lanes, Portable, Quad};
#[cfg(feature = "record")]
pub(crate) use launch::launch;
pub use launch::{Launcher, start_threads_by};
pub use panicked::panic_text;
pub use workers::{CHUNK, Workers};

/// A vector of D components.
pub type Vector<const D: usize> = [f64; D];
/// A D x D tensor, `t[row][column]`.
pub type Tensor<const D: usize> = [[f64; D]; D];

/// Scalar product.
#[inline(always)]
#[must_use]
pub fn dot<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> f64 {
    let mut s = 0.0;
    for k in 0..D {
        s += a[k] * b[k];
    }
    s
}

/// a - b.
#[inline(always)]
#[must_use]
pub fn sub<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|k| a[k] - b[k])
}

/// a + b.
#[inline(always)]
#[must_use]
pub fn add<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|k| a[k] + b[k])
}

/// s a.
#[inline(always)]
#[must_use]
pub fn scale<const D: usize>(s: f64, a: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|k| s * a[k])
}

/// What of a lies along a face with unit normal n: a - (n.a) n.
#[inline(always)]
#[must_use]
pub fn along<const D: usize>(n: &Vector<D>, a: &Vector<D>) -> Vector<D> {
    sub(a, &scale(dot(n, a), n))
}

/// Euclidean norm.
#[inline(always)]
#[must_use]
pub fn norm<const D: usize>(a: &Vector<D>) -> f64 {
    dot(a, a).sqrt()
}

/// Euclidean norm by `hypot`: no square over- or underflows, and bits differ from those of [`norm`], which hot loops take.
#[must_use]
pub fn length<const D: usize>(a: &Vector<D>) -> f64 {
    a.iter().fold(0.0_f64, |length, c| length.hypot(*c))
}

/// a over its [`length`], if that is finite and not 0.
#[must_use]
pub fn normalized<const D: usize>(a: &Vector<D>) -> Option<Vector<D>> {
    let size = length(a);
    (size > 0.0 && size.is_finite()).then(|| a.map(|c| c / size))
}

/// a x b.
#[must_use]
pub fn cross(a: &Vector<3>, b: &Vector<3>) -> Vector<3> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Adds s a (x) b to t.
#[inline(always)]
pub fn add_outer<const D: usize>(t: &mut Tensor<D>, s: f64, a: &Vector<D>, b: &Vector<D>) {
    for r in 0..D {
        for c in 0..D {
            t[r][c] += s * a[r] * b[c];
        }
    }
}

/// t . a.
#[inline(always)]
#[must_use]
pub fn apply<const D: usize>(t: &Tensor<D>, a: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|r| dot(&t[r], a))
}

/// a . b for tensors.
#[inline(always)]
#[must_use]
pub fn multiply<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let mut s = 0.0;
            for k in 0..D {
                s += a[r][k] * b[k][c];
            }
            s
        })
    })
}

/// The tensor that turns with this angular velocity: w x a = skew(w) a, in the plane about z.
#[inline(always)]
#[must_use]
pub fn skew<const D: usize>(w: &[f64; 3]) -> Tensor<D> {
    let mut j = [[0.0; D]; D];
    if D == 2 {
        j[0][1] = -w[2];
        j[1][0] = w[2];
    } else {
        for k in 0..D {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            j[b][a] = w[k];
            j[a][b] = -w[k];
        }
    }
    j
}

/// Trace.
#[inline(always)]
#[must_use]
pub fn trace<const D: usize>(t: &Tensor<D>) -> f64 {
    let mut s = 0.0;
    for (k, row) in t.iter().enumerate() {
        s += row[k];
    }
    s
}

/// Deviator of the symmetric part: e = sym(g) - tr(g)/D I.
#[inline(always)]
#[must_use]
pub fn strain_deviator<const D: usize>(g: &Tensor<D>) -> Tensor<D> {
    let mean = trace(g) / D as f64;
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let s = 0.5 * (g[r][c] + g[c][r]);
            if r == c { s - mean } else { s }
        })
    })
}

/// gamma = sqrt(2 e:e) of a deviator e.
#[inline(always)]
#[must_use]
pub fn shear_rate<const D: usize>(e: &Tensor<D>) -> f64 {
    let mut s = 0.0;
    for row in e {
        s += dot(row, row);
    }
    (2.0 * s).sqrt()
}

/// Determinant (D = 2 or 3).
#[inline(always)]
#[must_use]
pub fn determinant<const D: usize>(m: &Tensor<D>) -> f64 {
    if D == 2 {
        m[0][0] * m[1][1] - m[0][1] * m[1][0]
    } else {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }
}

/// Inverse by cofactors (D = 2 or 3); the caller has checked the determinant.
#[inline(always)]
#[must_use]
pub fn inverse<const D: usize>(m: &Tensor<D>) -> Tensor<D> {
    let f = 1.0 / determinant(m);
    let mut r = [[0.0; D]; D];
    if D == 2 {
        r[0][0] = f * m[1][1];
        r[0][1] = -f * m[0][1];
        r[1][0] = -f * m[1][0];
        r[1][1] = f * m[0][0];
    } else {
        for i in 0..3 {
            for j in 0..3 {
                let (a, b) = ((j + 1) % 3, (j + 2) % 3);
                let (c, d) = ((i + 1) % 3, (i + 2) % 3);
                r[i][j] = f * (m[a][c] * m[b][d] - m[a][d] * m[b][c]);
            }
        }
    }
    r
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let m = [[2.0, 0.3, -0.1], [0.2, 1.5, 0.4], [-0.3, 0.1, 0.9]];
        let p = multiply(&inverse(&m), &m);
        for (r, row) in p.iter().enumerate() {
            for (c, v) in row.iter().enumerate() {
                assert!((v - f64::from(u8::from(r == c))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn lengths_neither_over_nor_underflow_and_zero_has_no_direction() {
        for size in [1e-200, 1.0, 1e200] {
            let a = [2.0 * size, -3.0 * size, 6.0 * size];
            assert!((length(&a) / size - 7.0).abs() < 1e-14);
            assert!(normalized(&a).is_some_and(|n| (norm(&n) - 1.0).abs() < 1e-15));
        }
        assert_eq!(normalized(&[0.0, -0.0]), None);
        assert_eq!(normalized(&[f64::INFINITY, 1.0]), None);
    }

    #[test]
    fn a_cross_product_is_right_handed_and_normal_to_both() {
        assert_eq!(cross(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        let (a, b) = ([1.0, 2.0, 3.0], [-2.0, 0.5, 4.0]);
        assert_eq!(
            (dot(&cross(&a, &b), &a), dot(&cross(&a, &b), &b)),
            (0.0, 0.0)
        );
    }

    #[test]
    fn simple_shear_has_its_own_rate() {
        let mut g = [[0.0; 2]; 2];
        g[0][1] = 3.0;
        assert!((shear_rate(&strain_deviator(&g)) - 3.0).abs() < 1e-14);
    }
}
