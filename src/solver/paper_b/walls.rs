//! What a particle sees of walls: elements of their surface within its support.
//!
//! Boundary integrals: int grad' f W dx' = sum_j V_j f_j grad_i W_ij + sum_s f_s n_s W_is S_s, n_s outwards, over gamma_i.

use crate::boundary::Element;
use crate::math::{CHUNK, Vector, dot, norm, scale};
use crate::solver::Solver;
use crate::state::State;

/// A particle on a wall counts as this far before it [dp].
const CLOSEST: f64 = 0.02;

/// Nearer to a wall than this a particle no longer approaches it [dp].
const BOUNCE: f64 = 0.25;

/// Least Shepard factor: deeper in a corner sums are not made up to a whole one [1].
const LEAST_SHEPARD: f64 = 0.1;

/// An element in front of which a particle is.
pub(super) struct Seen<const D: usize> {
    /// Its centre, seen from the particle: x_s - x_i [m].
    pub(super) offset: Vector<D>,
    /// Unit normal towards the material, -n_s.
    pub(super) normal: Vector<D>,
    /// W_is S_s [1/m].
    pub(super) weight: f64,
    /// Its length, in space the side of a square [m].
    side: f64,
    /// Distance of the particle in front of it [m], and whether it is right above it, not beside it.
    pub(super) front: f64,
    pub(super) below: bool,
    /// Which it is, and the wall it belongs to.
    pub(super) index: usize,
    pub(super) group: usize,
}

impl<const D: usize> Seen<D> {
    /// n_s W_is S_s [1/m].
    pub(super) fn area(&self) -> Vector<D> {
        scale(-self.weight, &self.normal)
    }
}

impl<const D: usize> Solver<D> {
    /// Elements that the particle at `x` sees: in front of which it is, or that it has just gone through.
    #[inline]
    pub(super) fn elements<'s>(
        &'s self,
        x: &'s Vector<D>,
        near: &'s [u32],
    ) -> impl Iterator<Item = Seen<D>> + 's {
        let dp = self.numerics.spacing;
        near.iter().filter_map(move |&wall| {
            let w = wall as usize;
            let offset = self.periodic.difference(&self.walls.position[w], x);
            let r = norm(&offset);
            let side = if D == 2 {
                self.walls.weight[w] * dp
            } else {
                self.walls.weight[w].sqrt() * dp
            };
            // Of an element whose centre is outside the support a part may be inside.
            if r >= self.kernel.support() + 0.5 * side {
                return None;
            }
            let normal = self.walls.normal[w];
            let element = Element {
                offset,
                normal,
                side,
            };
            let front = element.front();
            let along2 = r * r - front * front;
            let below = along2 <= 0.25 * side * side * (1.0 + 1e-9);
            if front <= 0.0 && !(below && front > -dp) {
                return None;
            }
            let area = if D == 2 { side } else { side * side };
            Some(Seen {
                offset,
                normal,
                weight: self.kernel.w(r) * area,
                side,
                front,
                below,
                index: w,
                group: self.walls.group[w] as usize,
            })
        })
    }

    /// Share of the kernel that an element hides [1]: an integral over its surface, not for those who only ask where it is.
    pub(super) fn hidden(&self, seen: &Seen<D>) -> f64 {
        let element = Element {
            offset: seen.offset,
            normal: seen.normal,
            side: seen.side,
        };
        let closest = CLOSEST * self.numerics.spacing;
        element.hidden(&self.kernel, seen.front.max(closest))
    }

    /// Takes from `way` what goes into walls right before the particle at `x`. Shifting does not know that nothing comes after
    /// the wall: it took single particles of thin fronts through it.
    pub(super) fn keep_out(&self, x: &Vector<D>, near: &[u32], way: &mut Vector<D>) {
        for element in self.elements(x, near) {
            let towards = -dot(way, &element.normal);
            if towards > 0.0 && self.is_right_before(&element) {
                for k in 0..D {
                    way[k] += towards * element.normal[k];
                }
            }
        }
    }

    fn is_right_before(&self, element: &Seen<D>) -> bool {
        element.below && element.front < BOUNCE * self.numerics.spacing
    }

    /// Particles right before a wall lose the part of their velocity that goes into it. What is alone has a
    /// density so low that no pressure stops it. The wall gets their momentum.
    pub(super) fn bounce(&self, state: &mut State<D>) {
        for (b, block) in self.lists.blocks.iter().enumerate() {
            for row in 0..block.rows() {
                let i = b * CHUNK + row;
                for element in self.elements(&state.grains.position[i], block.wall_row(row)) {
                    let towards = -dot(&state.grains.velocity[i], &element.normal);
                    if towards <= 0.0 || !self.is_right_before(&element) {
                        continue;
                    }
                    let m = state.grains.mass[i];
                    for k in 0..D {
                        let change = towards * element.normal[k];
                        state.grains.velocity[i][k] += change;
                        state.impulse[element.group][k] -= m * change;
                    }
                }
            }
        }
    }

    /// gamma_i of what its elements hide together.
    pub(super) fn shepard(hidden: f64) -> f64 {
        (1.0 - hidden).max(LEAST_SHEPARD)
    }
}
