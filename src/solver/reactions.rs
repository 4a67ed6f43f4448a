//! Forces on walls: what every particle hands to the points that it sees, and whose it is where walls meet (docs/theory.md, "Forces
//! on walls").

use crate::math::{CHUNK, Vector, add, apply, dot, norm, scale, sub};
use crate::state::State;

use super::Solver;
use super::corners::{Push, part_at_corners};
use super::pair::WallRow;

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
                if self.material_of(state, b * CHUNK + row).is_fluid() {
                    part_at_corners(&mut pushes, self.numerics.spacing);
                }
                for push in &pushes {
                    let borne = &mut borne[push.group as usize];
                    *borne = add(borne, &push.impulse);
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
        let leant = seen.map_or([0.0; D], |w| self.leant(state, i, &w.lean));
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
        let by_stress = pushing.dt * self.width * self.volume[i];
        let mut in_solve = [0.0; D];
        for &w in near {
            let (x, r) = self.wall_offset(xi, w);
            if self.walls.weight[w as usize] == 0.0 || r >= support || r == 0.0 {
                continue;
            }
            let (pressure, stress) = self.stress_push(state, pushing, w, (&x, r));
            let (leant, other) = self.other_push(state, pushing, w, (&x, r));
            let solved = add(&scale(by_stress, &stress), &leant);
            in_solve = add(&in_solve, &solved);
            pushes.push(Push {
                group: self.walls.group[w as usize],
                normal: self.wall_normal(xi, w, state),
                to: scale(-1.0, &x),
                impulse: add(&add(&scale(by_stress, &pressure), &other), &solved),
            });
        }
        in_solve
    }

    /// On the particle, over its volume: of pressure, -2 p g, and of stress, 2 P (tau g) - 2 share eta c (P g)(P g).(v - v_w).
    fn stress_push(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        w: u32,
        (x, r): (&Vector<D>, f64),
    ) -> (Vector<D>, Vector<D>) {
        let i = pushing.i;
        let xi = &state.grains.position[i];
        let vf = self.wall_volume(i, w, self.walls.weight[w as usize]) * self.kernel.f(r);
        let g = scale(vf, x);
        let projection = self.wall_projection(xi, w, state);
        let seen = |a: Vector<D>| -> Vector<D> { projection.map_or(a, |n| scale(dot(&n, &a), &n)) };
        let flat = pushing.seen.is_some_and(|w| w.flat);
        let push = if flat { seen(g) } else { g };
        let mut pressure = scale(-2.0 * self.mean_pressure(i), &push);
        if let Some(uneven) = self.uneven_pressure.get(i) {
            pressure = add(&pressure, &scale(2.0, &apply(uneven, &push)));
        }
        let stress = scale(2.0, &seen(apply(&self.viscous.stress(i), &g)));
        let pg = seen(g);
        let dissipation = 2.0 * (D as f64 + 2.0);
        let c = dissipation / (-vf * r * r) * self.pair_viscosity[i];
        let against = sub(&self.viscous.velocity[i], &self.walls.velocity[w as usize]);
        let drag = -2.0 * self.numerics.pair_viscosity_share * c * dot(&pg, &against);
        (pressure, add(&stress, &scale(drag, &pg)))
    }

    /// Impulse on the particle of what is not a stress: each point's part of K (W4), as the solve has it, and of L (W7) and of (W5), as they were counted.
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
        if self.has_fluids && self.wall_projection(xi, w, state).is_none() {
            let n = self.wall_normal(xi, w, state);
            let along = sub(&pushing.leant, &scale(dot(&n, &pushing.leant), &n));
            leant = scale(-vf * dot(&n, x).powi(2), &along);
        }
        if seen.carried != [0.0; D] {
            let share = -vf * dt * mass * dot(x, &seen.carried);
            part = add(&part, &scale(share, x));
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
