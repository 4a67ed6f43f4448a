//! Shape and spacing to particle places: a square lattice, first row half a spacing inside the faces; or the same with every
//! other row half a spacing aside.

use super::Shape;
use crate::math::{Vector, dot};

/// Places and the volume each stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Places [m].
    pub points: Vec<[f64; 3]>,
    /// Volume (area in the plane) of one place [m^D].
    pub cell_volume: f64,
}

/// Fills a shape, below a level if given, "up" (an axis or its opposite) and the height along it, in `dimensions` 2 or 3.
///
/// Boxes are filled exactly: their spacing is stretched to a whole number of rows an axis. Other shapes keep the
/// spacing and take the places that lie inside, of rows from `start` on.
///
/// `staggered`: rows across the last axis are moved to and fro by a quarter of a spacing along the others. Rows of a square
/// lattice under load stand on top of each other and slide into the gaps of their neighbours in the end; these lie there.
#[must_use]
pub fn lattice(
    shape: &Shape,
    level: Option<(Vector<3>, f64)>,
    start: [f64; 3],
    spacing: f64,
    dimensions: usize,
    staggered: bool,
) -> Lattice {
    let (mut lower, upper) = bounds_below(shape, level);
    let exact = matches!(shape, Shape::Box { .. });
    if !exact {
        // Of rows below the level's nothing is left.
        lower[..dimensions].copy_from_slice(&start[..dimensions]);
    }
    let (mut count, mut step) = ([1usize; 3], [0.0; 3]);
    for k in 0..dimensions {
        (count[k], step[k]) = rows(upper[k] - lower[k], spacing, exact);
    }
    let last = dimensions - 1;
    // Counted from the origin, so that rows of bodies side by side go on.
    let first_row = (lower[last] / step[last]).round();
    let aside = |row: usize| {
        let odd = (first_row + row as f64).rem_euclid(2.0) == 1.0;
        if odd { 0.25 } else { -0.25 }
    };
    let mut points = Vec::new();
    for c in 0..count[2] {
        for b in 0..count[1] {
            for a in 0..count[0] {
                let mut x = [
                    lower[0] + (a as f64 + 0.5) * step[0],
                    lower[1] + (b as f64 + 0.5) * step[1],
                    if dimensions == 3 {
                        lower[2] + (c as f64 + 0.5) * step[2]
                    } else {
                        0.0
                    },
                ];
                if staggered {
                    for k in 0..last {
                        x[k] += aside([a, b, c][last]) * step[k];
                    }
                }
                let below = level.is_none_or(|(up, height)| dot(&up, &x) < height);
                if below && (exact || shape.contains(&x)) {
                    points.push(x);
                }
            }
        }
    }
    Lattice {
        points,
        cell_volume: step[..dimensions].iter().product(),
    }
}

/// The shape's bounds, but for what lies above a level.
fn bounds_below(shape: &Shape, level: Option<(Vector<3>, f64)>) -> (Vector<3>, Vector<3>) {
    let (mut lower, mut upper) = shape.bounds();
    if let Some((up, height)) = level {
        for k in 0..3 {
            if up[k] > 0.0 {
                upper[k] = upper[k].min(height);
            } else if up[k] < 0.0 {
                lower[k] = lower[k].max(-height);
            }
        }
    }
    (lower, upper)
}

/// How many rows an axis has, and their distance: stretched to a whole number if `exact`, else as many as cover it.
fn rows(extent: f64, spacing: f64, exact: bool) -> (usize, f64) {
    if exact {
        let rows = (extent / spacing).round().max(1.0);
        (rows as usize, extent / rows)
    } else {
        ((extent / spacing).ceil().max(1.0) as usize, spacing)
    }
}
