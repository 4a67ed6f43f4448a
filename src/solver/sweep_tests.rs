//! The sweeps in lanes against the plain ones, and both architectures against each other.

use crate::boundary::{GroupSpec, WallPoints};
use crate::material::{Material, Viscous};
use crate::math::{Arch, Geometry, Tensor, Vector};
use crate::state::{Grains, PoseTimes, Random, RestState, State};

use super::plain::PlainPairs;
use super::pressure::Prediction;
use super::record::Record;
use super::{Numerics, Periodic, Plan, Scheme, Solver, YieldForm};

const SPACING: f64 = 0.01;

fn numerics() -> Numerics {
    Numerics {
        spacing: SPACING,
        smoothing_ratio: 1.6,
        sound_speed: 20.0,
        scheme: Scheme::Implicit,
        courant: 0.5,
        acoustic_steps: 1,
        yield_form: YieldForm::Exact { iterations: 1 },
        cap_time: 4.0,
        density_diffusion: 0.1,
        diffusion_gate_time: 1.0,
        strain_relaxation_time: 0.05,
        pair_viscosity_share: 0.05,
        artificial_viscosity: 0.0,
        shifting: 0.0,
        solver_tolerance: 3e-4,
        solver_max_iterations: 500,
        sleep: false,
        seepage_interval: 1,
        jitter: 0.0,
        seed: 1,
    }
}

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
    let mut random = Random::new(11);
    let mut grains = Grains {
        implicit: true,
        exact_yield: true,
        ..Grains::default()
    };
    let periodic = !geometry.is_axisymmetric();
    let rho = 1.01 * material.rest_density();
    for n in 0..count.pow(D as u32) {
        let mut m = n;
        let mut x = [0.0; D];
        for c in &mut x {
            *c = ((m % count) as f64 + 0.5 + 0.3 * random.symmetric()) * SPACING;
            m /= count;
        }
        let mut v = [0.0; D];
        for c in &mut v {
            *c = random.symmetric();
        }
        let across = geometry.length_across(&x, 0.0);
        grains.push(
            n as u64,
            0,
            x,
            v,
            rho * across * SPACING.powi(D as i32),
            rho,
        );
    }
    let length = count as f64 * SPACING;
    let plan = Plan {
        numerics: numerics(),
        gravity: std::array::from_fn(|k| if k == 1 { -9.81 } else { 0.0 }),
        geometry,
        lower: [0.0; D],
        upper: [length; D],
        periodic: Periodic {
            lower: [0.0; D],
            length: std::array::from_fn(|k| if k == 0 && periodic { length } else { 0.0 }),
        },
        materials: vec![material],
        walls,
        ghost_depth: Vec::new(),
        movers: Vec::new(),
        plates: Vec::new(),
        sources: Vec::new(),
        sinks: Vec::new(),
    };
    let mut state = State {
        time: 0.0,
        initial_mass: grains.present_mass(),
        grains,
        pose: PoseTimes::default(),
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
    };
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    (solver, state)
}

fn close(a: f64, b: f64, scale: f64) {
    assert!((a - b).abs() <= 1e-12 * scale, "{a} {b} at {scale}");
}

