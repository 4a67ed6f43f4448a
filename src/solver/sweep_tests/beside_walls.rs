//! The sweeps beside walls: clay on a floor without slip, and a belt, a smooth face and a bend.

use super::{JITTER, clay, close, disordered_on, is_symmetric};
use crate::boundary::{GroupSpec, WallPoints};
use crate::material::Material;
use crate::math::{Geometry, Vector};
use crate::solver::Solver;
use crate::solver::record::Record;
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
