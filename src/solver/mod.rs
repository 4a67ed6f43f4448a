//! Rank 4: the solver. [`Solver::step`] is the algorithm of docs/theory.md, "Algorithm", one line a stage.
//!
//! It knows particles, walls and devices; no scenes, files or clocks. The same bits for any number of threads: every
//! row is gathered by itself, and sums run in a fixed order.
#![allow(
    clippy::needless_range_loop,
    reason = "textbook index notation: sums over components a, b, c = 0..D and over grains i, as in docs/theory.md"
)]

mod acoustic;
mod barrier;
mod constitutive;
mod devices;
mod equation_of_state;
mod error;
mod explicit;
mod fluid_row;
mod friction_row;
mod grid;
mod guess;
mod implicit;
mod kinematics;
mod lean;
mod lists;
mod lone;
mod meeting;
mod mirror;
mod motion;
mod numerics;
mod outputs;
mod pack;
mod packing;
mod pair;
mod paper_a;
mod paper_b;
#[cfg(any(test, feature = "cli"))]
mod passes;
#[cfg(any(test, feature = "cli"))]
mod plain;
mod plan;
mod plastic;
mod pore;
mod pressure;
mod pressure_row;
mod record;
mod rest;
mod ring;
#[cfg(test)]
mod ring_tests;
#[cfg(any(test, feature = "cli"))]
mod sample;
mod shift;
#[cfg(test)]
mod sweep_tests;
mod texture;
mod timestep;
mod validity;
mod viscous;
mod wall_contact;
mod wall_friction;
mod wall_geometry;
mod wall_row;
mod wall_yield;

pub use devices::{Sink, Source};
pub use error::SolverError;
pub use grid::Periodic;
pub use numerics::{Numerics, Scheme, YieldForm};
pub use outputs::three;
pub use paper_a::{PaperA, Sweeps};
pub use paper_b::PaperB;
#[cfg(any(test, feature = "cli"))]
pub use passes::{Pass, Passes};
pub use plan::{OnMove, Plan, StepBound, StepInputs, SubStep};
pub use rest::StaysAwake;
pub use validity::Validity;

use std::sync::Arc;

use crate::boundary::{Mover, Plate, WallPoints};
use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{Arch, Geometry, Quad, Vector, Workers, norm};
use crate::state::State;

use acoustic::Acoustic;
use barrier::Barrier;
use constitutive::Response;
use implicit::Viscous;
use kinematics::Kinematics;
use lists::Lists;
use packing::Packing;
use pressure::Prediction;
use record::Record;
use ring::Ring;
use wall_friction::Friction;

/// Skin of the neighbour lists over h [1].
const SKIN: f64 = 0.3;

/// Steps a [`State`]. Holds the plan, threads and derived data; nothing that a later bit depends on.
#[derive(Debug)]
pub struct Solver<const D: usize> {
    numerics: Numerics,
    gravity: Vector<D>,
    gravity_norm: f64,
    geometry: Geometry,
    /// Of planar scenes [m]; 1 otherwise.
    width: f64,
    lower: Vector<D>,
    upper: Vector<D>,
    periodic: Periodic<D>,
    materials: Vec<Material>,
    kernel: WendlandC2<D>,
    barrier: Barrier<D>,
    walls: WallPoints<D>,
    ghost_depth: Vec<f64>,
    /// Number of wall groups before the gates'.
    fixed_groups: usize,
    movers: Vec<Mover<D>>,
    plates: Vec<Plate<D>>,
    sources: Vec<Source<D>>,
    sinks: Vec<Sink<D>>,
    workers: Arc<Workers>,
    /// Instructions of the hot loops.
    arch: Arch,
    stays_awake: Option<StaysAwake>,
    has_bulk_friction: bool,
    has_fluids: bool,
    /// Whether fluids meet other materials, in the default scheme (F6).
    has_meetings: bool,
    /// Whether a material is saturated.
    has_pores: bool,
    /// Whether what presses grain on grain, or rubs on a wall, is not the pressure of every particle.
    has_effective_pressure: bool,
    lists: Lists<D>,
    /// Place and motion of each particle as sweeps over pairs look it up.
    records: Vec<Record>,
    kinematics: Vec<Kinematics>,
    /// V = m/rho; in the plane for each metre of width.
    volume: Vec<f64>,
    /// Empty unless particles are rings.
    rings: Vec<Ring>,
    responses: Vec<Response>,
    pressure: Vec<f64>,
    /// Pressure, shear rate, density and pair viscosity of each particle, as the pressure sweep looks it up.
    loads: Vec<Quad>,
    /// Pressure with bulk friction, what momentum feels [Pa]; empty unless a material has bulk friction.
    normal_pressure: Vec<f64>,
    /// Pressure between grains, that of saturated material without its pores' [Pa]; empty where it is the pressure.
    effective: Vec<f64>,
    pore: pore::Work,
    /// sum_j 2 V_j |F| of a full neighbourhood [1/m^2]; 0 in scenes without fluids and pores.
    lattice_sum: f64,
    packing: Packing,
    /// 1 for fluids without yield stress, else 0; empty in scenes without.
    flows: Vec<f64>,
    /// Part of each particle's momentum that walls are given; empty in scenes without fluids.
    lean: Vec<crate::math::Tensor<D>>,
    /// For each material whether (F3) is for it; where it is for none, this and what follows stay empty.
    slides: Vec<bool>,
    /// T of each particle: how unevenly its neighbours lie [1].
    texture: Vec<crate::math::Tensor<D>>,
    /// p T of each particle [Pa].
    uneven_pressure: Vec<crate::math::Tensor<D>>,
    /// Stress that each particle's strain against walls without slip lacks (W8) [Pa]; empty in scenes without fluids that yield.
    wall_share: Vec<f64>,
    /// Id and div v [1/s] at the start of the step of fluid particles without neighbours, by id; else empty.
    lone: Vec<(u64, f64)>,
    /// The flat wall without slip that each particle of a fluid sees; empty in scenes without fluids and of rings.
    mirrors: Vec<mirror::Mirror<D>>,
    /// Smallest eigenvalue of each particle's moment matrix, 1 far from surfaces; empty in scenes that do not shift [1].
    openness: Vec<f64>,
    /// Shift velocity of each particle in the step [m/s]; empty in scenes that do not shift.
    shift: Vec<Vector<D>>,
    /// Its divergence [1/s]; empty likewise.
    shift_divergence: Vec<f64>,
    viscosity: Vec<f64>,
    pair_viscosity: Vec<f64>,
    inertial_number: Vec<f64>,
    prediction: Vec<Prediction<D>>,
    acoustic: Acoustic<D>,
    viscous: Viscous<D>,
    friction: Friction<D>,
    paper_a: paper_a::Work<D>,
    paper_b: paper_b::Work<D>,
    /// Positions before the last move, for section crossings.
    before: Vec<Vector<D>>,
}

