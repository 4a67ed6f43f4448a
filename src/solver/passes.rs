//! The default scheme's sweeps one at a time, over disordered sand without walls: for benchmarks and tests of the sweeps.

use crate::boundary::WallPoints;
use crate::material::Material;
use crate::math::{Geometry, Tensor, Vector};
use crate::state::{Grains, PoseTimes, Random, RestState, State};

use super::kinematics::Kinematics;
use super::plain::PlainPairs;
use super::pressure::Prediction;
use super::record::Record;
use super::{Numerics, Periodic, Plan, Scheme, Solver, YieldForm};

/// Spacing dp of the sand [m].
const SPACING: f64 = 0.01;

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

/// Results of the plain sweeps.
#[derive(Debug, Default)]
struct Plain<const D: usize> {
    pairs: PlainPairs<D>,
    kinematics: Vec<Kinematics>,
    prediction: Vec<Prediction<D>>,
    gradient: Vec<Tensor<D>>,
    stress: Vec<Tensor<D>>,
    force: Vec<Vector<D>>,
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
        let (plan, mut state) = sand::<D>(geometry, side, jitter);
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

    /// Runs the plain scalar form of a pass, after those before it; nothing for [`Pass::Lists`].
    pub fn run_plain(&mut self, pass: Pass) {
        let (solver, state, plain) = (&self.solver, &self.state, &mut self.plain);
        let n = state.grains.len();
        let v = &state.grains.velocity;
        match pass {
            Pass::Lists => (),
            Pass::Pairs => {
                let rows = solver.plain_pairs(state, &mut plain.pairs);
                plain.kinematics.resize(n, Kinematics::default());
                for (i, (k, row)) in plain.kinematics.iter_mut().zip(&rows).enumerate() {
                    *k = solver.finish(row, state.grains.phase[i], i, &v[i]);
                }
            }
            Pass::Pressure => {
                plain.prediction.resize(n, Prediction::default());
                solver.plain_pressure(state, &plain.pairs, STEP, &mut plain.prediction);
            }
            Pass::Stress => {
                plain.gradient.resize(n, [[0.0; D]; D]);
                plain.stress.resize(n, [[0.0; D]; D]);
                solver.plain_gradients(&plain.pairs, v, &mut plain.gradient);
                for (i, tau) in plain.stress.iter_mut().enumerate() {
                    *tau = solver.row_stress(i, &v[i], &plain.gradient[i]);
                }
            }
            Pass::Force => {
                plain.force.resize(n, [0.0; D]);
                solver.plain_forces(&plain.pairs, v, &plain.stress, &mut plain.force);
            }
        }
    }

    /// Runs all passes in both forms; the largest difference between the results of one pass over the largest result,
    /// for each pass that has a plain form [1].
    pub fn disagreement(&mut self) -> Vec<(Pass, f64)> {
        let mut found = Vec::new();
        for pass in Pass::ALL {
            self.prepare(pass);
            self.run(pass);
            self.run_plain(pass);
            if pass.has_plain() {
                found.push((pass, self.differ(pass)));
            }
        }
        found
    }

    fn differ(&self, pass: Pass) -> f64 {
        let (solver, plain) = (&self.solver, &self.plain);
        match pass {
            Pass::Lists => 0.0,
            Pass::Pairs => {
                let of = |k: &Kinematics| [k.divergence, k.shear, k.pair_scale, k.relative_speed];
                apart(solver.kinematics.iter().zip(&plain.kinematics), of)
            }
            Pass::Pressure => {
                let velocity = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    p.velocity
                });
                let resistance = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    [p.resistance[0][0], p.resistance[D - 1][0]]
                });
                let diffusion = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    [p.diffusion]
                });
                velocity.max(resistance).max(diffusion)
            }
            Pass::Stress => {
                let fast: Vec<Tensor<D>> = self.stressed.iter().map(Record::stress).collect();
                apart(fast.iter().zip(&plain.stress), |t| t[0])
            }
            Pass::Force => {
                let to_force = |i: usize| solver.width * solver.volume[i];
                let plain: Vec<Vector<D>> = (0..self.force.len())
                    .map(|i| crate::math::scale(to_force(i), &plain.force[i]))
                    .collect();
                apart(self.force.iter().zip(&plain), |f| *f)
            }
        }
    }
}

/// Largest difference of the values of pairs of rows over the largest value.
fn apart<'a, T: 'a, const K: usize>(
    rows: impl Iterator<Item = (&'a T, &'a T)>,
    values: impl Fn(&T) -> [f64; K],
) -> f64 {
    let (mut difference, mut largest) = (0.0f64, f64::MIN_POSITIVE);
    for (a, b) in rows {
        for (a, b) in values(a).into_iter().zip(values(b)) {
            // Not a number must not pass as no difference.
            if !(a - b).is_finite() {
                return f64::INFINITY;
            }
            difference = difference.max((a - b).abs());
            largest = largest.max(b.abs());
        }
    }
    difference / largest
}

