//! The implicit viscous solve (docs/theory.md, E9, E12): (M - dt F) v = M v* by conjugate gradients with D x D Jacobi
//! blocks, started from what the last steps let expect (`guess`). With the exact yield it is solved a few times a step, each time with
//! the stress of the last projection beside it (`plastic`).

mod conjugate_gradients;

use crate::math::{Tensor, Vector, dot, scale, sub};
use crate::state::State;

use super::lists::mean;
use super::numerics::YieldForm;
use super::record::Record;
use super::{Solver, SolverError};

/// Share of one step's fall that the tolerance is of where nothing moves faster than that [1]. What rests is shaken by what the
/// solve leaves: with 1 the heap of the study `rest` had ten times the kinetic energy.
const RESTING: f64 = 0.3;

/// Tolerance against what stress and friction do in a step, over that against the speeds [1]. What a solve leaves is of one sign in what
/// slides steadily: against its speed alone, 3e-4 of 4 m/s was as much as its friction in a step.
const PUSHED: f64 = 30.0;

/// What a solve may leave [kg m/s].
struct Limit {
    /// Of what |M (v* - u)| is more than that of a step's fall; u is the walls' mean velocity where walls are touched, else the mean of v*.
    of_speed: f64,
    /// Of |M (v_g - v*)|, v_g the first guess.
    of_push: f64,
    /// Of the residual at the start [1].
    of_residual: f64,
    /// Of a step's fall, and of rounding.
    floor: f64,
}

/// Iterations of the yield in a step in which friction would turn what holds together round (`friction_drives`).
const MOST_TURNING: u32 = 10;

/// Work arrays of the solve. A velocity and the stress that is linear in it, (1 - share) 2 eta e(v), stand side by side.
#[derive(Debug, Default)]
pub(super) struct Viscous<const D: usize> {
    /// The unknown and its linear stress [m/s, Pa].
    pub(super) current: Vec<Record>,
    /// The same with the exact yield's stress added: what the solve starts from.
    whole: Vec<Record>,
    /// Stress that does not change in a solve: lambda - r q of the exact yield; empty without it [Pa].
    pub(super) fixed: Vec<Tensor<D>>,
    /// A search direction and its stress.
    searched: Vec<Record>,
    pub(super) jacobi: Vec<Tensor<D>>,
    pub(super) residual: Vec<Vector<D>>,
    /// Jacobi blocks times the residual.
    descent: Vec<Vector<D>>,
    direction: Vec<Vector<D>>,
    product: Vec<Vector<D>>,
    /// First guess of the velocity; after the solve the new velocity [m/s].
    pub(super) velocity: Vec<Vector<D>>,
    /// Rows that take their viscous force as it is, without the solve (`explicit`); empty if none may.
    pub(super) explicit: Vec<bool>,
    /// Rows whose own viscosity does next to nothing in a step; empty in scenes without Newtonian fluids.
    pub(super) quick: Vec<bool>,
    /// What of the wall friction of each of its rows does not follow the velocity [Pa].
    pub(super) held: Vec<Vector<D>>,
    /// Pieces of the lists that walls push in this step.
    pub(super) touching: Vec<bool>,
}

impl<const D: usize> Viscous<D> {
    fn resize(&mut self, n: usize) {
        for r in [&mut self.current, &mut self.whole, &mut self.searched] {
            r.resize(n, Record::default());
        }
        self.jacobi.resize(n, [[0.0; D]; D]);
        for v in [
            &mut self.residual,
            &mut self.descent,
            &mut self.direction,
            &mut self.product,
            &mut self.velocity,
        ] {
            v.resize(n, [0.0; D]);
        }
    }

    /// Whole stress of particle i at the end of the last linear solve [Pa].
    pub(super) fn stress(&self, i: usize) -> Tensor<D> {
        let mut tau = self.current[i].stress();
        if let Some(fixed) = self.fixed.get(i) {
            add(&mut tau, fixed);
        }
        tau
    }
}

impl<const D: usize> Solver<D> {
    /// Solves for the new velocities (left in `self.viscous.velocity`); returns the iterations used.
    pub(super) fn solve_viscous(
        &mut self,
        state: &mut State<D>,
        dt: f64,
    ) -> Result<u32, SolverError> {
        self.find_friction(state, dt);
        self.find_even_slope(state, dt);
        self.find_wall_share(state);
        let mut work = std::mem::take(&mut self.viscous);
        work.resize(state.grains.len());
        let result = self.solve_with_yield(state, dt, &mut work);
        if result.is_ok() {
            let current = &work.current;
            self.workers
                .each(&mut work.velocity, |i, v| *v = current[i].velocity());
            self.restore_momentum(state, &mut work);
        }
        self.viscous = work;
        result
    }

