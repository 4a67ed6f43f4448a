//! Boundary elements: flat pieces of a wall's surface, for scheme `paper_b` (docs/theory.md, "Scheme paper_b").
//!
//! Symbols: R support, x_i particle, n unit normal of the element towards the material, d = n.(x_i - x_s) distance in front
//! of it, r distance of a point of it, Q(r) share of the kernel outside of radius r.
//!
//! W is the divergence of -Q(r) (x' - x_i)/(s_D r^D) but for a point source at x_i (s_D = 2 pi, 4 pi), so that the kernel's
//! integral over the material, the geometric Shepard factor, is a sum over the wall's surface:
//!
//! gamma_i = 1 - sum_s (1/s_D) int_s Q(r) dOmega                                                         (PB3)
//!
//! Omega the angle (solid angle) that an element fills as seen from x_i (Calderon-Sanchez, Cercos-Pita, Duque 2019, doi
//! 10.1016/j.compfluid.2019.02.020). Angles are exact, Q is integrated by Gauss's rule; nothing is singular at the wall.

use std::f64::consts::PI;

use super::courses::of_plane;
use super::flats::{Face, crossings, extent};
use crate::kernel::WendlandC2;
use crate::math::{Vector, dot, norm, scale, sub};

/// Gauss's rule of three points on (-1, 1).
const NODES: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Parts of a side that a near element is cut into in space.
const PARTS: i32 = 4;

/// A flat piece of surface: in the plane a segment, in space a square with sides along `tangents`.
#[derive(Clone, Copy, Debug)]
pub struct Element<const D: usize> {
    /// Its centre, seen from the particle [m].
    pub offset: Vector<D>,
    /// Unit normal towards the material.
    pub normal: Vector<D>,
    /// Length of its sides [m].
    pub side: f64,
}

impl<const D: usize> Element<D> {
    /// Distance of the particle in front of its plane [m]; below 0 behind it.
    #[inline]
    #[must_use]
    pub fn front(&self) -> f64 {
        -dot(&self.offset, &self.normal)
    }

    /// Share of the kernel that the element hides, (1/s_D) int Q dOmega; the particle counts as `front` > 0 [m] before it.
    #[must_use]
    pub fn hidden(&self, kernel: &WendlandC2<D>, front: f64) -> f64 {
        let along = tangents(&self.normal).map(|t| dot(&self.offset, &t));
        if D == 2 {
            segment(kernel, front, along[0], 0.5 * self.side)
        } else {
            square(kernel, front, [along[0], along[1]], self.side)
        }
    }
}

/// (1/2 pi) int Q(r) dtheta, r = front/cos theta.
fn segment<const D: usize>(kernel: &WendlandC2<D>, front: f64, along: f64, half: f64) -> f64 {
    let from = (along - half).atan2(front);
    let to = (along + half).atan2(front);
    let (middle, reach) = (0.5 * (from + to), 0.5 * (to - from));
    let sum: f64 = NODES
        .iter()
        .map(|(x, w)| w * kernel.share_outside(front / (middle + reach * x).cos()))
        .sum();
    sum * reach / (2.0 * PI)
}

/// (1/4 pi) sum Q Omega over parts of a square.
fn square<const D: usize>(kernel: &WendlandC2<D>, front: f64, along: [f64; 2], side: f64) -> f64 {
    let near = along[0].hypot(along[1]).hypot(front) < 2.0 * side;
    let parts = if near { PARTS } else { 1 };
    let step = side / f64::from(parts);
    let corner = |x: f64, y: f64| (x * y / (front * x.hypot(y).hypot(front))).atan();
    let mut sum = 0.0;
    for a in 0..parts {
        for b in 0..parts {
            let x = along[0] - 0.5 * side + f64::from(a) * step;
            let y = along[1] - 0.5 * side + f64::from(b) * step;
            let angle = corner(x + step, y + step) - corner(x, y + step) - corner(x + step, y)
                + corner(x, y);
            let r = (x + 0.5 * step).hypot(y + 0.5 * step).hypot(front);
            sum += angle * kernel.share_outside(r);
        }
    }
    sum / (4.0 * PI)
}

/// Unit vectors along a face: the axis most along it, made orthogonal to the normal, then the one across both. In the plane
/// only the first.
#[must_use]
fn tangents<const D: usize>(normal: &Vector<D>) -> [Vector<D>; 2] {
    let mut first = [0.0; D];
    if D == 2 {
        first[0] = -normal[1];
        first[1] = normal[0];
        return [first, [0.0; D]];
    }
    let axis = (0..D).fold(0, |best, k| {
        if normal[k].abs() < normal[best].abs() {
            k
        } else {
            best
        }
    });
    first[axis] = 1.0;
    let first = sub(&first, &scale(normal[axis], normal));
    let first = scale(1.0 / norm(&first), &first);
    let second = std::array::from_fn(|k| {
        let (a, b) = ((k + 1) % D, (k + 2) % D);
        normal[a] * first[b] - normal[b] * first[a]
    });
    [first, second]
}

