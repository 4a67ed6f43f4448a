//! Inflows that let rows of particles in between two internal steps, where there is room.

use crate::boundary::{Mover, Piston, Plate};
use crate::math::{Vector, add, dot, norm, scale};
use crate::state::{Grains, State};

use super::{Scheme, Solver};

/// Distance from a slot of an inflow within which nothing may be when a particle enters there, over the spacing.
const ROOM: f64 = 0.6;

/// Distance from a point of a wall within which a place of an inflow's row is inside that wall, over the spacing. Such a place stands half
/// a spacing before its face and in from the face's ends, at least a quarter where that is short, and points half a spacing behind
/// theirs. Within walls no place is further from the nearest than 0.71 in the plane, and 0.87 in space, where a face of few places may be
/// missed.
pub const INSIDE: f64 = 0.74;

/// A face that lets rows of particles in.
#[derive(Clone, Debug)]
pub struct Source<const D: usize> {
    /// Where a row's particles appear [m].
    pub slots: Vec<Vector<D>>,
    /// Mass of the particle of each slot [kg].
    pub masses: Vec<f64>,
    /// Their velocity [m/s].
    pub velocity: Vector<D>,
    /// Index of the material.
    pub phase: u8,
    /// Density they come with [kg/m^3].
    pub density: f64,
    /// Longer edge of the face [m].
    pub length: f64,
    /// What of the wall behind the face comes forward, if what enters pushes.
    pub piston: Option<Piston<D>>,
}

impl<const D: usize> Source<D> {
    /// Mass of a row [kg].
    #[must_use]
    pub fn row_mass(&self) -> f64 {
        self.masses.iter().fold(0.0, |sum, m| sum + m)
    }
}

impl<const D: usize> Solver<D> {
    /// Lets in what is due of a row, where it has room; returns whether any came.
    pub(super) fn feed(&mut self, state: &mut State<D>, rates: &[f64], dt: f64) -> bool {
        let mut came = false;
        for n in 0..self.sources.len() {
            if self.sources[n].piston.is_some() {
                came |= self.let_row_in(state, n);
                continue;
            }
            let source = &self.sources[n];
            let row = source.row_mass();
            let inflow = &mut state.inflows[n];
            if rates[n] <= 0.0 {
                // Closed: a row that was due and had no room stays out.
                if inflow.pending >= row {
                    inflow.pending = 0.0;
                }
                continue;
            }
            inflow.pending += rates[n] * dt;
            if inflow.pending < row {
                continue;
            }
            let free = self.free_slots(&state.grains, source, ROOM);
            let entered = self.enter(state, source, &free);
            let inflow = &mut state.inflows[n];
            inflow.pending -= entered;
            inflow.admitted += entered;
            came |= entered > 0.0;
            if inflow.pending >= row {
                // What cannot enter, for what stands before it or because a step lets in one row, is refused and not saved up for a burst.
                inflow.pending = row;
                inflow.blocked = true;
            }
        }
        came
    }

    /// Which slots of a source have no grain within a share of the spacing, and are not inside a gate or a wall that moves: fixed walls
    /// were looked at when the scene was built.
    pub(super) fn free_slots(
        &self,
        grains: &Grains<D>,
        source: &Source<D>,
        room: f64,
    ) -> Vec<bool> {
        let (room, inside) = (room * self.numerics.spacing, INSIDE * self.numerics.spacing);
        let apart = |x: &Vector<D>, y: &Vector<D>| self.periodic.difference(x, y);
        let Some(first) = source.slots.first() else {
            return Vec::new();
        };
        let farthest = |most: f64, slot: &Vector<D>| most.max(norm(&apart(slot, first)));
        let reach = source.slots.iter().fold(0.0, farthest) + room.max(inside);
        let is_near = |x: &Vector<D>| norm(&apart(x, first)) < reach;
        let mut free = vec![true; source.slots.len()];
        let present = grains.position.iter().zip(&grains.drained);
        for (x, _) in present.filter(|(x, gone)| !**gone && is_near(x)) {
            for (slot, free) in source.slots.iter().zip(&mut free) {
                *free &= norm(&apart(x, slot)) >= room;
            }
        }
        let walls = &self.walls;
        let shown = |w: &usize| walls.weight[*w] > 0.5 && is_near(&walls.position[*w]);
        // Elements of scheme paper_b lie in the surface itself: what is in front of them is clear, however near.
        let in_surface = matches!(self.numerics.scheme, Scheme::PaperB(_));
        for w in self.moving_points().filter(shown) {
            for (slot, free) in source.slots.iter().zip(&mut free) {
                let d = apart(slot, &walls.position[w]);
                *free &= norm(&d) >= inside || in_surface && dot(&walls.normal[w], &d) >= 0.0;
            }
        }
        free
    }

    /// Indices of the wall points of gates and of walls that move as a whole.
    fn moving_points(&self) -> impl Iterator<Item = usize> + '_ {
        let plates = self.plates.iter().flat_map(Plate::range);
        plates.chain(self.movers.iter().flat_map(Mover::points).copied())
    }

    /// Adds a particle at each free slot; their mass [kg].
    pub(super) fn enter(&self, state: &mut State<D>, source: &Source<D>, free: &[bool]) -> f64 {
        let mut entered = 0.0;
        for ((slot, mass), free) in source.slots.iter().zip(&source.masses).zip(free) {
            if !free {
                continue;
            }
            let jitter: Vector<D> = std::array::from_fn(|_| state.random.symmetric());
            let x = add(
                slot,
                &scale(self.numerics.jitter * self.numerics.spacing, &jitter),
            );
            let id = state.next_id;
            state.next_id += 1;
            state
                .grains
                .push(id, source.phase, x, source.velocity, *mass, source.density);
            entered += mass;
        }
        entered
    }
}
