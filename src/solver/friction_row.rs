//! Who sees walls with friction in a step, and how hard each may hold on (docs/theory.md, "Wall friction"): what `wall_friction`
//! works with, made anew in every step from the contacts of the last sweep.

use std::ops::Range;

use crate::math::{Tensor, Vector, add_outer, apply, dot, inverse, norm, scale, sub, trace};
use crate::state::State;

use super::Solver;
use super::wall_contact::Contact;
use super::wall_friction::Friction;

/// Share of a face's area that `spread` gives the direction across all faces, where it has none.
const ACROSS: f64 = 1e-2;

/// Slip over what full friction would take of it in one step, above which it is sure to slide on [1].
const SURELY: f64 = 2.0;

/// A particle that sees faces with friction.
#[derive(Clone, Debug)]
pub(super) struct FrictionRow<const D: usize> {
    /// The particle.
    pub(super) i: usize,
    /// Its contacts, of [`Friction::contacts`].
    pub(super) range: Range<usize>,
    /// Sum of a P over the contacts [m^2].
    pub(super) grip: Tensor<D>,
    /// Sum of a P v_w over the contacts [m^3/s].
    pub(super) drive: Vector<D>,
    /// Turns a force along the faces into the traction that makes it; only this little of it across them.
    pub(super) spread: Tensor<D>,
    /// Penalty r [Pa s/m].
    pub(super) penalty: f64,
    /// mu_w p [Pa].
    pub(super) bears: f64,
    /// Speed along the faces that mu_w p would take from it alone in the step [m/s].
    pub(super) stops: f64,
    /// Whether it holds together with what is around it, by cohesion.
    pub(super) holds: bool,
    /// Whether it is loose and slides, faster than friction could stop it in the step. What holds together loosens from no wall, and the
    /// stress of a plug, which its friction follows, is known after the solve alone.
    pub(super) slides: bool,
}

impl<const D: usize> FrictionRow<D> {
    /// Grip, drive and spread of what particle i touches, in order; it bears nothing yet.
    fn of_contacts(i: usize, range: Range<usize>, contacts: &[Contact<D>]) -> Self {
        let mut row = Self {
            i,
            range,
            grip: [[0.0; D]; D],
            drive: [0.0; D],
            spread: [[0.0; D]; D],
            penalty: 0.0,
            bears: 0.0,
            stops: 0.0,
            holds: false,
            slides: false,
        };
        let mut normal = [0.0; D];
        for c in contacts {
            let drive = c.along(&c.drive);
            for k in 0..D {
                row.grip[k][k] += c.area;
                row.drive[k] += drive[k];
                normal[k] += c.area * c.normal[k];
            }
            add_outer(&mut row.grip, -c.area, &c.normal, &c.normal);
        }
        let mut full = row.grip;
        let size = norm(&normal);
        // Faces opposite each other, as near: across either.
        let across = if size > 0.0 {
            scale(1.0 / size, &normal)
        } else {
            contacts.first().map_or([0.0; D], |c| c.normal)
        };
        // A flat face has no area across itself, and a bend little: there it takes no part.
        let least = dot(&across, &apply(&full, &across));
        add_outer(
            &mut full,
            (ACROSS * trace(&row.grip)).max(least) - least,
            &across,
            &across,
        );
        row.spread = inverse(&full);
        row
    }

    /// Slip velocity along the faces at velocity v [m/s].
    #[inline]
    pub(super) fn slip(&self, v: &Vector<D>) -> Vector<D> {
        let gripped = sub(&apply(&self.grip, v), &self.drive);
        apply(&self.spread, &gripped)
    }
}

impl<const D: usize> Solver<D> {
    /// Makes the friction rows of a step from the contacts of the last sweep.
    pub(super) fn find_friction(&mut self, state: &mut State<D>, dt: f64) {
        if !state.grains.wall_friction {
            return;
        }
        let Friction {
            mut contacts,
            mut rows,
        } = std::mem::take(&mut self.friction);
        contacts.clear();
        rows.clear();
        let seen = self.lists.blocks.iter().flat_map(|b| &b.contacts);
        contacts.extend(seen.filter(|c| c.area > 0.0));
        let mut first = 0;
        for seen in contacts.chunk_by(|a, b| a.i == b.i) {
            let range = first..first + seen.len();
            first = range.end;
            let i = seen[0].i as usize;
            let stopping = dt / state.grains.mass[i];
            rows.push(self.friction_row(state, i, range, seen, stopping));
        }
        self.friction = Friction { contacts, rows };
        // What has left the walls takes no traction with it.
        let grains = &mut state.grains;
        let mut next = 0;
        let ends = self.friction.rows.iter().map(|r| r.i);
        for end in ends.chain([grains.len()]) {
            grains.wall_traction[next..end].fill([0.0; D]);
            grains.wall_slip[next..end].fill([0.0; D]);
            next = end + 1;
        }
    }

    /// What particle i's contacts bear, and its penalty; `stopping` is dt/m [s/kg].
    fn friction_row(
        &self,
        state: &State<D>,
        i: usize,
        range: Range<usize>,
        contacts: &[Contact<D>],
        stopping: f64,
    ) -> FrictionRow<D> {
        let mut row = FrictionRow::of_contacts(i, range, contacts);
        let friction = self.mean_friction(contacts);
        let slip = norm(&row.slip(&state.grains.velocity[i]));
        let pressure = self.pressure_on_walls(row.i).max(0.0);
        let stick = friction.min(1.0) * self.numerics.cap_time / (0.5 * self.numerics.spacing);
        row.bears = friction * pressure;
        // Friction takes some steps to come, so that what comes to rest does not turn round; but is all there in the first of
        // what slides and cannot come to rest in it.
        // Grip is I - n n for each contact: of D - 1 directions along it.
        row.stops = stopping * row.bears * trace(&row.grip) / (D as f64 - 1.0);
        let slides = slip > SURELY * row.stops;
        let begins = norm(&state.grains.wall_traction[i]) < 0.5 * row.bears;
        row.holds = self.materials[state.grains.phase[i] as usize].cohesion > 0.0;
        row.slides = slides && !row.holds;
        let share = if slides && row.holds && begins {
            1.0
        } else {
            0.1
        };
        row.penalty = pressure * stick.min(share * friction / slip.max(f64::MIN_POSITIVE));
        row
    }

    /// mu_w of contacts, by area [1].
    fn mean_friction(&self, contacts: &[Contact<D>]) -> f64 {
        let (mut area, mut friction) = (0.0, 0.0);
        for c in contacts {
            area += c.area;
            friction += c.area * self.walls.groups[c.group as usize].friction;
        }
        friction / area
    }

    /// p between grains and walls that momentum feels over the step [Pa].
    pub(super) fn pressure_on_walls(&self, i: usize) -> f64 {
        let mean = self.acoustic.pressure.get(i);
        mean.map_or_else(|| self.effective_pressure()[i], |p| *p)
    }
}
