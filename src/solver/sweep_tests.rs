//! The sweeps in lanes against the plain ones, and both architectures against each other.

mod beside_walls;

use crate::boundary::WallPoints;
use crate::material::{Material, Viscous};
use crate::math::{Arch, Geometry, Tensor, Vector, norm, scale, sub};
use crate::state::State;

use super::Solver;
use super::plain::PlainPairs;
use super::pressure::Prediction;
use super::record::Record;
use super::sample;

/// How far samples are displaced [dp].
const JITTER: f64 = 0.3;

/// The clay of Monge-Gapper et al. (2024), Table 1.
fn clay() -> Material {
    let viscous = Viscous {
        consistency: 4.472,
        flow_index: 0.472,
    };
    Material::fluid(1540.0, viscous, 30.0)
}

/// Disordered material under load, moving at random, that repeats along x.
fn disordered<const D: usize>(
    material: Material,
    geometry: Geometry,
    count: usize,
) -> (Solver<D>, State<D>) {
    disordered_on(material, geometry, count, WallPoints::default())
}

fn disordered_on<const D: usize>(
    material: Material,
    geometry: Geometry,
    count: usize,
    walls: WallPoints<D>,
) -> (Solver<D>, State<D>) {
    let (mut plan, mut state) = sample::disordered(material, geometry, count, JITTER);
    if !geometry.is_axisymmetric() {
        plan.periodic.length[0] = plan.upper[0];
    }
    plan.walls = walls;
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    (solver, state)
}

fn close(a: f64, b: f64, scale: f64) {
    assert!((a - b).abs() <= 1e-12 * scale, "{a} {b} at {scale}");
}

fn agrees<const D: usize>(material: Material, geometry: Geometry, count: usize) {
    let (mut solver, state) = disordered::<D>(material, geometry, count);
    let mut pairs = PlainPairs::default();
    kinematics_agree(&solver, &state, &mut pairs);
    predictions_agree(&mut solver, &state, &pairs);
    let tau = stresses_agree(&solver, &state, &pairs);
    forces_agree(&solver, &state, &pairs, &tau);
}

fn kinematics_agree<const D: usize>(
    solver: &Solver<D>,
    state: &State<D>,
    pairs: &mut PlainPairs<D>,
) {
    let mut rows = solver.plain_pairs(state, pairs);
    assert!(pairs.count() > 10 * state.grains.len());
    // The plain way through the rest of a row gives what the sweep gave, to rounding.
    for (i, row) in rows.iter_mut().enumerate() {
        if !solver.turns.is_empty() {
            solver.turn(row, state.grains.phase[i], true);
        }
        let plain = solver.finish(row, state.grains.phase[i], i, &state.grains.velocity[i]);
        let fast = &solver.kinematics[i];
        close(plain.relative_speed, fast.relative_speed, 3.0);
        close(plain.divergence, fast.divergence, 1e3);
        close(
            plain.curvature,
            fast.curvature,
            fast.curvature.abs().max(1e3),
        );
        close(plain.shear, fast.shear, 1e3);
        close(plain.correction, fast.correction, 1e2);
        close(plain.pair_scale, fast.pair_scale, 1e2);
        close(plain.looseness, fast.looseness, 1e2);
    }
}

fn predictions_agree<const D: usize>(
    solver: &mut Solver<D>,
    state: &State<D>,
    pairs: &PlainPairs<D>,
) {
    solver.sweep_pressure(state, 1e-4);
    let slides = solver.materials[0].is_fluid() && !solver.geometry.is_axisymmetric();
    let uneven = solver.uneven_pressure.as_flattened().as_flattened();
    assert_eq!(uneven.iter().any(|p| *p != 0.0), slides);
    let mut plain = vec![Prediction::default(); state.grains.len()];
    solver.plain_pressure(state, pairs, 1e-4, &mut plain);
    for (plain, fast) in plain.iter().zip(&solver.prediction) {
        for (a, b) in fast.velocity.iter().zip(&plain.velocity) {
            close(*a, *b, 3.0);
        }
    }
}

