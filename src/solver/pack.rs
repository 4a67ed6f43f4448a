//! Packing of the start (docs/theory.md, "Start"): a lattice whose points were moved at random presses unevenly, 2 p grad C_i where
//! C_i = sum_j V_j W_ij should be even, and material that yields keeps such forces for good. Particles are moved down the
//! gradient of C before the first step (after Colagrossi, Bouscasse, Antuono, Marrone 2012, doi 10.1016/j.cpc.2012.02.032):
//!
//!   x_i <- x_i - dp^2 grad C_i,   rho_i by the weight of what lies higher or lower.                           (S1)
//!
//! What is at a surface stays where it is: C falls there as it should. What was moved into a wall, corners above all, so that (W5)
//! would throw it out, goes out of it first.

use crate::math::{Vector, add, dot, norm, scale};
use crate::state::State;

use super::shift::SURFACE;
use super::{Scheme, Solver};

/// Sweeps. What is as long as the kernel's width decays by a tenth in each; what is shorter presses little.
const SWEEPS: u32 = 40;

/// Most of a move, over the spacing [1]; and the move of what is behind the surface of a wall.
const LONGEST: f64 = 0.1;
const OUT: f64 = 0.02;

impl<const D: usize> Solver<D> {
    /// Evens a fresh state; nothing where the lattice was left as it is, of rings, and in the reference schemes.
    pub(super) fn pack(&mut self, state: &mut State<D>) {
        let numerics = &self.numerics;
        if numerics.jitter == 0.0
            || numerics.scheme != Scheme::Implicit
            || self.geometry.is_axisymmetric()
        {
            return;
        }
        let start = state.grains.position.clone();
        let ids = state.grains.id.clone();
        self.sweep_kinematics(state);
        for _ in 0..SWEEPS {
            let moves = self.even_out(state);
            for (x, step) in state.grains.position.iter_mut().zip(&moves) {
                for k in 0..D {
                    x[k] += step[k];
                }
            }
            self.wrap(&mut state.grains.position);
            self.sweep_kinematics_in_valid_lists(state, false);
        }
        self.weigh(state, &ids, &start);
    }

    /// The step of each particle [m].
    fn even_out(&mut self, state: &State<D>) -> Vec<Vector<D>> {
        let n = state.grains.len();
        let mut open = vec![1.0; n];
        self.workers
            .blocks_read(&self.lists.blocks, &mut open, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    *o = self.openness(state, block, row, first + row);
                }
            });
        let dp = self.numerics.spacing;
        let mut moves = vec![[0.0; D]; n];
        self.workers
            .blocks_read(&self.lists.blocks, &mut moves, |block, first, out| {
                let mut walls = block.wall_rows.iter().peekable();
                for (row, o) in out.iter_mut().enumerate() {
                    let wall = walls.next_if(|w| w.row as usize == row);
                    let mut slope = wall.map_or([0.0; D], |w| w.s);
                    let mut least = open[first + row];
                    block.for_each_pair(row, |j, _, g| {
                        least = least.min(open[j as usize]);
                        for k in 0..D {
                            slope[k] += g[k];
                        }
                    });
                    if least >= SURFACE {
                        let step = scale(-dp * dp, &slope);
                        let size = norm(&step);
                        if size > 0.0 {
                            *o = scale((LONGEST * dp / size).min(1.0), &step);
                        }
                    }
                    if let Some(w) = wall.filter(|w| w.barrier > 0.0) {
                        *o = add(o, &scale(OUT * dp / norm(&w.push), &w.push));
                    }
                }
            });
        moves
    }

    /// Pressure of the depth that a particle has come to.
    fn weigh(&self, state: &mut State<D>, ids: &[u64], start: &[Vector<D>]) {
        let grains = &mut state.grains;
        let mut at: Vec<u32> = (0..ids.len() as u32).collect();
        at.sort_unstable_by_key(|&i| ids[i as usize]);
        for i in 0..grains.len() {
            let Ok(place) = at.binary_search_by_key(&grains.id[i], |&k| ids[k as usize]) else {
                continue;
            };
            let from = &start[at[place] as usize];
            let moved = self.periodic.difference(&grains.position[i], from);
            let material = &self.materials[grains.phase[i] as usize];
            let rest = material.rest_density();
            // What is loose by its flow stays so.
            if grains.density[i] >= rest {
                let c = self.sound_speed_of(material);
                let change = rest * dot(&self.gravity, &moved) / (c * c);
                grains.density[i] = (grains.density[i] + change).max(rest);
            }
        }
        grains.swept_density.clone_from(&grains.density);
    }
}
