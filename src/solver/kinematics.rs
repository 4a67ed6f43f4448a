//! One sweep over pairs at the current positions and velocities: pair coefficients, velocity gradient, kernel
//! correction, dissipation of the pair form, largest relative speed (docs/theory.md, E1 to E4).
//!
//! Symbols: F = W'(r)/r <= 0, grad W_ij = F x_ij, x_ij = x_i - x_j, v_ij = v_i - v_j, V = m/rho.

use crate::math::{
    Lanes, Tensor, Vector, add_outer, determinant, dot, in_lanes, inverse, multiply, norm, scale,
    sub, trace,
};
use crate::state::State;

use super::Solver;
use super::barrier::Nearness;
use super::fluid_row::Row;
use super::mirror::add_image_gradient;
use super::pair::{Block, WallRow};
use super::record::Record;
use super::wall_friction::{Contact, Face};

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kinematics {
    /// div v [1/s].
    pub(super) divergence: f64,
    /// gamma from the plain gradient [1/s]: the one whose adjoint is the stress force.
    pub(super) shear: f64,
    /// R = gamma from the corrected gradient over gamma, 0.8 to 3 [1].
    pub(super) correction: f64,
    /// s: bias of the pair form for a shear like this one, 0.5 to 2 [1].
    pub(super) pair_scale: f64,
    /// Largest speed relative to a neighbour or wall [m/s].
    pub(super) relative_speed: f64,
}

impl<const D: usize> Solver<D> {
    /// Sweeps all pairs; afterwards `self.kinematics` and the blocks' pairs belong to the state's positions and velocities.
    pub(super) fn sweep_kinematics(&mut self, state: &State<D>) {
        let n = state.grains.len();
        self.volume.resize(n, 0.0);
        self.update_volumes(&state.grains.mass, &state.grains.swept_density);
        self.hold_fluid_volumes(state);
        self.update_rings(state);
        let mut records = std::mem::take(&mut self.records);
        records.resize(n, Record::default());
        self.note_mirrors(state);
        let grains = &state.grains;
        self.workers.each(&mut records, |i, r| {
            let hoop = self.rings.get(i).map_or(0.0, |ring| ring.hoop);
            *r = Record::of_motion(
                &grains.position[i],
                &grains.velocity[i],
                self.volume[i],
                hoop,
            );
        });
        self.kinematics.resize(n, Kinematics::default());
        let mut kinematics = std::mem::take(&mut self.kinematics);
        let mut blocks = std::mem::take(&mut self.lists.blocks);
        self.workers
            .blocks(&mut blocks, &mut kinematics, |block, first, out| {
                let rings = self.geometry.is_axisymmetric();
                in_lanes!(self.arch, |lanes| match (rings, self.has_fluids) {
                    (true, true) => self.block_kinematics::<_, true, true>(
                        lanes, state, &records, block, first, out
                    ),
                    (true, false) => self.block_kinematics::<_, true, false>(
                        lanes, state, &records, block, first, out
                    ),
                    (false, true) => self.block_kinematics::<_, false, true>(
                        lanes, state, &records, block, first, out
                    ),
                    (false, false) => self.block_kinematics::<_, false, false>(
                        lanes, state, &records, block, first, out
                    ),
                });
            });
        self.records = records;
        self.lists.blocks = blocks;
        self.kinematics = kinematics;
        self.note_lean(state);
    }

    #[inline(always)]
    fn block_kinematics<L: Lanes, const RINGS: bool, const FLUIDS: bool>(
        &self,
        lanes: L,
        state: &State<D>,
        records: &[Record],
        block: &mut Block<D>,
        first: usize,
        out: &mut [Kinematics],
    ) {
        block.forget_pairs();
        let mut near = std::mem::take(&mut block.near);
        let mut contacts = std::mem::take(&mut block.contacts);
        for (row, o) in out.iter_mut().enumerate() {
            let i = first + row;
            let (x, v) = (&state.grains.position[i], &state.grains.velocity[i]);
            let count = self.find_near(lanes, records, i, x, block.row(row), &mut near);
            let mut sums = self.fluid_row::<L, RINGS, FLUIDS>(
                lanes,
                records,
                (i, x, v),
                block,
                &near[..count],
            );
            block.group_ends.push(block.j.len() as u32);
            if !block.wall_row(row).is_empty()
                && let Some(mut w) = self.wall_row(
                    state,
                    (i, row),
                    block.wall_row(row),
                    &mut sums,
                    &mut contacts,
                )
            {
                if FLUIDS && !RINGS {
                    let first_image = block.images.len() as u32;
                    w.lean_less = self.find_images(state, i, block, &near[..count]);
                    w.images = (first_image, block.images.len() as u32);
                    let v = &state.grains.velocity;
                    add_image_gradient(block.images_of(&w), i, v, &mut sums.images);
                }
                block.wall_rows.push(w);
            }
            *o = self.finish(&sums, state.grains.phase[i], i, v);
        }
        block.near = near;
        block.contacts = contacts;
    }

