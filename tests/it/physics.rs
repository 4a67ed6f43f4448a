//! What the physics must do, judged through the component on the cases of the repository: exact solutions, published
//! data and conservation laws. No comparison with our own older output here.
//!
//! Tolerances are those of the issue that asked for the case; each test says where its number comes from.

mod acoustic_steps;
mod askew;
mod axisymmetric;
mod bends;
mod bins;
mod boxes;
mod chutes;
mod collapse;
mod conservation;
mod drives;
mod drops;
mod films;
mod gates;
mod gliding;
mod incline;
mod inflows;
mod layers;
mod leaks;
mod lips;
mod meeting;
mod moments;
mod moving_walls;
mod packing;
mod paper_a;
mod paper_b;
mod phases;
mod pores;
mod rest;
mod rheology;
mod ring_sections;
mod roofs;
mod seams;
mod sides;
mod silo;
mod slices;
mod tension;
mod turning;
mod validity;
mod walls;
mod waves;

use sandgate::component::{Component, ValueReference};
use sandgate::scene::{self, Scene};
use sandgate::solver::{Plan, Solver, StepInputs};
use sandgate::state::State;

/// A case of the repository, with edits of its text as (old, new).
fn case(name: &str, edits: &[(&str, &str)]) -> Scene {
    let path = format!("{}/cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (old, new) in edits {
        assert!(text.contains(old), "{name}: no {old:?} to replace");
        text = text.replace(old, new);
    }
    scene::parse(&path, &text).unwrap()
}

/// A component that is stepped and read by names.
struct Unit {
    component: Component,
    step: f64,
}

impl Unit {
    fn new(scene: &Scene) -> Self {
        let mut component = Component::new(scene).unwrap();
        component.initialize(0.0, None).unwrap();
        Self {
            component,
            step: scene.run.step,
        }
    }

    fn reference(&self, name: &str) -> ValueReference {
        let row = self.component.variables().by_name(name);
        row.unwrap_or_else(|| panic!("no variable {name}"))
            .reference
    }

    fn get(&self, name: &str) -> f64 {
        let mut value = [f64::NAN];
        let reference = self.reference(name);
        self.component.get(&[reference], &mut value).unwrap();
        value[0]
    }

    fn set(&mut self, name: &str, value: f64) {
        let reference = self.reference(name);
        self.component.set(&[reference], &[value]).unwrap();
    }

    /// One communication step; the mass ledger must be exact after each.
    fn step(&mut self) {
        let t = self.component.time();
        self.component.do_step(t, self.step).unwrap();
        let ledger = self.component.ledger();
        assert_eq!(ledger.error(), 0.0, "t = {t}: {ledger:?}");
    }

    /// Steps until at least `time` [s].
    fn run_to(&mut self, time: f64) {
        while self.component.time() < time - 0.5 * self.step {
            self.step();
        }
    }
}

/// A planar scene without devices after `time` [s], and the solver that stepped it.
fn solve(scene: &Scene, time: f64) -> (Solver<2>, State<2>) {
    let (plan, state) = scene::build::<2>(scene).unwrap();
    advance(plan, state, time)
}

/// As [`solve`], from a plan and a state of its own.
fn advance(plan: Plan<2>, mut state: State<2>, time: f64) -> (Solver<2>, State<2>) {
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    while state.time < time {
        solver
            .step(&mut state, time, &inputs, &mut |_, _| {})
            .unwrap_or_else(|e| panic!("{e}"));
    }
    (solver, state)
}

/// Sum of m v [kg m/s].
fn momentum(state: &State<2>) -> [f64; 2] {
    let rows = state.grains.mass.iter().zip(&state.grains.velocity);
    rows.fold([0.0; 2], |s, (m, v)| [s[0] + m * v[0], s[1] + m * v[1]])
}
