//! What particles have at a point: the value there of the straight line (plane) that fits those of the particles around best,
//! weighted with V W. A mean alone would read what is a little above a point near the floor, where half the particles are
//! missing.
//!
//! Symbols: w = V W(|x - x_j|), d = x_j - x, bars means with w, C = mean (d - d_bar)(d - d_bar), b = C^-1 mean (d - d_bar) f;
//! f(x) = f_bar - b . d_bar. Where too few particles tell b, and beyond a free surface, it is left out.

use super::{Validity, View};
use crate::math::{add_outer, apply, determinant, dot, inverse, sub};

/// Shepard sum below which no mean is given: less than a quarter of a lone grain's weight at its own centre.
const DRY: f64 = 0.05;

/// Share of what walls leave free around a place that material has to fill for a line to be trusted there: at a free surface it fills half, a
/// spacing beyond it a tenth, and the line would be drawn out by several times what it is made of.
const BEYOND: f64 = 0.4;

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
    let mut near: Vec<Near<D, N>> = Vec::new();
    view.for_each_particle(at, |j, x, r| {
        let weight = view.volume(j) * view.kernel.w(r);
        weights += weight;
        let is_image = view.geometry.is_axisymmetric() && x[0] < 0.0;
        near.push((weight, sub(&x, at), of(j, is_image)));
    });
    if weights < DRY {
        return Err(Validity::Empty);
    }
    let free = 1.0 - view.solid_around(at).0;
    let mean = mean(&near, weights);
    Ok(match weights < BEYOND * free {
        true => mean.1,
        false => fitted(&near, weights, mean, view.spacing),
    })
}

/// A particle near a place: its weight w, where it lies from there [m], and its values.
type Near<const D: usize, const N: usize> = (f64, [f64; D], [f64; N]);

/// Means of places and values.
fn mean<const D: usize, const N: usize>(near: &[Near<D, N>], weights: f64) -> ([f64; D], [f64; N]) {
    let (mut place, mut mean) = ([0.0; D], [0.0; N]);
    for (w, d, f) in near {
        for a in 0..D {
            place[a] += w / weights * d[a];
        }
        for n in 0..N {
            mean[n] += w / weights * f[n];
        }
    }
    (place, mean)
}

/// Values at d = 0 of the linear fits.
fn fitted<const D: usize, const N: usize>(
    near: &[Near<D, N>],
    weights: f64,
    (place, mean): ([f64; D], [f64; N]),
    spacing: f64,
) -> [f64; N] {
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
    std::array::from_fn(|n| mean[n] - dot(&apply(&unspread, &together[n]), &place))
}
