//! Particle shifting of fluids (docs/theory.md, "Shifting"; [B] eqs. 17 to 20, after Michel et al. 2022, doi
//! 10.1016/j.jcp.2022.110999): particles go a little from where they are dense to where they are not.
//!
//! Symbols: R = 2 h, U_i largest relative speed among the neighbours (of i, not of the whole domain: a fast jet must not stir a
//! bed at rest), C_i = sum_j V_j W_ij, lambda_i smallest eigenvalue of the moment matrix M (E2), n_i its direction:
//!
//!   du_i = -k_i grad C_i,   k_i = U_i/2 (R/dp)^3 R,   at most U_i/2 R/(2 dp)                        ([B] 17, 18)
//!
//! grad C changes by V |F(0)| times the way of a particle among neighbours that stay, and twice that where they go the other way:
//! what goes further than to where grad C is 0 comes back, and further each time. So
//!
//!   k_i <= 1/(2 V |F(0)| dt)                                                                         (SH3)
//!
//! At a flat surface lambda is 0.5 in the first row, 0.8 in the second and 1 inside. A particle that is at a surface or has a
//! neighbour there is not shifted: [B] 19 and 20 leave out du's part along grad lambda, but with the rest, too, surfaces feed
//! on it. Velocities do not change; the shift ends at walls, whose points count in C and M. Nothing pays for what it lifts: where
//! the particles that go up gain more than those that go down lose, their way up is cut to that share (SH1). Density follows the shift
//! as it follows v:
//!
//!   d rho_i/dt = -rho_i [sum_j (du_j - du_i) . g_ij - 2 du_i . sum_walls g_iw]                      (SH2)
//!
//! and du_r/r of rings, whose C is that of the section.
//!
//! div v of a flow whose places grow uneven is the rate at which sum_j V_j W_ij grows. Shifting takes that back; while density did
//! not see it, pressure in closed channels rose by 10 to 30 Pa a second, for good (not Bingham's).
//!
//! Before walls bore weight along themselves (`lean`) a tank of water at rest had 90 mJ after 1 s with [B] 19 and 20, 12 without
//! shifts at surfaces, 1.9 with (SH1) as well, 1.6 without shifting; docs/theory.md has what is left now.

use crate::math::{Tensor, Vector, add_outer, dot, norm, scale, sub};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// lambda of a particle at a free surface is below this [1].
pub(super) const SURFACE: f64 = 0.9;

impl<const D: usize> Solver<D> {
    /// Whether particles of a scene are shifted.
    pub(super) fn shifts(&self) -> bool {
        self.numerics.shifting > 0.0 && self.materials.iter().any(|m| m.is_fluid())
    }

