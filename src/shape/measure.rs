//! Area and volume of shapes, of whole bodies of revolution where a section stands for rings.

use std::f64::consts::{PI, TAU};

use super::Shape;
use crate::math::{Vector, dot};

impl Shape {
    /// Area in the plane [m^2], volume in space and of what a section sweeps about the axis x = 0 as `rings` [m^3]: of the part
    /// below a level if given, "up" (an axis or its opposite) and the height along it. `None` for a column that a level cuts
    /// lengthwise.
    #[must_use]
    pub fn measure(
        &self,
        level: Option<(Vector<3>, f64)>,
        dimensions: usize,
        rings: bool,
    ) -> Option<f64> {
        match self {
            Shape::Box { lower, upper } if dimensions == 3 => {
                let (mut lower, mut upper) = (*lower, *upper);
                if let Some((up, height)) = level {
                    for k in 0..3 {
                        if up[k] > 0.5 {
                            upper[k] = upper[k].min(height);
                        } else if up[k] < -0.5 {
                            lower[k] = lower[k].max(-height);
                        }
                    }
                }
                Some((0..3).map(|k| upper[k] - lower[k]).product())
            }
            Shape::Box { lower, upper } => {
                let ([a, b, _], [c, d, _]) = (*lower, *upper);
                Some(section(&[[a, b], [c, b], [c, d], [a, d]], level, rings))
            }
            Shape::Polygon { points } => Some(section(points, level, rings)),
            Shape::Column {
                base,
                radius,
                height,
                quarter,
            } => {
                let top = base[2] + height;
                let tall = match level {
                    Some((up, level)) if up[2] > 0.5 => top.min(level) - base[2],
                    Some((up, level)) if up[2] < -0.5 => top - base[2].max(-level),
                    Some((up, level)) if dot(&up, &[base[0], base[1], top]) + radius > level => {
                        return None;
                    }
                    _ => *height,
                };
                let share = if *quarter { 0.25 } else { 1.0 };
                Some(share * PI * radius * radius * tall)
            }
        }
    }
}

/// Area of a polygon's part below a level, or the volume that it sweeps.
fn section(points: &[[f64; 2]], level: Option<(Vector<3>, f64)>, rings: bool) -> f64 {
    let cut = match level {
        Some((up, height)) => cut_below(points, [up[0], up[1]], height),
        None => points.to_vec(),
    };
    let edges = (0..cut.len()).map(|i| (cut[i], cut[(i + 1) % cut.len()]));
    let sum: f64 = edges
        .map(|(a, b)| {
            let twice = a[0] * b[1] - b[0] * a[1];
            // Of the triangle with the origin: its area, times 2 pi and the radius of its centre.
            let along = if rings {
                TAU * (a[0] + b[0]) / 3.0
            } else {
                1.0
            };
            0.5 * twice * along
        })
        .sum();
    sum.abs()
}

/// The part of a polygon with `direction` . x <= `level`.
#[must_use]
pub fn cut_below(points: &[[f64; 2]], direction: [f64; 2], level: f64) -> Vec<[f64; 2]> {
    let height = |p: [f64; 2]| p[0] * direction[0] + p[1] * direction[1] - level;
    let mut kept = Vec::new();
    for (i, &s) in points.iter().enumerate() {
        let t = points[(i + 1) % points.len()];
        let (hs, ht) = (height(s), height(t));
        if hs <= 0.0 {
            kept.push(s);
        }
        if (hs <= 0.0) != (ht <= 0.0) {
            let share = hs / (hs - ht);
            kept.push([s[0] + share * (t[0] - s[0]), s[1] + share * (t[1] - s[1])]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const Y: Vector<3> = [0.0, 1.0, 0.0];
    const Z: Vector<3> = [0.0, 0.0, 1.0];

    fn close(found: Option<f64>, expected: f64) {
        let found = found.unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{found} for {expected}"
        );
    }

    #[test]
    fn cutting_a_square_at_a_level_leaves_the_part_below() {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let square = Shape::Polygon {
            points: points.to_vec(),
        };
        close(square.measure(Some((Y, 0.5)), 2, false), 1.0);
        close(square.measure(None, 2, false), 4.0);
        close(
            square.measure(Some(([0.0, -1.0, 0.0], -0.5)), 2, false),
            3.0,
        );
    }

    #[test]
    fn sections_sweep_cones_and_tubes() {
        let cone = Shape::Polygon {
            points: vec![[0.0, 0.0], [0.3, 0.0], [0.0, 0.6]],
        };
        close(cone.measure(None, 2, true), PI * 0.3 * 0.3 * 0.6 / 3.0);
        let half = PI * 0.3 * 0.3 * 0.6 / 3.0 * (1.0 - 0.125);
        close(cone.measure(Some((Y, 0.3)), 2, true), half);
        let tube = Shape::Box {
            lower: [0.1, 0.0, 0.0],
            upper: [0.2, 0.5, 0.0],
        };
        close(tube.measure(None, 2, true), PI * (0.04 - 0.01) * 0.5);
    }

    #[test]
    fn columns_are_round_and_end_at_a_level() {
        let column = |quarter| Shape::Column {
            base: [0.0, 0.0, 0.1],
            radius: 0.2,
            height: 0.4,
            quarter,
        };
        close(column(false).measure(None, 3, false), PI * 0.04 * 0.4);
        close(
            column(true).measure(Some((Z, 0.2)), 3, false),
            0.25 * PI * 0.04 * 0.1,
        );
        assert_eq!(
            column(false).measure(Some(([1.0, 0.0, 0.0], 0.1)), 3, false),
            None
        );
        let block = Shape::Box {
            lower: [0.0; 3],
            upper: [1.0, 2.0, 3.0],
        };
        close(block.measure(Some((Z, 1.5)), 3, false), 3.0);
    }
}
