//! Per particle: pressure from density and shear rate, regularised viscosity, sound speed; and the bound of the step.
//!
//! Symbols: x = rho_s/rho_s0, r = rho/(rho_s0 phi_max), K_t = 1/(phi_max rho_s0 c0^2).

use crate::material::{Grains, Material, grain_compression};
use crate::solver::{Solver, SolverError, StepBound};
use crate::state::State;

use super::PaperA;
use super::sums::Rates;

/// What the momentum equation and the step's bound need of a particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Response {
    /// rho [kg/m^3].
    pub(super) density: f64,
    /// p [Pa].
    pub(super) pressure: f64,
    /// P = p/rho^2 [m^5/(kg s^2)].
    pub(super) pressure_term: f64,
    /// eta [Pa s].
    pub(super) viscosity: f64,
    /// c [m/s].
    pub(super) sound_speed: f64,
    /// I [1].
    pub(super) inertial_number: f64,
}

impl<const D: usize> Solver<D> {
    /// Responses to the state's densities and the shear rates of a sweep.
    pub(super) fn respond_paper_a(
        &self,
        choices: &PaperA,
        state: &State<D>,
        rates: &[Rates],
        out: &mut Vec<Response>,
    ) {
        let grains = &state.grains;
        out.resize(grains.len(), Response::default());
        self.workers.each(out, |i, response| {
            let (rho, shear) = (grains.density[i], rates[i].shear);
            let material = &self.materials[grains.phase[i] as usize];
            let sound_speed = self.sound_speed_of(material);
            *response = granular::<D>(choices, material, sound_speed, rho, shear);
        });
    }

    /// dt <= courant min(h/c, 0.1 rho h^2/eta) ([A] eq. 39).
    pub(in crate::solver) fn bound_paper_a(
        &self,
        time: f64,
    ) -> Result<(f64, StepBound), SolverError> {
        let h = self.kernel.h;
        let (mut acoustic, mut viscous) = (f64::INFINITY, f64::INFINITY);
        for r in &self.paper_a.response {
            acoustic = acoustic.min(h / r.sound_speed);
            // A viscosity that is not a number is kept, and refused below.
            if r.viscosity != 0.0 {
                let bound = 0.1 * r.density * h * h / r.viscosity;
                viscous = if bound < viscous || bound.is_nan() {
                    bound
                } else {
                    viscous
                };
            }
        }
        // A scene without particles steps as if there were some at rest.
        if acoustic.is_infinite() {
            acoustic = h / self.numerics.sound_speed;
        }
        let bound = if acoustic <= viscous {
            (self.numerics.courant * acoustic, StepBound::Acoustic)
        } else {
            (self.numerics.courant * viscous, StepBound::Viscous)
        };
        let smallest = 1e-6 * self.numerics.longest_step();
        // Written so that a bound that is not a number is refused too.
        if bound.0 >= smallest {
            return Ok(bound);
        }
        Err(SolverError::StepCollapsed {
            time,
            step: bound.0,
            bound: bound.1.name(),
            smallest,
        })
    }
}

/// [A] eqs. 6, 41, 43, 44 with the shear rate of the instant, and the regularised viscosity of section 4.2.
fn granular<const D: usize>(
    choices: &PaperA,
    m: &Material,
    c0: f64,
    rho: f64,
    shear: f64,
) -> Response {
    let rest = m.rest_density();
    let compressibility = 1.0 / (rest * c0 * c0);
    let b = m.grains.dilatancy_factor(compressibility) * shear * shear;
    let q = m.grains.phi_min / m.grains.phi_max;
    let x = grain_compression::<D>(rho / rest, b, q);
    let pressure = (x - 1.0) / compressibility;
    if pressure <= 0.0 {
        return Response {
            density: rho,
            // It is pressed again with the stiffness of sand at rest.
            sound_speed: c0,
            ..Response::default()
        };
    }
    let (m0, tau_0) = (choices.scaling_time, choices.reference_yield_stress);
    let time = m.grains.inertial_time(pressure) * Grains::compressed_time_factor::<D>(x);
    Response {
        density: rho,
        pressure,
        pressure_term: pressure / (rho * rho),
        viscosity: m.regularised_viscosity(shear, pressure, m0, tau_0),
        sound_speed: c0 * stiffness::<D>(x, rho / rest, q).sqrt(),
        inertial_number: shear * time,
    }
}

/// (c/c0)^2 = dx/dr at constant shear rate, from (x - 1)(x - r)^2 = B x^n, n = 2 in the plane and 7/3 in space; from
/// x = r/q at the smallest volume fraction, q = phi_min/phi_max.
fn stiffness<const D: usize>(x: f64, r: f64, q: f64) -> f64 {
    if x >= r / q {
        return 1.0 / q;
    }
    let n = if D == 2 { 2.0 } else { 7.0 / 3.0 };
    let (u, v) = (x - 1.0, x - r);
    2.0 * u / (v + 2.0 * u - n * u * v / x)
}

#[cfg(test)]
mod tests {
    use super::super::Sweeps;
    use super::*;

    #[test]
    fn sound_speed_is_the_slope_of_the_pressure() {
        let m = Material::sand_04();
        let choices = PaperA {
            reference_yield_stress: 800.0,
            scaling_time: 1.0,
            ghost_velocity_factor: 1.5,
            sweeps: Sweeps::Plain,
        };
        for (rho, shear) in [(1600.0, 0.0), (1565.0, 5.0), (1550.0, 40.0), (1500.0, 90.0)] {
            let at = |rho: f64| granular::<2>(&choices, &m, 4.0, rho, shear);
            let slope = (at(rho + 1e-3).pressure - at(rho - 1e-3).pressure) / 2e-3;
            let c2 = at(rho).sound_speed.powi(2);
            assert!(
                (slope / c2 - 1.0).abs() < 1e-5,
                "{rho} {shear}: {slope} {c2}"
            );
        }
        let c3 = granular::<3>(&choices, &m, 4.0, 1550.0, 40.0).sound_speed;
        let at = |rho: f64| granular::<3>(&choices, &m, 4.0, rho, 40.0).pressure;
        assert!(((at(1550.001) - at(1549.999)) / 2e-3 / (c3 * c3) - 1.0).abs() < 1e-5);
    }
}
