//! Particle shifting of fluids (docs/theory.md, "Shifting"; [B] eqs. 17 to 20, after Michel et al. 2022, doi
//! 10.1016/j.jcp.2022.110999): particles go a little from where they are dense to where they are not.
//!
//! Symbols: R = 2 h, U_i largest relative speed among the neighbours (of i, not of the whole domain: a fast jet must not stir a
//! bed at rest), C_i = sum_j V_j W_ij, lambda_i smallest eigenvalue of the moment matrix M (E2), n_i its direction:
//!
//!   du_i = -U_i/2 (R/dp)^3 R grad C_i,  at most U_i/2 R/(2 dp)                                      ([B] 17, 18)
//!
//! At a flat surface lambda is 0.5 in the first row, 0.8 in the second and 1 inside. Where a particle or a neighbour of it is at
//! a surface, du's part along grad lambda is left out ([B] 19, 20): pushed outwards, rows would lift the surface.
//! Velocities do not change; the shift ends at walls, whose points count in C and M.

use crate::math::{Tensor, Vector, add_outer, dot, norm, scale};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// lambda of a particle at a free surface is below this [1].
pub(super) const SURFACE: f64 = 0.9;

/// lambda of drops and spray, which are left alone, is below this [1].
const ALONE: f64 = 0.2;

/// What shifting knows of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Openness<const D: usize> {
    /// Smallest eigenvalue of M.
    pub(super) lambda: f64,
    /// Its direction.
    normal: Vector<D>,
}

impl<const D: usize> Openness<D> {
    /// That of a particle with neighbours all round.
    pub(super) const INSIDE: Self = Self {
        lambda: 1.0,
        normal: [0.0; D],
    };
}

impl<const D: usize> Solver<D> {
    /// Whether particles of a scene are shifted.
    pub(super) fn shifts(&self) -> bool {
        self.numerics.shifting > 0.0 && self.materials.iter().any(|m| m.is_fluid())
    }

    /// Fills `self.shift` from the pair coefficients of the state's positions; before `sweep_pressure` changes them.
    pub(super) fn find_shift(&mut self, state: &State<D>) {
        if !self.shifts() {
            return;
        }
        let n = state.grains.len();
        let mut open = std::mem::take(&mut self.openness);
        open.resize(n, Openness::INSIDE);
        self.workers
            .blocks_read(&self.lists.blocks, &mut open, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    *o = self.openness(state, block, row, first + row);
                }
            });
        let mut shift = std::mem::take(&mut self.shift);
        shift.resize(n, [0.0; D]);
        self.workers
            .blocks_read(&self.lists.blocks, &mut shift, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                for (row, o) in out.iter_mut().enumerate() {
                    let wall = walls.next_if(|w| w.row as usize == row);
                    let slope = wall.map_or([0.0; D], |w| w.s);
                    *o = self.shift_velocity(state, &open, (block, row, first + row), slope);
                }
            });
        self.openness = open;
        self.shift = shift;
    }

    pub(super) fn openness(
        &self,
        state: &State<D>,
        block: &Block<D>,
        row: usize,
        i: usize,
    ) -> Openness<D> {
        let mut moment = [[0.0; D]; D];
        // -x (x) g = g (x) g/(V |F|), and V |F| = k/2.
        block.for_each_pair(row, |_, k, g| add_outer(&mut moment, 2.0 / k, &g, &g));
        let near = block.wall_row(row);
        if !near.is_empty() {
            self.add_wall_moment(&state.grains.position[i], i, near, &mut moment);
        }
        let (lambda, normal) = smallest(&moment);
        Openness { lambda, normal }
    }

    /// du of row i [m/s]; `slope` is the walls' part of grad C.
    fn shift_velocity(
        &self,
        state: &State<D>,
        open: &[Openness<D>],
        (block, row, i): (&Block<D>, usize, usize),
        mut slope: Vector<D>,
    ) -> Vector<D> {
        let speed = self.kinematics[i].relative_speed;
        let own = &open[i];
        let shifted = self.materials[state.grains.phase[i] as usize].is_fluid();
        if !shifted || speed == 0.0 || own.lambda < ALONE {
            return [0.0; D];
        }
        let mut outwards = [0.0; D];
        let mut least = own.lambda;
        block.for_each_pair(row, |j, _, g| {
            let lambda = open[j as usize].lambda;
            least = least.min(lambda);
            for a in 0..D {
                slope[a] += g[a];
                outwards[a] += (lambda - own.lambda) * g[a];
            }
        });
        if least < SURFACE {
            let size = norm(&outwards);
            let n = if size > 0.0 {
                scale(1.0 / size, &outwards)
            } else {
                own.normal
            };
            let along = dot(&slope, &n);
            for a in 0..D {
                slope[a] -= along * n[a];
            }
        }
        let reach = self.kernel.support();
        let ratio = reach / self.numerics.spacing;
        let size = ratio.powi(3) * reach * norm(&slope);
        let most = 0.5 * ratio;
        let cut = if size > most { most / size } else { 1.0 };
        let factor = -0.5 * self.numerics.shifting * speed * cut * ratio.powi(3) * reach;
        scale(factor, &slope)
    }

    fn add_wall_moment(&self, x: &Vector<D>, i: usize, near: &[u32], moment: &mut Tensor<D>) {
        for &wall in near {
            let (offset, r) = self.wall_offset(x, wall);
            let weight = self.walls.weight[wall as usize];
            if r < self.kernel.support() && weight > 0.0 {
                let vf = self.wall_volume(i, wall, weight) * self.kernel.f(r);
                add_outer(moment, -vf, &offset, &offset);
            }
        }
    }
}

