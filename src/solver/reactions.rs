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
        // What the solve has left, so that walls give all that the material gets.
        let left = self.momentum_left(state);
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
                self.push_points(state, &pushing, near, &mut pushes);
                let grains = !self.material_of(state, b * CHUNK + row).is_fluid();
                part_at_corners(&mut pushes, grains, self.numerics.spacing);
                for push in &pushes {
                    let borne = &mut borne[push.group as usize];
                    *borne = add(borne, &push.impulse());
                }
            }
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
        self.add_friction_reactions(state, dt, all);
    }

    /// Momentum that the viscous solve has left in what touches walls [N s]: (E9) holds to its tolerance. What touches none has it back
    /// already ([`Solver::restore_momentum`]).
    fn momentum_left(&self, state: &State<D>) -> Vector<D> {
        let mut sum = [0.0; D];
        let residual = &self.viscous.residual;
        if residual.len() != state.grains.len() {
            return sum;
        }
        // Rings keep momentum along their axis only.
        let first = usize::from(self.geometry.is_axisymmetric());
        for (r, piece) in residual.iter().zip(&self.lists.pieces) {
            if piece.is_none() {
                for k in first..D {
                    sum[k] += r[k];
                }
            }
        }
        sum
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

    /// Adds what a particle hands to each of the points `near` it, as it feels it.
    fn push_points(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        near: &[u32],
        pushes: &mut Vec<Push<D>>,
    ) {
        let i = pushing.i;
        let xi = &state.grains.position[i];
        let support = self.kernel.support();
        let by_stress = pushing.dt * self.width * self.volume[i];
        for &w in near {
            let (x, r) = self.wall_offset(xi, w);
            if self.walls.weight[w as usize] == 0.0 || r >= support || r == 0.0 {
                continue;
            }
            let (pressure, shear) = self.stress_push(state, pushing, w, (&x, r));
            let other = self.other_push(state, pushing, w, (&x, r));
            pushes.push(Push {
                group: self.walls.group[w as usize],
                normal: self.wall_normal(xi, w, state),
                to: scale(-1.0, &x),
                pressure: scale(by_stress, &pressure),
                rest: add(&scale(by_stress, &shear), &other),
            });
        }
    }

    /// Of pressure, -2 p g, and of shear stress, 2 P (tau g) - 2 share eta c (P g)(P g).(v - v_w), on the particle and over its volume.
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
        let shear = scale(2.0, &seen(apply(&self.viscous.stress(i), &g)));
        let pg = seen(g);
        let dissipation = 2.0 * (D as f64 + 2.0);
        let c = dissipation / (-vf * r * r) * self.pair_viscosity[i];
        let against = sub(&self.viscous.velocity[i], &self.walls.velocity[w as usize]);
        let drag = -2.0 * self.numerics.pair_viscosity_share * c * dot(&pg, &against);
        (pressure, add(&shear, &scale(drag, &pg)))
    }

    /// Impulse on the particle of what is not a stress: each point's part of K (W4), of L (W7) and of (W5), as they were counted.
    fn other_push(
        &self,
        state: &State<D>,
        pushing: &Pushing<D>,
        w: u32,
        (x, r): (&Vector<D>, f64),
    ) -> Vector<D> {
        let mut part = [0.0; D];
        let Some(seen) = pushing.seen else {
            return part;
        };
        let (i, dt) = (pushing.i, pushing.dt);
        let mass = state.grains.mass[i];
        let xi = &state.grains.position[i];
        let weight = self.walls.weight[w as usize];
        let vf = self.wall_volume(i, w, weight) * self.kernel.f(r);
        if self.has_fluids && self.wall_projection(xi, w, state).is_none() {
            let n = self.wall_normal(xi, w, state);
            let along = sub(&pushing.leant, &scale(dot(&n, &pushing.leant), &n));
            part = scale(-vf * dot(&n, x).powi(2), &along);
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
        part
    }
}
