//! Fluids whose rows slide over each other: what their uneven places make pressure carry (docs/theory.md, F3).
//!
//! Where rows slide, neighbours lie nearer along the direction of compression, and M of (E2) is not the identity but has a shear part
//! of -1e-4 to -1e-3. The pair form (p_i + p_j) makes a shear stress p dev M of that. In a film p is twenty times the shear stress:
//! rows near a plug were held back by 1 % of it, which is a third of a yield stress fluid's rate there. So pressure acts as
//!
//!   P_i = p_i (I - T_i),   T_i = chi f(s) dev M_i,   f = max(0, 1 - s/0.3),   s = h |sum_j g_ij|, walls once             (F3)
//!
//! f leaves surfaces alone, where M lacks neighbours. Forces cancel pair by pair as before. div v stays what it is: with volumes held
//! it is the rate of a sum over places, sum_j V_j W_ij, and comes back with them; with T : G taken out, the adjoint of (F3), volumes
//! drift. So (F3) does work: where nothing holds a fluid still never more than its viscosity takes,
//!
//!   chi = min(1, eta gamma/|p f dev M|),   |A|^2 = A:A/2,   else 1,                                                        (F3b)
//!
//! so that what turns or creeps slowly under its weight is not held back by p dev M, and what rests is left alone.
//!
//! Not for sand, whose shear stress goes through the same sums, nor for rings, nor where viscosity does next to nothing in one step
//! (water).

use crate::material::Material;
use crate::math::{Geometry, Tensor, dot, norm, scale, trace};
use crate::state::State;

use super::fluid_row::Row;
use super::{Numerics, Scheme, Solver, explicit};

/// s from which on neighbours lack on one side, and M says nothing of their order [1].
const OPEN: f64 = 0.3;

/// For each material whether (F3) is for it; empty where it is for none. `rate`: what e of a step is made of (`explicit`),
/// sum_j 2 (D + 2) V_j |F|/D of a lattice [1/m^2].
pub(super) fn who_slides(
    numerics: &Numerics,
    geometry: Geometry,
    materials: &[Material],
    rate: f64,
) -> Vec<bool> {
    let step = numerics.acoustic_step();
    // Of the scene's own, so that scenes of all sizes are alike.
    let shear = match numerics.diffusion_gate_time {
        0.0 => 1.0,
        time => 1.0 / time,
    };
    let viscosity = |m: &Material| m.viscous.stress(shear) / shear;
    let is_thin =
        |m: &Material| m.flows() && step * rate * viscosity(m) < explicit::MOST * m.rest_density();
    let slides: Vec<bool> = materials
        .iter()
        .map(|m| m.is_fluid() && !is_thin(m))
        .collect();
    let any = numerics.scheme == Scheme::Implicit
        && !geometry.is_axisymmetric()
        && slides.contains(&true);
    if any { slides } else { Vec::new() }
}

impl<const D: usize> Solver<D> {
    /// f dev M of a particle from the sums of its row.
    pub(super) fn texture(&self, sums: &Row<D>, phase: u8) -> Tensor<D> {
        let side = self.kernel.h * norm(&sums.side);
        if !self.slides[phase as usize] || side >= OPEN {
            return [[0.0; D]; D];
        }
        let share = 1.0 - side / OPEN;
        let mean = trace(&sums.moment) / D as f64;
        let mut t = sums.moment.map(|row| row.map(|m| share * m));
        for (a, row) in t.iter_mut().enumerate() {
            row[a] -= share * mean;
        }
        t
    }

    /// Gathers f dev M of every particle after a sweep; nothing in scenes that do without.
    pub(super) fn note_textures(&mut self, state: &State<D>) {
        if self.slides.is_empty() {
            return;
        }
        self.texture.resize(state.grains.len(), [[0.0; D]; D]);
        let mut texture = std::mem::take(&mut self.texture);
        self.workers
            .blocks_read(&self.lists.blocks, &mut texture, |block, _, out| {
                out.copy_from_slice(&block.textures);
            });
        self.texture = texture;
    }

