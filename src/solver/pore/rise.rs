//! Water that a saturated bed has run over rises through it (docs/theory.md, F8).
//!
//! Pores follow the water above at once (F2), so that what water a bed covers is not held: it seeps out, and grains settle in its place. Particles of
//! water do not pass between those of a bed. A row of them that its front runs over stays on the floor, bears all that lies on it, is therefore what
//! the pores above it have as their pressure, and leaves nothing between the grains: the front slid on it without friction, further the finer.
//!
//! So what is covered changes places with the grains above it. Mass is nobody's but each particle's own, momentum is kept, and energy lost: of the fall,
//! and of how both moved against each other.
//!
//! Symbols: dp spacing, S_s and S_w the sums dp^D W over what holds grains (saturated ones, wall points) and over fluids, of what is more than 0.3 dp
//! above; S_0 that sum in a lattice.

use crate::math::{CHUNK, Vector, dot, norm, scale};
use crate::solver::Solver;
use crate::solver::meeting::HARDER;
use crate::state::State;

use super::lattice;

/// How much higher than a particle what covers it is, over the spacing [1].
const ABOVE: f64 = 0.3;
/// S_s/S_0 from which on it is covered, and S_w/S_0 up to which [1]. Under one whole row the first is 0.9; in a crack as wide as a spacing the second
/// is 0.47, beside an upright bank 0.73 (by the kernel's sums over a lattice, h/dp = 1.6, in the plane).
const COVERED: f64 = 0.75;
const OPEN: f64 = 0.2;
/// Distance up to which it changes places, over the spacing [1].
const REACH: f64 = 1.5;

impl<const D: usize> Solver<D> {
    /// Lets fluid under saturated grains change places with them (F8); returns whether any did. Lists must be made anew then.
    pub(in crate::solver) fn let_rise(&mut self, state: &mut State<D>) -> bool {
        if !self.has_pores || !self.has_fluids || self.gravity_norm == 0.0 {
            return false;
        }
        let up = scale(-1.0 / self.gravity_norm, &self.gravity);
        let whole = self.lattice_above();
        let mut has_moved = Vec::new();
        let mut moved = std::mem::take(&mut self.moved);
        for i in 0..state.grains.len() {
            let Some(j) = self.above_it(state, i, &up, whole) else {
                continue;
            };
            has_moved.resize(state.grains.len(), false);
            if has_moved[i] || has_moved[j] {
                continue;
            }
            (has_moved[i], has_moved[j]) = (true, true);
            let grains = &state.grains;
            let [from, to] = [i, j].map(|k| grains.position[k]);
            let way = self.periodic.difference(&to, &from);
            for (k, from, way) in [(i, from, way), (j, to, scale(-1.0, &way))] {
                // Across a periodic side as if there were none.
                let to = std::array::from_fn(|a| from[a] + way[a]);
                moved.note((grains.phase[k], grains.mass[k]), from, to);
            }
            self.exchange(state, i, j, dot(&way, &up));
        }
        self.moved = moved;
        !has_moved.is_empty()
    }

    /// The grains that particle i, if it is of the fluid in their pores and they cover it, changes places with.
    fn above_it(&self, state: &State<D>, i: usize, up: &Vector<D>, whole: f64) -> Option<usize> {
        let (grains, spacing) = (&state.grains, self.numerics.spacing);
        let fluid = &self.materials[grains.phase[i] as usize];
        let block = &self.lists.blocks[i / CHUNK];
        if !fluid.flows() || block.kinds(i % CHUNK)[HARDER as usize].is_empty() || grains.drained[i]
        {
            return None;
        }
        let x = &grains.position[i];
        let cell = spacing.powi(D as i32);
        let (mut solid, mut open) = (0.0, 0.0);
        let mut nearest = (f64::INFINITY, None);
        for &j in block.row(i % CHUNK) {
            let j = j as usize;
            let d = self.periodic.difference(&grains.position[j], x);
            let height = dot(&d, up);
            if height <= ABOVE * spacing {
                continue;
            }
            let material = &self.materials[grains.phase[j] as usize];
            let distance = norm(&d);
            let share = cell * self.kernel.w(distance);
            if material.is_fluid() {
                open += share;
            } else {
                solid += share;
            }
            let other = material.grains.pore_density - fluid.rest_density();
            // A density that went through a solid fraction is off by rounding.
            let holds = other.abs() <= 1e-9 * fluid.rest_density()
                && material.rest_density() > fluid.rest_density();
            // Of two as near, the one straight above.
            let beside = (distance * distance - height * height).max(0.0).sqrt();
            let is_near = distance < REACH * spacing && distance + beside < nearest.0;
            if holds && is_near && !grains.drained[j] {
                nearest = (distance + beside, Some(j));
            }
        }
        for &w in block.wall_row(i % CHUNK) {
            let d = self
                .periodic
                .difference(&self.walls.position[w as usize], x);
            if dot(&d, up) > ABOVE * spacing {
                solid += cell * self.walls.weight[w as usize] * self.kernel.w(norm(&d));
            }
        }
        let covered = solid >= COVERED * whole && open <= OPEN * whole;
        nearest.1.filter(|_| covered)
    }

    /// Particles i and j, j higher by `height` [m], change places: each has the pressure of where it comes to, both the velocity of their mass centre.
    fn exchange(&self, state: &mut State<D>, i: usize, j: usize, height: f64) {
        let grains = &mut state.grains;
        grains.position.swap(i, j);
        let (m, n) = (grains.mass[i], grains.mass[j]);
        let together: Vector<D> = std::array::from_fn(|k| {
            (m * grains.velocity[i][k] + n * grains.velocity[j][k]) / (m + n)
        });
        for (k, other) in [(i, j), (j, i)] {
            let material = &self.materials[grains.phase[k] as usize];
            let c = self.sound_speed_of(material);
            grains.velocity[k] = together;
            grains.density[k] = material.density_under(self.pressure[other].max(0.0), c);
        }
        let density = self.materials[grains.phase[j] as usize].grains.pore_density;
        let deeper = density * self.gravity_norm * height;
        grains.pore_pressure[j] += deeper;
        let relaxed = &mut grains.relaxed_pore_pressure[j];
        // 0 of what has just come.
        if *relaxed != 0.0 {
            *relaxed += deeper;
        }
    }

    /// S_0 [1].
    fn lattice_above(&self) -> f64 {
        let spacing = self.numerics.spacing;
        let above = lattice(&self.kernel, spacing).filter(|x| x[D - 1] > 0.0);
        spacing.powi(D as i32) * above.map(|x| self.kernel.w(norm(&x))).sum::<f64>()
    }
}