    /// Fills `self.shift` for a step of dt [s] from the pair coefficients of the state's positions; before `sweep_pressure` changes
    /// them.
    pub(super) fn find_shift(&mut self, state: &State<D>, dt: f64) {
        if !self.shifts() {
            return;
        }
        let n = state.grains.len();
        let mut open = std::mem::take(&mut self.openness);
        open.resize(n, 1.0);
        self.workers
            .blocks_read(&self.lists.blocks, &mut open, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    *o = self.openness(state, block, row, first + row);
                }
            });
        let restoring = self.numerics.spacing.powi(D as i32) * self.kernel.f(0.0).abs();
        let most = 0.5 / (restoring * dt);
        let mut shift = std::mem::take(&mut self.shift);
        shift.resize(n, [0.0; D]);
        self.workers
            .blocks_read(&self.lists.blocks, &mut shift, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                for (row, o) in out.iter_mut().enumerate() {
                    let wall = walls.next_if(|w| w.row as usize == row);
                    let slope = wall.map_or([0.0; D], |w| w.s);
                    let own = (block, row, first + row);
                    *o = self.shift_velocity(state, &open, own, (slope, most));
                }
            });
        self.openness = open;
        self.lift_nothing(state, &mut shift);
        self.shift = shift;
        self.find_shift_divergence();
    }

    /// div du by the sums of div v.                                                                          (SH2)
    fn find_shift_divergence(&mut self) {
        let mut divergence = std::mem::take(&mut self.shift_divergence);
        let shift = &self.shift;
        divergence.resize(shift.len(), 0.0);
        self.workers
            .blocks_read(&self.lists.blocks, &mut divergence, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    let own = shift[first + row];
                    *o = self.hoop_rate(first + row, &own);
                    block.for_each_pair(row, |j, _, g| {
                        *o += dot(&sub(&shift[j as usize], &own), &g);
                    });
                }
                for wall in &block.wall_rows {
                    let row = wall.row as usize;
                    out[row] -= 2.0 * dot(&shift[first + row], &wall.s);
                }
            });
        self.shift_divergence = divergence;
    }

    /// Cuts what goes against gravity by what of it goes along gravity does not pay for: sum m g . du >= 0.     (SH1)
    fn lift_nothing(&self, state: &State<D>, shift: &mut [Vector<D>]) {
        // Nothing is higher along a periodic side.
        let down: Vector<D> = std::array::from_fn(|k| {
            if self.periodic.length[k] > 0.0 {
                0.0
            } else {
                self.gravity[k]
            }
        });
        let size = norm(&down);
        if size == 0.0 {
            return;
        }
        let down = scale(1.0 / size, &down);
        let mass = &state.grains.mass;
        let [paid, asked] = self.workers.sums(shift.len(), |i| {
            let part = mass[i] * dot(&down, &shift[i]);
            [part.max(0.0), (-part).max(0.0)]
        });
        if asked <= paid {
            return;
        }
        let missing = 1.0 - paid / asked;
        self.workers.each(shift, |_, du| {
            let way = dot(&down, du);
            if way < 0.0 {
                for k in 0..D {
                    du[k] -= missing * way * down[k];
                }
            }
        });
    }

    /// lambda of row i [1].
    pub(super) fn openness(&self, state: &State<D>, block: &Block<D>, row: usize, i: usize) -> f64 {
        if self.geometry.is_axisymmetric() {
            return smallest(&self.section_sums(state, block, (i, row)).1).0;
        }
        let mut moment = [[0.0; D]; D];
        // -x (x) g = g (x) g/(V |F|), and V |F| = k/2.
        block.for_each_pair(row, |_, k, g| add_outer(&mut moment, 2.0 / k, &g, &g));
        let near = block.wall_row(row);
        if !near.is_empty() {
            self.add_wall_moment(&state.grains.position[i], i, near, &mut moment);
        }
        smallest(&moment).0
    }

    /// du of row i [m/s]; `slope` is the walls' part of grad C, `most` what k is at most [m^2/s].
    fn shift_velocity(
        &self,
        state: &State<D>,
        open: &[f64],
        (block, row, i): (&Block<D>, usize, usize),
        (mut slope, most): (Vector<D>, f64),
    ) -> Vector<D> {
        let speed = self.kinematics[i].relative_speed;
        let own = open[i];
        let shifted = self.materials[state.grains.phase[i] as usize].is_fluid();
        if !shifted || speed == 0.0 || own < SURFACE {
            return [0.0; D];
        }
        let mut least = own;
        block.for_each_pair(row, |j, _, g| {
            least = least.min(open[j as usize]);
            for a in 0..D {
                slope[a] += g[a];
            }
        });
        if self.geometry.is_axisymmetric() {
            slope = self.section_sums(state, block, (i, row)).0;
        }
        if least < SURFACE {
            return [0.0; D];
        }
        let reach = self.kernel.support();
        let ratio = reach / self.numerics.spacing;
        let half_speed = 0.5 * self.numerics.shifting * speed;
        let k = (half_speed * ratio.powi(3) * reach).min(most);
        let (size, largest) = (k * norm(&slope), half_speed * 0.5 * ratio);
        let cut = if size > largest { largest / size } else { 1.0 };
        scale(-k * cut, &slope)
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