    /// One linear solve with the plain cap; with the exact yield a few, each followed by the projection.
    fn solve_with_yield(
        &self,
        state: &mut State<D>,
        dt: f64,
        work: &mut Viscous<D>,
    ) -> Result<u32, SolverError> {
        self.guess(state, dt, &mut work.velocity);
        self.stress(&work.velocity, &mut work.current, true, &[]);
        self.jacobi_blocks(state, dt, &mut work.jacobi);
        self.grip_blocks(dt, &mut work.jacobi);
        self.find_explicit(state, dt, work);
        let limit = self.solver_limit(state, dt, &work.velocity);
        self.cut_slip(state);
        match self.numerics.yield_form {
            YieldForm::Capped => {
                self.expect_friction(state, work);
                self.hold_friction(state, &mut work.held);
                let spent = self.conjugate_gradients(state, dt, &limit, work)?;
                self.project_friction(state, work);
                Ok(spent)
            }
            YieldForm::Exact { iterations } => {
                let (mut spent, mut done) = (0, 0);
                self.cut_stress(state);
                while done < iterations || done < MOST_TURNING && self.friction_drives(state, work)
                {
                    if done == 0 && self.acoustic.count() > 1 {
                        self.expect_plastic_stress(state, work);
                    } else {
                        self.fix_plastic_stress(state, work);
                    }
                    if done == 0 {
                        self.expect_friction(state, work);
                    }
                    self.hold_friction(state, &mut work.held);
                    spent += self.conjugate_gradients(state, dt, &limit, work)?;
                    self.project(state, work);
                    self.project_friction(state, work);
                    done += 1;
                }
                Ok(spent)
            }
        }
    }

    /// What a step's solves may leave, from v* and the first guess of the velocity: the same in every inertial frame (docs/theory.md, E12).
    fn solver_limit(&self, state: &State<D>, dt: f64, guess: &[Vector<D>]) -> Limit {
        let mass = &state.grains.mass;
        let touched = self.lists.blocks.iter().any(|b| !b.wall_rows.is_empty());
        let mut frame = if touched {
            mean(&self.walls.velocity, &self.walls.weight)
        } else {
            let momentum = |i: usize| scale(mass[i], &self.prediction[i].velocity);
            let [total] = self.workers.sums(mass.len(), |i| [mass[i]]);
            let sum = self.workers.sums(mass.len(), momentum);
            scale(1.0 / total, &sum)
        };
        if self.geometry.is_axisymmetric() {
            // The axis stands still.
            frame[0] = 0.0;
        }
        let fall = dt * self.gravity_norm;
        let [moved, masses, total, pushed] = self.workers.sums(mass.len(), |i| {
            let d = sub(&self.prediction[i].velocity, &frame);
            let p = sub(&self.prediction[i].velocity, &guess[i]);
            let m2 = mass[i] * mass[i];
            [m2 * dot(&d, &d), m2, mass[i], m2 * dot(&p, &p)]
        });
        let fallen = fall * masses.sqrt();
        // A fall grows with the step by itself. What solves leave adds up, and here are fewer to a second.
        let steps = f64::from(self.acoustic.count());
        let tolerance = self.numerics.solver_tolerance;
        // The floor is the rounding of velocities that are all the same.
        let floor = tolerance * RESTING * fallen + 1e-15 * self.numerics.sound_speed * total;
        Limit {
            of_speed: tolerance * steps * (moved.sqrt() - fallen).max(0.0),
            of_push: tolerance * PUSHED * pushed.sqrt(),
            of_residual: tolerance * PUSHED,
            floor,
        }
    }
}

impl Limit {
    /// Of a solve that starts from a residual of this size [kg m/s].
    fn of(&self, residual: f64) -> f64 {
        let of_push = self.of_push + self.of_residual * residual;
        self.floor + self.of_speed.min(of_push)
    }
}

/// t += u.
#[inline(always)]
fn add<const D: usize>(t: &mut Tensor<D>, u: &Tensor<D>) {
    for a in 0..D {
        for b in 0..D {
            t[a][b] += u[a][b];
        }
    }
}
