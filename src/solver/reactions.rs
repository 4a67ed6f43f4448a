//! Forces on walls: what every particle hands to the points that it sees, and whose it is where walls meet (docs/theory.md, "Forces
//! on walls").

use crate::math::{CHUNK, Vector, add, along, apply, dot, norm, scale, sub};
use crate::state::State;

use super::Solver;
use super::bend::Bend;
use super::corners::{Push, across, part_at_corners};
use super::pair::WallRow;
use super::seams::{OF_FLUIDS, share_at_seams};

/// What is the same for all points that a particle sees.
struct Pushing<'a, const D: usize> {
    i: usize,
    seen: Option<&'a WallRow<D>>,
    /// dt a of friction (W5) for each part of the push, and that push.
    grip: Option<(Vector<D>, Vector<D>)>,
    /// What (W4) carries on [N/m^2].
    leant: Vector<D>,
    dt: f64,
}

/// A wall point as the sums of a particle have it.
struct Reach<const D: usize> {
    /// V_i w F x, its part of the sum that stress is multiplied with.
    g: Vector<D>,
    /// The same for pressure: without the lattices' phase along a flat face that rubs.
    of_pressure: Vector<D>,
    /// Normal of a face with free slip, in a bend as the particle sees it.
    projection: Option<Vector<D>>,
    bend: Option<Bend<D>>,
    /// eta c of the pair form.
    c: f64,
}

impl<const D: usize> Solver<D> {
    /// Impulse of the material on walls whose force somebody reads, or on all of them, over one step [N s].
    pub(super) fn add_reactions(&mut self, state: &mut State<D>, dt: f64, all: bool) {
        let groups = &self.walls.groups;
        let read: Vec<bool> = groups.iter().map(|g| all || g.wants_force).collect();
        if !read.contains(&true) {
            return;
        }
        // What the solve has left, so that walls give all that the material gets: m (v* - v) + what walls gave in it.
        let mut left = self.momentum_of_solve(state);
        let mut borne = vec![[0.0; D]; read.len()];
        let mut pushes = Vec::new();
        for (b, block) in self.lists.blocks.iter().enumerate() {
            let mut wall_rows = block.wall_rows.iter().peekable();
            for row in 0..block.rows() {
                let seen = wall_rows.next_if(|w| w.row as usize == row);
                let near = block.wall_row(row);
                if near.is_empty() {
                    continue;
                }
                pushes.clear();
                let pushing = self.pushing(state, (b * CHUNK + row, seen), dt);
                let in_solve = self.push_points(state, &pushing, near, &mut pushes);
                left = add(&left, &in_solve);
                self.part_among_walls(state, pushing.i, dt, &mut pushes);
                for push in &pushes {
                    let borne = &mut borne[push.group as usize];
                    *borne = add(borne, &push.impulse);
                }
                if !self.moments.is_empty() {
                    let place = &state.grains.position[pushing.i];
                    for push in &pushes {
                        let on_wall = scale(-1.0, &push.impulse);
                        self.add_moments(&mut state.impulse, push.group, (place, &on_wall));
                    }
                }
            }
        }
        let rubbed = self.add_friction_reactions(state, dt, &read);
        left = sub(&left, &rubbed);
        if self.geometry.is_axisymmetric() {
            // Rings keep momentum along their axis only.
            left[0] = 0.0;
        }
        let total = borne.iter().fold(0.0, |sum, b| sum + norm(b));
        for (n, borne) in borne.iter().enumerate().filter(|(n, _)| read[*n]) {
            let share = if total > 0.0 {
                norm(borne) / total
            } else {
                0.0
            };
            for k in 0..D {
                state.impulse[n][k] -= borne[k] - share * left[k];
            }
        }
    }

    /// Adds what a particle at a place pushes a wall with to the moments of it that somebody reads: what angular momentum the
    /// material gets, and not, with friction half a spacing further out, more.
    pub(super) fn add_moments(
        &self,
        impulse: &mut [Vector<D>],
        group: u16,
        (place, push): (&Vector<D>, &Vector<D>),
    ) {
        let behind_forces = impulse.iter_mut().skip(self.walls.groups.len());
        for (sum, moment) in behind_forces.zip(&self.moments) {
            if moment.group == group {
                *sum = add(sum, &moment.of(place, push));
            }
        }
    }

