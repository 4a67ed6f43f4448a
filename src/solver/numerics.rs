//! Every numerical choice a scene may make, with the defaults of docs/theory.md.

use crate::material::Material;

use super::timestep::MOST_OF_A_PLATE;
use super::{PaperA, PaperB};

/// The whole scheme: how forces are formed and how they are integrated in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// Adjoint stress form, implicit viscosity, pressure diffusion: the default.
    Implicit,
    /// [A]'s own scheme, the reference: explicit pair viscosity, Morris ghosts, Verlet steps.
    PaperA(PaperA),
    /// [B]'s own scheme, the reference for several phases: explicit, boundary integrals, predictor and corrector.
    PaperB(PaperB),
}

/// How the yield stress holds material that does not flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YieldForm {
    /// Augmented Lagrangian with so many iterations a step: a plug does not creep. The default.
    Exact {
        /// Iterations a step, at least 1; default 1, since each step starts from the last one's stress.
        iterations: u32,
    },
    /// Viscosity cap alone: a plug creeps at a rate of up to 1/cap_time.
    Capped,
}

/// Whose rigid rotation makes no stress (docs/theory.md, T1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// That of grains with cohesion and of fluids with a yield stress. The default.
    Cohesive,
    /// That of all materials: friction of sand's surface that flows is up to a fifth too large.
    All,
    /// Nobody's: the plain form, which resists rotation near surfaces.
    Off,
}

/// Numerical choices. All resolved: the scene reader fills in what a file leaves out.
#[derive(Clone, Debug, PartialEq)]
pub struct Numerics {
    /// Particle spacing dp > 0 [m].
    pub spacing: f64,
    /// Smoothing length over spacing h/dp, 1.2 to 2.5 [1]; default 1.6.
    pub smoothing_ratio: f64,
    /// Artificial sound speed c0 [m/s]; default 10 max(sqrt(g H), expected speed).
    pub sound_speed: f64,
    /// Speed of a fall from the height of the material, at most c0/10 [m/s]: what is slow is measured by it.
    pub fall_speed: f64,
    /// The scheme. `PaperA` uses spacing, smoothing ratio, sound speed, Courant number, artificial viscosity, jitter and
    /// seed of this table, and none of the others; `PaperB` spacing, smoothing ratio, sound speed, Courant number, density
    /// diffusion, shifting, jitter and seed.
    pub scheme: Scheme,
    /// Acoustic Courant number, an acoustic step is courant h / c0 [1]; default 0.7, 0.5 of the reference schemes.
    pub courant: f64,
    /// Acoustic steps to one internal step where neighbours are slow, 1 or 2 [1]: pressure and density take so many over the pairs of
    /// one place; default [`Self::most_acoustic_steps`]. With 2, the first yield iteration of a step starts from the plastic rate that
    /// its first guess has.
    pub acoustic_steps: u32,
    /// Exact yield or plain cap.
    pub yield_form: YieldForm,
    /// Viscosity cap: eta <= cap_time (c + mu_s p) [s]. With the plain cap a plug creeps at up to 1/cap_time; default 20 c0/g.
    /// With the exact yield it is the penalty of the augmented Lagrangian in a plug; default 2 c0/g.
    pub cap_time: f64,
    /// Density diffusion delta [1]; default 0.1, 0 switches it off.
    pub density_diffusion: f64,
    /// Time scale T_d that gates diffusion at rest: factor min(1, T_d gamma) [s].
    pub diffusion_gate_time: f64,
    /// Whether dry grains' friction goes on into walls without slip (docs/theory.md, W14); default false.
    pub friction_into_walls: bool,
    /// Relaxation time of the strain rate in the equation of state [s].
    pub strain_relaxation_time: f64,
    /// Share of the viscous stress carried by the pair operator against zero-energy modes [1]; default 0.05, 0.5 where all materials are Newtonian fluids.
    pub pair_viscosity_share: f64,
    /// Whose rigid rotation makes no stress.
    pub rotation: Rotation,
    /// Artificial viscosity alpha of [A] eq. 38 [1]; default 0.
    pub artificial_viscosity: f64,
    /// Factor on the shifting of fluid particles towards even spacing [1]; 0 switches it off.
    pub shifting: f64,
    /// Relative tolerance of the viscous solve [1]; default 3e-4.
    pub solver_tolerance: f64,
    /// Most iterations of the viscous solve before it is an error.
    pub solver_max_iterations: u32,
    /// Whether a scene at rest sleeps until an input asks for something; default true.
    pub sleep: bool,
    /// Steps from one solve of the seepage to the next, at least 1; default 4.
    pub seepage_interval: u64,
    /// Whether rings are halved and joined so that their sections stay near dp^2; default true.
    pub resize_rings: bool,
    /// Random displacement of the starting lattice over dp [1], which is staggered unless this is 0; default 0.1.
    pub jitter: f64,
    /// Seed of that displacement.
    pub seed: u64,
}

impl Numerics {
    /// Longest acoustic step, courant h/c0 [s].
    #[must_use]
    pub fn acoustic_step(&self) -> f64 {
        self.courant * (self.spacing * self.smoothing_ratio) / self.sound_speed
    }

    /// Speed that every plate may reach, 0.1 h to an acoustic step, c0/7 with courant 0.7 [m/s]; faster, material before it would
    /// be neither nearly incompressible nor sure to stay on its side.
    #[must_use]
    pub fn plate_speed(&self) -> f64 {
        MOST_OF_A_PLATE * self.sound_speed / self.courant
    }

    /// Longest internal step that sound allows [s].
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        f64::from(self.acoustic_steps) * self.acoustic_step()
    }

    /// Most acoustic steps to one viscous solve in a scene of these materials: these steps leave out the sums of rings, fluids, pores, bulk
    /// friction and artificial viscosity, and the diffusion of density, one of all of them together, bears as much again.
    #[must_use]
    pub fn most_acoustic_steps<'a>(
        scheme: Scheme,
        is_axisymmetric: bool,
        (artificial_viscosity, density_diffusion): (f64, f64),
        mut materials: impl Iterator<Item = &'a Material>,
    ) -> u32 {
        let is_dry = |m: &Material| {
            let sticks = m.bulk_friction == 0.0 && m.viscous.consistency == 0.0;
            !m.is_fluid() && !m.is_saturated() && sticks
        };
        let may = scheme == Scheme::Implicit
            && !is_axisymmetric
            && artificial_viscosity == 0.0
            && materials.all(is_dry);
        if !may {
            return 1;
        }
        (1.0 / density_diffusion).clamp(1.0, 2.0) as u32
    }

    /// Whether particles keep the stress of the exact yield.
    #[must_use]
    pub fn keeps_stress(&self) -> bool {
        self.scheme == Scheme::Implicit && self.yield_form != YieldForm::Capped
    }
}
