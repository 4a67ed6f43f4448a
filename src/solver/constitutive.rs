//! Per particle: density, relaxed strain rate, pressure from the equation of state, viscosity from the rheology
//! (docs/theory.md, E5 and E6). No neighbours here.

use crate::material::{Grains, Material, Rheology, bulk_pressure, grain_compression};
use crate::state::State;

use super::{Solver, SolverError};

/// Shear rates below this count as none [1/s]: far below any that matters, far above rounding.
const STILL: f64 = 1e-12;

/// What the rheology makes of one particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Response {
    pressure: f64,
    /// With bulk friction.
    normal_pressure: f64,
    viscosity: f64,
    inertial_number: f64,
}

impl<const D: usize> Solver<D> {
    /// rho and the relaxed strain rate over a step, from the kinematics at its end.
    pub(super) fn advance_density(&self, state: &mut State<D>, dt: f64) -> Result<(), SolverError> {
        let relax = 1.0 - (-dt / self.numerics.strain_relaxation_time).exp();
        let grains = &mut state.grains;
        let phase = &grains.phase;
        let (density, relaxed) = (&mut grains.density, &mut grains.relaxed_shear);
        self.workers.both(density, relaxed, |i, rho, relaxed| {
            let k = &self.kinematics[i];
            // Exact for a constant divergence, and positive whatever the step.
            let new = *rho * (-dt * k.divergence).exp();
            let material = &self.materials[phase[i] as usize];
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

    /// Pressures and viscosities from the state and its kinematics.
    pub(super) fn respond(&mut self, state: &State<D>) {
        let grains = &state.grains;
        let n = grains.len();
        let bulk = self.materials.iter().any(|m| m.bulk_friction > 0.0);
        let mut responses = std::mem::take(&mut self.responses);
        responses.resize(n, Response::default());
        self.workers.each(&mut responses, |i, response| {
            let k = &self.kinematics[i];
            let material = &self.materials[grains.phase[i] as usize];
            let (rho, relaxed) = (grains.density[i], grains.relaxed_shear[i]);
            *response = self.granular(material, rho, relaxed, k.shear, k.correction);
            if bulk {
                response.normal_pressure = response.pressure
                    + bulk_pressure(
                        material.bulk_friction,
                        response.pressure,
                        k.divergence,
                        k.correction * k.shear,
                        rho * self.kernel.h * self.numerics.sound_speed,
                    );
            }
        });
        fill(&mut self.pressure, &responses, |r| r.pressure);
        fill(&mut self.viscosity, &responses, |r| r.viscosity);
        fill(&mut self.inertial_number, &responses, |r| r.inertial_number);
        if bulk {
            fill(&mut self.normal_pressure, &responses, |r| r.normal_pressure);
        }
        self.pair_viscosity.clear();
        let scales = self.kinematics.iter().map(|k| k.pair_scale);
        let scaled = responses.iter().zip(scales).map(|(r, s)| r.viscosity * s);
        self.pair_viscosity.extend(scaled);
        self.responses = responses;
    }

    /// [A] eqs. 6, 7, 41, 43, 44 with the cap.
    fn granular(
        &self,
        m: &Material,
        rho: f64,
        relaxed: f64,
        shear: f64,
        correction: f64,
    ) -> Response {
        let c0 = self.numerics.sound_speed;
        let rest = m.rest_density();
        let compressibility = 1.0 / (rest * c0 * c0);
        let b = m.grains.dilatancy_factor(compressibility) * relaxed * relaxed;
        let loosest = m.grains.phi_min / m.grains.phi_max;
        // Rods of a planar scene are compressed across alone, grains in space and in rings all round.
        let (x, factor) = if D == 3 || self.geometry.is_axisymmetric() {
            let x = grain_compression::<3>(rho / rest, b, loosest);
            (x, Grains::compressed_time_factor::<3>(x))
        } else {
            (grain_compression::<2>(rho / rest, b, loosest), 1.0)
        };
        let pressure = (x - 1.0) / compressibility;
        // Parted material carries nothing; dense material without pressure still has its cohesion.
        if pressure <= 0.0 && (m.cohesion == 0.0 || !m.is_dense(rho)) {
            return Response::default();
        }
        let correction = correction * factor;
        let inertial_number = if pressure > 0.0 {
            correction * shear * m.grains.inertial_time(pressure)
        } else {
            0.0
        };
        let cap = self.numerics.cap_time * m.strength(pressure);
        let viscosity = if shear > STILL {
            (m.shear_stress(shear, pressure, correction) / shear).min(cap)
        } else {
            cap
        };
        Response {
            pressure,
            viscosity,
            inertial_number,
            ..Response::default()
        }
    }
}

/// One quantity of all responses.
fn fill(out: &mut Vec<f64>, responses: &[Response], of: impl Fn(&Response) -> f64) {
    out.clear();
    out.extend(responses.iter().map(of));
}