/// The stresses.
fn stresses_agree<const D: usize>(
    solver: &Solver<D>,
    state: &State<D>,
    pairs: &PlainPairs<D>,
) -> Vec<Tensor<D>> {
    let n = state.grains.len();
    let mut gradients: Vec<Tensor<D>> = vec![[[0.0; D]; D]; n];
    let v = &state.grains.velocity;
    solver.plain_gradients(pairs, v, &mut gradients);
    let tau: Vec<Tensor<D>> = (0..n)
        .map(|i| {
            solver.unturned(i, &mut gradients[i]);
            solver.row_stress(i, &v[i], &gradients[i])
        })
        .collect();
    let mut records = vec![Record::default(); n];
    solver.stress(v, &mut records, false, &[]);
    let largest = tau.as_flattened().as_flattened();
    let largest = largest.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    assert!(largest > 0.0);
    for (record, tau) in records.iter().zip(&tau) {
        let fast = record.stress::<D>();
        for (a, b) in fast.as_flattened().iter().zip(tau.as_flattened()) {
            close(*a, *b, largest);
        }
    }
    tau
}

fn forces_agree<const D: usize>(
    solver: &Solver<D>,
    state: &State<D>,
    pairs: &PlainPairs<D>,
    tau: &[Tensor<D>],
) {
    let n = state.grains.len();
    let v = &state.grains.velocity;
    let mut records = vec![Record::default(); n];
    solver.stress(v, &mut records, false, &[]);
    let (mut plain, mut fast): (Vec<Vector<D>>, _) = (vec![[0.0; D]; n], vec![[0.0; D]; n]);
    let mut whole = tau.to_vec();
    for (whole, less) in whole.iter_mut().zip(solver.turned_stress(&records)) {
        for (a, b) in whole.iter_mut().flatten().zip(less.as_flattened()) {
            *a += b;
        }
    }
    solver.plain_forces(pairs, v, &whole, &mut plain);
    solver.force(&records, &mut fast, false, &[], |i, f| {
        let mut f = *f;
        for c in &mut f {
            *c /= solver.width * solver.volume[i];
        }
        if solver.geometry.is_axisymmetric() {
            f[0] += solver.ring_drag(i, &v[i], &tau[i], solver.numerics.pair_viscosity_share);
        }
        (f, 0.0)
    });
    let largest = plain
        .as_flattened()
        .iter()
        .fold(0.0f64, |m, f| m.max(f.abs()));
    for (a, b) in fast.as_flattened().iter().zip(plain.as_flattened()) {
        close(*a, *b, largest);
    }
}

#[test]
fn sweeps_in_lanes_agree_with_plain_ones() {
    let cohesive = || Material {
        cohesion: 100.0,
        ..Material::sand_04()
    };
    for material in [Material::sand_04, cohesive, clay] {
        agrees::<2>(material(), Geometry::Planar { width: 0.3 }, 20);
        agrees::<2>(material(), Geometry::Axisymmetric, 20);
        agrees::<3>(material(), Geometry::Space, 9);
    }
}

/// A free block that turns as one is not strained: gamma below 1e-10 of its angular velocity. Sand without cohesion resists by its surface.
fn strain_of_rotation<const D: usize>(material: Material, geometry: Geometry, count: usize) -> f64 {
    let (plan, mut state) = sample::disordered::<D>(material, geometry, count, JITTER);
    let mut solver = Solver::new(plan, 1);
    for i in 0..state.grains.len() {
        let x = state.grains.position[i];
        let v = &mut state.grains.velocity[i];
        *v = [0.0; D];
        (v[0], v[1]) = (3.0 - 2.0 * x[1], 2.0 * x[0]);
    }
    solver.start(&mut state);
    solver.shear_rates().fold(0.0, f64::max) / 2.0
}

