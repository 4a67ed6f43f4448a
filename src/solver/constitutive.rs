//! Per particle: density, relaxed strain rate, pressure from the equation of state, viscosity from the rheology
//! (docs/theory.md, E5 and E6). No neighbours here.

use crate::material::{Grains, Material, Rheology, bulk_pressure, grain_compression};
use crate::state::State;

use super::{Solver, SolverError};

/// Shear rates below this count as none [1/s]: far below any that matters, far above rounding.
const STILL: f64 = 1e-12;

/// Pressure, viscosity and inertial number of one particle.
#[derive(Default)]
struct Response {
    pressure: f64,
    viscosity: f64,
    inertial_number: f64,
}

impl<const D: usize> Solver<D> {
    /// rho and the relaxed strain rate over a step, from the kinematics at its end.
    pub(super) fn advance_density(&self, state: &mut State<D>, dt: f64) -> Result<(), SolverError> {
        let relax = 1.0 - (-dt / self.numerics.strain_relaxation_time).exp();
        let grains = &mut state.grains;
        for i in 0..grains.len() {
            let k = &self.kinematics[i];
            // Exact for a constant divergence, and positive whatever the step.
            let rho = grains.density[i] * (-dt * k.divergence).exp();
            if !(rho.is_finite() && rho > 0.0) {
                return Err(SolverError::NotFinite {
                    particle: grains.id[i],
                    time: state.time,
                    quantity: "density",
                    position: crate::solver::three(&grains.position[i]),
                });
            }
            let material = &self.materials[grains.phase[i] as usize];
            grains.density[i] = rho.max(material.parted_density * material.rest_density());
            let rate = k.correction * k.shear;
            grains.relaxed_shear[i] += relax * (rate - grains.relaxed_shear[i]);
        }
        Ok(())
    }

    /// V = m / (rho width): areas in the plane, volumes of rings and in space.
    pub(super) fn update_volumes(&mut self, mass: &[f64], density: &[f64]) {
        for (v, (m, rho)) in self.volume.iter_mut().zip(mass.iter().zip(density)) {
            *v = m / (rho * self.width);
        }
    }

    /// Pressures and viscosities from the state and its kinematics.
    pub(super) fn respond(&mut self, state: &State<D>) {
        let n = state.grains.len();
        self.pressure.resize(n, 0.0);
        self.viscosity.resize(n, 0.0);
        self.pair_viscosity.resize(n, 0.0);
        self.inertial_number.resize(n, 0.0);
        if self.materials.iter().any(|m| m.bulk_friction > 0.0) {
            self.normal_pressure.resize(n, 0.0);
        }
        for i in 0..n {
            let k = self.kinematics[i];
            let response = self.granular(
                &self.materials[state.grains.phase[i] as usize],
                state.grains.density[i],
                state.grains.relaxed_shear[i],
                k.shear,
                k.correction,
            );
            self.pressure[i] = response.pressure;
            if let Some(p) = self.normal_pressure.get_mut(i) {
                let m = &self.materials[state.grains.phase[i] as usize];
                *p = response.pressure
                    + bulk_pressure(
                        m.bulk_friction,
                        response.pressure,
                        k.divergence,
                        k.correction * k.shear,
                        state.grains.density[i] * self.kernel.h * self.numerics.sound_speed,
                    );
            }
            self.viscosity[i] = response.viscosity;
            self.inertial_number[i] = response.inertial_number;
            self.pair_viscosity[i] = response.viscosity * k.pair_scale;
        }
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
        }
    }
}
