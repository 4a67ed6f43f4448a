//! Where the lattices of shapes that meet begin: a slanted or bent seam between two of them has neither gaps nor pairs of places too near
//! each other if the rows of one go on in the other.
//!
//! Along each axis a shape that stands on another begins in the rows of that one, any other at its own lower face. Boxes, whose rows are
//! stretched to fit, do so always.

use super::{Lattice, Shape, lattice};
use crate::math::Vector;

/// A shape, and "up" and the height along it up to which it is filled.
pub type Fill<'a> = (&'a Shape, Option<(Vector<3>, f64)>);

/// Rounding of a row's place, over the spacing [1].
const ROUNDING: f64 = 1e-6;

/// The lattices of shapes that may touch, as [`lattice`] has them of each.
#[must_use]
pub fn lattices(fills: &[Fill], spacing: f64, dimensions: usize, staggered: bool) -> Vec<Lattice> {
    let alone = |fill: &Fill| {
        lattice(
            fill.0,
            fill.1,
            fill.0.bounds().0,
            spacing,
            dimensions,
            false,
        )
    };
    // Boxes stand on nothing, nor does what is alone.
    let asks = |fill: &&Fill| fills.len() > 1 && !matches!(fill.0, Shape::Box { .. });
    let own = |fill: &Fill| Some(fill).filter(asks).map(alone);
    let own: Vec<Option<Lattice>> = fills.iter().map(own).collect();
    let below = |n: usize, axis: usize| {
        let own = own[n].as_ref()?;
        stands_on(fills, own, (n, axis), spacing)
    };
    let start = |n: usize| {
        let mut start = fills[n].0.bounds().0;
        for (axis, start) in start.iter_mut().enumerate().take(dimensions) {
            let foot = foot_of(n, fills.len(), |n| below(n, axis));
            let rows = (*start - fills[foot].0.bounds().0[axis]) / spacing;
            let into = rows - (rows + ROUNDING).floor();
            if into.abs() > ROUNDING {
                *start -= into * spacing;
            }
        }
        start
    };
    let fill = |n: usize| {
        let (shape, level) = &fills[n];
        lattice(shape, *level, start(n), spacing, dimensions, staggered)
    };
    (0..fills.len()).map(fill).collect()
}

/// The shape at the foot of those that stand on each other; the shape itself where they go round.
fn foot_of(n: usize, most: usize, below: impl Fn(usize) -> Option<usize>) -> usize {
    let mut foot = n;
    for _ in 0..most {
        match below(foot) {
            Some(next) => foot = next,
            None => return foot,
        }
    }
    n
}

/// The shape that lies a spacing below most of the lowest places of shape n along an axis.
fn stands_on(
    fills: &[Fill],
    own: &Lattice,
    (n, axis): (usize, usize),
    spacing: f64,
) -> Option<usize> {
    let lowest = own
        .points
        .iter()
        .fold(f64::INFINITY, |low, x| low.min(x[axis]));
    let mut counts = vec![0usize; fills.len()];
    for x in own
        .points
        .iter()
        .filter(|x| x[axis] < lowest + 0.5 * spacing)
    {
        let mut x = *x;
        x[axis] -= spacing;
        let other = |m: &usize| *m != n && fills[*m].0.contains(&x);
        if let Some(m) = (0..fills.len()).find(other) {
            counts[m] += 1;
        }
    }
    let best = (0..fills.len()).max_by_key(|m| (counts[*m], usize::MAX - *m))?;
    let is_box = matches!(fills[best].0, Shape::Box { .. });
    (counts[best] > 0 && !is_box).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tank of two polygons: every cell of the tank is one place of one of them, wherever the seam ends.
    #[test]
    fn a_slanted_seam_has_no_gaps() {
        for end in [0.15, 0.1575, 0.16, 0.165] {
            for flip in [false, true] {
                let low = vec![[0.0, 0.0], [0.8, 0.0], [0.8, end], [0.0, 0.24]];
                let high = vec![[0.0, 0.24], [0.8, end], [0.8, 0.4], [0.0, 0.4]];
                let (a, b) = if flip { (high, low) } else { (low, high) };
                let (a, b) = (Shape::Polygon { points: a }, Shape::Polygon { points: b });
                let found = lattices(&[(&a, None), (&b, None)], 0.02, 2, false);
                let count: usize = found.iter().map(|l| l.points.len()).sum();
                assert_eq!(count, 800, "seam to {end}");
            }
        }
    }

    #[test]
    fn what_stands_on_a_floor_begins_there() {
        let bed = Shape::Polygon {
            points: vec![[0.0, 0.005], [1.0, 0.005], [1.0, 0.305], [0.0, 0.2]],
        };
        let other = Shape::Polygon {
            points: vec![[2.0, 0.013], [3.0, 0.013], [2.5, 0.5]],
        };
        let found = lattices(&[(&other, None), (&bed, None)], 0.02, 2, false);
        let low = |l: &Lattice| l.points.iter().fold(1.0, |low: f64, x| low.min(x[1]));
        assert!((low(&found[0]) - 0.023).abs() < 1e-12);
        assert!((low(&found[1]) - 0.015).abs() < 1e-12);
    }
}
