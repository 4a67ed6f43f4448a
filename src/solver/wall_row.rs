//! Particle i against the wall points that it sees: sums of each face, then what they come to for the row (docs/theory.md, E14,
//! W4, W5).
//!
//! Symbols: x = x_i - x_w, F = W'(r)/r <= 0, g = V_i w F x, v_w velocity of the point's wall where the particle is, n normal of its face
//! towards the material, in bends of what the particle sees of it (`bend`), P = n n^T at free slip and 1 at no slip.

use crate::material::{Friction as _, Material};
use crate::math::{Tensor, Vector, add_outer, along, apply, dot, scale, skew, sub, trace};
use crate::state::State;

use super::Solver;
use super::barrier::{Nearness, Rub};
use super::bend::Turning;
use super::face_sums::FaceSums;
use super::flat_face::FlatFace;
use super::fluid_row::Row;
use super::pair::WallRow;
use super::wall_contact::Contact;

/// Distance to the nearest wall point from which on (W5) cannot act, over the spacing [1]: on the surface it is 0.87 at most, and
/// even a point missing inside a wall has its neighbours nearer.
const CLEAR: f64 = 1.1;

impl<const D: usize> Solver<D> {
    /// Adds to the sums of row i what the wall points `near` it give, and to `contacts` the faces with friction; `None` where
    /// there is no wall within the support. `meets_fluid`: whether it is of grains and has fluids among its neighbours.
    // Within the sweep, so that the compiler may use the lanes' instructions here too.
    #[inline(always)]
    pub(super) fn wall_row(
        &self,
        state: &State<D>,
        (i, row, meets_fluid): (usize, usize, bool),
        near: &[u32],
        sums: &mut Row<D>,
        contacts: &mut Vec<Contact<D>>,
    ) -> Option<WallRow<D>> {
        let first_contact = contacts.len();
        let grains = &state.grains;
        let (xi, vi) = (&grains.position[i], &grains.velocity[i]);
        let support2 = self.kernel.support().powi(2);
        let dissipation = D as f64 + 2.0;
        let material = &self.materials[grains.phase[i] as usize];
        let is_fluid = material.is_fluid();
        let bears_fluid = meets_fluid || (self.has_pores && !is_fluid);
        let mut w = WallRow::new(row as u32);
        let mut flat = FlatFace::NONE;
        let mut face: Option<FaceSums<D>> = None;
        let mut nearest2 = f64::INFINITY;
        let mut turning = Turning::NONE;
        for &wall in near {
            let x = self
                .periodic
                .difference(xi, &self.walls.position[wall as usize]);
            let r2 = dot(&x, &x);
            let weight = self.walls.weight[wall as usize];
            if r2 >= support2 || r2 == 0.0 || weight == 0.0 {
                continue;
            }
            nearest2 = nearest2.min(r2);
            let normal = self.face_normal(xi, wall, is_fluid, face.as_ref(), state);
            let group = self.walls.group[wall as usize];
            let spec = &self.walls.groups[group as usize];
            let bend = if spec.free_slip {
                self.bend_at(wall, &x, &normal)
            } else {
                None
            };
            if face
                .as_ref()
                .is_none_or(|f| !f.has(group, &normal, bend.as_ref()))
            {
                let next = FaceSums::new(group, normal, spec.free_slip, bend);
                if let Some(done) = face.replace(next) {
                    self.add_turn(&done, &mut w, &mut turning);
                    self.add_face(&done, i, (contacts, first_contact), &mut w, &mut flat);
                }
            }
            let Some(face) = &mut face else { continue };
            let vf = self.wall_volume(i, wall, weight) * self.kernel.f(r2.sqrt());
            let g = scale(vf, &x);
            let vw = &self.wall_velocity_at(wall, &x);
            face.velocity = *vw;
            add_outer(&mut face.around, -1.0, &x, &g);
            face.add(&g, 2.0 * dissipation / (-vf * r2), vw);
            if spec.friction > 0.0 {
                face.add_length(self.ring_part(i, wall), &g);
            }
            if is_fluid {
                face.add_moment(-vf, &x, vw);
                if !face.free_slip {
                    face.lean -= vf * dot(&normal, &x).powi(2);
                }
            } else if bears_fluid && face.free_slip {
                face.add_moment(-vf, &along(&normal, &x), vw);
            }
            add_outer(&mut sums.moment, -1.0, &x, &g);
            for (side, g) in sums.side.iter_mut().zip(&g) {
                *side += g;
            }
            sums.nearness -= vf;
            let v = sub(vi, vw);
            let seen = face.seen(&v);
            sums.add_pair(&x, 2.0 * dot(&seen, &x), -vf, self.has_fluids);
            // Sliding along a free-slip face costs nothing: only the part it sees bounds the step, unless the face
            // itself comes along.
            let v = if spec.moves { v } else { seen };
            sums.speed2 = sums.speed2.max(dot(&v, &v));
        }
        let last = face?;
        self.add_turn(&last, &mut w, &mut turning);
        if !self.geometry.is_axisymmetric() {
            turning.complete(&sums.moment, &mut w);
        }
        self.add_face(&last, i, (contacts, first_contact), &mut w, &mut flat);
        flat.smooth(&mut w, self.numerics.spacing);
        if nearest2 < (CLEAR * self.numerics.spacing).powi(2) {
            let nearness = self.nearness(xi, vi, near, material);
            w.barrier = self.barrier.push(&nearness, self.sound_speed_of(material));
            if w.barrier > 0.0 {
                w.push = nearness.push(w.barrier);
                w.rub = nearness.rub();
            }
        }
        let wall_gradient = w.gradient(vi, true);
        for a in 0..D {
            for c in 0..D {
                sums.gradient[a][c] += wall_gradient[a][c];
            }
        }
        let share = (w.divergence(vi) - trace(&wall_gradient)) / D as f64;
        for k in 0..D {
            sums.gradient[k][k] += share;
        }
        Some(w)
    }

