//! Per particle: pressure from density, viscosity from strain rate, what yields; and the bound of the step.
//!
//! Symbols: e deviatoric strain rate with e_zz = -div u/3 kept in the plane ([B] eq. 5), gamma = sqrt(2 e:e), K consistency,
//! n flow index, m stiffening time, tau_0 = cohesion + alpha p_eff ([B] eq. 7 with its sign mended).

use crate::math::{Tensor, Vector, add, norm, scale, sub, trace};
use crate::solver::{Solver, SolverError, StepBound};
use crate::state::State;

use super::PaperB;
use super::sums::Sums;

/// Share of the shear rate 1/m below which a power law with n < 1 keeps its viscosity: K gamma^(n-1) has no bound at rest [1].
const LEAST_RATE: f64 = 0.01;

/// Below this x, T(x) = (1 - exp(-x))/x is summed as its series.
const SMALL: f64 = 1e-3;

/// What the momentum equation and the step's bound need of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Response<const D: usize> {
    /// p = max(0, c_k^2 (rho - rho_0k)) ([B] eq. 3) [Pa].
    pub(super) pressure: f64,
    /// eta = K gamma^(n-1) + m tau_0 T(m gamma) ([B] eq. 12 with its factor m) [Pa s].
    pub(super) viscosity: f64,
    /// gamma [1/s].
    pub(super) shear: f64,
    /// tau = 2 eta e [Pa].
    pub(super) shear_stress: Tensor<D>,
    /// Whether eta gamma is at most tau_0: it does not yield ([B] eqs. 13 and 14).
    pub(super) held: bool,
}

impl<const D: usize> Default for Response<D> {
    fn default() -> Self {
        Self {
            pressure: 0.0,
            viscosity: 0.0,
            shear: 0.0,
            shear_stress: [[0.0; D]; D],
            held: false,
        }
    }
}

impl<const D: usize> Solver<D> {
    /// c_k^2 (rho - rho_0k), without tension [Pa]: in [B] eq. 3 there is some, which tore thin fronts apart.
    #[inline]
    pub(super) fn pressure_of(&self, state: &State<D>, i: usize) -> f64 {
        let material = &self.materials[state.grains.phase[i] as usize];
        let excess = state.grains.density[i] - material.rest_density();
        (self.sound_speed_of(material).powi(2) * excess).max(0.0)
    }

    pub(super) fn respond_paper_b(
        &self,
        choices: &PaperB,
        state: &State<D>,
        (sums, effective): (&[Sums<D>], &[f64]),
        out: &mut Vec<Response<D>>,
    ) {
        out.resize(state.grains.len(), Response::default());
        let m = choices.stiffening_time;
        self.workers.each(out, |i, response| {
            let material = &self.materials[state.grains.phase[i] as usize];
            let (strain, shear) = strain_rate(&sums[i].gradient);
            let yield_stress = material.strength(effective[i]);
            let viscosity = material.viscous.viscosity(shear, LEAST_RATE / m)
                + m * yield_stress * decay(m * shear);
            *response = Response {
                pressure: self.pressure_of(state, i),
                viscosity,
                shear,
                shear_stress: strain.map(|row| row.map(|c| 2.0 * viscosity * c)),
                held: yield_stress > 0.0 && viscosity * shear <= yield_stress,
            };
        });
    }

    /// What |u| of (21) is against: the walls, which are fixed; where there are none the mean velocity, as in every inertial frame.
    fn frame_of_paper_b(&self, state: &State<D>) -> Vector<D> {
        let mut momentum = [0.0; D];
        if !self.walls.is_empty() {
            return momentum;
        }
        let grains = &state.grains;
        let mut mass = 0.0;
        for (m, v) in grains.mass.iter().zip(&grains.velocity) {
            momentum = add(&momentum, &scale(*m, v));
            mass += m;
        }
        scale(1.0 / mass, &momentum)
    }

    /// [B] eq. 21: dt <= min(CFL h/(c + h max_j pi_ij), CFL h/|u|, CFL sqrt(h/|a|), 0.125 rho h^2/eta).
    pub(in crate::solver) fn bound_paper_b(
        &self,
        state: &State<D>,
    ) -> Result<(f64, StepBound), SolverError> {
        let (h, courant) = (self.kernel.h, self.numerics.courant);
        let grains = &state.grains;
        let frame = self.frame_of_paper_b(state);
        let mut best = (self.numerics.longest_step(), StepBound::Acoustic);
        let mut offer = |step: f64, bound: StepBound| {
            // One that is not a number is kept, and refused below.
            if step < best.0 || step.is_nan() {
                best = (step, bound);
            }
        };
        for (i, (response, forces)) in self
            .paper_b
            .response
            .iter()
            .zip(&self.paper_b.forces)
            .enumerate()
        {
            let c = self.sound_speed_of(&self.materials[grains.phase[i] as usize]);
            offer(
                courant * h / (c + h * forces.approach_rate),
                StepBound::Acoustic,
            );
            let u = norm(&sub(&grains.velocity[i], &frame));
            let a = norm(&forces.acceleration);
            if u > 0.0 {
                offer(courant * h / u, StepBound::Motion);
            }
            if a > 0.0 {
                offer(courant * (h / a).sqrt(), StepBound::Motion);
            }
            if response.viscosity > 0.0 {
                let step = 0.125 * grains.density[i] * h * h / response.viscosity;
                offer(step, StepBound::Viscous);
            }
        }
        let smallest = 1e-6 * self.numerics.longest_step();
        // Written so that a bound that is not a number is refused too.
        if best.0 >= smallest {
            return Ok(best);
        }
        Err(SolverError::StepCollapsed {
            time: state.time,
            step: best.0,
            bound: best.1.name(),
            smallest,
        })
    }
}

/// e = sym grad u - (div u/3) I and gamma, with what e has across the plane.
fn strain_rate<const D: usize>(gradient: &Tensor<D>) -> (Tensor<D>, f64) {
    let third = trace(gradient) / 3.0;
    let mut e = [[0.0; D]; D];
    // Across the plane.
    let mut sum = if D == 2 { third * third } else { 0.0 };
    for a in 0..D {
        for b in 0..D {
            e[a][b] = 0.5 * (gradient[a][b] + gradient[b][a]);
            if a == b {
                e[a][b] -= third;
            }
            sum += e[a][b] * e[a][b];
        }
    }
    (e, (2.0 * sum).sqrt())
}

/// T(x) = (1 - exp(-x))/x for x >= 0.
fn decay(x: f64) -> f64 {
    if x < SMALL {
        1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0))
    } else {
        -(-x).exp_m1() / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decay_is_smooth_where_its_series_ends() {
        let (below, above) = (decay(SMALL * (1.0 - 1e-12)), decay(SMALL));
        assert!((below - above).abs() < 1e-13, "{below} {above}");
        assert_eq!(decay(0.0), 1.0);
        assert!((decay(2.0) - 0.432_332_358_381_693_7).abs() < 1e-15);
    }

    #[test]
    fn plane_strain_keeps_what_goes_across_the_plane() {
        // Shear alone: gamma is the shear rate; even dilation in the plane: e_zz = -2/3, e_xx = e_yy = 1/3.
        assert!((strain_rate(&[[0.0, 2.0], [0.0, 0.0]]).1 - 2.0).abs() < 1e-15);
        let (_, gamma) = strain_rate(&[[1.0, 0.0], [0.0, 1.0]]);
        assert!(
            (gamma - (2.0_f64 * 6.0 / 9.0).sqrt()).abs() < 1e-15,
            "{gamma}"
        );
        let (_, gamma) = strain_rate(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(gamma < 1e-15);
    }
}
