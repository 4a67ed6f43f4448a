//! Shape and spacing to particle places: a square lattice, first row half a spacing inside the faces.

use super::Shape;

/// Places and the volume each stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Places [m].
    pub points: Vec<[f64; 3]>,
    /// Volume (area in the plane) of one place [m^D].
    pub cell_volume: f64,
}

/// Fills a shape, below `level` on an axis if given, in `dimensions` 2 or 3.
///
/// Boxes are filled exactly: their spacing is stretched to a whole number of rows an axis. Other shapes keep the
/// spacing and take the places that lie inside.
#[must_use]
pub fn lattice(
    shape: &Shape,
    level: Option<(usize, f64)>,
    spacing: f64,
    dimensions: usize,
) -> Lattice {
    let (lower, mut upper) = shape.bounds();
    if let Some((axis, height)) = level {
        upper[axis] = upper[axis].min(height);
    }
    let exact = matches!(shape, Shape::Box { .. });
    let mut count = [1usize; 3];
    let mut step = [0.0; 3];
    for k in 0..dimensions {
        let rows = ((upper[k] - lower[k]) / spacing).round().max(1.0);
        count[k] = if exact {
            rows as usize
        } else {
            ((upper[k] - lower[k]) / spacing).ceil().max(1.0) as usize
        };
        step[k] = if exact {
            (upper[k] - lower[k]) / rows
        } else {
            spacing
        };
    }
    let mut points = Vec::new();
    for c in 0..count[2] {
        for b in 0..count[1] {
            for a in 0..count[0] {
                let x = [
                    lower[0] + (a as f64 + 0.5) * step[0],
                    lower[1] + (b as f64 + 0.5) * step[1],
                    if dimensions == 3 {
                        lower[2] + (c as f64 + 0.5) * step[2]
                    } else {
                        0.0
                    },
                ];
                let below = level.is_none_or(|(axis, height)| x[axis] < height);
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
