//! Per particle: density, relaxed strain rate, viscosity from the rheology (docs/theory.md, E5 and
//! E6). No neighbours here.

use crate::material::{Material, bulk_pressure};
use crate::state::State;

use super::{Solver, SolverError};

/// What the rheology makes of one particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Response {
    /// With bulk friction [Pa].
    normal_pressure: f64,
    viscosity: f64,
    inertial_number: f64,
}

impl<const D: usize> Solver<D> {
    /// rho over the last acoustic step of a step, and what else goes over the whole of it, from the kinematics at its end.
    pub(super) fn advance_density(
        &self,
        state: &mut State<D>,
        dt: f64,
        last: f64,
    ) -> Result<(), SolverError> {
        let relax = 1.0 - (-dt / self.numerics.strain_relaxation_time).exp();
        let grains = &mut state.grains;
        let phase = &grains.phase;
        let (density, relaxed) = (&mut grains.density, &mut grains.relaxed_shear);
        self.workers.both(density, relaxed, |i, rho, relaxed| {
            let k = &self.kinematics[i];
            let material = &self.materials[phase[i] as usize];
            let room = self.packing_rate(material, k, (*rho, *relaxed), dt);
            // Places went straight to where div v is taken: what it changed by on the way.
            let bend = if material.is_fluid() {
                0.5 * last * k.curvature
            } else {
                0.0
            };
            let rate = k.divergence + bend + dt / last * room;
            // Exact for a constant rate, and positive whatever the step.
            let new = *rho * (-last * rate).exp();
            let least = material.parted_density * material.rest_density();
            // NaN stays NaN, to be found below.
            *rho = if new < least { least } else { new };
            *relaxed += relax * (k.correction * k.shear - *relaxed);
            []
        });
        let fine = |i: usize| grains.density[i].is_finite() && grains.density[i] > 0.0;
        match self.workers.first_bad(grains.len(), |i| !fine(i)) {
            None => Ok(()),
            Some(bad) => Err(self.not_finite(state, "density", |n| n != bad)),
        }
    }

    /// V = m / (rho width): areas in the plane, volumes of rings and in space.
    pub(super) fn update_volumes(&mut self, mass: &[f64], density: &[f64]) {
        for (v, (m, rho)) in self.volume.iter_mut().zip(mass.iter().zip(density)) {
            *v = m / (rho * self.width);
        }
    }

    /// V = m / (rho_0 width) of what pressure makes denser and not smaller: fluids, saturated beds, and grains that hold by themselves
    /// where they are denser than at rest. Where they lie does not follow it (docs/theory.md, "Phases").
    pub(super) fn hold_volumes(&mut self, state: &State<D>) {
        let held = |m: &Material| m.keeps_volume() || m.holds_by_itself();
        if !self.materials.iter().any(held) {
            return;
        }
        let grains = &state.grains;
        for (i, v) in self.volume.iter_mut().enumerate() {
            let material = &self.materials[grains.phase[i] as usize];
            if held(material) {
                let rho = material.density_of_volume(grains.swept_density[i]);
                *v = grains.mass[i] / (rho * self.width);
            }
        }
    }

    /// Pressures and viscosities from the state and its kinematics.
    pub(super) fn respond(&mut self, state: &State<D>) {
        self.load_all(state);
        if self.has_effective_pressure {
            self.subtract_pore_pressure(state);
        }
        let grains = &state.grains;
        let mut responses = std::mem::take(&mut self.responses);
        responses.resize(grains.len(), Response::default());
        self.workers.each(&mut responses, |i, response| {
            let material = &self.materials[grains.phase[i] as usize];
            *response = self.resist(material, i, grains.density[i]);
        });
        fill(&mut self.viscosity, &responses, |r| r.viscosity);
        fill(&mut self.inertial_number, &responses, |r| r.inertial_number);
        if self.has_bulk_friction {
            fill(&mut self.normal_pressure, &responses, |r| r.normal_pressure);
        }
        self.pair_viscosity.clear();
        let scales = self.kinematics.iter().map(|k| k.pair_scale);
        let scaled = responses.iter().zip(scales).map(|(r, s)| r.viscosity * s);
        self.pair_viscosity.extend(scaled);
        self.responses = responses;
        self.weigh_turning(state);
    }

    /// Viscosity, inertial number and bulk friction at the pressure p between grains: [A] eqs. 6, 7 with the cap.
    #[inline]
    fn resist(&self, m: &Material, i: usize, rho: f64) -> Response {
        let k = &self.kinematics[i];
        let pressure = self.pressure[i];
        let p = self.effective.get(i).map_or(pressure, |p| *p);
        let mut response = Response {
            normal_pressure: pressure,
            ..Response::default()
        };
        // Parted material carries nothing; dense material without pressure still has its cohesion and viscosity.
        let holds = m.cohesion > 0.0 || m.viscous.consistency > 0.0;
        if p <= 0.0 && !(holds && m.is_dense(rho)) {
            return response;
        }
        let correction = k.correction * self.compressed_time_factor(m, pressure);
        if p > 0.0 {
            response.inertial_number = correction * k.shear * m.grains.inertial_time(p);
        }
        // A fluid's stress is that of the corrected rate, and works on it: Phi(R gamma). Friction must match its pressure.
        let r = if m.is_fluid() { k.correction } else { 1.0 };
        let summed = m.as_summed(k.correction);
        let law = summed.as_ref().unwrap_or(m);
        response.viscosity =
            r * r * law.capped_viscosity(r * k.shear, p, correction, self.numerics.cap_time);
        // What is pulled has no friction against changes of its volume.
        if m.bulk_friction > 0.0 && p > 0.0 {
            response.normal_pressure += bulk_pressure(
                m.bulk_friction,
                p,
                k.divergence,
                k.correction * k.shear + self.slow_rate(),
                rho * self.kernel.h * self.numerics.sound_speed,
            );
        }
        response
    }
}

/// One quantity of all responses.
fn fill(out: &mut Vec<f64>, responses: &[Response], of: impl Fn(&Response) -> f64) {
    out.clear();
    out.extend(responses.iter().map(of));
}