    /// Hands pushes of particle i on, where several walls have a part in them, to those that bear them.
    fn part_among_walls(&self, state: &State<D>, i: usize, dt: f64, pushes: &mut Vec<Push<D>>) {
        let Some(first) = pushes.first() else {
            return;
        };
        if pushes.iter().all(|p| p.group == first.group) {
            return;
        }
        let spacing = self.numerics.spacing;
        let by_stress = self.by_stress(i, dt);
        if self.material_of(state, i).is_fluid() {
            let push = |g: &Vector<D>| scale(by_stress, &self.pressure_push(i, g));
            share_at_seams(pushes, push, OF_FLUIDS, spacing);
            part_at_corners(pushes, spacing, across);
            return;
        }
        let sheared = pushes
            .iter()
            .all(|p| !self.walls.groups[p.group as usize].free_slip);
        // Pores push as fluids do.
        let in_pores = |g: &Vector<D>| scale(-2.0 * by_stress * self.pore_pressure(state, i), g);
        let push = |g: &Vector<D>| {
            let pressed = self.pressure_push(i, g);
            let stress = scale(2.0, &apply(&self.viscous.stress(i), g));
            let whole = if sheared {
                add(&pressed, &stress)
            } else {
                pressed
            };
            sub(&scale(by_stress, &whole), &in_pores(g))
        };
        share_at_seams(pushes, push, 1.0, spacing);
        share_at_seams(pushes, in_pores, OF_FLUIDS, spacing);
        part_at_corners(pushes, spacing, |corner, point| {
            let pores = in_pores(&corner.across(&point.reach));
            // What rubs does so with all that its points press.
            if self.walls.groups[point.group as usize].friction > 0.0 {
                return pores;
            }
            add(&push(&corner.along(&point.reach)), &pores)
        });
    }

    /// Impulse over a push over a particle's volume [m^3 s].
    fn by_stress(&self, i: usize, dt: f64) -> f64 {
        dt * self.width * self.volume[i]
    }

