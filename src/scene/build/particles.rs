//! The start state: particles of the bodies, on their lattices, with the masses, densities and speeds they start with.

use std::ops::Range;

use crate::boundary::{RigidMotion, Steers};
use crate::math::{Vector, add};
use crate::shape::{Fill, Lattice};
use crate::solver::{Scheme, three};
use crate::state::{
    DriveState, GateState, Grains, InflowState, PoseTimes, Random, RestState, State,
};

use super::{geometry, narrow, rigid_motion};
use crate::scene::footing::Support;
use crate::scene::load::Loads;
use crate::scene::steady_flow::steady_flow;
use crate::scene::{Body, Dimension, Point, Scene};

/// Mass of a particle of `density` at a place that stands for `cell` m^D of the section [kg]. Rings far from the axis
/// are heavier than those near it: the heaviest that the domain has room for sets what masses are multiples of.
pub(super) fn particle_mass(scene: &Scene, place: &Point, density: f64, cell: f64) -> f64 {
    let geometry = geometry(scene);
    let length = |x: &Point| geometry.length_across(x, 0.0);
    let mass = density * cell * length(place);
    let outermost = if geometry.is_axisymmetric() {
        cell * length(&scene.domain.upper)
    } else {
        cell * length(place)
    };
    let materials = scene.materials.iter();
    let densest = materials
        .map(|m| m.material.rest_density())
        .fold(density, f64::max);
    exact_mass(mass, density * outermost, densest * outermost)
}

/// Mass of a particle, rounded to a multiple of a power of two so that sums are exact: of up to 2^28 particles no heavier
/// than `largest`, the heaviest of its own density, and of up to 2^26 no heavier than `heaviest` of all [kg].
fn exact_mass(mass: f64, largest: f64, heaviest: f64) -> f64 {
    let magnitude = |m: f64| m.log2().floor() as i32;
    let quantum = 2f64.powi((magnitude(largest) - 24).max(magnitude(heaviest) - 26));
    (mass / quantum).round() * quantum
}

/// Particles, and devices as they start; `walls` are the points of walls and gates that they may stand on or lie under.
///
/// # Errors
/// A sentence: no particles and no inflow.
pub(super) fn state<const D: usize>(
    scene: &Scene,
    walls: &[Support<D>],
) -> Result<State<D>, String> {
    let mut random = Random::new(scene.numerics.seed);
    let lattices = lattices::<D>(scene);
    let grains = grains(scene, walls, &lattices, &mut random);
    if grains.is_empty() && scene.inflows.is_empty() {
        return Err("the scene has no particles and no inflow: add a body that holds at least one particle spacing".to_owned());
    }
    let gates = scene
        .gates
        .iter()
        .map(|g| GateState {
            opening: g.start,
            rate: 0.0,
            blocked: false,
            listed_opening: g.start,
        })
        .collect();
    Ok(State {
        time: 0.0,
        initial_mass: grains.present_mass(),
        next_id: grains.len() as u64,
        grains,
        pose: PoseTimes::default(),
        drives: drives(scene),
        gates,
        inflows: vec![InflowState::default(); scene.inflows.len()],
        drained: vec![0.0; scene.outflows.len()],
        impulse: vec![[0.0; D]; scene.walls.len() + scene.gates.len() + scene.moments().count()],
        steps: 0,
        iterations: 0,
        step_size: 0.0,
        trend: 0.0,
        rest: RestState::default(),
        random,
    })
}

/// Steered walls where they are drawn, at their start speed.
fn drives(scene: &Scene) -> Vec<DriveState> {
    let drives = scene.drives().map(|(_, drive)| DriveState {
        rate: match drive.steers {
            Steers::Rate => drive.start,
            Steers::Way => 0.0,
        },
        ..DriveState::default()
    });
    drives.collect()
}