    fn wall_row(
        &self,
        state: &State<D>,
        (i, row): (usize, usize),
        near: &[u32],
        sums: &mut Row<D>,
        contacts: &mut Vec<Contact<D>>,
    ) -> Option<WallRow<D>> {
        let first_contact = contacts.len();
        let grains = &state.grains;
        let (xi, vi) = (&grains.position[i], &grains.velocity[i]);
        let support = self.kernel.support();
        let dissipation = D as f64 + 2.0;
        let mut w = WallRow {
            row: row as u32,
            s: [0.0; D],
            drive: 0.0,
            k: [[[0.0; D]; D]; D],
            q: [[0.0; D]; D],
            c: [[0.0; D]; D],
            cv: [0.0; D],
            flat: false,
            barrier: 0.0,
            push: [0.0; D],
            lean: [[0.0; D]; D],
            lean_less: [[0.0; D]; D],
            images: (0, 0),
        };
        let material = &self.materials[grains.phase[i] as usize];
        let is_fluid = material.is_fluid();
        let mut nearness = Nearness::NONE;
        let mut any = false;
        let mut face = Face::None;
        for &wall in near {
            let (x, r) = self.wall_offset(xi, wall);
            let weight = self.walls.weight[wall as usize];
            if r >= support || r == 0.0 || weight == 0.0 {
                continue;
            }
            any = true;
            let vf = self.wall_volume(i, wall, weight) * self.kernel.f(r);
            let g = scale(vf, &x);
            let vw = self.walls.velocity[wall as usize];
            let projection = self.wall_projection(xi, wall, state);
            let seen =
                |a: &Vector<D>| -> Vector<D> { projection.map_or(*a, |n| scale(dot(&n, a), &n)) };
            let rubs =
                projection.is_some_and(|n| self.touch(contacts, first_contact, (i, wall), &n, &g));
            face = face.with(projection.filter(|_| rubs));
            if is_fluid && projection.is_none() {
                let n = self.wall_normal(xi, wall, state);
                let part = -vf * dot(&n, &x).powi(2);
                for a in 0..D {
                    w.lean[a][a] += part;
                }
                add_outer(&mut w.lean, -part, &n, &n);
            }
            for k in 0..D {
                w.s[k] += g[k];
            }
            let against = sub(vi, &self.point_velocity(wall));
            self.barrier.add(&mut nearness, (&x, r), weight, &against);
            if let Some((x, r)) = self.wall_image(xi, wall) {
                self.barrier.add(&mut nearness, (&x, r), weight, &against);
            }
            w.drive += dot(&self.point_velocity(wall), &g);
            for a in 0..D {
                for b in 0..D {
                    let p = projection.map_or(f64::from(u8::from(a == b)), |n| n[a] * n[b]);
                    for (c, gc) in g.iter().enumerate() {
                        w.k[a][b][c] += p * gc;
                    }
                }
            }
            add_outer(&mut w.q, 1.0, &seen(&vw), &g);
            let pg = seen(&g);
            let c = 2.0 * dissipation / (-vf * r * r);
            add_outer(&mut w.c, c, &pg, &pg);
            let drive = c * dot(&pg, &vw);
            for k in 0..D {
                w.cv[k] += drive * pg[k];
            }
            let v = seen(&sub(vi, &vw));
            add_outer(&mut sums.moment, -1.0, &x, &g);
            sums.add_pair(&x, 2.0 * dot(&v, &x), -vf, self.has_fluids);
            // Sliding along a free-slip face costs nothing: only the part it sees bounds the step, unless the face
            // itself comes along.
            let v = if self.walls.groups[self.walls.group[wall as usize] as usize].moves {
                sub(vi, &vw)
            } else {
                v
            };
            sums.speed2 = sums.speed2.max(dot(&v, &v));
        }
        if !any {
            return None;
        }
        w.barrier = self.barrier.push(&nearness, self.sound_speed_of(material));
        if w.barrier > 0.0 {
            w.push = nearness.push(w.barrier);
        }
        let wall_gradient = w.gradient(vi, true);
        for a in 0..D {
            for c in 0..D {
                sums.gradient[a][c] += wall_gradient[a][c];
            }
        }
        if let Face::Flat(n) = face {
            // Sliding along it does nothing, whatever the lattices' phase: g along the face adds up to nothing.
            w.flat = true;
            w.s = scale(dot(&n, &w.s), &n);
            return Some(w);
        }
        // Divergence takes the whole velocity (a tangential sum over a flat wall vanishes); the strain takes P v.
        let seen = trace(&wall_gradient);
        let whole = -2.0 * (dot(vi, &w.s) - w.drive);
        let share = (whole - seen) / D as f64;
        for k in 0..D {
            sums.gradient[k][k] += share;
        }
        Some(w)
    }

