//! Moving walls, gates, inflows and outflows: what moves, adds and takes out between two internal steps.

use crate::boundary::Piston;
use crate::math::{CHUNK, Vector, add, norm, scale};
use crate::state::{Grains, State};

use super::Solver;
use super::timestep::MOST_OF_A_PLATE;

/// Share of a leading edge that has to be stood against [1]. A stream always has single grains in the way somewhere along an edge: were one
/// enough, a gate would not close through it, the less the longer its edge or the finer the spacing.
const HELD: f64 = 0.5;

/// Distance to the leading edge at which a grain stops a plate, over the spacing; of one that is in a wall already.
const TOUCH: f64 = 0.25;
const PRESSED: f64 = 0.75;

/// Distance from a slot of an inflow within which nothing may be when a particle enters there, over the spacing.
const ROOM: f64 = 0.6;

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

/// A box that takes particles out.
#[derive(Clone, Copy, Debug)]
pub struct Sink<const D: usize> {
    /// Lower corner [m].
    pub lower: Vector<D>,
    /// Upper corner [m].
    pub upper: Vector<D>,
}

impl<const D: usize> Source<D> {
    /// Mass of a row [kg].
    #[must_use]
    pub fn row_mass(&self) -> f64 {
        self.masses.iter().fold(0.0, |sum, m| sum + m)
    }
}

impl<const D: usize> Solver<D> {
    /// Moves the walls that move as a whole to the end of a step.
    pub(super) fn move_walls(&mut self, state: &mut State<D>, dt: f64) {
        if !self.movers.is_empty() {
            state.pose.now += dt;
            self.place_movers(state.pose.now);
        }
    }

    /// Puts the walls that move as a whole where they are after having moved for `time` [s].
    pub(super) fn place_movers(&mut self, time: f64) {
        for mover in &self.movers {
            mover.place(&mut self.walls, time);
            for i in mover.range() {
                self.periodic.wrap(&mut self.walls.position[i]);
            }
        }
    }

    /// Moves plates towards the openings wanted; a plate that material holds or slows down says so, until
    /// [`State::forget_blocked`].
    pub(super) fn move_gates(&mut self, state: &mut State<D>, wanted: &[f64], dt: f64) {
        for g in 0..self.plates.len() {
            let plate = &self.plates[g];
            let gate = state.gates[g];
            let most = (plate.max_speed * dt).min(MOST_OF_A_PLATE * self.kernel.h) / plate.length;
            let mut change = (wanted[g] - gate.opening).clamp(-most, most);
            let mut slowed = false;
            if change < 0.0 {
                let shutting = self.shutting_speed(state, g) * dt / plate.length;
                slowed = -change > shutting;
                change = change.max(-shutting);
            }
            let mut rate = change / dt;
            let blocked = change < 0.0 && self.is_blocked(state, g);
            if blocked {
                rate = 0.0;
            }
            let opening = if blocked {
                gate.opening
            } else {
                (gate.opening + change).clamp(0.0, 1.0)
            };
            let gate = &mut state.gates[g];
            (gate.opening, gate.rate) = (opening, rate);
            gate.blocked |= blocked || slowed;
            self.plates[g].place(&mut self.walls, opening, rate);
        }
    }

    /// Most speed V of a plate that closes [m/s]: grains in an opening of width w and depth L are pressed out of it at V L/w, and no
    /// faster than they fall through it by their weight, sqrt(g L). Faster plates shot single ones out at several times their own speed.
    fn shutting_speed(&self, state: &State<D>, gate: usize) -> f64 {
        let (plate, opening) = (&self.plates[gate], state.gates[gate].opening);
        let spacing = self.numerics.spacing;
        let gap = plate.gap(opening);
        let caught = |x: &Vector<D>| plate.shuts_on(x, opening, spacing);
        let speed = gap.max(TOUCH * spacing) * (self.gravity_norm / plate.thickness()).sqrt();
        let is_slow = speed < plate.max_speed && speed > 0.0;
        if is_slow && self.stiff(state).any(caught) {
            speed
        } else {
            f64::INFINITY
        }
    }

    /// Whether grains stand against the leading edge of a plate that wants to close, along a share [`HELD`] of it in space: fewer are
    /// pushed aside, and so are fluids that flow, of which one drop at the lip held a gate as long as it stood there.
    fn is_blocked(&self, state: &State<D>, gate: usize) -> bool {
        let (plate, opening) = (&self.plates[gate], state.gates[gate].opening);
        let stops = |x: &Vector<D>| plate.stopped_by(x, opening, self.numerics.spacing, TOUCH);
        // What is pressed between the edge and another wall stops it from further away.
        let squeezed = |x: &Vector<D>| plate.stopped_by(x, opening, self.numerics.spacing, PRESSED);
        let blocks = self.lists.blocks.iter().enumerate();
        let mut pushed = blocks.flat_map(|(b, block)| {
            let rows = block.wall_rows.iter().filter(|w| w.barrier > 0.0);
            rows.map(move |w| b * CHUNK + w.row as usize)
        });
        let spacing = self.numerics.spacing;
        let mut held = vec![false; plate.pieces(spacing)];
        for x in self.stiff(state).filter(|x| stops(x)) {
            held[plate.piece_of(x, spacing)] = true;
        }
        let share = held.iter().filter(|h| **h).count() as f64 / held.len() as f64;
        share >= HELD || pushed.any(|i| state.grains.position.get(i).is_some_and(squeezed))
    }

    /// Places of what a plate does not just push aside: all but fluids that flow.
    fn stiff<'a>(&'a self, state: &'a State<D>) -> impl Iterator<Item = &'a Vector<D>> {
        let grains = &state.grains;
        let stands =
            |i: usize| !grains.drained[i] && !self.materials[usize::from(grains.phase[i])].flows();
        (0..grains.len())
            .filter(move |i| stands(*i))
            .map(|i| &grains.position[i])
    }

    /// Counts and marks what has entered a sink; removal waits for the next lists.
    pub(super) fn drain(&self, state: &mut State<D>) {
        for (s, sink) in self.sinks.iter().enumerate() {
            for i in 0..state.grains.len() {
                let x = &state.grains.position[i];
                let inside = (0..D).all(|k| x[k] >= sink.lower[k] && x[k] <= sink.upper[k]);
                if inside && !state.grains.drained[i] {
                    state.grains.drained[i] = true;
                    state.drained[s] += state.grains.mass[i];
                }
            }
        }
    }

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
            if free.contains(&false) && inflow.pending >= row {
                // What cannot enter is refused, not saved up for a burst.
                inflow.pending = row;
                inflow.blocked = true;
            }
        }
        came
    }

    /// Which slots of a source have nothing within a share of the spacing.
    pub(super) fn free_slots(
        &self,
        grains: &Grains<D>,
        source: &Source<D>,
        room: f64,
    ) -> Vec<bool> {
        let room = room * self.numerics.spacing;
        let away = |x: &Vector<D>, y: &Vector<D>| norm(&self.periodic.difference(x, y));
        let Some(first) = source.slots.first() else {
            return Vec::new();
        };
        let farthest = |most: f64, slot: &Vector<D>| most.max(away(slot, first));
        let reach = source.slots.iter().fold(0.0, farthest) + room;
        let mut free = vec![true; source.slots.len()];
        let present = grains.position.iter().zip(&grains.drained);
        for (x, _) in present.filter(|(x, gone)| !**gone && away(x, first) < reach) {
            for (slot, free) in source.slots.iter().zip(&mut free) {
                *free &= away(x, slot) >= room;
            }
        }
        free
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
