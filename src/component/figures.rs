//! What a simulation tells of all its particles: the account of material, figures, sums, copies.

use super::{MassLedger, ParticleView, Statistics, Totals};
use crate::math::dot;
use crate::solver::{Solver, three};
use crate::state::{Grains, State};

/// The account of material.
pub(super) fn ledger<const D: usize>(state: &State<D>) -> MassLedger {
    MassLedger {
        initial: state.initial_mass,
        // An empty sum of floats is -0; no flow is +0.
        inflow: state.inflows.iter().fold(0.0, |sum, i| sum + i.admitted),
        outflow: state.drained.iter().fold(0.0, |sum, mass| sum + mass),
        present: state.grains.present_mass(),
    }
}

/// Figures of the solver, without the number of communication steps.
pub(super) fn statistics<const D: usize>(state: &State<D>, solver: &Solver<D>) -> Statistics {
    let grains = &state.grains;
    let (mut energy, mut fastest) = (0.0, 0.0f64);
    let mut particles = 0;
    for i in (0..grains.len()).filter(|&i| !grains.drained[i]) {
        let v2 = dot(&grains.velocity[i], &grains.velocity[i]);
        particles += 1;
        energy += 0.5 * grains.mass[i] * v2;
        fastest = fastest.max(v2.sqrt());
    }
    let validity = solver.validity(state);
    Statistics {
        communication_steps: 0,
        steps: state.steps,
        iterations: state.iterations,
        particles,
        step_size: state.step_size,
        kinetic_energy: energy,
        max_speed: fastest,
        share_asleep: f64::from(u8::from(state.rest.asleep)),
        share_dilute: validity.share_dilute,
        share_ill_posed: validity.share_ill_posed,
        creep_rate: validity.creep_rate,
        share_fast: validity.share_fast,
        share_squeezed: validity.share_squeezed,
    }
}

/// Momentum, energy and bounds of all particles.
pub(super) fn totals<const D: usize>(grains: &Grains<D>) -> Totals {
    let mut totals = Totals {
        lower: [f64::INFINITY; 3],
        upper: [f64::NEG_INFINITY; 3],
        ..Totals::default()
    };
    for i in (0..grains.len()).filter(|&i| !grains.drained[i]) {
        let (x, v, m) = (
            three(&grains.position[i]),
            three(&grains.velocity[i]),
            grains.mass[i],
        );
        let v2 = dot(&v, &v);
        totals.momentum_scale += m * v2.sqrt();
        totals.kinetic_energy += 0.5 * m * v2;
        for k in 0..3 {
            totals.momentum[k] += m * v[k];
            totals.moment[k] += m * x[k];
            totals.lower[k] = totals.lower[k].min(x[k]);
            totals.upper[k] = totals.upper[k].max(x[k]);
        }
    }
    totals
}

/// Particles as plain arrays, in single precision.
pub(super) fn particles<const D: usize>(state: &State<D>, solver: &Solver<D>) -> ParticleView {
    let grains = &state.grains;
    let mut view = ParticleView::default();
    for i in (0..grains.len()).filter(|&i| !grains.drained[i]) {
        view.position
            .push(three(&grains.position[i]).map(|c| c as f32));
        view.velocity
            .push(three(&grains.velocity[i]).map(|c| c as f32));
        view.pressure.push(solver.pressure()[i] as f32);
        view.inertial_number
            .push(solver.inertial_number()[i] as f32);
        view.phase.push(grains.phase[i]);
        view.asleep.push(u8::from(state.rest.asleep));
    }
    view
}