/// (centre, normal, length) of the elements of a polyline with the material on its left, about `spacing` long.
#[must_use]
pub fn polyline_elements(
    corners: &[[f64; 2]],
    closed: bool,
    spacing: f64,
) -> Vec<([f64; 2], [f64; 2], f64)> {
    let count = if closed {
        corners.len()
    } else {
        corners.len() - 1
    };
    let mut elements = Vec::new();
    for s in 0..count {
        let (a, b) = (corners[s], corners[(s + 1) % corners.len()]);
        let way = sub(&b, &a);
        let length = norm(&way);
        let parts = (length / spacing).round().max(1.0) as usize;
        let normal = [-way[1] / length, way[0] / length];
        for n in 0..parts {
            let share = (n as f64 + 0.5) / parts as f64;
            let x = [a[0] + share * way[0], a[1] + share * way[1]];
            elements.push((x, normal, length / parts as f64));
        }
    }
    elements
}

/// (centre, normal, side) of the elements of a box with the material outside, about `spacing` wide.
#[must_use]
pub fn box_elements<const D: usize>(
    lower: &Vector<D>,
    upper: &Vector<D>,
    spacing: f64,
) -> Vec<(Vector<D>, Vector<D>, f64)> {
    let mut elements = Vec::new();
    for face in 0..2 * D {
        let (axis, sign) = (face / 2, if face % 2 == 0 { -1.0 } else { 1.0 });
        let mut normal = [0.0; D];
        normal[axis] = sign;
        let count: [usize; D] = std::array::from_fn(|k| {
            if k == axis {
                1
            } else {
                ((upper[k] - lower[k]) / spacing).round().max(1.0) as usize
            }
        });
        let area: f64 = (0..D)
            .filter(|&k| k != axis)
            .map(|k| (upper[k] - lower[k]) / count[k] as f64)
            .product();
        let side = if D == 2 { area } else { area.sqrt() };
        for n in 0..count.iter().product() {
            let mut rest: usize = n;
            let x = std::array::from_fn(|k| {
                let place = rest % count[k];
                rest /= count[k];
                if k == axis {
                    if sign < 0.0 { lower[k] } else { upper[k] }
                } else {
                    lower[k] + (place as f64 + 0.5) * (upper[k] - lower[k]) / count[k] as f64
                }
            });
            elements.push((x, normal, side));
        }
    }
    elements
}

