//! The default scheme's sweeps one at a time, over disordered sand without walls: for benchmarks and tests of the sweeps.
//! `agreement` compares them with their plain forms.

mod agreement;

use crate::material::Material;
use crate::math::{Geometry, Vector};
use crate::state::State;

use super::Solver;
use super::record::Record;
use super::sample::disordered;
use agreement::Plain;

/// Step of the pressure sweep [s].
const STEP: f64 = 1e-4;

/// One sweep of the default scheme over all particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Sorts particles and builds neighbour lists; not every step.
    Lists,
    /// Neighbours within the support, kernel, velocity gradient, moment, pair coefficients; once a step.
    Pairs,
    /// Pressure force, diffusion of density, pair viscosities; once a step.
    Pressure,
    /// Viscous stress of a velocity; once an iteration of the viscous solve.
    Stress,
    /// Viscous force of that stress; once an iteration of the viscous solve.
    Force,
}

impl Pass {
    /// All of them, in the order of a step.
    pub const ALL: [Self; 5] = [
        Self::Lists,
        Self::Pairs,
        Self::Pressure,
        Self::Stress,
        Self::Force,
    ];

    /// Name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lists => "lists",
            Self::Pairs => "pairs",
            Self::Pressure => "pressure",
            Self::Stress => "stress",
            Self::Force => "force",
        }
    }

    /// Whether there is a plain scalar form to compare with.
    #[must_use]
    pub fn has_plain(self) -> bool {
        self != Self::Lists
    }
}

/// What the coefficients of pairs are fit for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Lists only.
    Listed,
    /// Geometric coefficients.
    Swept,
    /// Multiplied by viscosity.
    Weighted,
}

/// Disordered sand under load, in the plane (D = 2) or in space (D = 3), and the sweeps over it, on one thread.
///
/// A square (cube) of particles, dp = 1 cm, h/dp = 1.6, displaced by up to `jitter` dp, moving at random, free sides.
#[derive(Debug)]
pub struct Passes<const D: usize> {
    solver: Solver<D>,
    state: State<D>,
    stage: Stage,
    /// Velocity and stress of each particle, as the force sweep reads them.
    stressed: Vec<Record>,
    force: Vec<Vector<D>>,
    plain: Plain<D>,
}

impl<const D: usize> Passes<D> {
    /// `side`^D particles, 1 or more, displaced by up to `jitter` dp, 0 to 0.5; all sweeps have been through once.
    #[must_use]
    pub fn new(side: usize, jitter: f64) -> Self {
        let geometry = if D == 2 {
            Geometry::Planar { width: 1.0 }
        } else {
            Geometry::Space
        };
        let (plan, mut state) = disordered(Material::sand_04(), geometry, side, jitter);
        let mut solver = Solver::new(plan, 1);
        solver.start(&mut state);
        let n = state.grains.len();
        let mut passes = Self {
            solver,
            state,
            stage: Stage::Swept,
            stressed: vec![Record::default(); n],
            force: vec![[0.0; D]; n],
            plain: Plain::default(),
        };
        for pass in [Pass::Pressure, Pass::Stress, Pass::Force] {
            passes.run(pass);
        }
        passes.run_plain(Pass::Pairs);
        passes
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.state.grains.len()
    }

    /// Pairs within the support, each counted from both sides.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.plain.pairs.count()
    }

    /// Positions in the order of the sweeps [m].
    #[must_use]
    pub fn positions(&self) -> &[Vector<D>] {
        &self.state.grains.position
    }

    /// Velocities in the order of the sweeps [m/s].
    #[must_use]
    pub fn velocities(&self) -> &[Vector<D>] {
        &self.state.grains.velocity
    }

    /// Smoothing length h [m]; the support is 2 h.
    #[must_use]
    pub fn smoothing_length(&self) -> f64 {
        self.solver.kernel.h
    }

    /// h over the spacing dp [1].
    #[must_use]
    pub fn smoothing_ratio(&self) -> f64 {
        self.solver.numerics.smoothing_ratio
    }

    /// Brings pair coefficients to what a pass reads; no part of the pass, costs nothing where they are.
    pub fn prepare(&mut self, pass: Pass) {
        let wanted = match pass {
            Pass::Lists | Pass::Pairs => return,
            Pass::Pressure => Stage::Swept,
            Pass::Stress | Pass::Force => Stage::Weighted,
        };
        if self.stage == wanted {
            return;
        }
        self.run(Pass::Pairs);
        if wanted == Stage::Weighted {
            self.run(Pass::Pressure);
        }
    }

    /// Runs a pass as the solver does; `prepare` comes first.
    pub fn run(&mut self, pass: Pass) {
        let Self {
            solver,
            state,
            stressed,
            force,
            ..
        } = self;
        match pass {
            Pass::Lists => {
                solver.renew_lists(state);
                self.stage = Stage::Listed;
            }
            Pass::Pairs => {
                solver.sweep_kinematics(state);
                self.stage = Stage::Swept;
            }
            Pass::Pressure => {
                solver.sweep_pressure(state, STEP);
                self.stage = Stage::Weighted;
            }
            Pass::Stress => solver.stress(&state.grains.velocity, stressed, false, &[]),
            Pass::Force => {
                solver.force(stressed, force, false, &[], |_, f| (*f, 0.0));
            }
        }
    }
}
