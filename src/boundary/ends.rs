//! Free ends of walls: a polyline that stops in the open is as thick as its rows, and what stands beside its end sees that
//! face and not the one in front (the lip of an outlet).

use super::wall_points::WallPoints;
use crate::math::{Vector, dot, scale, sub};

/// The face at a free end of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<const D: usize> {
    /// The polyline's last point [m].
    pub point: Vector<D>,
    /// Unit direction out of it.
    pub outward: Vector<D>,
    /// Unit normal of the segment that ends there, towards the material.
    pub normal: Vector<D>,
    /// Thickness behind it [m].
    pub depth: f64,
    /// How far below the surface the end begins to count as its own face [m]: what lies on the wall, or on a gate that goes
    /// on from it, sees one flat face.
    pub rim: f64,
}

impl<const D: usize> End<D> {
    /// Its normal if what is at `d` from its point stands beside it.
    #[inline]
    #[must_use]
    pub fn normal_at(&self, d: &Vector<D>) -> Option<Vector<D>> {
        let height = dot(d, &self.normal);
        let beside = dot(d, &self.outward) > 0.0 && (-self.depth..-self.rim).contains(&height);
        beside.then_some(self.outward)
    }
}

impl<const D: usize> WallPoints<D> {
    /// Adds the face at a free end of wall `group`, for the wall's points behind its last `length` [m].
    pub fn add_end(&mut self, end: End<D>, length: f64, group: u16) {
        self.ends.push(end);
        let number = self.ends.len() as u16;
        self.end.resize(self.position.len(), 0);
        for i in 0..self.position.len() {
            let d = sub(&self.position[i], &end.point);
            let along = -dot(&d, &end.outward);
            let height = dot(&d, &end.normal);
            let own = self.group[i] == group
                && (0.0..length).contains(&along)
                && (-end.depth..0.0).contains(&height);
            if own {
                self.end[i] = number;
            }
        }
    }

    /// The face at the end that a point belongs to.
    #[inline]
    #[must_use]
    pub fn end_of(&self, point: usize) -> Option<&End<D>> {
        let number = *self.end.get(point)?;
        self.ends.get(usize::from(number).checked_sub(1)?)
    }
}

/// The free ends of an open polyline with `depth` behind it: each with how much of the polyline belongs to it [m].
#[must_use]
pub fn free_ends(
    corners: &[[f64; 2]],
    joints: [Option<[f64; 2]>; 2],
    depth: f64,
    rim: f64,
) -> Vec<(End<2>, f64)> {
    let n = corners.len();
    if n < 2 {
        return Vec::new();
    }
    let end = |from: usize, to: usize, forwards: bool| {
        let d = sub(&corners[to], &corners[from]);
        let length = d[0].hypot(d[1]);
        let outward = scale(1.0 / length, &d);
        let t = if forwards {
            outward
        } else {
            scale(-1.0, &outward)
        };
        let end = End {
            point: corners[to],
            outward,
            normal: [-t[1], t[0]],
            depth,
            rim,
        };
        // Both ends of a short piece have half of it.
        (end, if n == 2 { 0.5 * length } else { length })
    };
    let mut ends = Vec::new();
    if joints[0].is_none() {
        ends.push(end(1, 0, false));
    }
    if joints[1].is_none() {
        ends.push(end(n - 2, n - 1, true));
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_a_lip_the_normal_is_that_of_its_end() {
        // A floor from 0 to 1 with the material above.
        let ends = free_ends(&[[0.0, 0.0], [1.0, 0.0]], [None; 2], 0.4, 0.025);
        assert_eq!(ends.len(), 2);
        let (last, length) = ends[1];
        assert_eq!((last.normal, last.outward), ([0.0, 1.0], [1.0, 0.0]));
        assert!((length - 0.5).abs() < 1e-12);
        assert_eq!(last.normal_at(&[0.05, -0.2]), Some([1.0, 0.0]));
        // Above the surface, under the wall, and within it.
        assert_eq!(last.normal_at(&[0.05, 0.05]), None);
        assert_eq!(last.normal_at(&[0.05, -0.5]), None);
        assert_eq!(last.normal_at(&[-0.05, -0.2]), None);
        assert_eq!(ends[0].0.normal_at(&[-0.05, -0.2]), Some([-1.0, 0.0]));
    }

    #[test]
    fn an_end_has_the_points_of_its_own_wall() {
        let mut walls = WallPoints::<2>::default();
        walls.push([0.95, -0.05], [0.0; 2], [0.0, 1.0], 1.0, 0);
        walls.push([0.95, -0.05], [0.0; 2], [0.0, 1.0], 1.0, 1);
        walls.push([0.2, -0.05], [0.0; 2], [0.0, 1.0], 1.0, 0);
        let (end, length) = free_ends(&[[0.0, 0.0], [1.0, 0.0]], [None; 2], 0.4, 0.025)[1];
        walls.add_end(end, length, 0);
        assert_eq!(walls.end_of(0), Some(&end));
        assert_eq!(walls.end_of(1), None);
        assert_eq!(walls.end_of(2), None);
    }
}
