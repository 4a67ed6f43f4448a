//! Where wall points lie: rows behind planes and in boxes.

use super::ROWS;
use super::courses::{of_box, of_plane};
use crate::math::{Vector, add, dot, norm, scale, sub};

/// A face of another wall: a point on it and its normal.
pub type Face<const D: usize> = (Vector<D>, Vector<D>);

/// (position, weight) of the points behind the plane through `point` with unit `normal`, inside lower..upper widened by the rows on axes
/// that are not periodic. They count from the `faces` that cross the plane at right angles; where there are none, from the domain's
/// lower corner, moved into the plane.
#[must_use]
pub fn plane_points<const D: usize>(
    (point, normal): (&Vector<D>, &Vector<D>),
    faces: &[Face<D>],
    (lower, upper): (&Vector<D>, &Vector<D>),
    periodic: &[bool; D],
    spacing: f64,
) -> Vec<(Vector<D>, f64)> {
    let margin = ROWS as f64 * spacing;
    let tangents = plane_tangents(normal);
    let start = {
        let d = sub(lower, point);
        sub(lower, &scale(dot(&d, normal), normal))
    };
    let inside = |x: &Vector<D>| {
        (0..D).all(|k| {
            let m = if periodic[k] { 0.0 } else { margin };
            x[k] > lower[k] - m && x[k] < upper[k] + m
        })
    };
    let (outer_lower, outer_upper) = (lower.map(|x| x - margin), upper.map(|x| x + margin));
    let courses = |number: usize| match tangents.get(number) {
        Some(tangent) => {
            let mut across = crossings(faces, tangent, &start);
            // A period begins and ends as a wall would.
            for k in (0..D).filter(|&k| periodic[k] && is_along(tangent, k)) {
                across.extend([lower, upper].map(|x| (x[k] - start[k]) * tangent[k]));
            }
            let way = extent(tangent, &start, (&outer_lower, &outer_upper));
            of_plane(&across, way, spacing)
        }
        None => vec![(0.0, spacing)],
    };
    let (first, second) = (courses(0), courses(1));
    let mut points = Vec::new();
    for row in 0..ROWS {
        let base = sub(&start, &scale((row as f64 + 0.5) * spacing, normal));
        for a in &first {
            for b in &second {
                let mut x = base;
                for (t, (along, _)) in tangents.iter().zip([a, b]) {
                    x = add(&x, &scale(*along, t));
                }
                // The wall's own axis may lie outside the domain: only the tangential extent is clipped.
                let on = sub(&x, &scale(dot(&sub(&x, point), normal), normal));
                if inside(&on) {
                    points.push((x, a.1 / spacing * (b.1 / spacing)));
                }
            }
        }
    }
    points
}

/// Where faces at right angles to a direction stand along it, from `start`.
pub(super) fn crossings<const D: usize>(
    faces: &[Face<D>],
    along: &Vector<D>,
    start: &Vector<D>,
) -> Vec<f64> {
    faces
        .iter()
        .filter(|(_, normal)| dot(normal, along).abs() > 1.0 - 1e-9)
        .map(|(point, _)| dot(&sub(point, start), along))
        .collect()
}

/// Whether a unit vector is along axis k.
fn is_along<const D: usize>(tangent: &Vector<D>, k: usize) -> bool {
    tangent[k].abs() > 1.0 - 1e-12
}

/// From where to where a box reaches along a tangent, from `start`.
pub(super) fn extent<const D: usize>(
    tangent: &Vector<D>,
    start: &Vector<D>,
    (lower, upper): (&Vector<D>, &Vector<D>),
) -> (f64, f64) {
    let (mut least, mut most) = (0.0, 0.0);
    for k in 0..D {
        let ends = [lower[k], upper[k]].map(|x| (x - start[k]) * tangent[k]);
        least += ends[0].min(ends[1]);
        most += ends[0].max(ends[1]);
    }
    (least, most)
}

/// Unit vectors along a plane with this unit normal, at right angles: the other axes for an axis-aligned plane (so that its
/// points continue the particles' lattice).
fn plane_tangents<const D: usize>(normal: &Vector<D>) -> Vec<Vector<D>> {
    let axis = (0..D).find(|&k| normal[k].abs() > 1.0 - 1e-12);
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
    tangents
}

/// (position, outward normal, weight) of the outer rows of a solid box that the `faces` of other walls meet.
#[must_use]
pub fn box_points<const D: usize>(
    lower: &Vector<D>,
    upper: &Vector<D>,
    faces: &[Face<D>],
    spacing: f64,
) -> Vec<(Vector<D>, Vector<D>, f64)> {
    let courses: [Vec<(f64, f64)>; D] = std::array::from_fn(|k| {
        let mut axis = [0.0; D];
        axis[k] = 1.0;
        let across = crossings(faces, &axis, &[0.0; D]);
        of_box(&across, (lower[k], upper[k]), spacing)
    });
    let total: usize = courses.iter().map(Vec::len).product();
    let mut points = Vec::new();
    for n in 0..total {
        let (mut m, mut weight) = (n, 1.0);
        let x: Vector<D> = std::array::from_fn(|k| {
            let (middle, length) = courses[k][m % courses[k].len()];
            m /= courses[k].len();
            weight *= length / spacing;
            middle
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
            points.push((x, normal, weight));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_points_lie_behind_the_plane() {
        let n = [0.0, 0.0, 1.0];
        let p = plane_points(
            (&[0.0; 3], &n),
            &[],
            (&[0.0; 3], &[1.0, 1.0, 1.0]),
            &[false; 3],
            0.25,
        );
        assert!(
            p.iter()
                .all(|(x, w)| x[2] < 0.0 && x[2] > -1.0 && *w == 1.0)
        );
        assert_eq!(p.len(), 4 * 12 * 12);
    }

    /// A floor of 40 by 40 points under a sky of a million kilometres.
    #[test]
    fn planes_across_a_long_domain_have_the_points_of_a_short_one() {
        let floor = |normal: [f64; 3], height: f64| {
            let upper = [1.0, 1.0, height];
            let box_ = (&[0.0; 3], &upper);
            plane_points((&[0.0; 3], &normal), &[], box_, &[false; 3], 0.025)
        };
        let (low, high) = (floor([0.0, 0.0, 1.0], 1.0), floor([0.0, 0.0, 1.0], 1e9));
        assert_eq!(low.len(), 4 * 48 * 48);
        assert_eq!(low, high);
        // A slope meets the domain in a patch, wherever its sides are.
        let slope = floor([0.6, 0.0, 0.8], 1.0);
        assert_eq!(slope.len() % 4, 0);
        assert!(slope.len() > 1000, "{}", slope.len());
    }
}