/// Particles of all bodies, in their order; their numbers are their places.
fn grains<const D: usize>(
    scene: &Scene,
    walls: &[Support<D>],
    lattices: &[Lattice],
    random: &mut Random,
) -> Grains<D> {
    let mut grains = Grains {
        implicit: scene.numerics.scheme == Scheme::Implicit,
        exact_yield: scene.keeps_stress(),
        wall_friction: scene.has_wall_friction(),
        saturated: scene.has_pore_pressure(),
        ..Grains::default()
    };
    let rings = scene.dimension == Dimension::Axisymmetric;
    let loads = Loads::new(scene, up_axis(scene), lattices, walls);
    for (number, (body, lattice)) in scene.bodies.iter().zip(lattices).enumerate() {
        let material = &scene.materials[body.material].material;
        let sound_speed = material.sound_speed.unwrap_or(scene.numerics.sound_speed);
        let flow = steady_flow(scene, body);
        let bulk = bulk_density(scene, body);
        // Rings are not packed (`solver/pack.rs`), and nothing damps what uneven ones of a fluid do to its pressure.
        let still = rings && material.is_fluid();
        for (n, place) in lattice.points.iter().enumerate() {
            let position: Vector<D> = std::array::from_fn(|k| {
                let aside = reach(scene, k, place) * random.symmetric();
                if still { place[k] } else { place[k] + aside }
            });
            let mut velocity: Vector<D> = narrow(&body.velocity);
            let load = loads.at(number, (n, place), &three(&position));
            let mut density = material.density_under(load, sound_speed);
            let mut shear_rate = 0.0;
            if let Some(flow) = &flow {
                let here = flow.at(&three(&position), sound_speed);
                velocity = add(&velocity, &narrow(&here.velocity));
                (density, shear_rate) = (here.density, here.shear_rate);
            }
            let mass = particle_mass(scene, place, bulk, lattice.cell_volume);
            let id = grains.len() as u64;
            grains.push(id, body.material as u8, position, velocity, mass, density);
            if let Some(relaxed) = grains.relaxed_shear.last_mut() {
                *relaxed = shear_rate;
            }
        }
    }
    grains
}

/// Density that makes the masses of a body's particles [kg/m^3].
pub(super) fn bulk_density(scene: &Scene, body: &Body) -> f64 {
    let at_rest = scene.materials[body.material].material.rest_density();
    steady_flow(scene, body).map_or(at_rest, |flow| flow.loose_density)
}

/// How bodies that turn do so at the start, by the numbers of their particles.
pub(super) fn spins<const D: usize>(scene: &Scene) -> Vec<(Range<u64>, RigidMotion<D>)> {
    let mut first = 0;
    let mut spins = Vec::new();
    if scene.bodies.iter().all(|b| b.rotation.is_none()) {
        return spins;
    }
    for (body, lattice) in scene.bodies.iter().zip(lattices::<D>(scene)) {
        let ids = first..first + lattice.points.len() as u64;
        first = ids.end;
        if let Some(rotation) = &body.rotation {
            spins.push((ids, rigid_motion(&body.velocity, Some(rotation))));
        }
    }
    spins
}

/// What the bodies are filled on.
pub(super) fn lattices<const D: usize>(scene: &Scene) -> Vec<Lattice> {
    let rings = scene.dimension == Dimension::Axisymmetric;
    // With the packing of the start (`solver/pack.rs`), which evens what it leaves uneven beside walls.
    let staggered =
        scene.numerics.jitter > 0.0 && !rings && scene.numerics.scheme == Scheme::Implicit;
    let level = |body: &Body| body.level.map(|height| (scene.up(), height));
    let bodies = scene.bodies.iter();
    let fills: Vec<Fill> = bodies.map(|body| (&body.shape, level(body))).collect();
    crate::shape::lattices(&fills, scene.numerics.spacing, D, staggered)
}

/// How far a particle may start from its place along an axis [m]. Rings of half a spacing move half as far: the mass is
/// that of the place, and the section's area follows from it.
fn reach(scene: &Scene, axis: usize, place: &Point) -> f64 {
    let dp = scene.numerics.spacing;
    let rings = scene.dimension == Dimension::Axisymmetric;
    let room = if rings && axis == 0 {
        dp.min(place[0])
    } else {
        dp
    };
    scene.numerics.jitter * room
}

/// Axis of "up".
fn up_axis(scene: &Scene) -> usize {
    let up = scene.up();
    (0..3).fold(0, |best, k| {
        if up[k].abs() > up[best].abs() {
            k
        } else {
            best
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two million particles of each of two materials, one as light as a scene may have it beside the other: the sum is
    /// that of whole numbers, whichever comes first.
    #[test]
    fn masses_of_the_lightest_beside_the_heaviest_add_up_exactly() {
        let heaviest = 1.999 * 2.65;
        let lightest = heaviest / 4096.0;
        let light = exact_mass(lightest, lightest, heaviest);
        let heavy = exact_mass(heaviest, heaviest, heaviest);
        assert!((light / lightest - 1.0).abs() < 2f64.powi(-14));
        let many = 1 << 21;
        let sum = |masses: [f64; 2]| {
            let all = (0..2 * many).map(|i| masses[i % 2]);
            all.fold(0.0, |sum, mass| sum + mass)
        };
        let of_each = many as f64 * light + many as f64 * heavy;
        assert_eq!(sum([light, heavy]), of_each);
        let taken = (0..many).fold(of_each, |rest, _| rest - heavy);
        assert_eq!(taken, many as f64 * light);
    }
}
