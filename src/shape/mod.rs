//! Regions to fill with material: inside tests and bounds. Points are `[x, y, z]`, z = 0 in planar scenes.

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
    },
}
