//! The points of all walls and gates, and what those of one wall share. Where they lie is for `points` to say.

use std::collections::HashMap;

use super::ends::End;
use crate::math::{Vector, norm, scale, sub};

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
    /// Angular velocity, by which its velocity changes from place to place: about z in the plane [rad/s].
    pub spin: [f64; 3],
    /// Velocity of the centre that it turns about, where it turns [m/s].
    pub drift: [f64; 3],
}

impl GroupSpec {
    /// Of a wall that moves at this share of its full speed.
    #[must_use]
    pub(super) fn at_rate(self, rate: f64) -> Self {
        Self {
            spin: scale(rate, &self.spin),
            drift: scale(rate, &self.drift),
            ..self
        }
    }
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
    /// From the point to the centre of the bend of the face that it lies behind, 0 where that is flat [m]; empty where all are.
    pub to_centre: Vec<Vector<D>>,
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
    /// The wall that bears half of the force on a point on a joint, the end of that wall ([`Joint`](super::Joint)); shorter than the
    /// points or empty where there are none.
    pub partner: Vec<Option<u16>>,
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

    /// From a point to the centre of the bend that it lies in, if it does [m].
    #[inline(always)]
    #[must_use]
    pub fn bend(&self, point: usize) -> Option<&Vector<D>> {
        self.to_centre.get(point).filter(|to| **to != [0.0; D])
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

    /// Keeps the points whose position and group satisfy `wanted`.
    pub fn retain(&mut self, wanted: impl Fn(&Vector<D>, u16) -> bool) {
        let keep: Vec<usize> = (0..self.len())
            .filter(|&i| wanted(&self.position[i], self.group[i]))
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
        if !self.to_centre.is_empty() {
            self.to_centre.resize(count, [0.0; D]);
            pick(&mut self.to_centre, keep);
        }
        pick(&mut self.group, keep);
        if !self.ends.is_empty() {
            self.end.resize(count, 0);
            pick(&mut self.end, keep);
        }
        if !self.partner.is_empty() {
            self.partner.resize(count, None);
            pick(&mut self.partner, keep);
        }
    }

    /// Drops points closer than half a spacing to one of a rougher wall or, as rough, to an earlier one (walls that overlap at corners:
    /// beside a smooth wall a bed goes on as its mirror image). `together`: whether two groups stay where they are to each other;
    /// what would part keeps all of its points.
    pub fn drop_doubles(&mut self, spacing: f64, together: impl Fn(u16, u16) -> bool) {
        let reach = 0.5 * spacing;
        let cell =
            |x: &Vector<D>| -> [i64; D] { std::array::from_fn(|k| (x[k] / reach).floor() as i64) };
        let mut seen: HashMap<[i64; D], Vec<usize>> = HashMap::new();
        let mut keep = Vec::new();
        let mut roughest_first: Vec<usize> = (0..self.len()).collect();
        roughest_first.sort_by(|a, b| self.roughness(*b).total_cmp(&self.roughness(*a)));
        for i in roughest_first {
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
        keep.sort_unstable();
        self.pick(&keep);
    }

    /// Friction of a point's face [1]; what nothing slips along is roughest.
    fn roughness(&self, point: usize) -> f64 {
        match self.groups.get(self.group[point] as usize) {
            Some(spec) if spec.free_slip => spec.friction,
            _ => f64::INFINITY,
        }
    }
}
