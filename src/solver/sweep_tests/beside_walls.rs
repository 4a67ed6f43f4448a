//! The sweeps beside walls: clay on a floor without slip, a belt, a smooth face and a bend, and sand on a smooth floor in space.

use super::{JITTER, clay, close, disordered_on, is_symmetric};
use crate::boundary::{GroupSpec, WallPoints};
use crate::material::Material;
use crate::math::{CHUNK, Geometry, Vector};
use crate::solver::Solver;
use crate::solver::record::Record;
use crate::solver::reflect::{reflected_divergence, reflected_pressure};
use crate::solver::sample::SPACING;
use crate::state::State;

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
        spin: [0.0; 3],
        drift: [0.0; 3],
    });
    let (mut solver, mut state) =
        disordered_on::<2>(clay(), Geometry::Planar { width: 0.3 }, 20, floor);
    for i in 0..state.grains.len() {
        let x = &mut state.grains.position[i];
        for c in x.iter_mut() {
            let even = ((*c / SPACING).floor() + 0.5) * SPACING;
            *c = even + jitter / JITTER * (*c - even);
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
            spin: [0.0; 3],
            drift: [0.0; 3],
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

/// Sand on a smooth floor in space: what images add to pressure and to div v is each the adjoint of the other, and works between
/// particles alone (docs/theory.md, W12).
#[test]
fn images_of_sand_in_a_smooth_floor_keep_momentum_and_energy() {
    let mut floor = WallPoints::default();
    for n in 0..8 * 14 * 4 {
        let place = |k: usize| (k as f64 + 0.5) * SPACING;
        let (x, y, z) = (n % 8, n / 8 % 14, n / 112);
        let at = [place(x), place(y) - 3.0 * SPACING, -place(z)];
        floor.push(at, [0.0; 3], [0.0, 0.0, 1.0], 1.0, 0);
    }
    floor.groups.push(GroupSpec {
        free_slip: true,
        friction: 0.0,
        moves: false,
        wants_force: false,
        spin: [0.0; 3],
        drift: [0.0; 3],
    });
    let (solver, state) = disordered_on::<3>(Material::sand_04(), Geometry::Space, 8, floor);
    let v = &state.grains.velocity;
    let pressure: Vec<f64> = v.iter().map(|v| 100.0 + v[0]).collect();
    let (mut push, mut power, mut seen) = ([0.0; 3], [0.0; 2], 0);
    for (b, block) in solver.lists.blocks.iter().enumerate() {
        for w in &block.wall_rows {
            let i = b * CHUNK + w.row as usize;
            let images = block.reflections_of(w);
            let force = reflected_pressure(images, i, &pressure);
            for k in 0..3 {
                push[k] -= solver.volume[i] * force[k];
                power[0] -= solver.volume[i] * force[k] * v[i][k];
            }
            power[1] += solver.volume[i] * pressure[i] * reflected_divergence(images, i, v);
            seen += images.len();
        }
    }
    assert!(seen > 1000, "{seen}");
    assert!(power[0].abs() > 1e-3, "{power:?}");
    close(power[0], power[1], 1e3);
    push.iter().for_each(|push| close(*push, 0.0, 1e3));
    // The whole of div v of a flow along the floor, with its acoustic steps.
    let mut found = Vec::new();
    solver.divergence(v, &mut found);
    for (found, k) in found.iter().zip(&solver.kinematics) {
        close(*found, k.divergence, 100.0);
    }
}
