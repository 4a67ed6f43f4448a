//! Moving walls, gates and outflows: what moves and takes out between two internal steps.

use crate::boundary::{Course, Plate};
use crate::math::{CHUNK, Vector};
use crate::state::{DriveState, State};

use super::Solver;
use super::timestep::MOST_OF_A_PLATE;

/// Share of a leading edge that has to be stood against [1]. A stream always has single grains in the way somewhere along an edge: were one
/// enough, a gate would not close through it, the less the longer its edge or the finer the spacing.
const HELD: f64 = 0.5;

/// Distance to the leading edge at which a grain stops a plate, over the spacing; of one that is in a wall already.
const TOUCH: f64 = 0.25;
const PRESSED: f64 = 0.75;

/// What takes particles out.
#[derive(Clone, Copy, Debug)]
pub struct Sink<const D: usize> {
    /// Lower corner of a box [m].
    pub lower: Vector<D>,
    /// Upper corner [m].
    pub upper: Vector<D>,
    /// Whether it takes what is outside of the box, and not what is in it.
    pub outside: bool,
}

impl<const D: usize> Sink<D> {
    /// Whether it takes what is at a place, in the box or on its sides, or beyond them.
    #[must_use]
    pub fn holds(&self, x: &Vector<D>) -> bool {
        if self.outside {
            // What is nowhere is lost, and not taken.
            return (0..D).any(|k| x[k] < self.lower[k] || x[k] > self.upper[k]);
        }
        (0..D).all(|k| x[k] >= self.lower[k] && x[k] <= self.upper[k])
    }
}

/// Way and rate of a drive.
pub(super) fn course(at: &DriveState) -> Course {
    Course {
        way: at.way,
        rate: at.rate,
    }
}

impl<const D: usize> Solver<D> {
    /// Moves the walls that move as a whole, and those that are steered, to the end of a step.
    pub(super) fn move_walls(&mut self, state: &mut State<D>, wanted: &[(f64, f64)], dt: f64) {
        let drives = self.drives.iter().zip(&mut state.drives);
        for ((drive, at), (told, slope)) in drives.zip(wanted) {
            Course {
                way: at.way,
                rate: at.rate,
            } = drive.advance(course(at), told + slope * dt, dt);
        }
        if !self.movers.is_empty() {
            state.pose.now += dt;
        }
        self.place_walls(state);
    }

    /// Puts walls that move where they are now, at the speed that they have.
    pub(super) fn place_walls(&mut self, state: &State<D>) {
        self.put_walls(state.pose.now, |drive| course(&state.drives[drive]));
        for belt in &self.belts {
            belt.run(&mut self.walls, state.drives[belt.drive].rate);
        }
    }

    /// Puts walls that move as a whole where they were when the neighbour lists were built.
    pub(super) fn place_walls_as_listed(&mut self, state: &State<D>) {
        self.put_walls(state.pose.listed, |drive| Course {
            way: state.drives[drive].listed_way,
            rate: 0.0,
        });
    }

    /// Puts the walls that move as a whole where they are after having moved for `time` [s], steered ones by their course.
    fn put_walls(&mut self, time: f64, course: impl Fn(usize) -> Course) {
        for mover in &self.movers {
            let unsteered = Course {
                way: time,
                rate: 1.0,
            };
            mover.place(&mut self.walls, mover.drive.map_or(unsteered, &course));
            for &i in mover.points() {
                self.periodic.wrap(&mut self.walls.position[i]);
            }
        }
    }

    /// Most that a wall which moves as a whole has moved since the neighbour lists were built [m].
    pub(super) fn travel_of_walls(&self, state: &State<D>) -> f64 {
        let unsteered = state.pose.now - state.pose.listed;
        let way = |drive: usize| (state.drives[drive].way - state.drives[drive].listed_way).abs();
        self.movers.iter().fold(0.0, |travel, mover| {
            f64::max(travel, mover.travel(mover.drive.map_or(unsteered, way)))
        })
    }

    /// Whether drives can be as these are: none beyond its end stops or faster than it can be.
    #[must_use]
    pub fn can_be(&self, drives: &[DriveState]) -> bool {
        let each = self.drives.iter().zip(drives);
        each.into_iter().all(|(drive, at)| {
            let (least, most) = drive.stops;
            let ways = [at.way, at.listed_way];
            let is_within = |way: &f64| way.is_finite() && (least..=most).contains(way);
            ways.iter().all(is_within) && (-1.0..=1.0).contains(&at.rate)
        })
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
        if is_slow && self.stiff_beside(state, plate).any(|x| caught(&x)) {
            speed
        } else {
            f64::INFINITY
        }
    }

    /// Whether grains stand against the leading edge of a plate that wants to close, along a share [`HELD`] of it: fewer are
    /// pushed aside, and so are fluids that flow, of which one drop at the lip held a gate as long as it stood there.
    fn is_blocked(&self, state: &State<D>, gate: usize) -> bool {
        let (plate, opening) = (&self.plates[gate], state.gates[gate].opening);
        let spacing = self.numerics.spacing;
        let stops = |x: &Vector<D>| plate.stopped_by(x, opening, spacing, TOUCH);
        // What is pressed between the edge and another wall stops it from further away.
        let squeezed = |x: &Vector<D>| plate.stopped_by(x, opening, spacing, PRESSED);
        let blocks = self.lists.blocks.iter().enumerate();
        let mut pushed = blocks.flat_map(|(b, block)| {
            let rows = block.wall_rows.iter().filter(|w| w.barrier > 0.0);
            rows.map(move |w| b * CHUNK + w.row as usize)
        });
        let mut held = vec![false; plate.pieces(spacing)];
        for x in self.stiff_beside(state, plate).filter(stops) {
            held[plate.piece_of(&x, spacing)] = true;
        }
        let share = held.iter().filter(|h| **h).count() as f64 / held.len() as f64;
        let middle = plate.middle();
        share >= HELD
            || pushed.any(|i| {
                let place = state.grains.position.get(i);
                place.is_some_and(|x| squeezed(&self.periodic.image(x, &middle)))
            })
    }

    /// Places of what a plate does not just push aside, all but fluids that flow, by their images nearest to it.
    fn stiff_beside<'a>(
        &'a self,
        state: &'a State<D>,
        plate: &Plate<D>,
    ) -> impl Iterator<Item = Vector<D>> + use<'a, D> {
        let middle = plate.middle();
        let grains = &state.grains;
        let stands =
            |i: usize| !grains.drained[i] && !self.materials[usize::from(grains.phase[i])].flows();
        (0..grains.len())
            .filter(move |i| stands(*i))
            .map(move |i| self.periodic.image(&grains.position[i], &middle))
    }

    /// Counts and marks what has entered a sink; removal waits for the next lists.
    pub(super) fn drain(&self, state: &mut State<D>) {
        for (s, sink) in self.sinks.iter().enumerate() {
            for i in 0..state.grains.len() {
                let x = &state.grains.position[i];
                if sink.holds(x) && !state.grains.drained[i] {
                    state.grains.drained[i] = true;
                    state.drained[s] += state.grains.mass[i];
                }
            }
        }
    }
}