impl<const D: usize> Solver<D> {
    /// A solver for a plan, on `threads` threads (0: all cores).
    #[must_use]
    pub fn new(plan: Plan<D>, threads: usize) -> Self {
        let Plan {
            numerics,
            gravity,
            geometry,
            lower,
            upper,
            periodic,
            materials,
            mut walls,
            ghost_depth,
            movers,
            mut plates,
            sources,
            sinks,
        } = plan;
        let spacing = numerics.spacing;
        let h = spacing * numerics.smoothing_ratio;
        let kernel = WendlandC2::new(h);
        let barrier = Barrier::new(numerics.spacing, numerics.longest_step());
        let fixed_groups = walls.groups.len() - plates.len();
        for mover in &movers {
            mover.place(&mut walls, 0.0);
        }
        let has_bulk_friction = materials.iter().any(|m| m.bulk_friction > 0.0);
        let has_pores = materials.iter().any(Material::is_saturated);
        let rubs = walls.groups.iter().any(|g| g.friction > 0.0);
        let has_fluids = materials.iter().any(Material::is_fluid);
        let has_meetings = numerics.scheme == Scheme::Implicit && has_fluids && materials.len() > 1;
        let has_effective_pressure = has_pores || (rubs && has_fluids);
        let lattice_sum = if has_pores || has_fluids {
            pore::lattice_sum(&kernel, spacing)
        } else {
            0.0
        };
        let rate = explicit::rate::<D>(lattice_sum);
        let slides = texture::who_slides(&numerics, geometry, &materials, rate);
        let stays_awake = rest::stays_awake(&numerics, &gravity, &walls, &materials);
        for plate in &mut plates {
            plate.append(&mut walls);
        }
        Self {
            lists: Lists::new(kernel.support(), SKIN * h),
            gravity_norm: norm(&gravity),
            numerics,
            gravity,
            geometry,
            width: geometry.width(),
            lower,
            upper,
            periodic,
            materials,
            kernel,
            barrier,
            walls,
            ghost_depth,
            fixed_groups,
            movers,
            plates,
            sources,
            sinks,
            workers: Arc::new(Workers::new(threads)),
            arch: Arch::detect(),
            stays_awake,
            has_bulk_friction,
            has_fluids,
            has_meetings,
            has_pores,
            has_effective_pressure,
            records: Vec::new(),
            kinematics: Vec::new(),
            volume: Vec::new(),
            rings: Vec::new(),
            responses: Vec::new(),
            pressure: Vec::new(),
            loads: Vec::new(),
            normal_pressure: Vec::new(),
            effective: Vec::new(),
            pore: pore::Work::default(),
            lattice_sum,
            packing: Packing::new(&kernel, spacing),
            flows: Vec::new(),
            lean: Vec::new(),
            wall_share: Vec::new(),
            lone: Vec::new(),
            slides,
            texture: Vec::new(),
            uneven_pressure: Vec::new(),
            mirrors: Vec::new(),
            openness: Vec::new(),
            shift: Vec::new(),
            shift_divergence: Vec::new(),
            viscosity: Vec::new(),
            pair_viscosity: Vec::new(),
            inertial_number: Vec::new(),
            prediction: Vec::new(),
            acoustic: Acoustic::default(),
            viscous: Viscous::default(),
            friction: Friction::default(),
            paper_a: paper_a::Work::default(),
            paper_b: paper_b::Work::default(),
            before: Vec::new(),
        }
    }

