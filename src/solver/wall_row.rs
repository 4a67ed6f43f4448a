//! Particle i against the wall points that it sees: sums of each face, then what they come to for the row (docs/theory.md, E14,
//! W4, W5).
//!
//! Symbols: x = x_i - x_w, F = W'(r)/r <= 0, g = V_i w F x, v_w velocity of the point's wall where the particle is, n normal of its face
//! towards the material, in bends of what the particle sees of it (`bend`), P = n n^T at free slip and 1 at no slip.

use crate::boundary::GroupSpec;
use crate::math::{Tensor, Vector, add_outer, along, apply, dot, scale, skew, sub, trace};
use crate::state::State;

use super::Solver;
use super::barrier::Rub;
use super::bend::Bend;
use super::face_sums::FaceSums;
use super::fluid_row::Row;
use super::pair::WallRow;
use super::wall_contact::Contact;
use super::wall_faces::WallFaces;

/// Distance to the nearest wall point from which on (W5) cannot act, over the spacing [1]: on the surface it is 0.87 at most, and
/// even a point missing inside a wall has its neighbours nearer.
const CLEAR: f64 = 1.1;

/// Particle i before walls.
struct Particle<'s, const D: usize> {
    i: usize,
    x: &'s Vector<D>,
    v: &'s Vector<D>,
    is_fluid: bool,
    /// Whether its shear stress goes on into walls (W4, W14).
    leans: bool,
    /// Whether a fluid's pressure goes on in it, or presses on it beside it or where there are pores.
    holds_fluid: bool,
    bears_fluid: bool,
}