fn agrees<const D: usize>(material: Material, geometry: Geometry, count: usize) {
    let (mut solver, state) = disordered::<D>(material, geometry, count);
    let n = state.grains.len();
    let mut pairs = PlainPairs::default();
    let rows = solver.plain_pairs(&state, &mut pairs);
    assert!(pairs.count() > 10 * n);
    for (row, kinematics) in rows.iter().zip(&solver.kinematics) {
        close(row.speed2.sqrt(), kinematics.relative_speed, 3.0);
    }
    // The plain way through the rest of a row gives what the sweep gave, to rounding.
    for (i, row) in rows.iter().enumerate() {
        let plain = solver.finish(row, state.grains.phase[i], i, &state.grains.velocity[i]);
        let fast = &solver.kinematics[i];
        close(plain.divergence, fast.divergence, 1e3);
        close(plain.shear, fast.shear, 1e3);
        close(plain.correction, fast.correction, 1e2);
        close(plain.pair_scale, fast.pair_scale, 1e2);
        close(plain.looseness, fast.looseness, 1e2);
    }
    solver.sweep_pressure(&state, 1e-4);
    let slides = solver.materials[0].is_fluid() && !solver.geometry.is_axisymmetric();
    let uneven = solver.uneven_pressure.as_flattened().as_flattened();
    assert_eq!(uneven.iter().any(|p| *p != 0.0), slides);
    let mut plain = vec![Prediction::default(); n];
    solver.plain_pressure(&state, &pairs, 1e-4, &mut plain);
    for (plain, fast) in plain.iter().zip(&solver.prediction) {
        for (a, b) in fast.velocity.iter().zip(&plain.velocity) {
            close(*a, *b, 3.0);
        }
    }
    let mut gradients: Vec<Tensor<D>> = vec![[[0.0; D]; D]; n];
    let v = &state.grains.velocity;
    solver.plain_gradients(&pairs, v, &mut gradients);
    let tau: Vec<Tensor<D>> = (0..n)
        .map(|i| solver.row_stress(i, &v[i], &gradients[i]))
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
    let (mut plain, mut fast): (Vec<Vector<D>>, _) = (vec![[0.0; D]; n], vec![[0.0; D]; n]);
    solver.plain_forces(&pairs, v, &tau, &mut plain);
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
    for material in [Material::sand_04, clay] {
        agrees::<2>(material(), Geometry::Planar { width: 0.3 }, 20);
        agrees::<2>(material(), Geometry::Axisymmetric, 20);
        agrees::<3>(material(), Geometry::Space, 9);
    }
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

/// Clay on a floor without slip, displaced by up to `jitter` dp, at velocities `motion(x, noise)`.
fn on_floor(
    jitter: f64,
    motion: impl Fn(&Vector<2>, &Vector<2>) -> Vector<2>,
) -> (Solver<2>, State<2>) {
    let mut floor = WallPoints::default();
    for n in 0..80 {
        let place = |k: usize| (k as f64 + 0.5) * SPACING;
        floor.push(
            [place(n % 20), -place(n / 20)],
            [0.0; 2],
            [0.0, 1.0],
            1.0,
            0,
        );
    }
    floor.groups.push(GroupSpec {
        free_slip: false,
        friction: 0.0,
        moves: false,
        wants_force: false,
    });
    let (mut solver, mut state) =
        disordered_on::<2>(clay(), Geometry::Planar { width: 0.3 }, 20, floor);
    for i in 0..state.grains.len() {
        let x = &mut state.grains.position[i];
        for c in x.iter_mut() {
            let even = ((*c / SPACING).floor() + 0.5) * SPACING;
            *c = even + jitter / 0.3 * (*c - even);
        }
        let x = *x;
        state.grains.velocity[i] = motion(&x, &state.grains.velocity[i]);
    }
    solver.start(&mut state);
    (solver, state)
}

/// The end of a belt, a smooth face and a bend in it: what acoustic steps make of a velocity is what the step itself does.
#[test]
fn acoustic_steps_have_the_steps_own_divergence_beside_walls() {
    let mut walls = WallPoints::default();
    let root = 0.5f64.sqrt();
    for n in 0..80 {
        let place = |k: usize| (k as f64 + 0.5) * SPACING;
        let (velocity, normal, group) = match n % 20 {
            0..8 => ([3.0, 0.0], [0.0, 1.0], 0),
            8..14 => ([0.0; 2], [0.0, 1.0], 1),
            _ => ([0.0; 2], [root, root], 1),
        };
        walls.push(
            [place(n % 20), -place(n / 20)],
            velocity,
            normal,
            1.0,
            group,
        );
    }
    for free_slip in [false, true] {
        walls.groups.push(GroupSpec {
            free_slip,
            friction: 0.0,
            moves: false,
            wants_force: false,
        });
    }
    let plane = Geometry::Planar { width: 0.3 };
    let (solver, state) = disordered_on::<2>(Material::sand_04(), plane, 20, walls);
    let mut found = Vec::new();
    solver.divergence(&state.grains.velocity, &mut found);
    let seen = solver.lists.blocks.iter().map(|b| b.wall_rows.len());
    assert!(seen.sum::<usize>() > 50);
    for (found, k) in found.iter().zip(&solver.kinematics) {
        close(*found, k.divergence, 100.0);
    }
}

#[test]
fn a_linear_shear_flow_over_a_floor_has_its_rate_in_every_row() {
    let (solver, state) = on_floor(0.0, |x, _| [3.0 * x[1], 0.0]);
    let mut rows = 0;
    for (x, k) in state.grains.position.iter().zip(&solver.kinematics) {
        if x[1] < 0.15 {
            let rate = k.correction * k.shear;
            assert!((rate / 3.0 - 1.0).abs() < 2e-3, "{rate} at {x:?}");
            rows += 1;
        }
    }
    assert_eq!(rows, 300);
}

#[test]
fn the_pair_form_over_a_floor_leaves_a_linear_shear_flow_alone() {
    let rate = 3.0;
    let (mut solver, state) = on_floor(0.0, |x, _| [rate * x[1], 0.0]);
    // All of the viscosity by pairs, and the same everywhere.
    solver.numerics.pair_viscosity_share = 1.0;
    solver.pair_viscosity.fill(1.0);
    solver.sweep_pressure(&state, 1e-4);
    let n = state.grains.len();
    let (mut records, mut force) = (vec![Record::default(); n], vec![[0.0; 2]; n]);
    solver.stress(&state.grains.velocity, &mut records, false, &[]);
    solver.force(&records, &mut force, false, &[], |_, f| (*f, 0.0));
    let shear = |i: usize| rate / SPACING * solver.width * solver.volume[i];
    let rows: Vec<usize> = (0..n)
        .filter(|&i| state.grains.position[i][1] < 0.15)
        .collect();
    assert_eq!(rows.len(), 300);
    for i in rows {
        let off = force[i][0] / shear(i);
        assert!(
            off.abs() < 5e-3,
            "{off} of a row's shear at {:?}",
            state.grains.position[i]
        );
    }
}

#[test]
fn the_viscous_operator_over_a_floor_is_symmetric() {
    let (mut solver, state) = on_floor(0.2, |_, noise| *noise);
    solver.sweep_pressure(&state, 1e-4);
    let images: usize = solver.lists.blocks.iter().map(|b| b.images.len()).sum();
    assert!(images > 300, "{images}");
    is_symmetric(&solver, &state.grains.velocity);
}

/// Sand, clay and water all mixed up, in the plane and as rings.
#[test]
fn the_viscous_operator_is_symmetric_where_materials_meet() {
    for geometry in [Geometry::Planar { width: 0.3 }, Geometry::Axisymmetric] {
        let (mut solver, mut state) = disordered::<2>(clay(), geometry, 20);
        let thick = Viscous {
            consistency: 5.0,
            flow_index: 1.0,
        };
        let sand = Material::sand_04();
        let rho = 1.01 * sand.rest_density() / 1540.0;
        solver.materials = vec![clay(), Material::fluid(1540.0, thick, 0.0), sand];
        solver.has_meetings = true;
        solver.slides.clear();
        let grains = &mut state.grains;
        for i in 0..grains.len() {
            grains.phase[i] = (grains.id[i] % 3) as u8;
            if grains.phase[i] == 2 {
                grains.density[i] *= rho;
                grains.mass[i] *= rho;
            }
        }
        solver.start(&mut state);
        solver.sweep_pressure(&state, 1e-4);
        let blocks = &solver.lists.blocks;
        for kind in 0..4 {
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
