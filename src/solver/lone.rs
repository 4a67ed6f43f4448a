//! Fluid particles without neighbours, against walls (docs/theory.md, F5).
//!
//! Density follows div v at the end of a step. A drop that flies onto a wall then counts the way in too much and the way out too
//! little, since walls are nearer at one end of each step than at the other, and jumps back a tenth higher than it fell. Its div v
//! is all the walls', so both ends are to be had: their mean makes density a function of place, to second order, and the jump
//! elastic. In flight it has nothing that could press it.

use crate::math::CHUNK;
use crate::state::State;

use super::Solver;
use super::pair::{Block, WallRow};

/// Whether a row has no neighbours within the support.
fn is_lone<const D: usize>(block: &Block<D>, row: usize) -> bool {
    let mut lone = block.groups(row).len() <= 1;
    if lone {
        block.for_each_pair(row, |_, _, _| lone = false);
    }
    lone
}

impl<const D: usize> Solver<D> {
    /// Particles of fluids without neighbours, and what they see of walls.
    fn lone_rows<'a>(
        &'a self,
        phase: &'a [u8],
    ) -> impl Iterator<Item = (usize, Option<&'a WallRow<D>>)> {
        let blocks = self.lists.blocks.iter().enumerate();
        blocks.flat_map(move |(b, block)| {
            let mut walls = block.wall_rows.iter().peekable();
            (0..block.rows()).filter_map(move |row| {
                let wall = walls.next_if(|w| w.row as usize == row);
                let i = b * CHUNK + row;
                let is_fluid = self.materials[phase[i] as usize].is_fluid();
                (is_fluid && is_lone(block, row)).then_some((i, wall))
            })
        })
    }

    /// Notes div v of lone particles where they stand, at the velocity that is about to move them; nothing in scenes without fluids.
    pub(super) fn note_lone(&mut self, state: &State<D>) {
        let mut lone = std::mem::take(&mut self.lone);
        lone.clear();
        if self.has_fluids {
            let rate = |(i, wall): (usize, Option<&WallRow<D>>)| {
                let rate = wall.map_or(0.0, |w| w.divergence(&self.viscous.velocity[i]));
                (state.grains.id[i], rate)
            };
            lone.extend(self.lone_rows(&state.grains.phase).map(rate));
            lone.sort_unstable_by_key(|(id, _)| *id);
        }
        self.lone = lone;
    }

    /// Makes div v of those that were lone before the sweep, and are, that of the middle of the step; rho_0 where they see nothing.
    pub(super) fn centre_lone(&mut self, state: &mut State<D>) {
        if self.lone.is_empty() {
            return;
        }
        let mut kinematics = std::mem::take(&mut self.kinematics);
        let grains = &mut state.grains;
        for (i, wall) in self.lone_rows(&grains.phase) {
            let Some(w) = wall else {
                if self.rings.get(i).is_none_or(|ring| ring.axis == 0.0) {
                    grains.density[i] = self.materials[grains.phase[i] as usize].rest_density();
                }
                continue;
            };
            let known = self.lone.binary_search_by_key(&grains.id[i], |(id, _)| *id);
            if let Ok(place) = known {
                let after = w.divergence(&grains.velocity[i]);
                kinematics[i].divergence += 0.5 * (self.lone[place].1 - after);
            }
        }
        self.kinematics = kinematics;
    }
}
