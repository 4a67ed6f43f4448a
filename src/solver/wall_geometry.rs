//! Wall points as a particle sees them: where they lie, how they move, which way their face looks.

use crate::math::{Vector, dot, norm, scale, sub};
use crate::state::State;

use super::Solver;

impl<const D: usize> Solver<D> {
    /// Whether the points of a wall or gate come along with its velocity: a belt's surface slides, its points stay.
    #[inline(always)]
    pub(super) fn wall_moves(&self, group: u16) -> bool {
        usize::from(group) >= self.fixed_groups || self.walls.groups[group as usize].moves
    }

    /// Volume (area in the section) by which particle i sees a wall point of this weight.
    #[inline(always)]
    pub(super) fn wall_volume(&self, i: usize, wall: u32, weight: f64) -> f64 {
        if self.geometry.is_axisymmetric() {
            self.ring_wall_area(i, wall, weight)
        } else {
            self.volume[i] * weight
        }
    }

    /// How a wall point moves [m/s]: a belt's surface slides, its points stay, and what comes near them is compressed
    /// by its own way only. Behind a stream they come along with it, across their face.
    #[inline(always)]
    pub(super) fn point_velocity(&self, wall: u32) -> Vector<D> {
        if self.wall_moves(self.walls.group[wall as usize]) {
            self.walls.velocity[wall as usize]
        } else if self.has_streams {
            let normal = &self.walls.normal[wall as usize];
            scale(dot(normal, &self.walls.velocity[wall as usize]), normal)
        } else {
            [0.0; D]
        }
    }

    /// x_i - x_wall and its length, nearest image.
    #[inline(always)]
    pub(super) fn wall_offset(&self, xi: &Vector<D>, wall: u32) -> (Vector<D>, f64) {
        let x = self
            .periodic
            .difference(xi, &self.walls.position[wall as usize]);
        let r = norm(&x);
        (x, r)
    }

    /// x_i - x' and its length, x' the image of a wall point across the axis; `None` where there is no axis. A wall goes on
    /// there, and its points are not listed twice.
    #[inline(always)]
    pub(super) fn wall_image(&self, xi: &Vector<D>, wall: u32) -> Option<(Vector<D>, f64)> {
        if !self.geometry.is_axisymmetric() {
            return None;
        }
        let xw = &self.walls.position[wall as usize];
        let mut x = sub(xi, xw);
        x[0] = xi[0] + xw[0];
        let r = norm(&x);
        Some((x, r))
    }

    /// Normal to project on at free slip; `None` at no slip.
    #[inline(always)]
    pub(super) fn wall_projection(
        &self,
        xi: &Vector<D>,
        wall: u32,
        state: &State<D>,
    ) -> Option<Vector<D>> {
        let group = self.walls.group[wall as usize] as usize;
        let free = self.walls.groups[group].free_slip;
        free.then(|| self.wall_normal(xi, wall, state))
    }

    /// Normal towards the material of a wall point that a particle at xi sees.
    #[inline(always)]
    pub(super) fn wall_normal(&self, xi: &Vector<D>, wall: u32, state: &State<D>) -> Vector<D> {
        let group = self.walls.group[wall as usize] as usize;
        let gate = group.checked_sub(self.fixed_groups);
        if let Some(g) = gate {
            let plate = &self.plates[g];
            let xi = self.periodic.image(xi, &plate.middle());
            return plate.normal_at(&xi, state.gates[g].opening);
        }
        let end = self.walls.end_of(wall as usize);
        let beside = end.and_then(|e| e.normal_at(&self.periodic.difference(xi, &e.point)));
        beside.unwrap_or(self.walls.normal[wall as usize])
    }
}
