//! Plane and space geometry for the checks of `lift`: do regions overlap, does a wall cut a body, is a polygon simple.
//!
//! Touching is not overlapping: every test has a tolerance `eps` [m], a small part of the particle spacing.

use crate::scene::Point;

/// A point of the plane [m].
pub(super) type Flat = [f64; 2];

/// A region, as the checks see it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Region {
    /// Planar: the inside of a simple polygon.
    Polygon(Vec<Flat>),
    /// Space: an axis-aligned box.
    Block { lower: Point, upper: Point },
    /// Space: an upright round column.
    Column {
        base: Point,
        radius: f64,
        height: f64,
        /// Only where x and y are beyond the base's.
        quarter: bool,
    },
}

impl Region {
    /// A box, as a polygon in the plane.
    pub(super) fn block(planar: bool, lower: Point, upper: Point) -> Self {
        if planar {
            let ([a, b, _], [c, d, _]) = (lower, upper);
            Self::Polygon(vec![[a, b], [c, b], [c, d], [a, d]])
        } else {
            Self::Block { lower, upper }
        }
    }

    /// Corners of the smallest box around it.
    pub(super) fn bounds(&self) -> (Point, Point) {
        match self {
            Region::Block { lower, upper } => (*lower, *upper),
            Region::Column {
                base: [x, y, z],
                radius: r,
                height,
                quarter,
            } => {
                let back = if *quarter { 0.0 } else { *r };
                ([x - back, y - back, *z], [x + r, y + r, z + height])
            }
            Region::Polygon(points) => {
                let mut lower = [f64::INFINITY, f64::INFINITY, 0.0];
                let mut upper = [f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0];
                for point in points {
                    for axis in 0..2 {
                        lower[axis] = lower[axis].min(point[axis]);
                        upper[axis] = upper[axis].max(point[axis]);
                    }
                }
                (lower, upper)
            }
        }
    }

    /// Area or volume.
    pub(super) fn measure(&self) -> f64 {
        match self {
            Region::Polygon(points) => signed_area(points).abs(),
            Region::Block { lower, upper } => (0..3).map(|a| upper[a] - lower[a]).product(),
            Region::Column {
                radius,
                height,
                quarter,
                ..
            } => {
                let share = if *quarter { 0.25 } else { 1.0 };
                share * std::f64::consts::PI * radius * radius * height
            }
        }
    }

    /// Whether a point lies inside, further than `eps` from the boundary.
    pub(super) fn holds(&self, point: Point, eps: f64) -> bool {
        match self {
            Region::Polygon(points) => strictly_inside(points, [point[0], point[1]], eps),
            Region::Block { lower, upper } => {
                (0..3).all(|a| point[a] > lower[a] + eps && point[a] < upper[a] - eps)
            }
            Region::Column {
                base,
                radius,
                height,
                quarter,
            } => {
                let beyond = |k: usize| !quarter || point[k] > base[k] + eps;
                let away = (point[0] - base[0]).hypot(point[1] - base[1]);
                let up = point[2] - base[2];
                away < radius - eps && up > eps && up < height - eps && beyond(0) && beyond(1)
            }
        }
    }

    /// Whether two regions share more than a boundary.
    pub(super) fn overlaps(&self, other: &Region, eps: f64) -> bool {
        let ((al, au), (bl, bu)) = (self.bounds(), other.bounds());
        let axes = if matches!(self, Region::Polygon(_)) {
            2
        } else {
            3
        };
        if (0..axes).any(|k| al[k] >= bu[k] - eps || bl[k] >= au[k] - eps) {
            return false;
        }
        match (self, other) {
            (Region::Polygon(a), Region::Polygon(b)) => polygons_overlap(a, b, eps),
            (Region::Column { base, radius, .. }, Region::Block { lower, upper })
            | (Region::Block { lower, upper }, Region::Column { base, radius, .. }) => {
                let gap = |k: usize| base[k] - base[k].clamp(lower[k], upper[k].max(lower[k]));
                gap(0).hypot(gap(1)) < radius - eps
            }
            (
                Region::Column { base, radius, .. },
                Region::Column {
                    base: other_base,
                    radius: other_radius,
                    ..
                },
            ) => {
                (base[0] - other_base[0]).hypot(base[1] - other_base[1])
                    < radius + other_radius - eps
            }
            _ => true,
        }
    }
}

/// Area with sign: positive if the corners go round counter-clockwise.
pub(super) fn signed_area(points: &[Flat]) -> f64 {
    edges(points)
        .map(|([ax, ay], [bx, by])| ax * by - bx * ay)
        .sum::<f64>()
        / 2.0
}

/// Edges of a closed polygon.
pub(super) fn edges(points: &[Flat]) -> impl Iterator<Item = (Flat, Flat)> + Clone + '_ {
    (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()]))
}

