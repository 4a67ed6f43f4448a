//! Where wall points lie: rows behind polylines, planes and in boxes.

use std::collections::HashMap;

use super::ends::End;
use crate::math::{Vector, add, dot, norm, scale, sub};

/// Rows of points behind a wall's surface: enough for a support of 2 h at h/dp <= 2.
pub const ROWS: usize = 4;

/// What all points of one wall or gate share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupSpec {
    /// Free slip: only the normal part of motion is seen.
    pub free_slip: bool,
    /// Coulomb friction mu_w >= 0 of a face with free slip, 0: none [1].
    pub friction: f64,
    /// Whether its points move against the material, gates apart: then sliding along it counts as motion, too.
    pub moves: bool,
    /// Whether somebody reads the force on it.
    pub wants_force: bool,
}

/// All wall points: fixed walls first, then gates.
#[derive(Clone, Debug, Default)]
pub struct WallPoints<const D: usize> {
    /// Position [m].
    pub position: Vec<Vector<D>>,
    /// Velocity [m/s].
    pub velocity: Vec<Vector<D>>,
    /// Unit normal towards the material (free slip only needs it).
    pub normal: Vec<Vector<D>>,
    /// Share of a full point, 0 to 1 (spacing differs from dp, or the plate's end is half hidden).
    pub weight: Vec<f64>,
    /// Index into `groups`.
    pub group: Vec<u16>,
    /// One per wall, then one per gate.
    pub groups: Vec<GroupSpec>,
    /// Faces at free ends of walls.
    pub ends: Vec<End<D>>,
    /// The end that each point belongs to, counted from 1, 0: none; shorter than the points or empty where there are none.
    pub end: Vec<u16>,
}