    /// Normal of the face that a wall point belongs to, as far as a particle at xi needs it: 0 where neither slip nor fluid asks
    /// for it. `last` is the face of the point before: one gate has one normal for all its points.
    #[inline(always)]
    fn face_normal(
        &self,
        xi: &Vector<D>,
        wall: u32,
        is_fluid: bool,
        last: Option<&FaceSums<D>>,
        state: &State<D>,
    ) -> Vector<D> {
        let group = self.walls.group[wall as usize];
        if !is_fluid && !self.walls.groups[group as usize].free_slip {
            return [0.0; D];
        }
        match last {
            Some(f) if f.group == group && usize::from(group) >= self.fixed_groups => f.normal,
            _ => self.wall_normal(xi, wall, state),
        }
    }

    /// Adds the sums of a face to those of the row.
    #[inline(always)]
    fn add_face(
        &self,
        face: &FaceSums<D>,
        i: usize,
        (contacts, first): (&mut Vec<Contact<D>>, usize),
        w: &mut WallRow<D>,
        flat: &mut FlatFace<D>,
    ) {
        let n = face.across();
        for a in 0..D {
            w.s[a] += face.s[a];
            w.cv[a] += face.dragged[a];
            w.moment_drive[a] += face.moment_drive[a];
            for b in 0..D {
                w.moment[a][b] += face.moment[a][b];
                w.c[a][b] += face.pair[a][b];
                let p = if face.free_slip {
                    n[a] * n[b]
                } else {
                    f64::from(u8::from(a == b))
                };
                for c in 0..D {
                    w.k[a][b][c] += p * face.s[c];
                    w.q[a][c] += p * face.carried[b][c];
                }
            }
        }
        let moves = self.wall_moves(face.group);
        if moves {
            w.drive += trace(&face.carried);
        }
        let n = &face.normal;
        if face.lean > 0.0 {
            for a in 0..D {
                w.lean[a][a] += face.lean;
            }
            add_outer(&mut w.lean, -face.lean, n, n);
        }
        let rubs = face.free_slip && self.walls.groups[face.group as usize].friction > 0.0;
        flat.add(face, rubs && face.bend.is_none(), moves);
        if !rubs {
            return;
        }
        let to_area = -2.0 * self.volume[i] * self.width;
        let area = to_area * dot(&face.s, n);
        let drive = scale(to_area, &apply(&face.carried, n));
        Contact::gather(contacts, first, (i, face.group), n, area, &drive);
    }