/// Whether two edges of an outline that are not neighbours cross; gives their indices. `closed`: an edge leads from the last
/// point to the first.
pub(super) fn crossing_edges(points: &[Flat], closed: bool, eps: f64) -> Option<(usize, usize)> {
    let count = points.len();
    let edges = if closed { count } else { count - 1 };
    let edge = |i: usize| (points[i], points[(i + 1) % count]);
    for i in 0..edges {
        for j in i + 2..edges {
            let neighbours = closed && i == 0 && j == count - 1;
            if !neighbours && cross(edge(i), edge(j), eps) {
                return Some((i, j));
            }
        }
    }
    None
}

/// Distance of a point from the line through `a` and `b`, positive on its left.
fn side(a: Flat, b: Flat, point: Flat) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    (dx * (point[1] - a[1]) - dy * (point[0] - a[0])) / dx.hypot(dy)
}

/// Whether two segments cross properly: each has its ends on both sides of the other.
pub(super) fn cross(first: (Flat, Flat), second: (Flat, Flat), eps: f64) -> bool {
    let split = |line: (Flat, Flat), ends: (Flat, Flat)| {
        let (p, q) = (side(line.0, line.1, ends.0), side(line.0, line.1, ends.1));
        (p > eps && q < -eps) || (p < -eps && q > eps)
    };
    split(first, second) && split(second, first)
}

fn strictly_inside(points: &[Flat], point: Flat, eps: f64) -> bool {
    let [x, y] = point;
    let mut inside = false;
    for ([ax, ay], [bx, by]) in edges(points) {
        if distance([ax, ay], [bx, by], point) <= eps {
            return false;
        }
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            inside = !inside;
        }
    }
    inside
}

fn distance(a: Flat, b: Flat, point: Flat) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let along = ((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / square;
    let t = if square > 0.0 {
        along.clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point[0] - a[0] - t * dx).hypot(point[1] - a[1] - t * dy)
}

fn polygons_overlap(a: &[Flat], b: &[Flat], eps: f64) -> bool {
    let crossing = edges(a).any(|e| edges(b).any(|f| cross(e, f, eps)));
    let enters = |p: &[Flat], q: &[Flat]| {
        let middle = |(s, t): (Flat, Flat)| [(s[0] + t[0]) / 2.0, (s[1] + t[1]) / 2.0];
        let mut probes = p.iter().copied().chain(edges(p).map(middle));
        probes.any(|point| strictly_inside(q, point, eps))
            || inner_point(p).is_some_and(|point| strictly_inside(q, point, eps))
    };
    crossing || enters(a, b) || enters(b, a)
}

/// A point well inside a polygon: half way through it on the line half way between two corners' heights.
fn inner_point(points: &[Flat]) -> Option<Flat> {
    let mut heights: Vec<f64> = points.iter().map(|p| p[1]).collect();
    heights.sort_by(f64::total_cmp);
    let gap = heights
        .windows(2)
        .max_by(|v, w| (v[1] - v[0]).total_cmp(&(w[1] - w[0])))?;
    let y = (gap[0] + gap[1]) / 2.0;
    let mut cuts: Vec<f64> = edges(points)
        .filter(|(s, t)| (s[1] > y) != (t[1] > y))
        .map(|(s, t)| s[0] + (y - s[1]) / (t[1] - s[1]) * (t[0] - s[0]))
        .collect();
    cuts.sort_by(f64::total_cmp);
    match cuts[..] {
        [first, second, ..] => Some([(first + second) / 2.0, y]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EPS: f64 = 1e-9;

    fn square(x: f64, y: f64, side: f64) -> Region {
        Region::block(true, [x, y, 0.0], [x + side, y + side, 0.0])
    }

    #[test]
    fn touching_squares_do_not_overlap_and_shifted_or_equal_ones_do() {
        let a = square(0.0, 0.0, 1.0);
        assert!(!a.overlaps(&square(1.0, 0.0, 1.0), EPS));
        assert!(!a.overlaps(&square(1.0, 1.0, 1.0), EPS));
        assert!(a.overlaps(&square(0.5, 0.5, 1.0), EPS));
        assert!(a.overlaps(&square(0.25, 0.25, 0.5), EPS));
        assert!(a.overlaps(&a, EPS));
    }

    #[test]
    fn a_bow_tie_is_not_simple() {
        let tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(crossing_edges(&tie, true, EPS), Some((0, 2)));
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(crossing_edges(&square, true, EPS), None);
        // Open, the last point is joined to nothing.
        let hook = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.5, 1.0], [0.8, -1.0]];
        assert_eq!(crossing_edges(&hook, false, EPS), Some((0, 3)));
        assert_eq!(crossing_edges(&hook[..4], false, EPS), None);
        let back = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
        assert_eq!(crossing_edges(&back, false, EPS), None, "end on start");
    }

    #[test]
    fn columns_and_blocks_meet_at_the_circle_not_at_its_box() {
        let column = Region::Column {
            base: [0.0; 3],
            radius: 1.0,
            height: 1.0,
            quarter: false,
        };
        let block = |x: f64| Region::Block {
            lower: [x, x, 0.0],
            upper: [2.0, 2.0, 1.0],
        };
        assert!(!column.overlaps(&block(0.8), EPS));
        assert!(column.overlaps(&block(0.6), EPS));
    }
}
