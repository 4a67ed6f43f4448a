//! Streams that push: fluids let in through a wall (docs/theory.md, W13).
//!
//! The wall's points behind the face come forward with the stream, one spacing for each row, and take the place of the row that enters
//! next: what stands before the face is pressed on as by the stream. Behind the wall that has the inertia of a length L of it, the face's
//! own, and the thrust of a pressure P, as much as makes the fluid denser by [`DENSER`]:
//!
//!   dw/dt <= (P - p)/(rho L),   w <= Q/(rho A),   p the mean pressure before the face                               (W13)
//!
//! A stream that is behind when less is asked for goes on until it has caught up, so far as P stops it in the s that it is behind:
//! w <= sqrt(2 P s/(rho L)). If it stopped at once, a rate that goes to and fro faster than it gathers speed would let in next to nothing.

use crate::boundary::Piston;
use crate::state::State;

use super::Solver;
use super::sources::Source;

/// How much denser than at rest material may become before a face for the stream to go on [1]: twice what the sound speed is chosen for.
const DENSER: f64 = 0.02;

/// How far before the wall that comes forward material is pressed on by it, over the spacing: the first row, which stands at a half.
const BEFORE: f64 = 1.2;

/// Most speed of a stream that is behind what was asked for, over the speed asked for [1].
const CATCHING_UP: f64 = 1.1;

/// Distance from a place of a row within which nothing may be when it enters, over the spacing: its volume has been made already.
const ROOM: f64 = 0.3;

/// Advance from which on a row is due: rounding is nothing.
const DUE: f64 = 1.0 - 1e-9;

impl<const D: usize> Solver<D> {
    /// Brings the walls behind streams forward by what is asked for in a step, as far as what stands before them lets it.
    pub(super) fn push_streams(&mut self, state: &mut State<D>, rates: &[f64], dt: f64) {
        for (n, source) in self.sources.iter().enumerate() {
            let Some(piston) = &source.piston else {
                continue;
            };
            let row = source.row_mass();
            let asked = rates[n].max(0.0) / row;
            // Only a stream that runs looks at what stands before it.
            let faster = if asked > 0.0 || state.inflows[n].rate > 0.0 {
                self.thrust(state, (source, piston), state.inflows[n].advance) * dt
            } else {
                0.0
            };
            let inflow = &mut state.inflows[n];
            inflow.pending += rates[n].max(0.0) * dt;
            let behind = (inflow.pending / row - inflow.advance).max(0.0);
            let stops = (2.0 * self.most_thrust(source) * behind).sqrt();
            let wanted = (CATCHING_UP * asked).max(stops.min(inflow.rate));
            let wanted = wanted.min(behind / dt);
            let rate = wanted.min(inflow.rate + faster).max(0.0);
            inflow.rate = rate;
            inflow.advance += rate * dt;
            piston.place(&mut self.walls, inflow.advance, inflow.rate);
        }
    }

    /// What (W13) allows a stream to become faster by [1/s^2].
    fn thrust(
        &self,
        state: &State<D>,
        (source, piston): (&Source<D>, &Piston<D>),
        advance: f64,
    ) -> f64 {
        let spacing = self.numerics.spacing;
        let reach = (advance + BEFORE) * spacing;
        let (mut count, mut sum) = (0, 0.0);
        let middle = piston.middle();
        for (x, p) in state.grains.position.iter().zip(&self.pressure) {
            let Some(ahead) = piston.ahead(&self.periodic.image(x, &middle)) else {
                continue;
            };
            if ahead > 0.0 && ahead < reach {
                count += 1;
                sum += p;
            }
        }
        if count == 0 {
            return f64::INFINITY;
        }
        let pressure = sum / (count.max(source.slots.len()) as f64 * source.density);
        self.most_thrust(source) - pressure / (source.length * spacing)
    }

    /// P/(rho L) of a stream, in rows [1/s^2].
    fn most_thrust(&self, source: &Source<D>) -> f64 {
        let material = &self.materials[usize::from(source.phase)];
        let most = DENSER * self.sound_speed_of(material).powi(2);
        most / (source.length * self.numerics.spacing)
    }

    /// Lets in a row of a stream that pushes where one is due and has room; returns whether one came.
    pub(super) fn let_row_in(&mut self, state: &mut State<D>, n: usize) -> bool {
        let source = &self.sources[n];
        let Some(piston) = &source.piston else {
            return false;
        };
        let row = source.row_mass();
        let due = state.inflows[n].advance >= DUE;
        let came = due && self.slots_are_free(state, source);
        if came {
            let entered = self.enter(state, source, &vec![true; source.slots.len()]);
            let inflow = &mut state.inflows[n];
            inflow.pending = (inflow.pending - entered).max(0.0);
            inflow.admitted += entered;
            inflow.advance = (inflow.advance - 1.0).max(0.0);
        }
        let inflow = &mut state.inflows[n];
        if due && !came {
            (inflow.advance, inflow.rate) = (1.0, 0.0);
        }
        if inflow.pending > (inflow.advance + 1.0) * row {
            // What cannot enter is refused, not saved up for a burst.
            inflow.pending = (inflow.advance + 1.0) * row;
            inflow.blocked = true;
        }
        if due {
            piston.place(&mut self.walls, inflow.advance, inflow.rate);
        }
        came
    }

    fn slots_are_free(&self, state: &State<D>, source: &Source<D>) -> bool {
        let free = self.free_slots(&state.grains, source, ROOM);
        !free.contains(&false)
    }

    /// Puts the walls behind streams where a state has them, or had them when its lists were built.
    pub(super) fn place_streams(&mut self, state: &State<D>, listed: bool) {
        for (source, inflow) in self.sources.iter().zip(&state.inflows) {
            let Some(piston) = &source.piston else {
                continue;
            };
            let advance = if listed {
                inflow.listed_advance
            } else {
                inflow.advance
            };
            piston.place(&mut self.walls, advance, inflow.rate);
        }
    }

    /// How far the walls behind streams have come since lists were built [m].
    pub(super) fn travel_of_streams(&self, state: &State<D>) -> f64 {
        let of = self.sources.iter().zip(&state.inflows);
        let of = of.filter(|(source, _)| source.piston.is_some());
        of.map(|(_, inflow)| (inflow.advance - inflow.listed_advance).abs())
            .fold(0.0, f64::max)
            * self.numerics.spacing
    }
}
