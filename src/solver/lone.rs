//! Fluid particles without neighbours, against walls (docs/theory.md, F5).
//!
//! Density follows div v at the end of a step. A drop that flies onto a wall then counts the way in too much and the way out too
//! little, since walls are nearer at one end of each step than at the other, and jumps back a tenth higher than it fell. Its div v
//! is all the walls', so both ends are to be had: their mean makes density a function of place, to second order, and the jump
//! elastic. In flight it has nothing that could press it.

use crate::math::{Vector, dot};
use crate::state::State;

use super::Solver;
use super::pair::{Block, WallRow};

/// What walls do to the volume of a particle at velocity v [1/s].
fn wall_rate<const D: usize>(w: &WallRow<D>, v: &Vector<D>) -> f64 {
    -2.0 * (dot(v, &w.s) - w.drive)
}

/// Whether a row has no neighbours within the support.
fn is_lone<const D: usize>(block: &Block<D>, row: usize) -> bool {
    let mut lone = block.groups(row).len() <= 1;
    if lone {
        block.for_each_pair(row, |_, _, _| lone = false);
    }
    lone
}

impl<const D: usize> Solver<D> {
    /// Notes div v of lone particles where they stand, at the velocity that is about to move them; nothing in scenes without fluids.
    pub(super) fn note_lone(&mut self, state: &State<D>) {
        self.lone.clear();
        if !self.has_fluids {
            return;
        }
        let mut first = 0;
        for block in &self.lists.blocks {
            let mut walls = block.wall_rows.iter().peekable();
            for row in 0..block.rows() {
                let wall = walls.next_if(|w| w.row as usize == row);
                let i = first + row;
                let material = &self.materials[state.grains.phase[i] as usize];
                if material.is_fluid() && is_lone(block, row) {
                    let rate = wall.map_or(0.0, |w| wall_rate(w, &self.viscous.velocity[i]));
                    self.lone.push((state.grains.id[i], rate));
                }
            }
            first += block.rows();
        }
        self.lone.sort_unstable_by_key(|(id, _)| *id);
    }

    /// Makes div v of those that were lone before the sweep, and are, that of the middle of the step; rho_0 where they see nothing.
    pub(super) fn centre_lone(&mut self, state: &mut State<D>) {
        if self.lone.is_empty() {
            return;
        }
        let grains = &mut state.grains;
        let mut first = 0;
        for block in &self.lists.blocks {
            let mut walls = block.wall_rows.iter().peekable();
            for row in 0..block.rows() {
                let wall = walls.next_if(|w| w.row as usize == row);
                let i = first + row;
                let material = &self.materials[grains.phase[i] as usize];
                if !material.is_fluid() || !is_lone(block, row) {
                    continue;
                }
                let Some(w) = wall else {
                    if self.rings.get(i).is_none_or(|ring| ring.axis == 0.0) {
                        grains.density[i] = material.rest_density();
                    }
                    continue;
                };
                let known = self.lone.binary_search_by_key(&grains.id[i], |(id, _)| *id);
                if let Ok(place) = known {
                    let after = wall_rate(w, &grains.velocity[i]);
                    self.kinematics[i].divergence += 0.5 * (self.lone[place].1 - after);
                }
            }
            first += block.rows();
        }
    }
}
