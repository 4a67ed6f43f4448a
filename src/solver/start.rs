//! How a solver begins: made for a plan, started on a fresh state, resumed on a restored one.

use std::collections::HashMap;
use std::sync::Arc;

use crate::boundary::{Belt, Course, Mover};
use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{Arch, Vector, Workers, norm};
use crate::state::State;

use super::acoustic::Acoustic;
use super::barrier::Barrier;
use super::implicit::Viscous;
use super::lists::{Lists, SKIN};
use super::packing::Packing;
use super::ring_sections::Moved;
use super::wall_friction::Friction;
use super::{
    Plan, Scheme, Solver, StaysAwake, explicit, paper_a, paper_b, pore, pressure, rest, texture,
    turning,
};

/// What of a plan tells which stages and forms of sweeps its steps need; fields as in [`Solver`].
struct Needs {
    bulk_friction: bool,
    fluids: bool,
    meetings: bool,
    impedances: Vec<f64>,
    pores: bool,
    effective_pressure: bool,
    lattice_sum: f64,
    slides: Vec<bool>,
    turns: Vec<bool>,
    stays_awake: Option<StaysAwake>,
}

impl Needs {
    /// Of a plan whose movers are where they start.
    fn of<const D: usize>(plan: &Plan<D>, kernel: &WendlandC2<D>) -> Self {
        let (numerics, geometry, materials) = (&plan.numerics, plan.geometry, &plan.materials);
        let fluids = materials.iter().any(Material::is_fluid);
        let pores = materials.iter().any(Material::is_saturated);
        let rubs = plan.walls.groups.iter().any(|g| g.friction > 0.0);
        let lattice_sum = if pores || fluids {
            pore::lattice_sum(kernel, numerics.spacing)
        } else {
            0.0
        };
        let rate = explicit::rate::<D>(lattice_sum);
        let movers = plan.movers.iter().filter(|m| m.drive.is_some());
        let belts = plan.belts.iter().map(Belt::group);
        let steered: Vec<u16> = movers.map(Mover::group).chain(belts).collect();
        Self {
            bulk_friction: materials.iter().any(|m| m.bulk_friction > 0.0),
            fluids,
            impedances: pressure::impedances(materials, numerics.sound_speed),
            meetings: numerics.scheme == Scheme::Implicit && fluids && materials.len() > 1,
            pores,
            effective_pressure: pores || (rubs && fluids),
            lattice_sum,
            slides: texture::who_slides(numerics, geometry, materials, rate),
            turns: turning::who_turns(numerics, geometry, materials),
            stays_awake: rest::stays_awake(
                numerics,
                &plan.gravity,
                &plan.walls,
                &steered,
                materials,
            ),
        }
    }
}

impl<const D: usize> Solver<D> {
    /// A solver for a plan, on `threads` threads (0: all cores).
    #[must_use]
    pub fn new(mut plan: Plan<D>, threads: usize) -> Self {
        let spacing = plan.numerics.spacing;
        let h = spacing * plan.numerics.smoothing_ratio;
        let kernel = WendlandC2::new(h);
        for mover in &plan.movers {
            mover.place(&mut plan.walls, Course::START);
        }
        let needs = Needs::of(&plan, &kernel);
        let fixed_groups = plan.walls.groups.len() - plan.plates.len();
        for plate in &mut plan.plates {
            plate.append(&mut plan.walls);
        }
        Self {
            lists: Lists::new(kernel.support(), SKIN * h),
            gravity_norm: norm(&plan.gravity),
            barrier: Barrier::new(spacing, plan.numerics.longest_step()),
            numerics: plan.numerics,
            gravity: plan.gravity,
            geometry: plan.geometry,
            width: plan.geometry.width(),
            lower: plan.lower,
            upper: plan.upper,
            periodic: plan.periodic,
            materials: plan.materials,
            kernel,
            walls: plan.walls,
            ghost_depth: plan.ghost_depth,
            fixed_groups,
            movers: plan.movers,
            belts: plan.belts,
            drives: plan.drives,
            plates: plan.plates,
            spins: plan.spins,
            has_streams: plan.sources.iter().any(|s| s.piston.is_some()),
            sources: plan.sources,
            sinks: plan.sinks,
            moments: plan.moments,
            workers: Arc::new(Workers::new(threads)),
            arch: Arch::detect(),
            stays_awake: needs.stays_awake,
            has_bulk_friction: needs.bulk_friction,
            has_fluids: needs.fluids,
            has_meetings: needs.meetings,
            impedances: needs.impedances,
            has_pores: needs.pores,
            has_effective_pressure: needs.effective_pressure,
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
            lattice_sum: needs.lattice_sum,
            packing: Packing::new(&kernel, spacing),
            flows: Vec::new(),
            damped: Vec::new(),
            friction_goes_on: plan.friction_goes_on,
            lean: Vec::new(),
            even_slope: Vec::new(),
            wall_share: Vec::new(),
            lone: Vec::new(),
            slides: needs.slides,
            texture: Vec::new(),
            uneven_pressure: Vec::new(),
            turns: needs.turns,
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
        self.place_walls(state);
        let grains = &state.grains;
        let turns = |id: &u64| self.spins.iter().any(|(ids, _)| ids.contains(id));
        let places = grains
            .id
            .iter()
            .copied()
            .zip(grains.position.iter().copied());
        let made: HashMap<u64, Vector<D>> = places.filter(|(id, _)| turns(id)).collect();
        self.renew_lists(state);
        // What lies as it was made has not moved.
        self.moved = Moved::default();
        self.pack(state);
        self.set_turning(state, &made);
        if self.has_pores && self.numerics.scheme == Scheme::Implicit {
            self.sweep_kinematics(state);
            self.seep(state);
            // Suction is none, as in the steps (`pore/follow.rs`).
            let pore = state.grains.pore_pressure.iter();
            state.grains.relaxed_pore_pressure = pore.map(|p| p.max(0.0)).collect();
        }
        self.derive(state);
    }

    /// Bodies that turn at the start do so about where their particles were packed to, of what has crossed a periodic side by the image
    /// beside where it was made.
    fn set_turning(&self, state: &mut State<D>, made: &HashMap<u64, Vector<D>>) {
        let grains = &mut state.grains;
        for (ids, motion) in &self.spins {
            for i in (0..grains.len()).filter(|i| ids.contains(&grains.id[*i])) {
                let x = &grains.position[i];
                let place = made
                    .get(&grains.id[i])
                    .map_or(*x, |near| self.periodic.image(x, near));
                grains.velocity[i] = motion.velocity_at(&place, 0.0);
            }
        }
    }

    /// Derives lists, walls, pressures and viscosities of a restored state, with the bits they had.
    pub fn resume(&mut self, state: &State<D>) {
        // What the state before had moved is no part of this one.
        self.moved = Moved::default();
        // Lists were built with plates and movers where they were then.
        self.place_walls_as_listed(state);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.listed_opening, 0.0);
        }
        self.place_streams(state, true);
        self.build_lists(state);
        self.place_walls(state);
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.opening, gate.rate);
        }
        self.place_streams(state, false);
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