/// (centre, length or area over that of a spacing) of the elements of a plane in the domain, as far as it is not behind `planes`, other
/// walls. They count from the faces that cross it, as the rows of [`super::plane_points`] do; else from the domain's lower corner.
#[must_use]
pub fn plane_elements<const D: usize>(
    (point, normal): (&Vector<D>, &Vector<D>),
    (faces, planes): (&[Face<D>], &[Face<D>]),
    (lower, upper): (&Vector<D>, &Vector<D>),
    spacing: f64,
) -> Vec<(Vector<D>, f64)> {
    let along = tangents(normal);
    let onto = |x: &Vector<D>| -> Vector<D> {
        let off = dot(&sub(x, point), normal);
        std::array::from_fn(|k| x[k] - off * normal[k])
    };
    let start = onto(lower);
    let courses = |tangent: &Vector<D>| {
        let way = extent(tangent, &start, (lower, upper));
        of_plane(&crossings(faces, tangent, &start), way, spacing)
    };
    let across = if D == 2 {
        vec![(0.0, spacing)]
    } else {
        courses(&along[1])
    };
    let inside = |x: &Vector<D>| {
        // Along its own axis a plane may lie outside the domain.
        (0..D).all(|k| normal[k].abs() > 1.0 - 1e-12 || (x[k] > lower[k] && x[k] < upper[k]))
    };
    let is_shown = |x: &Vector<D>| planes.iter().all(|(p, n)| dot(&sub(x, p), n) > 0.0);
    let mut elements = Vec::new();
    for (a, long) in courses(&along[0]) {
        for (b, wide) in &across {
            let x: Vector<D> =
                std::array::from_fn(|k| start[k] + a * along[0][k] + b * along[1][k]);
            if inside(&x) && is_shown(&x) {
                elements.push((x, long / spacing * (wide / spacing)));
            }
        }
    }
    elements
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the kernel in front of a plane `front` away, by brute force.
    fn exact<const D: usize>(kernel: &WendlandC2<D>, front: f64) -> f64 {
        let n = 4000;
        let dr = kernel.support() / f64::from(n);
        let mut hidden = 0.0;
        for i in 0..n {
            let r = (f64::from(i) + 0.5) * dr;
            if r > front {
                let cap = if D == 2 {
                    2.0 * (front / r).acos() * r
                } else {
                    2.0 * PI * r * r * (1.0 - front / r)
                };
                hidden += kernel.w(r) * cap * dr;
            }
        }
        1.0 - hidden
    }

    fn gamma<const D: usize>(
        kernel: &WendlandC2<D>,
        x: &Vector<D>,
        elements: &[(Vector<D>, Vector<D>, f64)],
    ) -> f64 {
        let hidden = |(centre, normal, side): &(Vector<D>, Vector<D>, f64)| {
            let e = Element {
                offset: sub(centre, x),
                normal: *normal,
                side: *side,
            };
            e.hidden(kernel, e.front())
        };
        1.0 - elements.iter().map(hidden).sum::<f64>()
    }

    #[test]
    fn the_shepard_factor_before_a_wall_is_the_kernel_in_front_of_it() {
        let dp = 0.1;
        let (k2, k3) = (WendlandC2::<2>::new(0.2), WendlandC2::<3>::new(0.2));
        let line = polyline_elements(&[[-1.0, 0.0], [1.0, 0.0]], false, dp);
        let plane = plane_elements(
            (&[0.0; 3], &[0.0, 0.0, 1.0]),
            (&[], &[]),
            (&[-0.7, -0.7, -0.1], &[0.7, 0.7, 1.0]),
            dp,
        );
        let floor: Vec<_> = plane.iter().map(|x| (x.0, [0.0, 0.0, 1.0], dp)).collect();
        for front in [1e-6, 0.01, 0.03, 0.05, 0.1, 0.2, 0.35] {
            for shift in [0.0, 0.02, 0.05] {
                let got = gamma(&k2, &[shift, front], &line);
                assert!(
                    (got - exact(&k2, front)).abs() < 4e-3,
                    "{front} {shift}: {got}"
                );
                let got = gamma(&k3, &[shift, -shift, front], &floor);
                let off = (got - exact(&k3, front)).abs();
                assert!(off < 8e-3, "{front} {shift}: {got} {off}");
            }
        }
    }

    #[test]
    fn corners_keep_their_angles() {
        let dp = 0.1;
        let kernel = WendlandC2::<2>::new(0.2);
        // A square corner, material above and to the right; and the outside of a box.
        let inner = polyline_elements(&[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]], false, dp);
        assert!((gamma(&kernel, &[1e-5, 1e-5], &inner) - 0.25).abs() < 5e-3);
        let outer = box_elements(&[-1.0, -1.0], &[0.0, 0.0], dp);
        // Seen are only faces in front of which the particle is.
        let seen: Vec<_> = outer
            .into_iter()
            .filter(|(x, n, _)| dot(&sub(&[1e-5, 1e-5], x), n) > 0.0)
            .collect();
        let got = gamma(&kernel, &[1e-5, 1e-5], &seen);
        assert!((got - 0.75).abs() < 5e-3, "{got}");
    }

    /// A floor and a side, planes that the domain goes on behind, a quarter of a spacing off its lattice.
    #[test]
    fn planes_end_where_they_meet() {
        let dp = 0.1;
        let kernel = WendlandC2::<2>::new(0.2);
        let domain = (&[-0.425, -0.425], &[1.0, 1.0]);
        let (floor, side) = (([0.0; 2], [0.0, 1.0]), ([0.0; 2], [1.0, 0.0]));
        let elements = |own: &Face<2>, other: &Face<2>| -> Vec<_> {
            let others = [*other];
            plane_elements((&own.0, &own.1), (&others, &others), domain, dp)
                .into_iter()
                .map(|(x, share)| (x, own.1, share * dp))
                .collect()
        };
        let mut corner = elements(&floor, &side);
        corner.extend(elements(&side, &floor));
        assert!((gamma(&kernel, &[1e-5, 1e-5], &corner) - 0.25).abs() < 5e-3);
    }

    #[test]
    fn elements_cover_their_walls() {
        let area: f64 = box_elements(&[0.0; 3], &[1.0, 0.5, 0.26], 0.1)
            .iter()
            .map(|(_, _, side)| side * side)
            .sum();
        assert!((area - 2.0 * (0.5 + 0.26 + 0.13)).abs() < 1e-12, "{area}");
        let length: f64 = polyline_elements(&[[0.0, 0.0], [1.03, 0.0], [1.03, 0.5]], true, 0.1)
            .iter()
            .map(|(_, _, l)| l)
            .sum();
        assert!((length - 1.53 - 1.03_f64.hypot(0.5)).abs() < 1e-12);
    }
}
