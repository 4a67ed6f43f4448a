//! One sweep over pairs at the current positions and velocities: pair coefficients, velocity gradient, kernel
//! correction, dissipation of the pair form, largest relative speed (docs/theory.md, E1 to E4).
//!
//! Symbols: F = W'(r)/r <= 0, grad W_ij = F x_ij, x_ij = x_i - x_j, v_ij = v_i - v_j, V = m/rho.

use crate::math::{LANES, Lanes, Tensor, Vector, determinant, in_lanes, inverse, multiply, trace};
use crate::state::State;

use super::Solver;
use super::fluid_row::Row;
use super::meeting::{KINDS, Neighbours};
use super::mirror::add_image_gradient;
use super::pair::Block;
use super::record::Record;
use super::reflect::add_reflected_gradient;

/// What the sweep leaves per particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kinematics {
    /// div v [1/s].
    pub(super) divergence: f64,
    /// What div v of a step's end misses of its way, over half of the step, in fluids [1/s^2].
    pub(super) curvature: f64,
    /// gamma from the plain gradient [1/s]: the one whose adjoint is the stress force.
    pub(super) shear: f64,
    /// R = gamma from the corrected gradient over gamma, 0.8 to 3 [1].
    pub(super) correction: f64,
    /// s: bias of the pair form for a shear like this one, 0.5 to 2 [1].
    pub(super) pair_scale: f64,
    /// Largest speed relative to a neighbour or wall [m/s].
    pub(super) relative_speed: f64,
    /// Share of room that its volume leaves empty [1].
    pub(super) looseness: f64,
}

impl<const D: usize> Solver<D> {
    /// Sweeps all pairs; afterwards `self.kinematics` and the blocks' pairs belong to the state's positions and velocities.
    pub(super) fn sweep_kinematics(&mut self, state: &State<D>) {
        let n = state.grains.len();
        self.volume.resize(n, 0.0);
        self.update_volumes(&state.grains.mass, &state.grains.swept_density);
        self.hold_volumes(state);
        self.update_rings(state);
        let mut records = std::mem::take(&mut self.records);
        records.resize(n, Record::default());
        self.note_mirrors(state);
        self.note_faces(state);
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
                macro_rules! sweep {
                    ($rings:literal, $fluids:literal, $meet:literal) => {
                        in_lanes!(self.arch, |lanes| self
                            .block_kinematics::<_, $rings, $fluids, $meet>(
                                lanes, state, &records, block, first, out
                            ))
                    };
                }
                match (rings, self.has_fluids, self.has_meetings) {
                    (true, _, true) => sweep!(true, true, true),
                    (true, true, false) => sweep!(true, true, false),
                    (true, false, false) => sweep!(true, false, false),
                    (false, _, true) => sweep!(false, true, true),
                    (false, true, false) => sweep!(false, true, false),
                    (false, false, false) => sweep!(false, false, false),
                }
            });
        self.records = records;
        self.lists.blocks = blocks;
        self.kinematics = kinematics;
        self.note_lean(state);
        self.note_textures(state);
        self.note_turning(state);
        self.note_transmitted(state);
    }

    #[inline(always)]
    fn block_kinematics<L: Lanes, const RINGS: bool, const FLUIDS: bool, const MEET: bool>(
        &self,
        lanes: L,
        state: &State<D>,
        records: &[Record],
        block: &mut Block<D>,
        first: usize,
        out: &mut [Kinematics],
    ) {
        block.forget_pairs(if MEET { KINDS - 1 } else { 0 });
        let mut near = std::mem::take(&mut block.near);
        let mut found = std::mem::take(&mut block.found);
        for (row, o) in out.iter_mut().enumerate() {
            let i = first + row;
            let (x, v) = (&state.grains.position[i], &state.grains.velocity[i]);
            let mut count = self.find_near(lanes, records, i, x, block.row(row), &mut near);
            let mut kinds = [count / LANES; KINDS - 1];
            if MEET {
                (count, kinds) = self.sort_by_kind(state, i, &mut near, count, &mut found);
                block.tell_kinds(kinds);
            }
            let near = Neighbours {
                all: &near[..count],
                kinds,
            };
            let own = (i, x, v);
            let mut sums =
                self.fluid_row::<L, RINGS, FLUIDS, MEET>(lanes, records, own, block, near);
            let sees_walls = self.add_walls::<FLUIDS>(state, (i, row), block, near, &mut sums);
            let phase = state.grains.phase[i];
            if !self.turns.is_empty() {
                let alone = !near.have_harder() && !sees_walls;
                block.turning.push(self.turn(&mut sums, phase, alone));
            }
            if self.has_pores {
                block.transmitted.push(self.transmitted(&sums.moment));
            }
            *o = self.finish(&sums, phase, i, v);
            if FLUIDS && !self.slides.is_empty() {
                block.textures.push(self.texture(&sums, phase));
            }
        }
        block.near = near;
        block.found = found;
    }

    /// Adds what walls give row i to its sums, with images across flat ones, and to the block; whether it sees any.
    #[inline(always)]
    fn add_walls<const FLUIDS: bool>(
        &self,
        state: &State<D>,
        (i, row): (usize, usize),
        block: &mut Block<D>,
        near: Neighbours<'_>,
        sums: &mut Row<D>,
    ) -> bool {
        if block.wall_row(row).is_empty() {
            return false;
        }
        let mut contacts = std::mem::take(&mut block.contacts);
        let own = (i, row, near.have_softer());
        let seen = self.wall_row(state, own, block.wall_row(row), sums, &mut contacts);
        block.contacts = contacts;
        let Some(mut w) = seen else {
            return false;
        };
        let v = &state.grains.velocity;
        if FLUIDS {
            let first = block.images.len() as u32;
            w.lean_less = self.find_images(state, i, block, near.all, &w.lean);
            w.images = (first, block.images.len() as u32);
            add_image_gradient(block.images_of(&w), i, v, &mut sums.images);
        }
        if !self.faces.is_empty() {
            let first = block.reflections.len() as u32;
            self.find_reflections(state, i, block, near.all, sums);
            w.reflections = (first, block.reflections.len() as u32);
            let into = if FLUIDS {
                &mut sums.images
            } else {
                &mut sums.gradient
            };
            add_reflected_gradient(block.reflections_of(&w), i, v, into);
        }
        block.wall_rows.push(w);
        true
    }

    /// From the sums of row i, at velocity v, to what the rheology needs.
    #[inline(always)]
    pub(super) fn finish(&self, sums: &Row<D>, phase: u8, i: usize, v: &Vector<D>) -> Kinematics {
        let hoop = self.hoop_rate(i, v);
        let mut gradient = sums.gradient;
        let mut kinematics = Kinematics {
            divergence: trace(&gradient),
            curvature: sums.curvature,
            shear: 0.0,
            correction: 1.0,
            pair_scale: 1.0,
            relative_speed: sums.speed2.sqrt(),
            looseness: self.packing.looseness(sums),
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
        }
        let plain = self.geometry.strain_deviator(&gradient, hoop);
        kinematics.shear = self.geometry.shear_rate(&plain);
        let moment = minus(&sums.moment, &sums.softer);
        if kinematics.shear > 0.0 && determinant(&moment) > 0.15 {
            // M does without what `axis` stands for.
            let corrected = multiply(&plain_gradient, &inverse(&moment));
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
}

fn minus<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| a[r][c] - b[r][c]))
}
