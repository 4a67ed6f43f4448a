//! In which directions a particle's neighbours lie: what the pair form bears of a linear velocity field (docs/theory.md, E4).
//!
//! gamma_pair^2 = (D + 2) sum w (x.e x)^2/r^2 = (D + 2) e:Q:e with Q_abcd = sum w x_a x_b x_c x_d/r^2. Q_abcc = M_ab, and that much of
//! it is in `moment`; kept is the rest, which is 0 in the plane where neighbours lie evenly all around.
//!
//! Symbols: w = V_j |F|, x = x_i - x_j, theta its direction, e strain rate, M the moment.

use std::ops::{Add, Mul, Sub};

use crate::math::{Tensor, trace};

/// In the plane r^2 cos 4 theta and r^2 sin 4 theta; in space Q of xxyy, xxzz, yyzz, xxxy, xyyy, xxxz, xzzz, yyyz, yzzz.
pub(super) const COUNT: usize = 9;

/// One neighbour's part; `weight` is w/r^2.
#[inline(always)]
pub(super) fn of_neighbour<const D: usize, T>(x: &[T; D], weight: T, zero: T) -> [T; COUNT]
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let mut q = [zero; COUNT];
    if D == 2 {
        let (even, odd) = ((x[0] - x[1]) * (x[0] + x[1]), (x[0] + x[0]) * x[1]);
        q[0] = weight * (even - odd) * (even + odd);
        q[1] = weight * (even + even) * odd;
        return q;
    }
    let squares: [T; D] = std::array::from_fn(|a| x[a] * x[a]);
    for (n, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        let both = weight * (x[a] * x[b]);
        q[n] = both * (x[a] * x[b]);
        q[3 + 2 * n] = both * squares[a];
        q[4 + 2 * n] = both * squares[b];
    }
    q
}

/// (D + 2) e:Q:e from the sums over neighbours [1/s^2]: q, their moment m and a deviator e of the strain rate.
pub(super) fn pair_shear2<const D: usize>(q: &[f64; COUNT], m: &Tensor<D>, e: &Tensor<D>) -> f64 {
    if D == 2 {
        return in_the_plane(q, m, e);
    }
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let mut sum = 0.0;
    // Q of aaaa is what M_aa has more than Q of aabb and aacc, and so on.
    for a in 0..3 {
        let others = pairs.iter().zip(q).filter(|((b, c), _)| *b == a || *c == a);
        let alike = others.fold(m[a][a], |rest, (_, q)| rest - q);
        sum += e[a][a] * e[a][a] * alike;
    }
    let mixed: [f64; 3] = std::array::from_fn(|n| {
        let (a, b) = pairs[n];
        m[a][b] - q[3 + 2 * n] - q[4 + 2 * n]
    });
    for (n, (a, b)) in pairs.into_iter().enumerate() {
        let c = 3 - a - b;
        let slope = e[a][a] * q[3 + 2 * n] + e[b][b] * q[4 + 2 * n] + e[c][c] * mixed[n];
        sum += (2.0 * e[a][a] * e[b][b] + 4.0 * e[a][b] * e[a][b]) * q[n];
        sum += 4.0 * e[a][b] * slope + 8.0 * e[a][c] * e[b][c] * mixed[n];
    }
    (D as f64 + 2.0) * sum
}

/// The same in the plane, a ring's hoop included.
fn in_the_plane<const D: usize>(q: &[f64; COUNT], m: &Tensor<D>, e: &Tensor<D>) -> f64 {
    // e = t/2 I + [[a, b], [b, -a]], and x.e x = t r^2/2 + r^2 (a cos 2 theta + b sin 2 theta).
    let t = trace(e);
    let (a, b) = (0.5 * (e[0][0] - e[1][1]), e[0][1]);
    let [even, odd, ..] = q;
    let round = (0.5 * t * t + a * a + b * b) * trace(m);
    let twofold = t * (a * (m[0][0] - m[1][1]) + 2.0 * b * m[0][1]);
    // The hoop's own rate is -t.
    2.0 * (round + (a * a - b * b) * even + 2.0 * a * b * odd) + 4.0 * twofold + t * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{apply, dot};

    #[test]
    fn any_strain_of_any_neighbours_is_what_their_sum_says() {
        fn check<const D: usize>(points: &[[f64; D]], e: &Tensor<D>) {
            let (mut q, mut m, mut exact) = ([0.0; COUNT], [[0.0; D]; D], 0.0);
            for (n, x) in points.iter().enumerate() {
                let w = 1.0 + 0.3 * n as f64;
                let weight = w / dot(x, x);
                let part = of_neighbour(x, weight, 0.0);
                q.iter_mut().zip(part).for_each(|(q, part)| *q += part);
                for a in 0..D {
                    for b in 0..D {
                        m[a][b] += w * x[a] * x[b];
                    }
                }
                exact += (D as f64 + 2.0) * weight * dot(x, &apply(e, x)).powi(2);
            }
            let found = pair_shear2(&q, &m, e);
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} for {exact}");
        }
        let e = [[0.3, -0.7, 0.2], [-0.7, 0.5, 1.1], [0.2, 1.1, -0.8]];
        let points = [
            [1.0, 0.2, -0.4],
            [-0.3, 0.9, 0.5],
            [0.1, -0.6, 1.2],
            [0.7, 0.7, 0.1],
        ];
        check(&points, &e);
        let flat = points.map(|[x, y, _]| [x, y]);
        check(&flat, &[[0.4, 0.9], [0.9, -0.4]]);
    }
}
