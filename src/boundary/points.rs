//! Where wall points lie: rows behind polylines.

use super::tips::Tip;
use crate::math::{add, dot, norm, scale, sub};

/// Rows of points behind a wall's surface: enough for a support of 2 h at h/dp <= 2.
pub const ROWS: usize = 4;

/// (position, normal, weight) of the points behind a polyline with the material on its left.
///
/// Row k is the polyline moved (k + 1/2) dp to the right with mitred corners; points sit on the corners and evenly
/// between them, half a spacing from free ends. Their weight is the actual spacing over dp. The first row has none on acute
/// corners of the wall's body: those of [`super::tip_points`] stand for it.
#[must_use]
pub fn polyline_points(
    corners: &[[f64; 2]],
    closed: bool,
    spacing: f64,
) -> Vec<([f64; 2], [f64; 2], f64)> {
    joined_points(corners, closed, [None; 2], spacing)
}

/// As [`polyline_points`] of an open polyline whose ends other ones go on from: `joints` are the directions in which another
/// arrives at its first point and leaves its last one. There it is mitred like at its own corners.
#[must_use]
pub fn joined_points(
    corners: &[[f64; 2]],
    closed: bool,
    joints: [Option<[f64; 2]>; 2],
    spacing: f64,
) -> Vec<([f64; 2], [f64; 2], f64)> {
    let polyline = Polyline {
        corners,
        closed,
        joints,
    };
    let mut points = Vec::new();
    for row in 0..ROWS {
        for s in 0..polyline.segments() {
            polyline.add_segment(s, row, spacing, &mut points);
        }
    }
    points
}

/// A wall's surface in the plane.
pub(super) struct Polyline<'a> {
    pub corners: &'a [[f64; 2]],
    pub closed: bool,
    /// Directions of what goes on from its ends: see [`joined_points`].
    pub joints: [Option<[f64; 2]>; 2],
}

/// Normal of a direction, to its right.
pub(super) fn right(t: &[f64; 2]) -> [f64; 2] {
    [t[1], -t[0]]
}

