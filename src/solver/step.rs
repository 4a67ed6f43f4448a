//! One internal step: [`Solver::step`] chooses its length and the scheme; the default scheme's is the algorithm of
//! docs/theory.md, "Algorithm".

use crate::state::State;

use super::ring_sections::Moved;
use super::{OnMove, Scheme, Solver, SolverError, StepBound, StepInputs, SubStep};

impl<const D: usize> Solver<D> {
    /// One internal step of at most the stable length, that brings `state` towards `end` in equal steps.
    ///
    /// `on_move` looks before periodic sides and sinks act.
    ///
    /// # Errors
    /// [`SolverError`]; the state is then half-stepped and must be discarded.
    pub fn step(
        &mut self,
        state: &mut State<D>,
        end: f64,
        inputs: &StepInputs<'_>,
        on_move: &mut OnMove<'_, D>,
    ) -> Result<SubStep, SolverError> {
        if self.stays_asleep(state, inputs) {
            return Ok(self.sleep_until(state, end));
        }
        let step = self.choose_step(state, inputs, end)?;
        match self.numerics.scheme {
            Scheme::Implicit => self.step_implicit(state, inputs, step, on_move),
            Scheme::PaperA(choices) => self.step_paper_a(&choices, state, step, on_move),
            Scheme::PaperB(choices) => self.step_paper_b(&choices, state, step, on_move),
        }
    }

    /// One step of length `dt` by the default scheme, one line a stage (docs/theory.md, "Algorithm").
    fn step_implicit(
        &mut self,
        state: &mut State<D>,
        inputs: &StepInputs<'_>,
        (dt, bound): (f64, StepBound),
        on_move: &mut OnMove<'_, D>,
    ) -> Result<SubStep, SolverError> {
        // Forces tell when a scene may sleep, whoever reads them.
        let was_quiet = self.stays_awake.is_none() && self.is_quiet(&state.grains);
        self.find_shift(state, dt);
        let acoustic_dt = self.step_sound(state, dt);
        let iterations = self.solve_viscous(state, dt)?;
        let impulse = state.impulse.clone();
        self.add_reactions(state, dt, was_quiet);
        self.even_friction(state, dt, was_quiet);
        self.note_lone(state);
        self.move_grains(state, dt, acoustic_dt)?;
        on_move(&self.before, &state.grains);
        self.move_walls(state, inputs.drives, dt);
        self.move_gates(state, inputs.openings, dt);
        self.push_streams(state, inputs.rates, dt);
        self.drain(state);
        self.keep_inside(state)?;
        let seeps = state.steps.is_multiple_of(self.numerics.seepage_interval);
        let rose = seeps && self.let_rise(state);
        self.sweep_kinematics_in_valid_lists(state, rose);
        self.centre_lone(state);
        if let Err(error) = self.advance_density(state, dt, acoustic_dt) {
            // New lists may have other rows, in another order: who asks what broke reads pressures by them.
            self.respond(state);
            return Err(error);
        }
        let came = self.feed(state, inputs.rates, dt);
        if came {
            self.sweep_kinematics_in_valid_lists(state, true);
        }
        if !self.moved.before.is_empty() {
            on_move(&self.moved.before, &self.moved.after);
            self.moved = Moved::default();
        }
        if came || seeps {
            self.seep(state);
        }
        self.follow_pores(state, dt);
        self.respond(state);
        state.time += dt;
        state.steps += 1;
        state.iterations += u64::from(iterations);
        state.step_size = dt;
        if self.stays_awake.is_none() {
            self.notice_rest(state, inputs, was_quiet, &impulse, dt);
            if state.rest.asleep {
                // Velocities are 0 from here on, and what follows from them is what a restored state gives.
                self.derive(state);
            }
        }
        Ok(SubStep {
            dt,
            bound,
            iterations,
        })
    }
}