    /// From the sums of row i, at velocity v, to what the rheology needs.
    pub(super) fn finish(&self, sums: &Row<D>, phase: u8, i: usize, v: &Vector<D>) -> Kinematics {
        let hoop = self.hoop_rate(i, v);
        let mut gradient = sums.gradient;
        let mut kinematics = Kinematics {
            divergence: trace(&gradient),
            shear: 0.0,
            correction: 1.0,
            pair_scale: 1.0,
            relative_speed: sums.speed2.sqrt(),
        };
        if self.has_fluids {
            // Images change the shear rate and not div v, whose adjoint the pressure is.
            for a in 0..D {
                for b in 0..D {
                    gradient[a][b] += sums.images[a][b];
                }
            }
        }
        let mut pair_shear2 = sums.pair_shear2;
        let plain_gradient = gradient;
        if self.geometry.is_axisymmetric() {
            gradient[0][0] += self.axis_rate(i, v);
            kinematics.divergence += hoop + self.rings[i].closing;
            pair_shear2 += hoop * hoop;
            if self.rings[i].axis != 0.0 {
                // Its image comes as fast.
                kinematics.relative_speed = kinematics.relative_speed.max(2.0 * v[0].abs());
            }
        }
        let plain = self.geometry.strain_deviator(&gradient, hoop);
        kinematics.shear = self.geometry.shear_rate(&plain);
        if kinematics.shear > 0.0 && determinant(&sums.moment) > 0.15 {
            // M does without what `axis` stands for.
            let corrected = multiply(&plain_gradient, &inverse(&sums.moment));
            let e = self.geometry.strain_deviator(&corrected, hoop);
            let shear = self.geometry.shear_rate(&e);
            kinematics.correction = (shear / kinematics.shear).clamp(0.8, 3.0);
            if self.materials[phase as usize].is_fluid() {
                // Were velocities taken as they are, their unevenness would count as shear and the pair form would bear less of the
                // mean stress than its share. Sand keeps them: there unevenness also raises mu(I).
                pair_shear2 = sums.even_pair_shear2(&e);
            }
        }
        if pair_shear2 > 0.0 {
            kinematics.pair_scale =
                (kinematics.shear * kinematics.shear / pair_shear2).clamp(0.5, 2.0);
        }
        kinematics
    }

    /// Volume (area in the section) by which particle i sees a wall point of this weight.
    #[inline(always)]
    pub(super) fn wall_volume(&self, i: usize, wall: u32, weight: f64) -> f64 {
        if self.geometry.is_axisymmetric() {
            self.ring_wall_area(i, wall, weight)
        } else {
            self.volume[i] * weight
        }
    }

    /// How a wall point moves [m/s]: a belt's surface slides, its points stay, and what comes near them is compressed
    /// by its own way only.
    #[inline(always)]
    pub(super) fn point_velocity(&self, wall: u32) -> Vector<D> {
        let group = self.walls.group[wall as usize] as usize;
        if group >= self.fixed_groups || self.walls.groups[group].moves {
            self.walls.velocity[wall as usize]
        } else {
            [0.0; D]
        }
    }

    /// x_i - x_wall and its length, nearest image.
    #[inline(always)]
    pub(super) fn wall_offset(&self, xi: &Vector<D>, wall: u32) -> (Vector<D>, f64) {
        let x = self
            .periodic
            .difference(xi, &self.walls.position[wall as usize]);
        let r = norm(&x);
        (x, r)
    }

    /// x_i - x' and its length, x' the image of a wall point across the axis; `None` where there is no axis. A wall goes on
    /// there, and its points are not listed twice.
    #[inline(always)]
    pub(super) fn wall_image(&self, xi: &Vector<D>, wall: u32) -> Option<(Vector<D>, f64)> {
        if !self.geometry.is_axisymmetric() {
            return None;
        }
        let xw = &self.walls.position[wall as usize];
        let mut x = sub(xi, xw);
        x[0] = xi[0] + xw[0];
        let r = norm(&x);
        Some((x, r))
    }

    /// Normal to project on at free slip; `None` at no slip.
    #[inline(always)]
    pub(super) fn wall_projection(
        &self,
        xi: &Vector<D>,
        wall: u32,
        state: &State<D>,
    ) -> Option<Vector<D>> {
        let group = self.walls.group[wall as usize] as usize;
        let free = self.walls.groups[group].free_slip;
        free.then(|| self.wall_normal(xi, wall, state))
    }

    /// Normal towards the material of a wall point that a particle at xi sees.
    #[inline(always)]
    pub(super) fn wall_normal(&self, xi: &Vector<D>, wall: u32, state: &State<D>) -> Vector<D> {
        let group = self.walls.group[wall as usize] as usize;
        let gate = group.checked_sub(self.fixed_groups);
        if let Some(g) = gate {
            return self.plates[g].normal_at(xi, state.gates[g].opening);
        }
        let end = self.walls.end_of(wall as usize);
        let beside = end.and_then(|e| e.normal_at(&self.periodic.difference(xi, &e.point)));
        beside.unwrap_or(self.walls.normal[wall as usize])
    }
}

impl<const D: usize> WallRow<D> {
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
