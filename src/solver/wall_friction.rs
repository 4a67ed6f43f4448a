//! Coulomb friction of walls and gates by the augmented Lagrangian of the yield (docs/theory.md, "Wall friction").
//!
//! A face with friction acts across itself as one with free slip. Along itself it pushes particle i with
//! -a P T_i, a = -2 n.S V_i the face's share of the particle (so that its normal force is a (p - n.tau n)),
//! P = I - n n^T, and T_i a multiplier with |P T_i| <= mu_w (p - n.tau n). Each linear solve holds
//! -a [P (T - r s) + r P (v - v_w)], s the slip that belongs to T; afterwards x = T + r (slip) is cut to the disc:
//!
//! T = x - (what is beyond mu_w (p - n.tau n)),   s = (x - T)/r.                                           (W3)
//!
//! Material that sticks has s = 0 and does not creep; where it slides T is on the disc, against the slip. Loose material that surely slides
//! has that T from the first (`expect_friction`) and to the last (`even_friction`).

use std::ops::Range;

use crate::math::{Tensor, Vector, add_outer, apply, dot, inverse, norm, scale, sub, trace};
use crate::state::State;

use super::Solver;
use super::implicit::Viscous;
use super::plastic::SPARE;
use super::record::Record;

/// A face with friction, as one particle sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<const D: usize> {
    /// The particle.
    i: u32,
    /// Group of the wall or gate.
    group: u16,
    /// Unit normal towards the material.
    normal: Vector<D>,
    /// Area a [m^2].
    area: f64,
    /// Sum of a v_w over the face's points [m^3/s].
    drive: Vector<D>,
}

/// A particle that sees faces with friction.
#[derive(Clone, Debug)]
pub(super) struct FrictionRow<const D: usize> {
    i: usize,
    /// Its contacts, of [`Friction::contacts`].
    range: Range<usize>,
    /// Sum of a P over the contacts [m^2].
    grip: Tensor<D>,
    /// Sum of a P v_w over the contacts [m^3/s].
    drive: Vector<D>,
    /// Turns a force along the faces into the traction that makes it; only this little of it across them.
    spread: Tensor<D>,
    /// Penalty r [Pa s/m].
    penalty: f64,
    /// mu_w p [Pa].
    bears: f64,
    /// Whether it is loose and slides, faster than friction could stop it in the step. What holds together loosens from no wall, and the
    /// stress of a plug, which its friction follows, is known after the solve alone.
    slides: bool,
}

/// Who sees walls with friction; empty in scenes without.
#[derive(Clone, Debug, Default)]
pub(super) struct Friction<const D: usize> {
    contacts: Vec<Contact<D>>,
    /// In ascending order of particles.
    rows: Vec<FrictionRow<D>>,
}

/// Share of a face's area that `spread` gives the direction across all faces, where it has none.
const ACROSS: f64 = 1e-2;

/// Slip over what full friction would take of it in one step, above which it is sure to slide on [1].
const SURELY: f64 = 2.0;

/// What a particle sees of walls, as far as it tells whether that is one flat face with friction.
#[derive(Clone, Copy, Debug)]
pub(super) enum Face<const D: usize> {
    /// Nothing yet.
    None,
    /// Points with friction and this normal only.
    Flat(Vector<D>),
    /// Something else, too.
    Other,
}

impl<const D: usize> Face<D> {
    /// With one more point; `normal` if it has friction.
    pub(super) fn with(self, normal: Option<Vector<D>>) -> Self {
        match (self, normal) {
            (Face::None, Some(n)) => Face::Flat(n),
            (Face::Flat(m), Some(n)) if same_normal(&m, &n) => self,
            _ => Face::Other,
        }
    }
}

fn same_normal<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> bool {
    dot(a, b) > 1.0 - 1e-9
}