/// Smallest eigenvalue of a symmetric tensor and its direction.
pub(super) fn smallest<const D: usize>(t: &Tensor<D>) -> (f64, Vector<D>) {
    if D == 2 {
        let (a, b, c) = (t[0][0], t[0][1], t[1][1]);
        let half = 0.5 * (a - c);
        let root = half.hypot(b);
        let lambda = 0.5 * (a + c) - root;
        // Of (b, lambda - a) and (lambda - c, b) the longer one: both are along the eigenvector.
        let (x, y) = if half > 0.0 {
            (b, lambda - a)
        } else {
            (lambda - c, b)
        };
        let size = x.hypot(y);
        let mut n = [0.0; D];
        if size > 0.0 {
            (n[0], n[1]) = (x / size, y / size);
        }
        return (lambda, n);
    }
    let eigen = nalgebra::Matrix3::from_fn(|a, b| t[a][b]).symmetric_eigen();
    let k = eigen.eigenvalues.imin();
    (
        eigen.eigenvalues[k],
        std::array::from_fn(|a| eigen.eigenvectors[(a, k)]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_smallest<const D: usize>(t: &Tensor<D>, expected: f64) {
        let (lambda, n) = smallest(t);
        assert!((lambda - expected).abs() < 1e-12, "{t:?}: {lambda}");
        assert!((norm(&n) - 1.0).abs() < 1e-12, "{t:?}: {n:?}");
        let image = crate::math::apply(t, &n);
        for k in 0..D {
            assert!((image[k] - lambda * n[k]).abs() < 1e-12, "{t:?}: {n:?}");
        }
    }

    #[test]
    fn smallest_eigenvalue_and_its_direction() {
        is_smallest(&[[2.0, 0.0], [0.0, 0.5]], 0.5);
        is_smallest(&[[0.5, 0.0], [0.0, 2.0]], 0.5);
        is_smallest(&[[2.0, 1.0], [1.0, 2.0]], 1.0);
        is_smallest(&[[1.0, 0.3], [0.3, 0.4]], 0.7 - 0.18f64.sqrt());
        is_smallest(&[[2.0, 0.0, 0.0], [0.0, 2.0, 1.0], [0.0, 1.0, 2.0]], 1.0);
    }
}
