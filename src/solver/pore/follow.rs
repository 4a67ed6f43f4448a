//! The pressure of what rests follows that of its pores (docs/theory.md, F7).
//!
//! What the water above changes presses on pores and not on grains. But a bed that does not yield holds its density, and with it
//! its pressure p: from water that left, it kept all of the weight between its grains, up to what makes it yield, 1/(1 - sin phi) of the buoyant weight.
//!
//! With a lag: p that followed at once would answer the sound of the water above with a force behind it by the steps between two
//! seepage solves, which drives it.

use crate::solver::Solver;
use crate::state::State;

/// Time in which p follows, over c0/g [1]: three times sqrt(H/g) where c0 = 10 sqrt(g H), seven periods of the slowest sound.
const LAG: f64 = 0.3;

impl<const D: usize> Solver<D> {
    /// Changes densities by what the relaxed pore pressure has changed by in a step, as far as the material is still.
    pub(in crate::solver) fn follow_pores(&self, state: &mut State<D>, dt: f64) {
        if !self.has_pores || self.gravity_norm == 0.0 {
            return;
        }
        let lag = LAG * self.numerics.sound_speed / self.gravity_norm;
        let share = -(-dt / lag).exp_m1();
        let gate = self.numerics.diffusion_gate_time;
        let grains = &mut state.grains;
        let (phase, pore) = (&grains.phase, &grains.pore_pressure);
        let (relaxed, density) = (&mut grains.relaxed_pore_pressure, &mut grains.density);
        self.workers.both(relaxed, density, |i, relaxed, rho| {
            let material = &self.materials[phase[i] as usize];
            let pore = pore[i].max(0.0);
            if !material.is_saturated() || *relaxed == 0.0 {
                // What has just come, too.
                *relaxed = pore;
                return [];
            }
            let change = share * (pore - *relaxed);
            let still = 1.0 - (gate * self.kinematics[i].shear).min(1.0);
            *relaxed += change;
            *rho += still * change / self.sound_speed_of(material).powi(2);
            []
        });
    }
}