impl<const D: usize> Contact<D> {
    /// Adds a face that particle i sees to the contacts of its row, which begin at `first`: area [m^2], and sum of area v_w
    /// over its points [m^3/s].
    pub(super) fn gather(
        contacts: &mut Vec<Self>,
        first: usize,
        (i, group): (usize, u16),
        normal: &Vector<D>,
        area: f64,
        drive: &Vector<D>,
    ) {
        let same = |c: &&mut Self| c.group == group && same_normal(&c.normal, normal);
        if let Some(contact) = contacts[first..].iter_mut().find(same) {
            contact.area += area;
            for k in 0..D {
                contact.drive[k] += drive[k];
            }
        } else {
            contacts.push(Self {
                i: i as u32,
                group,
                normal: *normal,
                area,
                drive: *drive,
            });
        }
    }

    /// P a.
    fn along(&self, a: &Vector<D>) -> Vector<D> {
        sub(a, &scale(dot(a, &self.normal), &self.normal))
    }
}

/// mu_w p over the traction of a face along which a particle slides by so small a share of its slip [1].
const STEEP: f64 = 10.0;

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

    /// Sums over the contacts of particle i, and its penalty; `stopping` is dt/m [s/kg].
    fn friction_row(
        &self,
        state: &State<D>,
        i: usize,
        range: Range<usize>,
        contacts: &[Contact<D>],
        stopping: f64,
    ) -> FrictionRow<D> {
        let mut row = FrictionRow {
            i,
            range,
            grip: [[0.0; D]; D],
            drive: [0.0; D],
            spread: [[0.0; D]; D],
            penalty: 0.0,
            bears: 0.0,
            slides: false,
        };
        let mut normal = [0.0; D];
        let (mut area, mut friction) = (0.0, 0.0);
        for c in contacts {
            let drive = c.along(&c.drive);
            for k in 0..D {
                row.grip[k][k] += c.area;
                row.drive[k] += drive[k];
                normal[k] += c.area * c.normal[k];
            }
            add_outer(&mut row.grip, -c.area, &c.normal, &c.normal);
            area += c.area;
            friction += c.area * self.walls.groups[c.group as usize].friction;
        }
        friction /= area;
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
        let slip = norm(&row.slip(&state.grains.velocity[i]));
        let pressure = self.pressure_on_walls(row.i).max(0.0);
        let stick = friction.min(1.0) * self.numerics.cap_time / (0.5 * self.numerics.spacing);
        row.bears = friction * pressure;
        // Friction takes some steps to come, so that what comes to rest does not turn round; but is all there in the first of
        // what slides and cannot come to rest in it.
        let slides = slip > SURELY * stopping * row.bears * trace(&row.grip);
        let begins = norm(&state.grains.wall_traction[i]) < 0.5 * row.bears;
        let holds = self.materials[state.grains.phase[i] as usize].cohesion > 0.0;
        row.slides = slides && !holds;
        let share = if slides && holds && begins { 1.0 } else { 0.1 };
        row.penalty = pressure * stick.min(share * friction / slip.max(f64::MIN_POSITIVE));
        row
    }

    /// Cuts the slip s that a step starts from where r s is more than the faces bear: at most a fifth of that is usual.
    ///
    /// Where a gate or a wall has stopped, r has grown with the slip gone, and r s of the old slip is out of all bounds.
    pub(super) fn cut_slip(&self, state: &mut State<D>) {
        for row in &self.friction.rows {
            let s = &mut state.grains.wall_slip[row.i];
            let size = row.penalty * norm(s);
            if size > row.bears {
                *s = scale(row.bears / size, s);
            }
        }
    }

    /// Gives what slides and cannot come to rest in the step the friction of this step's pressure to start from, at the slip u that it
    /// has: T = f P u/|P u|, s = u. The last step's would lag behind a pressure that trembles, as that of what has loosened from a
    /// wall does, and the two do not come out even.
    pub(super) fn expect_friction(&self, state: &mut State<D>, work: &Viscous<D>) {
        let grains = &mut state.grains;
        for row in self.friction.rows.iter().filter(|row| row.slides) {
            let u = row.slip(&grains.velocity[row.i]);
            let last = grains.stress.get(row.i);
            let tau = last.map_or_else(|| work.stress(row.i), |tau| *tau);
            grains.wall_traction[row.i] = self.sliding(row, &u, &tau);
            grains.wall_slip[row.i] = u;
        }
    }

    /// T of what slides at u: all that its faces bear against it [Pa]; less of one along which it hardly does.
    fn sliding(&self, row: &FrictionRow<D>, u: &Vector<D>, tau: &Tensor<D>) -> Vector<D> {
        let mut borne = [0.0; D];
        let most = STEEP * row.bears / norm(u).max(f64::MIN_POSITIVE);
        for c in &self.friction.contacts[row.range.clone()] {
            let along = c.along(u);
            let size = norm(&along).max(f64::MIN_POSITIVE);
            let share = most.min(self.friction_limit(c, tau) / size);
            for k in 0..D {
                borne[k] += c.area * share * along[k];
            }
        }
        apply(&row.spread, &borne)
    }

    /// Notes T - r s of every row, what of the next solve's tractions does not follow the velocity [Pa].
    pub(super) fn hold_friction(&self, state: &State<D>, held: &mut Vec<Vector<D>>) {
        let (t, s) = (&state.grains.wall_traction, &state.grains.wall_slip);
        let rows = self.friction.rows.iter();
        held.clear();
        held.extend(rows.map(|r| sub(&t[r.i], &scale(r.penalty, &s[r.i]))));
    }

    /// Calls `add(i, push)` with the force of friction against each particle [N] at the velocity of its record;
    /// `held`: with what does not follow the velocity.
    pub(super) fn each_friction(
        &self,
        records: &[Record],
        held: Option<&[Vector<D>]>,
        mut add: impl FnMut(usize, &Vector<D>),
    ) {
        for (n, row) in self.friction.rows.iter().enumerate() {
            let v: Vector<D> = records[row.i].velocity();
            let mut push = scale(row.penalty, &apply(&row.grip, &v));
            if let Some(held) = held {
                let held = apply(&row.grip, &held[n]);
                for k in 0..D {
                    push[k] += held[k] - row.penalty * row.drive[k];
                }
            }
            add(row.i, &push);
        }
    }

    /// Inverse Jacobi blocks with dt r sum a P.
    pub(super) fn grip_blocks(&self, dt: f64, jacobi: &mut [Tensor<D>]) {
        for row in &self.friction.rows {
            let mut block = inverse(&jacobi[row.i]);
            for r in 0..D {
                for c in 0..D {
                    block[r][c] += dt * row.penalty * row.grip[r][c];
                }
            }
            jacobi[row.i] = inverse(&block);
        }
    }

    /// (W3) for every particle that sees a wall with friction, at the velocity and stress of the last solve.
    pub(super) fn project_friction(&self, state: &mut State<D>, work: &Viscous<D>) {
        let grains = &mut state.grains;
        for row in &self.friction.rows {
            let i = row.i;
            if row.penalty <= 0.0 {
                (grains.wall_traction[i], grains.wall_slip[i]) = ([0.0; D], [0.0; D]);
                continue;
            }
            let slip = row.slip(&work.current[i].velocity());
            let tau = work.stress(i);
            if row.slides {
                grains.wall_traction[i] = self.sliding(row, &slip, &tau);
                grains.wall_slip[i] = slip;
                continue;
            }
            // What the last step's pressure bore and this one's does not by far is no slip (see `cut_stress`).
            let t = &grains.wall_traction[i];
            let t = sub(t, &self.beyond(row, t, &tau, SPARE));
            let x: Vector<D> = std::array::from_fn(|k| t[k] + row.penalty * slip[k]);
            let cut = self.beyond(row, &x, &tau, 1.0);
            grains.wall_traction[i] = sub(&x, &cut);
            // Nor may it become one where the penalty, which goes with the pressure, has fallen further than the limit:
            // cohesion bears traction at no pressure, and r s would throw the particle when the pressure returns.
            let size = norm(&cut);
            let most = SPARE * row.penalty * norm(&slip);
            let share = if size > most { most / size } else { 1.0 };
            grains.wall_slip[i] = scale(share / row.penalty, &cut);
        }
    }

    /// Makes the friction of a step of what slides that of the pressure and stress it ended with, by what the last solve took too much or
    /// too little: friction is then mu_w times the normal force, step by step. After [`Solver::add_reactions`], whose other forces are those
    /// of the solve's velocities.
    pub(super) fn even_friction(&mut self, state: &mut State<D>, dt: f64, all: bool) {
        let Viscous { held, velocity, .. } = &mut self.viscous;
        for (row, held) in self.friction.rows.iter().zip(held) {
            if !row.slides {
                continue;
            }
            let (v, t) = (&mut velocity[row.i], &state.grains.wall_traction[row.i]);
            let slip = row.slip(v);
            let lacks: Vector<D> = std::array::from_fn(|k| t[k] - held[k] - row.penalty * slip[k]);
            let most = row.bears / norm(&lacks).max(f64::MIN_POSITIVE);
            let lacks = scale(most.min(1.0), &lacks);
            for c in &self.friction.contacts[row.range.clone()] {
                let push = scale(dt * c.area, &c.along(&lacks));
                let group = c.group as usize;
                let read = all || self.walls.groups[group].wants_force;
                for k in 0..D {
                    v[k] -= push[k] / state.grains.mass[row.i];
                    state.impulse[group][k] += if read { push[k] } else { 0.0 };
                }
            }
        }
    }

    /// What of a traction x is beyond so many times what the contacts of a row bear [Pa].
    fn beyond(
        &self,
        row: &FrictionRow<D>,
        x: &Vector<D>,
        tau: &Tensor<D>,
        times: f64,
    ) -> Vector<D> {
        let mut beyond = [0.0; D];
        for c in &self.friction.contacts[row.range.clone()] {
            let along = c.along(x);
            let size = norm(&along);
            let most = times * self.friction_limit(c, tau);
            if size > most {
                for k in 0..D {
                    beyond[k] += c.area * (1.0 - most / size) * along[k];
                }
            }
        }
        apply(&row.spread, &beyond)
    }

    /// p between grains and walls that momentum feels over the step [Pa].
    fn pressure_on_walls(&self, i: usize) -> f64 {
        let mean = self.acoustic.pressure.get(i);
        mean.map_or_else(|| self.effective_pressure()[i], |p| *p)
    }

    /// mu_w (p - n.tau n) >= 0 of a contact [Pa].
    fn friction_limit(&self, c: &Contact<D>, tau: &Tensor<D>) -> f64 {
        let pull = dot(&c.normal, &apply(tau, &c.normal));
        let pressure = self.pressure_on_walls(c.i as usize) - pull;
        self.walls.groups[c.group as usize].friction * pressure.max(0.0)
    }

    /// Adds the impulse of friction over one step to those on walls whose force somebody reads, or on all [N s].
    pub(super) fn add_friction_reactions(&self, state: &mut State<D>, dt: f64, all: bool) {
        for (row, held) in self.friction.rows.iter().zip(&self.viscous.held) {
            let v = &self.viscous.velocity[row.i];
            for c in &self.friction.contacts[row.range.clone()] {
                let group = c.group as usize;
                if !(all || self.walls.groups[group].wants_force) {
                    continue;
                }
                let push: Vector<D> = std::array::from_fn(|k| {
                    c.area * held[k] + row.penalty * (c.area * v[k] - c.drive[k])
                });
                let push = c.along(&push);
                for k in 0..D {
                    state.impulse[group][k] += dt * push[k];
                }
            }
        }
    }
}

impl<const D: usize> FrictionRow<D> {
    /// Slip velocity along the faces at velocity v [m/s].
    fn slip(&self, v: &Vector<D>) -> Vector<D> {
        let gripped = sub(&apply(&self.grip, v), &self.drive);
        apply(&self.spread, &gripped)
    }
}
