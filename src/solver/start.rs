//! How a solver begins: made for a plan, started on a fresh state, resumed on a restored one.

use std::sync::Arc;

use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{Arch, Workers, norm};
use crate::state::State;

use super::acoustic::Acoustic;
use super::barrier::Barrier;
use super::implicit::Viscous;
use super::lists::{Lists, SKIN};
use super::packing::Packing;
use super::ring_sections::Moved;
use super::wall_friction::Friction;
use super::{Plan, Scheme, Solver, explicit, paper_a, paper_b, pore, rest, texture, turning};

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
            spins,
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
        let turns = turning::who_turns(&numerics, geometry, &materials);
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
            spins,
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
            damped: Vec::new(),
            lean: Vec::new(),
            wall_share: Vec::new(),
            lone: Vec::new(),
            slides,
            texture: Vec::new(),
            uneven_pressure: Vec::new(),
            turns,
            turning: Vec::new(),
            mirrors: Vec::new(),
            faces: Vec::new(),
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
            moved: Moved::default(),
        }
    }

    /// Uses another number of threads (0: all cores); results do not change.
    pub fn set_threads(&mut self, threads: usize) {
        self.workers = Arc::new(Workers::new(threads));
    }

    /// As many threads as there were, if this process has none of them because it was forked.
    pub fn renew_threads(&mut self) {
        if let Some(workers) = self.workers.renewed() {
            self.workers = Arc::new(workers);
        }
    }

    /// Sorts a fresh state's particles and derives everything else from it.
    pub fn start(&mut self, state: &mut State<D>) {
        self.renew_lists(state);
        // What lies as it was made has not moved.
        self.moved = Moved::default();
        self.pack(state);
        self.set_turning(state);
        if self.has_pores && self.numerics.scheme == Scheme::Implicit {
            self.sweep_kinematics(state);
            self.seep(state);
            // Suction is none, as in the steps (`pore/follow.rs`).
            let pore = state.grains.pore_pressure.iter();
            state.grains.relaxed_pore_pressure = pore.map(|p| p.max(0.0)).collect();
        }
        self.derive(state);
    }

    /// Bodies that turn at the start do so about where their particles were packed to.
    fn set_turning(&self, state: &mut State<D>) {
        let grains = &mut state.grains;
        for (ids, motion) in &self.spins {
            for i in (0..grains.len()).filter(|i| ids.contains(&grains.id[*i])) {
                grains.velocity[i] = motion.velocity_at(&grains.position[i], 0.0);
            }
        }
    }

    /// Derives lists, walls, pressures and viscosities of a restored state, with the bits they had.
    pub fn resume(&mut self, state: &State<D>) {
        // What the state before had moved is no part of this one.
        self.moved = Moved::default();
        // Lists were built with plates and movers where they were then.
        self.place_movers(state.pose.listed);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.listed_opening, 0.0);
        }
        self.build_lists(state);
        self.place_movers(state.pose.now);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.opening, gate.rate);
        }
        self.derive(state);
    }

    /// Everything that follows from a state.
    pub(super) fn derive(&mut self, state: &State<D>) {
        match self.numerics.scheme {
            Scheme::Implicit => {
                self.sweep_kinematics(state);
                self.respond(state);
            }
            Scheme::PaperA(choices) => self.derive_paper_a(&choices, state),
            Scheme::PaperB(choices) => self.derive_paper_b(&choices, state),
        }
    }
}
