//! Rank 4: the solver. [`Solver::step`] (`step.rs`) is the algorithm of docs/theory.md, "Algorithm", one line a stage; here is what
//! a solver holds.
//!
//! It knows particles, walls and devices; no scenes, files or clocks. The same bits for any number of threads: every
//! row is gathered by itself, and sums run in a fixed order.
#![allow(
    clippy::needless_range_loop,
    reason = "textbook index notation: sums over components a, b, c = 0..D and over grains i, as in docs/theory.md"
)]

mod acoustic;
mod barrier;
mod bend;
mod constitutive;
mod corners;
mod devices;
mod directions;
mod equation_of_state;
mod error;
mod explicit;
mod face_sums;
mod flat_face;
mod fluid_row;
mod friction_row;
mod grid;
mod guess;
mod handed;
mod implicit;
mod joints;
mod kinematics;
mod lean;
mod lists;
mod lone;
mod meeting;
mod mirror;
mod momentum;
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
mod reactions;
mod record;
mod reflect;
mod rest;
mod ring;
mod ring_sections;
#[cfg(test)]
mod ring_tests;
#[cfg(any(test, feature = "cli"))]
mod sample;
mod seams;
mod shift;
mod sources;
mod start;
mod step;
mod streams;
#[cfg(test)]
mod sweep_tests;
mod texture;
mod timestep;
mod turning;
mod validity;
mod viscous;
mod wall_contact;
mod wall_faces;
mod wall_friction;
mod wall_geometry;
mod wall_ratio;
mod wall_row;
mod wall_yield;

pub(crate) use corners::PARALLEL;
pub use devices::Sink;
pub use error::SolverError;
pub use grid::Periodic;
pub use handed::Handed;
pub use lists::SHORTEST_PERIOD;
pub use motion::SLACK;
pub use numerics::{Numerics, Rotation, Scheme, YieldForm};
pub use outputs::three;
pub use paper_a::{PaperA, Sweeps};
pub use paper_b::PaperB;
#[cfg(any(test, feature = "cli"))]
pub use passes::{Pass, Passes};
pub use plan::{Moment, OnMove, Plan, StepBound, StepInputs, SubStep};
pub use rest::StaysAwake;
pub use sources::{INSIDE, Source};
pub use validity::Validity;

use std::ops::Range;
use std::sync::Arc;

use crate::boundary::{Belt, Drive, Mover, Plate, RigidMotion, WallPoints};
use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{Arch, Geometry, Quad, Tensor, Vector, Workers};

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

/// Steps a [`State`](crate::state::State). Holds the plan, threads and derived data; nothing that a later bit depends on.
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
    belts: Vec<Belt<D>>,
    drives: Vec<Drive>,
    plates: Vec<Plate<D>>,
    spins: Vec<(Range<u64>, RigidMotion<D>)>,
    sources: Vec<Source<D>>,
    /// Whether one of them pushes (W13).
    has_streams: bool,
    sinks: Vec<Sink<D>>,
    moments: Vec<Moment<D>>,
    workers: Arc<Workers>,
    /// Instructions of the hot loops.
    arch: Arch,
    stays_awake: Option<StaysAwake>,
    has_bulk_friction: bool,
    has_fluids: bool,
    /// Whether fluids meet other materials, in the default scheme (F6).
    has_meetings: bool,
    /// rho_0 c of each material, where they differ (E8) [Pa s/m].
    impedances: Vec<f64>,
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
    /// Share of the viscosity made up to each particle's own that it feels (E21) [1]; empty where none is made up.
    damped: Vec<f64>,
    /// Whether grains' friction goes on into walls (W14).
    friction_goes_on: bool,
    /// Part of each particle's momentum that walls are given; empty in scenes where neither fluids nor friction go on into walls.
    lean: Vec<Tensor<D>>,
    /// b of (W14) of each particle [m/s^2]; empty where friction does not go on into walls.
    even_slope: Vec<Vector<D>>,
    /// For each material whether (F3) is for it; where it is for none, this and what follows stay empty.
    slides: Vec<bool>,
    /// T of each particle: how unevenly its neighbours lie [1].
    texture: Vec<Tensor<D>>,
    /// p T of each particle [Pa].
    uneven_pressure: Vec<Tensor<D>>,
    /// For each material whether (T1) is for it; where it is for none, this and what follows stay empty.
    turns: Vec<bool>,
    /// M of each particle that it is for, 0 of others [1].
    turning: Vec<Tensor<D>>,
    /// Stress that each particle's strain against walls without slip lacks (W8) [Pa]; empty in scenes where nothing that yields has (W4) or (W14).
    wall_share: Vec<f64>,
    /// Id and div v [1/s] at the start of the step of fluid particles without neighbours, by id; else empty.
    lone: Vec<(u64, f64)>,
    /// The flat wall without slip that each particle of a fluid sees; empty in scenes without fluids or walls without slip.
    mirrors: Vec<mirror::Mirror<D>>,
    /// The flat walls with free slip that each particle of a fluid sees; empty in the plane and in scenes without.
    faces: Vec<reflect::Faces<D>>,
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
    /// What the last making of lists did to rings.
    moved: ring_sections::Moved<D>,
}
