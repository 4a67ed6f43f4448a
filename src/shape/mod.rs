//! Rank 1: regions to fill with material: inside tests, bounds, lattices. Points are `[x, y, z]`, z = 0 in planar scenes.

mod align;
mod fill;
mod measure;

pub use align::{Fill, lattices};
pub use fill::{Lattice, lattice};
pub use measure::cut_below;

/// A region of space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An axis-aligned box.
    Box {
        /// Lower corner [m].
        lower: [f64; 3],
        /// Upper corner [m].
        upper: [f64; 3],
    },
    /// Planar: the inside of a simple polygon.
    Polygon {
        /// Corners in order, at least three [m].
        points: Vec<[f64; 2]>,
    },
    /// Space: an upright round column.
    Column {
        /// Centre of the base [m].
        base: [f64; 3],
        /// Radius [m].
        radius: f64,
        /// Height along z [m].
        height: f64,
        /// Only the quarter where x and y are beyond the base's centre.
        quarter: bool,
    },
}

impl Shape {
    /// Lower and upper corner of its bounding box [m].
    #[must_use]
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        match self {
            Shape::Box { lower, upper } => (*lower, *upper),
            Shape::Polygon { points } => {
                let mut low = [f64::INFINITY, f64::INFINITY, 0.0];
                let mut high = [f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0];
                for p in points {
                    for k in 0..2 {
                        low[k] = low[k].min(p[k]);
                        high[k] = high[k].max(p[k]);
                    }
                }
                (low, high)
            }
            Shape::Column {
                base,
                radius,
                height,
                quarter,
            } => {
                let back = if *quarter { 0.0 } else { *radius };
                (
                    [base[0] - back, base[1] - back, base[2]],
                    [base[0] + radius, base[1] + radius, base[2] + height],
                )
            }
        }
    }

    /// Whether a point lies inside (planar scenes: z is ignored for polygons and boxes without depth).
    #[must_use]
    pub fn contains(&self, x: &[f64; 3]) -> bool {
        match self {
            Shape::Box { lower, upper } => (0..3)
                .all(|k| (x[k] >= lower[k] && x[k] < upper[k]) || (k == 2 && lower[2] == upper[2])),
            Shape::Polygon { points } => {
                // Even-odd rule.
                let n = points.len();
                (0..n).fold(false, |inside, i| {
                    let (a, b) = (points[i], points[(i + 1) % n]);
                    let spans = (a[1] > x[1]) != (b[1] > x[1]);
                    let crosses =
                        spans && x[0] < (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]) + a[0];
                    inside != crosses
                })
            }
            Shape::Column {
                base,
                radius,
                height,
                quarter,
            } => {
                let (dx, dy) = (x[0] - base[0], x[1] - base[1]);
                (!quarter || (dx >= 0.0 && dy >= 0.0))
                    && dx * dx + dy * dy <= radius * radius
                    && x[2] >= base[2]
                    && x[2] < base[2] + height
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_contains_its_centre_and_not_its_corner_box() {
        let t = Shape::Polygon {
            points: vec![[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]],
        };
        assert!(t.contains(&[0.6, 0.6, 0.0]));
        assert!(!t.contains(&[1.5, 1.5, 0.0]));
    }

    #[test]
    fn four_quarters_make_a_column() {
        let column = |quarter| Shape::Column {
            base: [1.0, 2.0, 0.0],
            radius: 0.5,
            height: 0.3,
            quarter,
        };
        let count = |quarter| {
            lattice(
                &column(quarter),
                None,
                column(quarter).bounds().0,
                0.05,
                3,
                false,
            )
            .points
            .len()
        };
        assert_eq!(4 * count(true), count(false));
        assert_eq!(column(true).bounds().0, [1.0, 2.0, 0.0]);
        assert!(
            !column(true).contains(&[0.9, 2.1, 0.1]) && column(false).contains(&[0.9, 2.1, 0.1])
        );
    }

    #[test]
    fn a_box_is_filled_to_its_volume() {
        let shape = Shape::Box {
            lower: [0.0; 3],
            upper: [0.2, 0.1, 0.0],
        };
        for staggered in [false, true] {
            let l = lattice(&shape, None, shape.bounds().0, 0.0049, 2, staggered);
            assert!((l.cell_volume * l.points.len() as f64 - 0.02).abs() < 1e-15);
        }
    }

    #[test]
    fn a_level_is_a_height_along_up_whichever_way_that_is() {
        let square = Shape::Box {
            lower: [-0.2, -0.1, 0.0],
            upper: [0.0, 0.1, 0.0],
        };
        let filled = |up, level| {
            let l = lattice(
                &square,
                Some((up, level)),
                square.bounds().0,
                0.004,
                2,
                false,
            );
            l.cell_volume * l.points.len() as f64
        };
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 0.03, "{a} for {b}");
        close(filled([0.0, 1.0, 0.0], 0.02), 0.2 * 0.12);
        close(filled([0.0, -1.0, 0.0], 0.02), 0.2 * 0.12);
        close(filled([-1.0, 0.0, 0.0], 0.05), 0.05 * 0.2);
    }

    #[test]
    fn staggered_rows_lie_half_a_spacing_aside_and_go_on_from_body_to_body() {
        let places = |lower: f64, upper: f64| {
            let shape = Shape::Box {
                lower: [0.0, lower, 0.0],
                upper: [0.4, upper, 0.0],
            };
            lattice(&shape, None, shape.bounds().0, 0.1, 2, true).points
        };
        let whole = places(-0.3, 0.2);
        let parts = [places(-0.3, -0.1), places(-0.1, 0.2)].concat();
        for (a, b) in whole.iter().zip(&parts) {
            assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
        }
        assert!(((whole[4][0] - whole[0][0]).abs() - 0.05).abs() < 1e-12);
        assert!(whole.iter().all(|x| x[0] > 0.02 && x[0] < 0.38));
    }
}