    /// Adds what turns with a face to the row: the rotation that a bend makes of sliding, and the wall's own.
    #[inline(always)]
    fn add_turn(&self, face: &FaceSums<D>, w: &mut WallRow<D>, turning: &mut Turning<D>) {
        let spin = &self.walls.groups[face.group as usize].spin;
        if let Some(bend) = &face.bend {
            w.add_bend(&bend.rate, &face.around, &face.velocity);
        }
        turning.add(face.bend.as_ref(), spin, &face.around, &face.velocity);
        if *spin != [0.0; 3] {
            w.add_spin(&skew(spin), &face.around);
        }
    }

    /// What (W5) is made of: sums over all wall points near a particle at xi, moving at vi.
    fn nearness(
        &self,
        xi: &Vector<D>,
        vi: &Vector<D>,
        near: &[u32],
        material: &Material,
    ) -> Nearness<D> {
        let mut nearness = Nearness::NONE;
        let rough = material.law.static_friction();
        for &wall in near {
            let (x, r) = self.wall_offset(xi, wall);
            let weight = self.walls.weight[wall as usize];
            let against = sub(vi, &self.point_velocity(wall));
            let spec = &self.walls.groups[self.walls.group[wall as usize] as usize];
            let friction = match (rough > 0.0, spec.free_slip) {
                (true, true) => spec.friction,
                (true, false) => rough,
                (false, _) => 0.0,
            };
            let face = (friction, &self.walls.velocity[wall as usize]);
            self.barrier
                .add(&mut nearness, (&x, r), weight, &against, face);
            if let Some((x, r)) = self.wall_image(xi, wall) {
                self.barrier
                    .add(&mut nearness, (&x, r), weight, &against, face);
            }
        }
        nearness
    }
}

impl<const D: usize> WallRow<D> {
    pub(super) fn new(row: u32) -> Self {
        Self {
            row,
            s: [0.0; D],
            drive: 0.0,
            k: [[[0.0; D]; D]; D],
            q: [[0.0; D]; D],
            c: [[0.0; D]; D],
            cv: [0.0; D],
            smoothed: 0.0,
            barrier: 0.0,
            push: [0.0; D],
            rub: Rub::NONE,
            grip: [0.0; D],
            lean: [[0.0; D]; D],
            lean_less: [[0.0; D]; D],
            moment: [[0.0; D]; D],
            moment_drive: [0.0; D],
            carried: [0.0; D],
            lack: [[0.0; D]; D],
            images: (0, 0),
            reflections: (0, 0),
        }
    }

    /// Part of the velocity gradient that walls give: -2 (K v - Q); without Q for the linear part.
    #[inline(always)]
    pub(super) fn gradient(&self, v: &Vector<D>, with_wall_velocity: bool) -> Tensor<D> {
        let mut g = [[0.0; D]; D];
        for a in 0..D {
            for c in 0..D {
                let mut s = if with_wall_velocity {
                    -self.q[a][c]
                } else {
                    0.0
                };
                for b in 0..D {
                    s += self.k[a][b][c] * v[b];
                }
                g[a][c] = -2.0 * s;
            }
        }
        g
    }

    /// Part of div v that walls give (E14b): by the whole velocity, -2 (v - v_w).s, where the strain takes P v, as pressure pushes along all of s.
    /// A belt's v_w, along its own face, opens and closes nothing.
    #[inline(always)]
    pub(super) fn divergence(&self, v: &Vector<D>) -> f64 {
        -2.0 * (dot(v, &self.s) - self.drive)
    }

    /// Force per volume of a stress through walls: 2 K : tau, the adjoint of [`WallRow::gradient`].
    #[inline(always)]
    pub(super) fn stress_force(&self, tau: &Tensor<D>) -> Vector<D> {
        let mut f = [0.0; D];
        for a in 0..D {
            for b in 0..D {
                for c in 0..D {
                    f[b] += 2.0 * self.k[a][b][c] * tau[a][c];
                }
            }
        }
        f
    }
}
