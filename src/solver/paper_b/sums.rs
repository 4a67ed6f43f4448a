//! First sweep: density rate, strain rate, Shepard factor, and where the surface of each phase is.
//!
//! Symbols: u_ji = u_j - u_i, r_ji = r_j - r_i, grad W = grad_i W_ij, V = m/rho, "same" sums over particles of i's own phase.

use crate::math::{Tensor, Vector, add_outer, dot, inverse, scale, sub};
use crate::solver::Solver;
use crate::solver::shift::smallest;
use crate::state::State;

use super::walls::Seen;

/// Below this smallest eigenvalue of the moment matrix gradients are not renormalised but left out [1].
const LEAST_MOMENT: f64 = 0.2;

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<const D: usize> {
    /// R = -rho_i sum V_j u_ji.grad W/gamma_i ([B] eq. 3, all phases; walls too) [kg/(m^3 s)].
    pub(super) density_rate: f64,
    /// grad u = sum_same V_j u_ji (x) grad W/gamma_i ([B] eq. 6) [1/s].
    pub(super) gradient: Tensor<D>,
    /// gamma_i [1].
    pub(super) shepard: f64,
    /// Smallest eigenvalue of the moment matrix sum_same r_ji (x) grad W V_j/gamma_i, walls counted ([B] eq. 19, not inverted):
    /// 1 inside a phase [1].
    pub(super) lambda: f64,
    /// L: inverse of the moment matrix of the particles alone; 0 where too few are near.
    pub(super) renormalisation: Tensor<D>,
    /// <grad rho>^L = L sum_same (rho_j - rho_i) grad W V_j [kg/m^4].
    pub(super) density_gradient: Vector<D>,
}

impl<const D: usize> Default for Sums<D> {
    fn default() -> Self {
        Self {
            density_rate: 0.0,
            gradient: [[0.0; D]; D],
            shepard: 1.0,
            lambda: 1.0,
            renormalisation: [[0.0; D]; D],
            density_gradient: [0.0; D],
        }
    }
}

/// A neighbour within the support.
pub(super) struct Near<const D: usize> {
    /// r_ji [m].
    pub(super) offset: Vector<D>,
    /// |r_ji| [m].
    pub(super) r: f64,
    /// V_j grad W [1/m].
    pub(super) slope: Vector<D>,
    /// V_j F, so that grad W = F (r_i - r_j) [1/m^2].
    pub(super) steepness: f64,
}

impl<const D: usize> Solver<D> {
    /// The sums of the state's positions, velocities and densities.
    pub(super) fn sum_rates(&mut self, state: &State<D>, out: &mut Vec<Sums<D>>) {
        let n = state.grains.len();
        self.volume.resize(n, 0.0);
        self.update_volumes(&state.grains.mass, &state.grains.density);
        out.resize(n, Sums::default());
        self.workers
            .blocks_read(&self.lists.blocks, out, |block, first, out| {
                for (row, sums) in out.iter_mut().enumerate() {
                    *sums = self.rates_of(state, first + row, block.row(row), block.wall_row(row));
                }
            });
    }

    fn rates_of(&self, state: &State<D>, i: usize, near: &[u32], walls: &[u32]) -> Sums<D> {
        let grains = &state.grains;
        let (x, u, rho) = (&grains.position[i], &grains.velocity[i], grains.density[i]);
        let mut divergence = 0.0;
        let mut gradient = [[0.0; D]; D];
        let mut moment = [[0.0; D]; D];
        let mut slope = [0.0; D];
        for &j in near {
            let j = j as usize;
            let Some(at) = self.near(state, i, j) else {
                continue;
            };
            let du = sub(&grains.velocity[j], u);
            divergence += dot(&du, &at.slope);
            if grains.phase[j] == grains.phase[i] {
                add_outer(&mut gradient, 1.0, &du, &at.slope);
                add_outer(&mut moment, 1.0, &at.offset, &at.slope);
                let change = grains.density[j] - rho;
                for k in 0..D {
                    slope[k] += change * at.slope[k];
                }
            }
        }
        let mut whole = moment;
        let mut hidden = 0.0;
        for element in self.elements(x, walls) {
            hidden += self.hidden(&element);
            let area = element.area();
            // A wall at rest: u_s - u_i, of which free slip sees the normal part only.
            let towards = -dot(u, &element.normal);
            divergence += towards * dot(&element.normal, &area);
            let du = if self.slips(&element) {
                scale(towards, &element.normal)
            } else {
                scale(-1.0, u)
            };
            add_outer(&mut gradient, 1.0, &du, &area);
            add_outer(&mut whole, 1.0, &element.offset, &area);
        }
        let shepard = Self::shepard(hidden);
        let over = 1.0 / shepard;
        let (alone, _) = smallest(&symmetric(&moment));
        let renormalisation = if alone > LEAST_MOMENT {
            inverse(&moment)
        } else {
            [[0.0; D]; D]
        };
        Sums {
            density_rate: -rho * divergence * over,
            gradient: gradient.map(|row| scale(over, &row)),
            shepard,
            lambda: over * smallest(&symmetric(&whole)).0,
            renormalisation,
            density_gradient: crate::math::apply(&renormalisation, &slope),
        }
    }

    /// Neighbour j of particle i, if it is within the support.
    #[inline(always)]
    pub(super) fn near(&self, state: &State<D>, i: usize, j: usize) -> Option<Near<D>> {
        let position = &state.grains.position;
        let offset = self.periodic.difference(&position[j], &position[i]);
        let r2 = dot(&offset, &offset);
        let support = self.kernel.support();
        (r2 < support * support && r2 > 0.0).then(|| {
            let r = r2.sqrt();
            let steepness = self.volume[j] * self.kernel.f(r);
            Near {
                offset,
                r,
                slope: scale(-steepness, &offset),
                steepness,
            }
        })
    }

    /// Whether material slips along an element.
    #[inline(always)]
    pub(super) fn slips(&self, element: &Seen<D>) -> bool {
        self.walls.groups[element.group].free_slip
    }
}

/// Its symmetric part.
fn symmetric<const D: usize>(t: &Tensor<D>) -> Tensor<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| 0.5 * (t[a][b] + t[b][a])))
}
