//! What a component tells beside its variables: step reports, the account of material, figures, particles.

use crate::solver::StepBound;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time reached: t + h, or where a watcher ended the step, bit for bit [s].
    pub time: f64,
    /// Whether a watcher ended the step before t + h.
    pub ended_early: bool,
    /// Internal steps taken, none while the scene sleeps.
    pub substeps: u64,
    /// Smallest internal step; of a scene that sleeps throughout, the time slept [s].
    pub smallest_step: f64,
    /// What bound it.
    pub bound_by: StepBound,
    /// Iterations of the viscous solve, summed over internal steps.
    pub iterations: u64,
}

/// Exact account of material: initial + inflow - outflow = present, in f64, at every time.
///
/// Particle masses are multiples of a power of two, so that every sum is exact whatever its order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassLedger {
    /// Mass at the start [kg].
    pub initial: f64,
    /// Mass that came in since [kg].
    pub inflow: f64,
    /// Mass that left since [kg].
    pub outflow: f64,
    /// Mass present, summed over particles [kg].
    pub present: f64,
}

impl MassLedger {
    /// initial + inflow - outflow - present [kg]: exactly 0.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.initial + self.inflow - self.outflow - self.present
    }
}

/// Figures of the solver that go to logs and summaries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Communication steps done.
    pub communication_steps: u64,
    /// Internal steps done.
    pub steps: u64,
    /// Iterations of viscous solves, in all.
    pub iterations: u64,
    /// Particles present.
    pub particles: u64,
    /// Last internal step [s].
    pub step_size: f64,
    /// Kinetic energy [J].
    pub kinetic_energy: f64,
    /// Largest particle speed [m/s].
    pub max_speed: f64,
    /// Share of the particles that sleep, all of them or none [1]: where nothing moves nothing is computed.
    pub share_asleep: f64,
    /// Share of mass with I > 0.3 [1]: outside the dense regime.
    pub share_dilute: f64,
    /// Share of mass that yields where its friction law is ill-posed [1].
    pub share_ill_posed: f64,
    /// Root mean square, by mass, of the shear rate of material below its static strength [1/s].
    pub creep_rate: f64,
    /// Share of the mass under pressure that moves faster than a fifth of its sound speed [1].
    pub share_fast: f64,
    /// Share of the mass under pressure that gives way by more than a twentieth [1].
    pub share_squeezed: f64,
}

/// Sums over all particles present, for checks of conservation. Of rings: of whole rings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Momentum [kg m/s].
    pub momentum: [f64; 3],
    /// Sum of mass times speed: what a momentum is small against [kg m/s].
    pub momentum_scale: f64,
    /// Sum of mass times position; over the mass, the centre of mass [kg m].
    pub moment: [f64; 3],
    /// Kinetic energy [J].
    pub kinetic_energy: f64,
    /// Least coordinates of any particle [m]; infinite where there is none.
    pub lower: [f64; 3],
    /// Largest coordinates of any particle [m]; minus infinite where there is none.
    pub upper: [f64; 3],
}

/// A copy of the particles in single precision, for logs and pictures (planar scenes: z = 0).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleView {
    /// Position [m].
    pub position: Vec<[f32; 3]>,
    /// Velocity [m/s].
    pub velocity: Vec<[f32; 3]>,
    /// Pressure [Pa].
    pub pressure: Vec<f32>,
    /// Inertial number [1].
    pub inertial_number: Vec<f32>,
    /// Phase: index of the material.
    pub phase: Vec<u8>,
    /// 1 while the scene sleeps, else 0.
    pub asleep: Vec<u8>,
}