    fn pushing<'a>(
        &self,
        state: &State<D>,
        (i, seen): (usize, Option<&'a WallRow<D>>),
        dt: f64,
    ) -> Pushing<'a, D> {
        let rubs = seen.filter(|w| w.grip != [0.0; D]);
        let grip = rubs.map(|w| {
            let size2 = dot(&w.push, &w.push);
            let share = dt * w.barrier * state.grains.mass[i] / size2;
            (scale(share, &w.grip), w.push)
        });
        let leant = seen.map_or([0.0; D], |w| self.leant(state, (i, &w.lean), dt));
        Pushing {
            i,
            seen,
            grip,
            leant,
            dt,
        }
    }

    /// Adds what a particle hands to each of the points `near` it, as it feels it; returns how much of it the solve has found.
    fn push_points(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        near: &[u32],
        pushes: &mut Vec<Push<D>>,
    ) -> Vector<D> {
        let i = pushing.i;
        let xi = &state.grains.position[i];
        let support = self.kernel.support();
        let by_stress = self.by_stress(i, pushing.dt);
        let mut in_solve = [0.0; D];
        for &w in near {
            let (x, r) = self.wall_offset(xi, w);
            if self.walls.weight[w as usize] == 0.0 || r >= support || r == 0.0 {
                continue;
            }
            let reach = self.reach(state, pushing, w, (&x, r));
            let pressure = self.pressure_push(i, &reach.of_pressure);
            let stress = self.stress_push(pushing, w, &x, &reach);
            let (leant, other) = self.other_push(state, pushing, w, (&x, r));
            let solved = add(&scale(by_stress, &stress), &leant);
            in_solve = add(&in_solve, &solved);
            let push = Push {
                group: self.walls.group[w as usize],
                normal: self.wall_normal(xi, w, state),
                to: scale(-1.0, &x),
                reach: reach.of_pressure,
                impulse: add(&add(&scale(by_stress, &pressure), &other), &solved),
            };
            let bearers = self.walls.bearers(w as usize);
            pushes.extend(bearers.map(|(group, share)| push.part(group, share)));
        }
        in_solve
    }

    /// A point as the sums of a particle have it.
    fn reach(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        w: u32,
        (x, r): (&Vector<D>, f64),
    ) -> Reach<D> {
        let vf = self.wall_volume(pushing.i, w, self.walls.weight[w as usize]) * self.kernel.f(r);
        let g = scale(vf, x);
        let projection = self.wall_projection(&state.grains.position[pushing.i], w, state);
        // A point has of what the sum lacks (W3b) as much as of the push across the face, and keeps what it pushes along itself.
        let of_pressure = match (projection, pushing.seen) {
            (Some(n), Some(seen)) if seen.phase != [0.0; D] => {
                let share = dot(&n, &g) / dot(&n, &seen.s);
                sub(&g, &scale(share, &seen.phase))
            }
            _ => g,
        };
        let bend = projection.and_then(|n| self.bend_at(w, x, &n));
        Reach {
            g,
            of_pressure,
            projection: bend.map(|b| b.normal).or(projection),
            bend,
            c: -self.pair_viscosity[pushing.i] * 2.0 * (D as f64 + 2.0) / (vf * r * r),
        }
    }

    /// On particle i, over its volume, where its pressure is multiplied with g.
    fn pressure_push(&self, i: usize, g: &Vector<D>) -> Vector<D> {
        let even = scale(-2.0 * self.mean_pressure(i), g);
        match self.uneven_pressure.get(i) {
            Some(uneven) => add(&even, &scale(2.0, &apply(uneven, g))),
            None => even,
        }
    }

    /// On a particle, over its volume, of stress: 2 P (tau g) - 2 share eta c (P g)(P g).(v - v_w), and what turns in bends.
    fn stress_push(
        &self,
        pushing: &Pushing<D>,
        w: u32,
        x: &Vector<D>,
        reach: &Reach<D>,
    ) -> Vector<D> {
        let i = pushing.i;
        let tau = self.viscous.stress(i);
        let seen =
            |a: Vector<D>| -> Vector<D> { reach.projection.map_or(a, |n| scale(dot(&n, &a), &n)) };
        let mut stress = scale(2.0, &seen(apply(&tau, &reach.g)));
        if let (Some(bend), Some(row)) = (&reach.bend, pushing.seen) {
            let turned = Self::bend_force(bend, &tau, (x, &reach.g), &row.lack);
            stress = add(&stress, &turned);
        }
        let pg = seen(reach.g);
        let against = sub(&self.viscous.velocity[i], &self.wall_velocity_at(w, x));
        let drag = -2.0 * self.numerics.pair_viscosity_share * reach.c * dot(&pg, &against);
        add(&stress, &scale(drag, &pg))
    }

    /// Impulse on the particle of what is not a stress: each point's part of K (W4, W14), as the solve has it, and of L (W7, W10) and of (W5), as they were counted.
    fn other_push(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        w: u32,
        (x, r): (&Vector<D>, f64),
    ) -> (Vector<D>, Vector<D>) {
        let (mut leant, mut part) = ([0.0; D], [0.0; D]);
        let Some(seen) = pushing.seen else {
            return (leant, part);
        };
        let (i, dt) = (pushing.i, pushing.dt);
        let mass = state.grains.mass[i];
        let xi = &state.grains.position[i];
        let weight = self.walls.weight[w as usize];
        let vf = self.wall_volume(i, w, weight) * self.kernel.f(r);
        if pushing.leant != [0.0; D] && self.wall_projection(xi, w, state).is_none() {
            let n = self.wall_normal(xi, w, state);
            leant = scale(-vf * dot(&n, x).powi(2), &along(&n, &pushing.leant));
        }
        if seen.carried != [0.0; D] {
            let carries = if self.material_of(state, i).holds_fluid() {
                *x
            } else {
                let projection = self.wall_projection(xi, w, state);
                projection.map_or([0.0; D], |n| along(&n, x))
            };
            let share = -vf * dt * mass * dot(&carries, &seen.carried);
            part = add(&part, &scale(share, &carries));
        }
        if seen.barrier > 0.0 {
            let mut away = self.barrier.slope(x, r, weight);
            if let Some((x, r)) = self.wall_image(xi, w) {
                away = add(&away, &self.barrier.slope(&x, r, weight));
            }
            part = add(&part, &scale(-dt * seen.barrier * mass, &away));
            if let Some((grip, push)) = &pushing.grip {
                part = add(&part, &scale(-dot(&away, push), grip));
            }
        }
        (leant, part)
    }
}