#[test]
fn rotation_makes_no_strain() {
    let cohesive = Material {
        cohesion: 100.0,
        ..Material::sand_04()
    };
    let plane = Geometry::Planar { width: 0.3 };
    for material in [cohesive, clay()] {
        let found = [
            strain_of_rotation::<2>(material.clone(), plane, 12),
            strain_of_rotation::<3>(material, Geometry::Space, 6),
        ];
        println!("gamma/omega {:.1e} and {:.1e}", found[0], found[1]);
        assert!(found.iter().all(|f| *f < 1e-10), "{found:?}");
    }
    assert!(strain_of_rotation::<2>(Material::sand_04(), plane, 12) > 0.1);
}

/// Unevenness of velocities, which the pair form damps, must not make it bear less of a fluid's mean stress.
#[test]
fn a_fluids_pair_form_bears_its_share_whatever_the_unevenness() {
    let shear = |noise: f64| {
        let (mut solver, mut state) = disordered::<2>(clay(), Geometry::Planar { width: 0.3 }, 20);
        for i in 0..state.grains.len() {
            let [_, y] = state.grains.position[i];
            let v = state.grains.velocity[i];
            state.grains.velocity[i] = [3.0 * y + noise * v[0], noise * v[1]];
        }
        solver.start(&mut state);
        let inside = |x: &Vector<2>| (0.05..0.15).contains(&x[1]);
        let rows = 0..state.grains.len();
        let rows: Vec<usize> = rows
            .filter(|&i| inside(&state.grains.position[i]))
            .collect();
        let mut pairs = PlainPairs::default();
        let sums = solver.plain_pairs(&state, &mut pairs);
        let scales = rows.iter().map(|&i| {
            let k = &solver.kinematics[i];
            (k.pair_scale, k.shear * k.shear / sums[i].pair_shear2)
        });
        scales.collect::<Vec<_>>()
    };
    let even = shear(0.0);
    assert!(even.len() > 100);
    for (scale, whole) in &even {
        // What linear velocities give is what they are taken to give.
        close(*scale, whole.clamp(0.5, 2.0), 1e3);
    }
    let mean = |rows: &[(f64, f64)]| rows.iter().map(|r| r.0).sum::<f64>() / rows.len() as f64;
    let whole = |rows: &[(f64, f64)]| rows.iter().map(|r| r.1).sum::<f64>() / rows.len() as f64;
    let uneven = shear(0.01);
    assert!((mean(&uneven) / mean(&even) - 1.0).abs() < 0.02);
    assert!(
        whole(&uneven) / whole(&even) < 0.8,
        "that much unevenness would count as shear"
    );
}

/// What density takes of a step is by how much the sum of kernels has grown over the way, to the third order of the step: div v of
/// the way's end alone leaves the second.
#[test]
fn a_fluids_density_follows_the_sum_of_kernels_along_the_way() {
    let (solver, state) = disordered::<2>(clay(), Geometry::Planar { width: 0.3 }, 20);
    let (x, v) = (&state.grains.position, &state.grains.velocity);
    let sum = |i: usize, back: f64| -> f64 {
        let before = |n: usize| sub(&x[n], &scale(back, &v[n]));
        let at = before(i);
        let others = (0..x.len()).filter(|&n| n != i);
        let kernel = |n: usize| {
            let r = norm(&solver.periodic.difference(&at, &before(n)));
            solver.volume[n] * solver.kernel.w(r)
        };
        others.map(kernel).sum()
    };
    let missed = |dt: f64| -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for (i, k) in solver.kinematics.iter().enumerate().step_by(7) {
            let grown = sum(i, 0.0) - sum(i, dt) + dt * k.divergence;
            worst[0] = worst[0].max(grown.abs());
            worst[1] = worst[1].max((grown + 0.5 * dt * dt * k.curvature).abs());
        }
        worst
    };
    let (coarse, fine) = (missed(2e-4), missed(1e-4));
    println!("without {coarse:?}, with {fine:?}");
    assert!((coarse[0] / fine[0] - 4.0).abs() < 0.4);
    assert!((coarse[1] / fine[1] - 8.0).abs() < 0.8);
}