    /// Uses another number of threads (0: all cores); results do not change.
    pub fn set_threads(&mut self, threads: usize) {
        self.workers = Arc::new(Workers::new(threads));
    }

    /// Sorts a fresh state's particles and derives everything else from it.
    pub fn start(&mut self, state: &mut State<D>) {
        self.renew_lists(state);
        self.pack(state);
        if self.has_pores && self.numerics.scheme == Scheme::Implicit {
            self.sweep_kinematics(state);
            self.seep(state);
        }
        self.derive(state);
    }

    /// Derives lists, walls, pressures and viscosities of a restored state, with the bits they had.
    pub fn resume(&mut self, state: &State<D>) {
        // Lists were built with plates and movers where they were then.
        self.place_movers(state.pose.listed);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.listed_opening, 0.0);
        }
        self.lists.build(
            &state.grains,
            &self.walls,
            &self.periodic,
            (&self.workers, self.arch),
        );
        self.place_movers(state.pose.now);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.opening, gate.rate);
        }
        self.derive(state);
    }

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
        let (dt, bound) = self.choose_step(state, inputs.openings, end)?;
        match self.numerics.scheme {
            Scheme::Implicit => {}
            Scheme::PaperA(choices) => {
                return self.step_paper_a(&choices, state, (dt, bound), on_move);
            }
            Scheme::PaperB(choices) => {
                return self.step_paper_b(&choices, state, (dt, bound), on_move);
            }
        }
        // Forces tell when a scene may sleep, whoever reads them.
        let was_quiet = self.stays_awake.is_none() && self.is_quiet(&state.grains);
        self.find_shift(state);
        let acoustic_dt = self.step_sound(state, dt);
        let iterations = self.solve_viscous(state, dt)?;
        let impulse = state.impulse.clone();
        self.add_reactions(state, dt, was_quiet);
        self.even_friction(state, dt, was_quiet);
        self.note_lone(state);
        self.move_grains(state, dt, acoustic_dt)?;
        on_move(&self.before, &state.grains);
        self.move_walls(state, dt);
        self.move_gates(state, inputs.openings, dt);
        self.drain(state);
        self.keep_inside(state)?;
        self.sweep_kinematics_in_valid_lists(state, false);
        self.centre_lone(state);
        self.advance_density(state, dt, acoustic_dt)?;
        let came = self.feed(state, inputs.rates, dt);
        if came {
            self.sweep_kinematics_in_valid_lists(state, true);
        }
        if came || state.steps.is_multiple_of(self.numerics.seepage_interval) {
            self.seep(state);
        }
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

    /// The stable step, shortened so that equal steps end at `end`.
    fn choose_step(
        &self,
        state: &State<D>,
        wanted: &[f64],
        end: f64,
    ) -> Result<(f64, StepBound), SolverError> {
        let (stable, bound) = match self.numerics.scheme {
            Scheme::Implicit => self.step_bound(state, wanted)?,
            Scheme::PaperA(_) => self.bound_paper_a(state.time)?,
            Scheme::PaperB(_) => self.bound_paper_b(state)?,
        };
        let left = end - state.time;
        let count = (left / stable - 1e-9).ceil().max(1.0);
        if count <= 1.0 {
            Ok((
                left,
                if left < 0.999 * stable {
                    StepBound::Communication
                } else {
                    bound
                },
            ))
        } else {
            Ok((left / count, bound))
        }
    }

    fn derive(&mut self, state: &State<D>) {
        match self.numerics.scheme {
            Scheme::Implicit => {
                self.sweep_kinematics(state);
                self.respond(state);
            }
            Scheme::PaperA(choices) => self.derive_paper_a(&choices, state),
            Scheme::PaperB(choices) => self.derive_paper_b(&choices, state),
        }
    }

    /// The first particle for which `fine` is false, as an error.
    fn not_finite(
        &self,
        state: &State<D>,
        quantity: &'static str,
        fine: impl Fn(usize) -> bool,
    ) -> SolverError {
        let i = (0..state.grains.len()).find(|&i| !fine(i)).unwrap_or(0);
        SolverError::NotFinite {
            particle: state.grains.id.get(i).copied().unwrap_or(0),
            time: state.time,
            quantity,
            position: state.grains.position.get(i).map_or([0.0; 3], three),
        }
    }
}
