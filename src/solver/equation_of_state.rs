//! Pressure from density and the relaxed shear rate: [A] eqs. 41, 43, 44; of fluids and saturated grains [B] eq. 3
//! (docs/theory.md, E5). No neighbours here.

use crate::material::{Grains, Material, grain_compression, grain_compressions};
use crate::math::{LANES, Lanes, Quad, in_lanes};
use crate::state::{Grains as Particles, State};

use super::Solver;

/// Constants of one material's equation of state.
#[derive(Clone, Copy, Debug)]
pub(super) struct PressureLaw {
    /// Density at rest without load [kg/m^3].
    rest: f64,
    /// rho_0 c^2 = 1/K_t, K_t the grains' compressibility [Pa].
    stiffness: f64,
    /// B/gamma^2 of the closing relation [s^2].
    dilatancy: f64,
    /// Density of the loosest grains that touch, over that at rest [1].
    loosest: f64,
    /// Whether density stands for packing: dry grains.
    packs: bool,
}

impl PressureLaw {
    /// Of a material with an artificial sound speed [m/s].
    #[inline]
    pub(super) fn new(m: &Material, sound_speed: f64) -> Self {
        let rest = m.rest_density();
        let stiffness = rest * sound_speed * sound_speed;
        Self {
            rest,
            stiffness,
            dilatancy: m.grains.dilatancy_factor(1.0 / stiffness),
            loosest: m.grains.loosest_density() / rest,
            packs: !m.keeps_volume(),
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Artificial sound speed of a material [m/s].
    #[inline]
    pub(super) fn sound_speed_of(&self, m: &Material) -> f64 {
        m.sound_speed.unwrap_or(self.numerics.sound_speed)
    }

    /// Whether grains are compressed from all sides, in space and in rings; rods of a planar scene are across alone.
    #[inline]
    fn compressed_all_round(&self) -> bool {
        D == 3 || self.geometry.is_axisymmetric()
    }

    /// Pressures of all particles.
    pub(super) fn load_all(&mut self, state: &State<D>) {
        let sound_speed = |m: &Material| self.sound_speed_of(m);
        let laws = self.materials.iter();
        let laws: Vec<PressureLaw> = laws.map(|m| PressureLaw::new(m, sound_speed(m))).collect();
        let mut pressure = std::mem::take(&mut self.pressure);
        pressure.resize(state.grains.len(), 0.0);
        self.workers.in_chunks(&mut pressure, |first, out| {
            in_lanes!(
                self.arch,
                |lanes| for (k, out) in out.chunks_mut(LANES).enumerate() {
                    self.load_group(lanes, &laws, &state.grains, first + LANES * k, out);
                }
            );
        });
        self.pressure = pressure;
    }

    /// Pressures of at most four particles from `first` on: side by side where all are dry grains in the plane.
    #[inline(always)]
    fn load_group<L: Lanes>(
        &self,
        lanes: L,
        laws: &[PressureLaw],
        grains: &Particles<D>,
        first: usize,
        out: &mut [f64],
    ) {
        let of = |k: usize| (grains.density[first + k], grains.relaxed_shear[first + k]);
        let phase = |k: usize| grains.phase[first + k] as usize;
        let alone = (0..out.len()).any(|k| !laws[phase(k)].packs);
        if alone || self.compressed_all_round() {
            for (k, p) in out.iter_mut().enumerate() {
                let (rho, relaxed) = of(k);
                *p = self.load(&self.materials[phase(k)], rho, relaxed);
            }
            return;
        }
        let mut r = Quad([1.0; LANES]);
        let (mut b, mut q) = (Quad([0.0; LANES]), Quad([0.5; LANES]));
        for k in 0..out.len() {
            let (law, (rho, relaxed)) = (&laws[phase(k)], of(k));
            r.0[k] = rho / law.rest;
            b.0[k] = law.dilatancy * relaxed * relaxed;
            q.0[k] = law.loosest;
        }
        let x = grain_compressions(lanes, &r, &b, &q).0;
        for (k, p) in out.iter_mut().enumerate() {
            *p = (x[k] - 1.0) * laws[phase(k)].stiffness;
        }
    }

    /// Pressure [Pa], with the tension that [`Material::least_pressure`] allows.
    #[inline]
    pub(super) fn load(&self, m: &Material, rho: f64, relaxed: f64) -> f64 {
        let c = self.sound_speed_of(m);
        let law = PressureLaw::new(m, c);
        if rho < law.rest && m.is_fluid() {
            let least = if m.is_dense(rho) {
                m.least_pressure(relaxed)
            } else {
                0.0
            };
            return least.max(c * c * (rho - law.rest));
        }
        let b = law.dilatancy * relaxed * relaxed;
        let x = if self.compressed_all_round() {
            grain_compression::<3>(rho / law.rest, b, law.loosest)
        } else {
            grain_compression::<2>(rho / law.rest, b, law.loosest)
        };
        (x - 1.0) * law.stiffness
    }

    /// What compression of the grains changes in the inertial number at a pressure p > 0 [1].
    #[inline]
    pub(super) fn compressed_time_factor(&self, m: &Material, p: f64) -> f64 {
        if !self.compressed_all_round() {
            return 1.0;
        }
        let law = PressureLaw::new(m, self.sound_speed_of(m));
        Grains::compressed_time_factor::<3>(1.0 + p / law.stiffness)
    }
}
