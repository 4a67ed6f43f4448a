//! Room that devices take: before the face of an inflow, behind the face of a gate in space.

use super::geometry::Region;
use crate::math::{cross, length, normalized, sub};
use crate::scene::types::{Gate, Point};

/// Most places looked at along an edge: more would tell no more of walls and bodies that are wider than this part of it.
const MOST: f64 = 100.0;

/// The face of an inflow and the row of particles before it.
pub(super) struct Face {
    from: Point,
    to: Point,
    span: Point,
    /// Unit vector along the velocity.
    way: Point,
    spacing: f64,
}

impl Face {
    /// A face that rows leave along the unit vector `way`.
    pub(super) fn new([from, to, span]: [Point; 3], way: Point, spacing: f64) -> Self {
        Self {
            from,
            to,
            span,
            way,
            spacing,
        }
    }

    /// Planar: the outline of the face and of the room before it, past the middles of the row. The far side is shorter than
    /// the face, so that a slanting velocity does not reach into walls beside it.
    pub(super) fn outline(&self) -> Option<Region> {
        if self.span != [0.0; 3] {
            return None;
        }
        let depth = 0.75 * self.spacing;
        let edge = normalized(&sub(&self.to, &self.from))?;
        let flat = |x: Point| [x[0], x[1]];
        let far = |end: Point, side: f64| {
            let at = |k: usize| end[k] + depth * (side * edge[k] + self.way[k]);
            [at(0), at(1)]
        };
        Some(Region::Polygon(vec![
            flat(self.from),
            flat(self.to),
            far(self.to, -1.0),
            far(self.from, 1.0),
        ]))
    }

    /// Corners of the face.
    pub(super) fn corners(&self) -> impl Iterator<Item = Point> + '_ {
        let far = |x: Point| std::array::from_fn(|k| x[k] + self.span[k]);
        [self.from, self.to, far(self.from), far(self.to)].into_iter()
    }

    /// Places of the row, about a spacing apart.
    pub(super) fn row(&self) -> impl Iterator<Item = Point> {
        let ahead = 0.5 * self.spacing;
        let start: Point = std::array::from_fn(|k| self.from[k] + ahead * self.way[k]);
        lattice(start, [sub(&self.to, &self.from), self.span], self.spacing)
    }
}

/// A span as it may be written for a face that has none: as long as the edge and across it, and such that `velocity` leaves
/// the face of an inflow.
pub(super) fn example_of_span(
    from: Option<Point>,
    to: Option<Point>,
    velocity: Option<Point>,
) -> String {
    let edge = from.zip(to).map(|(from, to)| sub(&to, &from));
    let across = |edge: &Point, way: Point| normalized(&cross(&way, edge));
    // Along y where nothing else is asked for; to the side of an edge along y.
    let ways = [
        velocity.unwrap_or([0.0; 3]),
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
    ];
    let fits = edge.and_then(|edge| {
        let unit = ways.into_iter().find_map(|way| across(&edge, way))?;
        let size = length(&edge);
        // To micrometres, and without the sign of a zero.
        Some(unit.map(|c| (c * size * 1e6).round() / 1e6 + 0.0))
    });
    let [x, y, z] = fits.unwrap_or([0.0, 0.1, 0.0]);
    format!("span = [{x}, {y}, {z}]")
}

/// Places in the plate of a gate in space where it covers its gap at the start, about a spacing apart, the first layer half
/// a spacing behind its face.
pub(super) fn plate_places(gate: &Gate, spacing: f64) -> Vec<Point> {
    let edge = sub(&gate.to, &gate.from);
    let Some(back) = normalized(&cross(&edge, &gate.span)) else {
        return Vec::new();
    };
    if gate.start >= 1.0 {
        return Vec::new();
    }
    let covered = edge.map(|c| (1.0 - gate.start) * c);
    let layers = (gate.thickness / spacing).round().clamp(1.0, 8.0);
    let layer = |i: usize| {
        let deep = (i as f64 + 0.5) * spacing;
        let start = std::array::from_fn(|k| gate.from[k] + gate.start * edge[k] + deep * back[k]);
        lattice(start, [covered, gate.span], spacing)
    };
    (0..layers as usize).flat_map(layer).collect()
}

/// Middles of the cells of a parallelogram.
fn lattice(start: Point, [first, second]: [Point; 2], spacing: f64) -> impl Iterator<Item = Point> {
    let count = |edge: Point| (length(&edge) / spacing).round().clamp(1.0, MOST);
    let (along, wide) = (count(first), count(second));
    (0..along as usize).flat_map(move |i| {
        (0..wide as usize).map(move |m| {
            let (s, t) = ((i as f64 + 0.5) / along, (m as f64 + 0.5) / wide);
            std::array::from_fn(|k| start[k] + s * first[k] + t * second[k])
        })
    })
}