impl<const D: usize> WallPoints<D> {
    /// Adds a point.
    pub fn push(
        &mut self,
        position: Vector<D>,
        velocity: Vector<D>,
        normal: Vector<D>,
        weight: f64,
        group: u16,
    ) {
        self.position.push(position);
        self.velocity.push(velocity);
        self.normal.push(normal);
        self.weight.push(weight);
        self.group.push(group);
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Keeps the points whose position satisfies `wanted`.
    pub fn retain(&mut self, wanted: impl Fn(&Vector<D>) -> bool) {
        let keep: Vec<usize> = (0..self.len())
            .filter(|&i| wanted(&self.position[i]))
            .collect();
        self.pick(&keep);
    }

    fn pick(&mut self, keep: &[usize]) {
        fn pick<T: Copy>(field: &mut Vec<T>, keep: &[usize]) {
            *field = keep.iter().map(|&i| field[i]).collect();
        }
        let count = self.len();
        pick(&mut self.position, keep);
        pick(&mut self.velocity, keep);
        pick(&mut self.normal, keep);
        pick(&mut self.weight, keep);
        pick(&mut self.group, keep);
        if !self.ends.is_empty() {
            self.end.resize(count, 0);
            pick(&mut self.end, keep);
        }
    }

    /// Drops points closer than half a spacing to an earlier one (walls that overlap at corners). `together`: whether two groups
    /// stay where they are to each other; what would part keeps all of its points.
    pub fn drop_doubles(&mut self, spacing: f64, together: impl Fn(u16, u16) -> bool) {
        let reach = 0.5 * spacing;
        let cell =
            |x: &Vector<D>| -> [i64; D] { std::array::from_fn(|k| (x[k] / reach).floor() as i64) };
        let mut seen: HashMap<[i64; D], Vec<usize>> = HashMap::new();
        let mut keep = Vec::new();
        for i in 0..self.len() {
            let here = cell(&self.position[i]);
            let near = (0..3usize.pow(D as u32)).any(|n| {
                let mut m = n;
                let c = std::array::from_fn(|k| {
                    let o = (m % 3) as i64 - 1;
                    m /= 3;
                    here[k] + o
                });
                seen.get(&c).is_some_and(|v| {
                    v.iter().any(|&j| {
                        norm(&sub(&self.position[i], &self.position[j])) < reach
                            && together(self.group[i], self.group[j])
                    })
                })
            });
            if !near {
                seen.entry(here).or_default().push(i);
                keep.push(i);
            }
        }
        self.pick(&keep);
    }
}

/// (position, normal, weight) of the points behind a polyline with the material on its left.
///
/// Row k is the polyline moved (k + 1/2) dp to the right with mitred corners; points sit on the corners and evenly
/// between them, half a spacing from free ends. Their weight is the actual spacing over dp.
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
    let n = corners.len();
    let segments = if closed { n } else { n - 1 };
    let tangent = |s: usize| {
        let d = sub(&corners[(s + 1) % n], &corners[s % n]);
        scale(1.0 / norm(&d), &d)
    };
    let right = |t: &[f64; 2]| [t[1], -t[0]];
    let mut points = Vec::new();
    for row in 0..ROWS {
        let depth = (row as f64 + 0.5) * spacing;
        // Corner c moved to the row: the two neighbouring rows meet there.
        let moved = |c: usize| -> [f64; 2] {
            let before = if c > 0 || closed {
                Some(tangent((c + segments - 1) % segments))
            } else {
                joints[0]
            };
            let after = if c < segments || closed {
                Some(tangent(c % segments))
            } else {
                joints[1]
            };
            let corner = &corners[c % n];
            match (before, after) {
                (Some(a), Some(b)) => {
                    let (ra, rb) = (right(&a), right(&b));
                    let m = add(&ra, &rb);
                    // Limited so that hairpins do not shoot out.
                    let f = 2.0 / dot(&m, &m).max(0.25);
                    add(corner, &scale(depth * f, &m))
                }
                (Some(a), None) => add(corner, &scale(depth, &right(&a))),
                (None, Some(b)) => add(corner, &scale(depth, &right(&b))),
                (None, None) => *corner,
            }
        };
        for s in 0..segments {
            let (a, b) = (moved(s), moved(s + 1));
            let t = tangent(s);
            let length = dot(&sub(&b, &a), &t);
            let free_start = s == 0 && !closed && joints[0].is_none();
            let free_end = s + 1 == segments && !closed && joints[1].is_none();
            // Half a spacing is left out at a free end; a joint's point belongs to the segment that starts there.
            let ends = 0.5 * (f64::from(u8::from(free_start)) + f64::from(u8::from(free_end)));
            let count = (length / spacing + 1.0 - ends).round();
            if count < 1.0 || length <= 0.0 {
                continue;
            }
            let step = length / (count - 1.0 + ends).max(1.0);
            let first = if free_start { 0.5 * step } else { 0.0 };
            let shared_end = !free_end;
            let normal = scale(-1.0, &right(&t));
            let count = count as usize;
            for k in 0..count {
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
    points
}

/// Points behind the plane through `point` with unit `normal`, inside lower..upper widened by the rows on axes that are
/// not periodic.
#[must_use]
pub fn plane_points<const D: usize>(
    point: &Vector<D>,
    normal: &Vector<D>,
    lower: &Vector<D>,
    upper: &Vector<D>,
    periodic: &[bool; D],
    spacing: f64,
) -> Vec<Vector<D>> {
    let margin = ROWS as f64 * spacing;
    let axis = (0..D).find(|&k| normal[k].abs() > 1.0 - 1e-12);
    // Tangents: the other axes for an axis-aligned plane (so that its points continue the particles' lattice).
    let mut tangents: Vec<Vector<D>> = Vec::new();
    for k in 0..D {
        if Some(k) == axis {
            continue;
        }
        let mut t = [0.0; D];
        t[k] = 1.0;
        let mut rest = sub(&t, &scale(dot(&t, normal), normal));
        for u in &tangents {
            rest = sub(&rest, &scale(dot(&rest, u), u));
        }
        if norm(&rest) > 1e-6 && tangents.len() + 1 < D {
            tangents.push(scale(1.0 / norm(&rest), &rest));
        }
    }
    let reach = (norm(&sub(upper, lower)) + 2.0 * margin) / spacing;
    let half = reach.ceil() as i64;
    let start = {
        // The lattice starts at the domain's lower corner, moved into the plane.
        let d = sub(lower, point);
        sub(lower, &scale(dot(&d, normal), normal))
    };
    let inside = |x: &Vector<D>| {
        (0..D).all(|k| {
            let m = if periodic[k] { 0.0 } else { margin };
            x[k] > lower[k] - m && x[k] < upper[k] + m
        })
    };
    let mut points = Vec::new();
    let range = |axis_count: usize| {
        if axis_count < tangents.len() {
            -half..half
        } else {
            0..1
        }
    };
    for row in 0..ROWS {
        let base = sub(&start, &scale((row as f64 + 0.5) * spacing, normal));
        for a in range(0) {
            for b in range(1) {
                let mut x = base;
                for (t, n) in tangents.iter().zip([a, b]) {
                    x = add(&x, &scale((n as f64 + 0.5) * spacing, t));
                }
                // The wall's own axis may lie outside the domain: only the tangential extent is clipped.
                let on = sub(&x, &scale(dot(&sub(&x, point), normal), normal));
                if inside(&on) {
                    points.push(x);
                }
            }
        }
    }
    points
}

/// (position, outward normal) of the outer rows of a solid box.
#[must_use]
pub fn box_points<const D: usize>(
    lower: &Vector<D>,
    upper: &Vector<D>,
    spacing: f64,
) -> Vec<(Vector<D>, Vector<D>)> {
    let count: [usize; D] =
        std::array::from_fn(|k| ((upper[k] - lower[k]) / spacing).round().max(1.0) as usize);
    let total: usize = count.iter().product();
    let mut points = Vec::new();
    for n in 0..total {
        let mut m = n;
        let index: [usize; D] = std::array::from_fn(|k| {
            let i = m % count[k];
            m /= count[k];
            i
        });
        let x: Vector<D> = std::array::from_fn(|k| {
            lower[k] + (index[k] as f64 + 0.5) * (upper[k] - lower[k]) / count[k] as f64
        });
        // Nearest face.
        let mut best = (f64::INFINITY, 0, 1.0);
        for k in 0..D {
            for (distance, sign) in [(x[k] - lower[k], -1.0), (upper[k] - x[k], 1.0)] {
                if distance < best.0 {
                    best = (distance, k, sign);
                }
            }
        }
        if best.0 <= ROWS as f64 * spacing {
            let mut normal = [0.0; D];
            normal[best.1] = best.2;
            points.push((x, normal));
        }
    }
    points
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

    #[test]
    fn plane_points_lie_behind_the_plane() {
        let n = [0.0, 0.0, 1.0];
        let p = plane_points(
            &[0.0; 3],
            &n,
            &[0.0; 3],
            &[1.0, 1.0, 1.0],
            &[false; 3],
            0.25,
        );
        assert!(p.iter().all(|x| x[2] < 0.0 && x[2] > -1.0));
        assert_eq!(p.len(), 4 * 12 * 12);
    }
}
