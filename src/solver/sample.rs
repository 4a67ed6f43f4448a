//! Samples for those who time and test single sweeps: a plan without walls, a state at its start, disordered material.

use crate::boundary::WallPoints;
use crate::material::Material;
use crate::math::{Geometry, Vector};
use crate::state::{Grains, PoseTimes, Random, RestState, State};

use super::{Numerics, Periodic, Plan, Rotation, Scheme, YieldForm};

/// Spacing dp of samples [m].
pub(super) const SPACING: f64 = 0.01;

/// Of a scene with a fall of 0.4 m, in steps of one acoustic step: each sweep once.
pub(super) fn numerics() -> Numerics {
    Numerics {
        spacing: SPACING,
        smoothing_ratio: 1.6,
        sound_speed: 20.0,
        fall_speed: 2.0,
        scheme: Scheme::Implicit,
        courant: 0.5,
        acoustic_steps: 1,
        yield_form: YieldForm::Exact { iterations: 1 },
        cap_time: 4.0,
        density_diffusion: 0.1,
        diffusion_gate_time: 1.0,
        friction_into_walls: false,
        strain_relaxation_time: 0.05,
        pair_viscosity_share: 0.05,
        rotation: Rotation::Cohesive,
        artificial_viscosity: 0.0,
        shifting: 0.0,
        solver_tolerance: 3e-4,
        solver_max_iterations: 500,
        sleep: false,
        seepage_interval: 1,
        resize_rings: true,
        jitter: 0.0,
        seed: 1,
    }
}

/// One material in the box from the origin to `upper` [m], without walls, devices and periodic sides.
pub(super) fn plan<const D: usize>(
    material: Material,
    geometry: Geometry,
    upper: Vector<D>,
) -> Plan<D> {
    Plan {
        numerics: numerics(),
        gravity: std::array::from_fn(|k| if k == 1 { -9.81 } else { 0.0 }),
        geometry,
        lower: [0.0; D],
        upper,
        periodic: Periodic {
            lower: [0.0; D],
            length: [0.0; D],
        },
        materials: vec![material],
        walls: WallPoints::default(),
        ghost_depth: Vec::new(),
        movers: Vec::new(),
        belts: Vec::new(),
        drives: Vec::new(),
        plates: Vec::new(),
        spins: Vec::new(),
        sources: Vec::new(),
        sinks: Vec::new(),
        moments: Vec::new(),
        friction_goes_on: false,
    }
}

/// These grains at the start of a scene without walls and devices.
pub(super) fn at_start<const D: usize>(grains: Grains<D>, random: Random) -> State<D> {
    State {
        time: 0.0,
        initial_mass: grains.present_mass(),
        grains,
        pose: PoseTimes::default(),
        drives: Vec::new(),
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
    }
}

/// `side`^D particles of a material under load, displaced by up to `jitter` dp, moving at random.
pub(super) fn disordered<const D: usize>(
    material: Material,
    geometry: Geometry,
    side: usize,
    jitter: f64,
) -> (Plan<D>, State<D>) {
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
    let upper = [side as f64 * SPACING; D];
    (plan(material, geometry, upper), at_start(grains, random))
}