/// A wall point as it sees it.
struct Seen<'s, const D: usize> {
    wall: u32,
    group: u16,
    spec: &'s GroupSpec,
    /// x and its square.
    x: Vector<D>,
    r2: f64,
    /// V_i w F, and g of it.
    vf: f64,
    g: Vector<D>,
    /// v_w.
    velocity: Vector<D>,
    /// Of the face, as far as it is needed: 0 where neither slip nor (W4) asks for it.
    normal: Vector<D>,
    /// The bend of a face with free slip that it lies in.
    bend: Option<Bend<D>>,
}

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
        let grains = &state.grains;
        let material = &self.materials[grains.phase[i] as usize];
        let is_fluid = material.is_fluid();
        let own = Particle {
            i,
            x: &grains.position[i],
            v: &grains.velocity[i],
            is_fluid,
            leans: is_fluid || self.friction_goes_on,
            holds_fluid: material.holds_fluid(),
            bears_fluid: meets_fluid || self.has_pores,
        };
        let mut faces = WallFaces::new(self, (i, row), contacts);
        let mut nearest2 = f64::INFINITY;
        for &wall in near {
            let Some(point) = self.see_wall(state, &own, wall, faces.last()) else {
                continue;
            };
            nearest2 = nearest2.min(point.r2);
            let face = faces.of_points(point.group, &point.normal, point.bend);
            self.add_to_face(&own, &point, face);
            self.add_to_row(&own, &point, face, sums);
        }
        let mut w = faces.finish(&sums.moment)?;
        if nearest2 < (CLEAR * self.numerics.spacing).powi(2) {
            self.hold_off((own.x, own.v), material, near, &mut w);
        }
        let wall_gradient = w.gradient(own.v, true);
        for a in 0..D {
            for c in 0..D {
                sums.gradient[a][c] += wall_gradient[a][c];
            }
        }
        let share = (w.divergence(own.v) - trace(&wall_gradient)) / D as f64;
        for k in 0..D {
            sums.gradient[k][k] += share;
        }
        Some(w)
    }

    /// `None` beyond the support. `last`: the face of the point before.
    #[inline(always)]
    fn see_wall(
        &self,
        state: &State<D>,
        own: &Particle<'_, D>,
        wall: u32,
        last: Option<&FaceSums<D>>,
    ) -> Option<Seen<'_, D>> {
        let x = self
            .periodic
            .difference(own.x, &self.walls.position[wall as usize]);
        let r2 = dot(&x, &x);
        let weight = self.walls.weight[wall as usize];
        if r2 >= self.kernel.support().powi(2) || r2 == 0.0 || weight == 0.0 {
            return None;
        }
        let normal = self.face_normal(own, wall, last, state);
        let group = self.walls.group[wall as usize];
        let spec = &self.walls.groups[group as usize];
        let bend = if spec.free_slip {
            self.bend_at(wall, &x, &normal)
        } else {
            None
        };
        let vf = self.wall_volume(own.i, wall, weight) * self.kernel.f(r2.sqrt());
        Some(Seen {
            wall,
            group,
            spec,
            x,
            r2,
            vf,
            g: scale(vf, &x),
            velocity: self.wall_velocity_at(wall, &x),
            normal,
            bend,
        })
    }

    /// Normal of the face that a wall point belongs to, as far as the particle needs it: 0 where neither slip nor (W4) asks for it.
    /// `last` is the face of the point before: one gate has one normal for all its points.
    #[inline(always)]
    fn face_normal(
        &self,
        own: &Particle<'_, D>,
        wall: u32,
        last: Option<&FaceSums<D>>,
        state: &State<D>,
    ) -> Vector<D> {
        let group = self.walls.group[wall as usize];
        if !own.leans && !self.walls.groups[group as usize].free_slip {
            return [0.0; D];
        }
        match last {
            Some(f) if f.group == group && usize::from(group) >= self.fixed_groups => f.normal,
            _ => self.wall_normal(own.x, wall, state),
        }
    }

    /// Adds a point to the sums of its face.
    #[inline(always)]
    fn add_to_face(&self, own: &Particle<'_, D>, point: &Seen<'_, D>, face: &mut FaceSums<D>) {
        let (x, g, vw) = (&point.x, &point.g, &point.velocity);
        face.velocity = *vw;
        add_outer(&mut face.around, -1.0, x, g);
        let c = 2.0 * (D as f64 + 2.0) / (-point.vf * point.r2);
        face.add(g, c, vw);
        if self.has_streams {
            face.pushed += dot(&self.point_velocity(point.wall), g);
        }
        if face.free_slip {
            face.add_length(self.ring_part(own.i, point.wall), g);
        }
        if own.leans && !face.free_slip {
            face.lean -= point.vf * dot(&point.normal, x).powi(2);
        }
        if own.holds_fluid {
            face.add_moment(-point.vf, x, vw);
        } else if own.bears_fluid && face.free_slip {
            face.add_moment(-point.vf, &along(&point.normal, x), vw);
        }
    }

    /// Adds a point to those sums of the row that do not ask whose face it is in, and what the particle sees of its motion.
    #[inline(always)]
    fn add_to_row(
        &self,
        own: &Particle<'_, D>,
        point: &Seen<'_, D>,
        face: &FaceSums<D>,
        sums: &mut Row<D>,
    ) {
        add_outer(&mut sums.moment, -1.0, &point.x, &point.g);
        for (side, g) in sums.side.iter_mut().zip(&point.g) {
            *side += g;
        }
        sums.nearness -= point.vf;
        let v = sub(own.v, &point.velocity);
        let seen = face.seen(&v);
        let approach = 2.0 * dot(&seen, &point.x);
        sums.add_pair(&point.x, approach, -point.vf, self.has_fluids);
        if own.is_fluid {
            sums.curvature += self.wall_curvature(own.v, point);
        }
        // Sliding along a free-slip face costs nothing: only the part it sees bounds the step, unless the face
        // itself comes along.
        let v = if point.spec.moves { v } else { seen };
        sums.speed2 = sums.speed2.max(dot(&v, &v));
    }

    /// What a point adds to K of (E20): how div v of (E14b) changes on a step's straight way towards it, and by its own way round.
    fn wall_curvature(&self, v: &Vector<D>, point: &Seen<'_, D>) -> f64 {
        let (x, spec) = (&point.x, point.spec);
        let comes_along = self.wall_moves(point.group);
        let motion = if comes_along {
            point.velocity
        } else {
            self.point_velocity(point.wall)
        };
        let u = sub(v, &motion);
        let (r, along) = (point.r2.sqrt(), dot(&u, x));
        let steeper = self.kernel.f_slope(r) / (self.kernel.f(r) * r);
        let mut sum = dot(&u, &u) + steeper * along * along;
        if comes_along && spec.spin != [0.0; 3] {
            let drift: Vector<D> = std::array::from_fn(|k| spec.drift[k]);
            let inwards = apply(&skew(&spec.spin), &sub(&motion, &drift));
            sum -= dot(&inwards, x);
        }
        2.0 * point.vf * sum
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
            phase: [0.0; D],
            barrier: 0.0,
            push: [0.0; D],
            rub: Rub::NONE,
            grip: [0.0; D],
            lean: [[0.0; D]; D],
            lean_less: [[0.0; D]; D],
            sticking: 0.0,
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