impl Polyline<'_> {
    pub(super) fn segments(&self) -> usize {
        let n = self.corners.len();
        if self.closed { n } else { n - 1 }
    }

    /// From start to end of segment s.
    fn way(&self, s: usize) -> [f64; 2] {
        let n = self.corners.len();
        sub(&self.corners[(s + 1) % n], &self.corners[s % n])
    }

    /// Unit direction of segment s.
    fn tangent(&self, s: usize) -> [f64; 2] {
        let d = self.way(s);
        scale(1.0 / norm(&d), &d)
    }

    /// Directions in which its sides arrive at corner c and leave it.
    pub(super) fn sides(&self, c: usize) -> [Option<[f64; 2]>; 2] {
        self.sides_at(c).map(|side| side.map(|(t, _)| t))
    }

    /// Direction and length of what arrives at corner c and of what leaves it; no length is told of what goes on from an end.
    pub(super) fn sides_at(&self, c: usize) -> [Option<([f64; 2], f64)>; 2] {
        let segments = self.segments();
        let side = |s: usize| Some((self.tangent(s), norm(&self.way(s))));
        let joint = |j: usize| self.joints[j].map(|t| (t, f64::INFINITY));
        let before = if c > 0 || self.closed {
            side((c + segments - 1) % segments)
        } else {
            joint(0)
        };
        let after = if c < segments || self.closed {
            side(c % segments)
        } else {
            joint(1)
        };
        [before, after]
    }

    /// Corner c moved to the row at this depth [m]: the two neighbouring rows meet there.
    fn moved(&self, c: usize, depth: f64) -> [f64; 2] {
        let corner = &self.corners[c % self.corners.len()];
        match self.sides(c) {
            [Some(a), Some(b)] => {
                let (ra, rb) = (right(&a), right(&b));
                let m = add(&ra, &rb);
                // Limited where they go round the outside of a hairpin, so that they do not shoot out.
                let least = if self.tip(c).is_some() { 0.0 } else { 0.25 };
                let f = 2.0 / dot(&m, &m).max(least);
                add(corner, &scale(depth * f, &m))
            }
            [Some(a), None] => add(corner, &scale(depth, &right(&a))),
            [None, Some(b)] => add(corner, &scale(depth, &right(&b))),
            [None, None] => *corner,
        }
    }

    /// How far from corner c the row at this depth ends [m] where the other side of an acute corner is too short to have one: no
    /// further back than that side reaches.
    fn cut(&self, c: usize, depth: f64) -> Option<f64> {
        let Tip { slope, leg, .. } = self.tip(c)?;
        (depth > leg * slope).then_some(leg)
    }

    /// Adds the points of segment s in this row.
    fn add_segment(
        &self,
        s: usize,
        row: usize,
        spacing: f64,
        points: &mut Vec<([f64; 2], [f64; 2], f64)>,
    ) {
        let depth = (row as f64 + 0.5) * spacing;
        let t = self.tangent(s);
        let n = self.corners.len();
        let cuts = [s, s + 1].map(|c| self.cut(c, depth));
        let end = |c: usize, cut: Option<f64>, way: f64| {
            cut.map_or_else(
                || self.moved(c, depth),
                |leg| {
                    let along = add(&self.corners[c % n], &scale(way * leg, &t));
                    add(&along, &scale(depth, &right(&t)))
                },
            )
        };
        let (a, b) = (end(s, cuts[0], 1.0), end(s + 1, cuts[1], -1.0));
        let length = dot(&sub(&b, &a), &t);
        let open = |end: usize| !self.closed && self.joints[end].is_none();
        let free_start = (s == 0 && open(0)) || cuts[0].is_some();
        let free_end = (s + 1 == self.segments() && open(1)) || cuts[1].is_some();
        // Half a spacing is left out at a free end; a joint's point belongs to the segment that starts
        // there, and where walls go straight on pushes both (`joints`).
        let ends = 0.5 * (f64::from(u8::from(free_start)) + f64::from(u8::from(free_end)));
        let count = (length / spacing + 1.0 - ends).round();
        let is_cut = cuts.iter().any(Option::is_some);
        if count < 1.0 || length <= 0.0 || (is_cut && length < 0.5 * spacing) {
            return;
        }
        let step = length / (count - 1.0 + ends).max(1.0);
        let first = if free_start { 0.5 * step } else { 0.0 };
        let shared_end = !free_end;
        let has_tip = row == 0 && !free_start && self.tip(s).is_some();
        let normal = scale(-1.0, &right(&t));
        let count = count as usize;
        for k in usize::from(has_tip)..count {
            if shared_end && k + 1 == count && count > 1 {
                break;
            }
            points.push((
                add(&a, &scale(first + k as f64 * step, &t)),
                normal,
                step / spacing,
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_corner_continues_the_square_lattice() {
        // Material above the floor and to the right of the left wall.
        let points = polyline_points(&[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]], false, 0.1);
        for (x, _, w) in &points {
            assert!((w - 1.0).abs() < 1e-9);
            for c in x {
                let q = (c / 0.1 - 0.5).rem_euclid(1.0);
                assert!((q - q.round()).abs() < 1e-9, "{x:?}");
            }
        }
        // 10 along each leg in 4 rows, and the 4 x 4 corner.
        assert_eq!(points.len(), 4 * 10 * 2 + 16);
    }

    /// A floor that is one wall and a side that is another make the corner that one wall of both makes.
    #[test]
    fn two_walls_that_meet_make_a_whole_corner() {
        let sorted = |mut points: Vec<[f64; 2]>| {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            points
        };
        let (side, floor) = ([[0.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]]);
        let one = polyline_points(&[side[0], side[1], floor[1]], false, 0.1);
        let one = sorted(one.into_iter().map(|p| p.0).collect());
        let mut two = joined_points(&side, false, [None, Some([1.0, 0.0])], 0.1);
        two.extend(joined_points(&floor, false, [Some([0.0, -1.0]), None], 0.1));
        let two = sorted(two.into_iter().map(|p| p.0).collect());
        assert_eq!(one.len(), two.len());
        for (a, b) in one.iter().zip(&two) {
            assert!(norm(&sub(a, b)) < 1e-12, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_free_wall_tiles_a_period() {
        let points = polyline_points(&[[0.0, 0.0], [0.8, 0.0]], false, 0.1);
        let mut row: Vec<f64> = points
            .iter()
            .filter(|p| p.0[1] > -0.1)
            .map(|p| p.0[0])
            .collect();
        row.sort_by(f64::total_cmp);
        assert_eq!(row.len(), 8);
        assert!((row[0] - 0.05).abs() < 1e-12 && (row[7] - 0.75).abs() < 1e-12);
    }
}