/// Two fluids all mixed up, and both with sand, in the plane and as rings; all turn.
#[test]
fn the_viscous_operator_is_symmetric_where_materials_meet() {
    let plane = Geometry::Planar { width: 0.3 };
    for (geometry, count) in [(plane, 3), (plane, 2), (Geometry::Axisymmetric, 3)] {
        let (mut solver, mut state) = disordered::<2>(clay(), geometry, 20);
        let thick = Viscous {
            consistency: 5.0,
            flow_index: 1.0,
        };
        let sand = Material::sand_04();
        let rho = 1.01 * sand.rest_density() / 1540.0;
        solver.materials = vec![clay(), Material::fluid(1540.0, thick, 0.0), sand];
        solver.materials.truncate(count);
        solver.has_meetings = true;
        solver.turns.resize(solver.turns.len() * count, true);
        solver.slides.clear();
        let grains = &mut state.grains;
        for i in 0..grains.len() {
            grains.phase[i] = (grains.id[i] % count as u64) as u8;
            if grains.phase[i] == 2 {
                grains.density[i] *= rho;
                grains.mass[i] *= rho;
            }
        }
        solver.start(&mut state);
        solver.sweep_pressure(&state, 1e-4);
        let blocks = &solver.lists.blocks;
        for kind in 0..if count == 3 { 4 } else { 2 } {
            let rows = blocks
                .iter()
                .map(|b| (0..b.rows()).map(|row| b.kinds(row)[kind].len()));
            assert!(rows.flatten().sum::<usize>() > 100);
        }
        let n = state.grains.len();
        let (mut records, mut force) = (vec![Record::default(); n], vec![[0.0; 2]; n]);
        solver.stress(&state.grains.velocity, &mut records, false, &[]);
        solver.force(&records, &mut force, false, &[], |_, f| (*f, 0.0));
        // Rings keep momentum along their axis.
        let sum: f64 = force.iter().map(|f| f[1]).sum();
        let size: f64 = force.iter().map(|f| f[1].abs()).sum();
        close(sum, 0.0, size);
        let turn = solver.turning.iter().filter(|m| **m != [[0.0; 2]; 2]);
        assert_eq!(turn.count() > 100, geometry == plane);
        is_symmetric(&solver, &state.grains.velocity);
    }
}

/// a . F(b) = b . F(a), and a . F(a) < 0.
fn is_symmetric(solver: &Solver<2>, a: &[Vector<2>]) {
    let force = |v: &[Vector<2>]| {
        let (mut records, mut force) = (vec![Record::default(); v.len()], vec![[0.0; 2]; v.len()]);
        solver.stress(v, &mut records, false, &[]);
        solver.force(&records, &mut force, false, &[], |_, f| (*f, 0.0));
        force
    };
    let b: Vec<Vector<2>> = a.iter().rev().map(|v| [v[1], v[0]]).collect();
    let product = |a: &[Vector<2>], b: &[Vector<2>]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| a[0] * b[0] + a[1] * b[1])
            .sum()
    };
    let (fa, fb) = (force(a), force(&b));
    close(product(&fa, &b), product(&fb, a), product(&fa, a).abs());
    assert!(product(&fa, a) < 0.0 && product(&fb, &b) < 0.0);
}

fn steps_agree<const D: usize>(material: fn() -> Material, geometry: Geometry, count: usize) {
    let run = |arch: Arch| {
        let (mut solver, mut state) = disordered::<D>(material(), geometry, count);
        solver.arch = arch;
        let inputs = super::StepInputs {
            openings: &[],
            rates: &[],
            drives: &[],
        };
        solver.lower = [-1.0; D];
        solver.upper = [1.0; D];
        for _ in 0..5 {
            solver
                .step(&mut state, 1.0, &inputs, &mut |_, _| ())
                .unwrap();
        }
        state
    };
    assert_eq!(run(Arch::Portable), run(Arch::detect()));
}

#[test]
fn every_architecture_gives_the_same_bits() {
    for material in [Material::sand_04, clay] {
        steps_agree::<2>(material, Geometry::Planar { width: 0.3 }, 20);
        steps_agree::<2>(material, Geometry::Axisymmetric, 20);
        steps_agree::<3>(material, Geometry::Space, 9);
    }
}
