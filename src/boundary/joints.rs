//! Joints of walls: where one chain of sides goes straight on as another one, their faces meet amid the points that stand on the
//! joint, and each of the two bears half of what these are pushed with.

use super::wall_points::WallPoints;
use crate::math::{Vector, add, dot, norm, sub};

/// How far from the plane between two walls a point may lie and still be on it, over its depth [1]: rounding.
const ON: f64 = 1e-6;

/// Where a wall goes on from another one.
#[derive(Clone, Copy, Debug)]
pub struct Joint<const D: usize> {
    /// Its first point, the other one's last [m].
    pub place: Vector<D>,
    /// Unit directions in which the other arrives there and the wall leaves.
    pub ways: [Vector<D>; 2],
    /// Unit normal of the wall's first side, towards the material.
    pub normal: Vector<D>,
    /// Thickness behind it [m].
    pub depth: f64,
}

impl<const D: usize> Joint<D> {
    /// Whether a point with this normal stands behind it, in the plane between the two walls.
    fn has(&self, x: &Vector<D>, normal: &Vector<D>) -> bool {
        let d = sub(x, &self.place);
        let beside = dot(&d, &add(&self.ways[0], &self.ways[1]));
        *normal == self.normal
            && (-self.depth..0.0).contains(&dot(&d, &self.normal))
            && beside.abs() < ON * norm(&d)
    }
}

impl<const D: usize> WallPoints<D> {
    /// Gives wall `other` half of the forces on those points of wall `group` that stand on the joint of the two.
    pub fn add_joint(&mut self, joint: &Joint<D>, group: u16, other: u16) {
        self.partner.resize(self.len(), None);
        for i in 0..self.len() {
            if self.group[i] == group && joint.has(&self.position[i], &self.normal[i]) {
                self.partner[i] = Some(other);
            }
        }
    }

    /// The wall that bears half of the force on a point, if its own does not bear all.
    #[inline]
    #[must_use]
    pub fn partner(&self, point: usize) -> Option<u16> {
        self.partner.get(point).copied().flatten()
    }

    /// The groups that bear the force on a point, and how much of it each [1].
    pub fn bearers(&self, point: usize) -> impl Iterator<Item = (u16, f64)> + use<D> {
        let partner = self.partner(point);
        let share = if partner.is_some() { 0.5 } else { 1.0 };
        std::iter::once((self.group[point], share)).chain(partner.map(|other| (other, 0.5)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::{ROWS, joined_points};
    use crate::math::scale;

    const DP: f64 = 0.1;

    /// Two walls, the second one `turn` [rad] to the left of the first; of the second's points those of both.
    fn parted(turn: f64) -> Vec<[f64; 2]> {
        let way = [turn.cos(), turn.sin()];
        let mut walls = WallPoints::<2>::default();
        let first = joined_points(&[[-1.0, 0.0], [0.0, 0.0]], false, [None, Some(way)], DP);
        let second = joined_points(&[[0.0, 0.0], way], false, [Some([1.0, 0.0]), None], DP);
        let normal = second[0].1;
        for (group, points) in [(0, first), (1, second)] {
            for (x, n, weight) in points {
                walls.push(x, [0.0; 2], n, weight, group);
            }
        }
        let joint = Joint {
            place: [0.0; 2],
            ways: [[1.0, 0.0], way],
            normal,
            depth: ROWS as f64 * DP,
        };
        walls.add_joint(&joint, 1, 0);
        let of_both = |i: &usize| walls.bearers(*i).count() == 2;
        let points = (0..walls.len()).filter(of_both);
        points
            .map(|i| {
                let bearers: Vec<(u16, f64)> = walls.bearers(i).collect();
                assert_eq!(bearers, [(1, 0.5), (0, 0.5)]);
                walls.position[i]
            })
            .collect()
    }

    #[test]
    fn points_on_a_joint_are_of_both_walls_one_in_each_row() {
        for turn in [0.0, 0.1, -0.3] {
            let points = parted(turn);
            assert_eq!(points.len(), ROWS, "{turn}: {points:?}");
            let behind = [(0.5 * turn).sin(), -(0.5 * turn).cos()];
            for (row, x) in points.iter().enumerate() {
                let depth = (row as f64 + 0.5) * DP / (0.5 * turn).cos();
                let off = norm(&sub(x, &scale(depth, &behind)));
                assert!(off < 1e-12, "{turn}: {x:?}");
            }
        }
    }

    #[test]
    fn points_of_one_wall_are_its_own() {
        let mut walls = WallPoints::<2>::default();
        walls.push([0.0, -0.05], [0.0; 2], [0.0, 1.0], 1.0, 3);
        assert_eq!(walls.bearers(0).collect::<Vec<_>>(), [(3, 1.0)]);
    }
}
