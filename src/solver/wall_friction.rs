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
//! has that T from the first (`expect_friction`) and to the last (`even_friction`). What a sweep sees of faces is `wall_contact`, who
//! holds on to them in a step `friction_row`.

use crate::math::{Tensor, Vector, apply, dot, inverse, norm, scale, sub};
use crate::state::State;

use super::Solver;
use super::friction_row::FrictionRow;
use super::implicit::Viscous;
use super::plastic::SPARE;
use super::record::Record;
use super::wall_contact::Contact;

/// Who sees walls with friction; empty in scenes without.
#[derive(Clone, Debug, Default)]
pub(super) struct Friction<const D: usize> {
    /// Row after row.
    pub(super) contacts: Vec<Contact<D>>,
    /// In ascending order of particles.
    pub(super) rows: Vec<FrictionRow<D>>,
}

/// mu_w p over the traction of a face along which a particle slides by so small a share of its slip [1].
const STEEP: f64 = 10.0;

/// Slip that does not count as one, at full friction, over what that takes in a step [1].
const STILL: f64 = 1e-3;

impl<const D: usize> Solver<D> {
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

    /// Whether friction, after a solve, drives most of what holds together along its faces instead of holding it back: it has come to rest
    /// in this step, and the traction of its slip would turn it round.
    pub(super) fn friction_drives(&self, state: &State<D>, work: &Viscous<D>) -> bool {
        let (mut all, mut driven) = (0, 0);
        for row in self.friction.rows.iter().filter(|row| row.holds) {
            let slip = row.slip(&work.current[row.i].velocity());
            let traction = &state.grains.wall_traction[row.i];
            let power = dot(traction, &slip);
            all += 1;
            driven += usize::from(power < -STILL * row.stops * row.bears);
        }
        2 * driven > all
    }

    /// Makes the friction of a step of what slides that of the pressure and stress it ended with, by what the last solve took too much or
    /// too little: friction is then mu_w times the normal force, step by step. After [`Solver::add_reactions`], whose other forces are those
    /// of the solve's velocities.
    pub(super) fn even_friction(&mut self, state: &mut State<D>, dt: f64, all: bool) {
        let mut velocity = std::mem::take(&mut self.viscous.velocity);
        for (row, held) in self.friction.rows.iter().zip(&self.viscous.held) {
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
                for k in 0..D {
                    v[k] -= push[k] / state.grains.mass[row.i];
                }
                for (group, share) in self.friction_bearers(state, c) {
                    let group = usize::from(group);
                    let read = all || self.walls.groups[group].wants_force;
                    for k in 0..D {
                        state.impulse[group][k] += if read { share * push[k] } else { 0.0 };
                    }
                    let (place, push) = (&state.grains.position[row.i], scale(share, &push));
                    self.add_moments(&mut state.impulse, group as u16, (place, &push));
                }
            }
        }
        self.viscous.velocity = velocity;
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

    /// mu_w (p - n.tau n) >= 0 of a contact [Pa].
    fn friction_limit(&self, c: &Contact<D>, tau: &Tensor<D>) -> f64 {
        let pull = dot(&c.normal, &apply(tau, &c.normal));
        let pressure = self.pressure_on_walls(c.i as usize) - pull;
        self.walls.groups[c.group as usize].friction * pressure.max(0.0)
    }

    /// Adds the impulse of friction over one step to those on walls whose force somebody reads, or on all [N s].
    ///
    /// Returns what it is on all walls together, as the solve has it.
    pub(super) fn add_friction_reactions(
        &self,
        state: &mut State<D>,
        dt: f64,
        read: &[bool],
    ) -> Vector<D> {
        let mut total = [0.0; D];
        for (row, held) in self.friction.rows.iter().zip(&self.viscous.held) {
            let v = &self.viscous.velocity[row.i];
            for c in &self.friction.contacts[row.range.clone()] {
                let push: Vector<D> = std::array::from_fn(|k| {
                    c.area * held[k] + row.penalty * (c.area * v[k] - c.drive[k])
                });
                let push = c.along(&push);
                for k in 0..D {
                    total[k] += dt * push[k];
                }
                let bearers = self.friction_bearers(state, c);
                for (group, share) in bearers.filter(|(group, _)| read[usize::from(*group)]) {
                    let push = scale(dt * share, &push);
                    for k in 0..D {
                        state.impulse[usize::from(group)][k] += push[k];
                    }
                    let place = &state.grains.position[row.i];
                    self.add_moments(&mut state.impulse, group, (place, &push));
                }
            }
        }
        total
    }
}