    /// p T of every particle [Pa]: what (F3) takes from its pressure.
    pub(super) fn find_uneven_pressure(&mut self, state: &State<D>) {
        if self.slides.is_empty() {
            return;
        }
        let mut uneven = std::mem::take(&mut self.uneven_pressure);
        uneven.resize(self.texture.len(), [[0.0; D]; D]);
        let pressure = self.normal_pressure();
        self.workers.each(&mut uneven, |i, u| {
            *u = self.texture[i].map(|row| row.map(|t| pressure[i] * t));
            if self.material_of(state, i).flows() {
                let stress = self.viscosity[i] * self.kinematics[i].shear;
                *u = at_most(stress, u);
            }
        });
        self.uneven_pressure = uneven;
    }
}

/// A stress, less of it where it is a larger shear stress than `most` (F3b) [Pa].
fn at_most<const D: usize>(most: f64, stress: &Tensor<D>) -> Tensor<D> {
    let size = (0.5 * stress.iter().map(|row| dot(row, row)).sum::<f64>()).sqrt();
    if size <= most {
        return *stress;
    }
    stress.map(|row| scale(most / size, &row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Viscous;

    /// Work of p T per volume is p T : G, of viscosity tau gamma.
    #[test]
    fn uneven_rows_do_no_more_than_viscosity_takes() {
        let uneven = [[0.3, -0.4], [-0.4, -0.3]];
        assert_eq!(at_most(0.6, &uneven), uneven);
        let bounded = at_most(0.1, &uneven);
        assert!((bounded[0][1] / bounded[0][0] - uneven[0][1] / uneven[0][0]).abs() < 1e-12);
        // The worst gradient of a shear rate of 1 lies along it.
        let e = scale_to_unit_shear(&uneven);
        let work: f64 = (0..2).map(|a| dot(&bounded[a], &e[a])).sum();
        assert!((work - 0.1).abs() < 1e-12, "{work}");
        assert_eq!(at_most(0.0, &uneven), [[0.0; 2]; 2]);
        assert_eq!(at_most(0.0, &[[0.0; 2]; 2]), [[0.0; 2]; 2]);
    }

    fn scale_to_unit_shear(t: &Tensor<2>) -> Tensor<2> {
        let size = t.as_flattened().iter().map(|c| c * c).sum::<f64>().sqrt();
        t.map(|row| scale(0.5_f64.sqrt() / size, &row))
    }

    /// Of a film on a slope that is larger by `size` under the same g: times grow by its root, stresses by itself.
    fn slides(size: f64, flow_index: f64, consistency: f64) -> bool {
        let time = size.sqrt();
        let numerics = Numerics {
            spacing: 0.01 * size,
            sound_speed: 10.0 * time,
            diffusion_gate_time: 0.3 * time,
            ..crate::solver::sample::numerics()
        };
        let viscous = Viscous {
            consistency: consistency * size * time.powf(flow_index),
            flow_index,
        };
        let fluid = Material::fluid(1000.0, viscous, 0.0);
        let rate = 2e5 / (size * size);
        who_slides(&numerics, Geometry::Planar { width: 1.0 }, &[fluid], rate) == [true]
    }

    #[test]
    fn whose_rows_slide_is_the_same_at_every_size() {
        let mut found = [0; 2];
        for flow_index in [0.5, 1.0, 1.5] {
            for consistency in [0.01, 0.03, 0.1, 0.2, 0.5, 1.0] {
                let here = slides(1.0, flow_index, consistency);
                found[usize::from(here)] += 1;
                for size in [1e-3, 1e3] {
                    assert_eq!(slides(size, flow_index, consistency), here);
                }
            }
        }
        assert!(found[0] > 2 && found[1] > 2, "{found:?}");
    }
}