/// `side`^D particles of sand under load, displaced by up to `jitter` dp, moving at random.
fn sand<const D: usize>(geometry: Geometry, side: usize, jitter: f64) -> (Plan<D>, State<D>) {
    let material = Material::sand_04();
    let mut random = Random::new(11);
    let mut grains = Grains {
        implicit: true,
        exact_yield: true,
        ..Grains::default()
    };
    let rho = 1.01 * material.rest_density();
    for n in 0..side.pow(D as u32) {
        let mut m = n;
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        for (x, v) in x.iter_mut().zip(&mut v) {
            *x = ((m % side) as f64 + 0.5 + jitter * random.symmetric()) * SPACING;
            *v = random.symmetric();
            m /= side;
        }
        let across = geometry.length_across(&x, 0.0);
        let mass = rho * across * SPACING.powi(D as i32);
        grains.push(n as u64, 0, x, v, mass, rho);
    }
    let plan = Plan {
        numerics: numerics(),
        gravity: std::array::from_fn(|k| if k == 1 { -9.81 } else { 0.0 }),
        geometry,
        lower: [0.0; D],
        upper: [side as f64 * SPACING; D],
        periodic: Periodic {
            lower: [0.0; D],
            length: [0.0; D],
        },
        materials: vec![material],
        walls: WallPoints::default(),
        ghost_depth: Vec::new(),
        movers: Vec::new(),
        plates: Vec::new(),
        sources: Vec::new(),
        sinks: Vec::new(),
    };
    let state = State {
        time: 0.0,
        initial_mass: grains.present_mass(),
        grains,
        pose: PoseTimes::default(),
        gates: Vec::new(),
        inflows: Vec::new(),
        drained: Vec::new(),
        impulse: Vec::new(),
        next_id: 0,
        steps: 0,
        iterations: 0,
        step_size: 0.0,
        trend: 0.0,
        rest: RestState::default(),
        random,
    };
    (plan, state)
}

/// Of a scene with a fall of 0.4 m, in steps of one acoustic step: each sweep once.
fn numerics() -> Numerics {
    Numerics {
        spacing: SPACING,
        smoothing_ratio: 1.6,
        sound_speed: 20.0,
        scheme: Scheme::Implicit,
        courant: 0.5,
        acoustic_steps: 1,
        yield_form: YieldForm::Exact { iterations: 1 },
        cap_time: 4.0,
        density_diffusion: 0.1,
        diffusion_gate_time: 1.0,
        strain_relaxation_time: 0.05,
        pair_viscosity_share: 0.05,
        artificial_viscosity: 0.0,
        shifting: 0.0,
        solver_tolerance: 3e-4,
        solver_max_iterations: 500,
        sleep: false,
        seepage_interval: 1,
        jitter: 0.0,
        seed: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{norm, sub};

    fn agrees<const D: usize>(side: usize) {
        let mut passes = Passes::<D>::new(side, 0.2);
        assert_eq!(passes.particles(), side.pow(D as u32));
        let found = passes.disagreement();
        assert_eq!(found.len(), 4);
        for (pass, difference) in found {
            assert!(difference < 1e-11, "{}: {difference}", pass.name());
        }
        let (x, support) = (passes.positions(), 2.0 * passes.smoothing_length());
        let near = |i: usize, j: usize| i != j && norm(&sub(&x[i], &x[j])) < support;
        let count = |i| (0..x.len()).filter(|&j| near(i, j)).count();
        assert_eq!(passes.pairs(), (0..x.len()).map(count).sum::<usize>());
        // A sweep repeated gives the same, whatever came between.
        let before = passes.force.clone();
        for pass in [Pass::Pairs, Pass::Lists, Pass::Pressure, Pass::Force] {
            passes.prepare(pass);
            passes.run(pass);
        }
        assert_eq!(before, passes.force);
    }

    #[test]
    fn fast_and_plain_passes_agree() {
        agrees::<2>(23);
        agrees::<3>(9);
    }

    #[test]
    fn a_wrong_result_is_seen() {
        let mut passes = Passes::<2>::new(12, 0.2);
        passes.disagreement();
        passes.plain.force[7][0] *= 1.01;
        passes.plain.prediction[7].diffusion = f64::NAN;
        assert!(passes.differ(Pass::Force) > 1e-6);
        assert!(passes.differ(Pass::Pressure).is_infinite());
    }
}
