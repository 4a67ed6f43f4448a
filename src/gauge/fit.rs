//! What particles have at a point: the value there of the straight line (plane) that fits those of the particles around best,
//! weighted with V W. A mean alone would read what is a little above a point near the floor, where half the particles are
//! missing.
//!
//! Symbols: w = V W(|x - x_j|), d = x_j - x, bars means with w, C = mean (d - d_bar)(d - d_bar), b = C^-1 mean (d - d_bar) f;
//! f(x) = f_bar - b . d_bar. Where too few particles tell b, or all lie far on one side, it is left out.

use super::{Validity, View};
use crate::math::{add_outer, apply, determinant, dot, inverse, sub};

/// Shepard sum below which no mean is given: less than a quarter of a lone grain's weight at its own centre.
const DRY: f64 = 0.05;

/// Square of the distance from the particles' mean, over their spread along the way to it, beyond which a line is not trusted. Between the
/// floor and the first row it is about 1, at a place that the first particles come to 10.
const FURTHEST: f64 = 4.0;

/// Values at a place, of what `of` says of a particle, and of a ring's image across the axis if it is true.
///
/// # Errors
/// Why there are none: outside, blocked, empty.
pub(super) fn fit_at<const D: usize, const N: usize>(
    view: &View<D>,
    at: &[f64; D],
    of: impl Fn(usize, bool) -> [f64; N],
) -> Result<[f64; N], Validity> {
    if view.is_outside(at) {
        return Err(Validity::Outside);
    }
    // Walls are hollow deep inside, and corners between walls that meet are behind neither.
    if view.is_inside(at) || view.is_covered(at) {
        return Err(Validity::Blocked);
    }
    let mut weights = 0.0;
    let mut near: Vec<(f64, [f64; D], [f64; N])> = Vec::new();
    view.for_each_particle(at, |j, x, r| {
        let weight = view.volume(j) * view.kernel.w(r);
        weights += weight;
        let is_image = view.geometry.is_axisymmetric() && x[0] < 0.0;
        near.push((weight, sub(&x, at), of(j, is_image)));
    });
    if weights < DRY {
        return Err(Validity::Empty);
    }
    Ok(fitted(&near, weights, view.spacing))
}

/// Values at d = 0 of the linear fits to rows of weight, place d [m] and values.
fn fitted<const D: usize, const N: usize>(
    near: &[(f64, [f64; D], [f64; N])],
    weights: f64,
    spacing: f64,
) -> [f64; N] {
    let (mut place, mut mean) = ([0.0; D], [0.0; N]);
    for (w, d, f) in near {
        for a in 0..D {
            place[a] += w / weights * d[a];
        }
        for n in 0..N {
            mean[n] += w / weights * f[n];
        }
    }
    let (mut spread, mut together) = ([[0.0; D]; D], [[0.0; D]; N]);
    for (w, d, f) in near {
        let d = sub(d, &place);
        add_outer(&mut spread, w / weights, &d, &d);
        for (n, together) in together.iter_mut().enumerate() {
            for a in 0..D {
                together[a] += w / weights * d[a] * (f[n] - mean[n]);
            }
        }
    }
    // Of a filled support the determinant is about (0.6 dp)^2D; a row along one line has none.
    if determinant(&spread) < (0.04 * spacing * spacing).powi(D as i32) {
        return mean;
    }
    let unspread = inverse(&spread);
    if dot(&place, &apply(&unspread, &place)) > FURTHEST {
        return mean;
    }
    std::array::from_fn(|n| mean[n] - dot(&apply(&unspread, &together[n]), &place))
}
