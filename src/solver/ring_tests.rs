//! Rings: the discrete operator, and what is exact or nearly so beside the axis.

use super::numerics::YieldForm;
use super::record::Record;
use super::sample::{self, SPACING as DP};
use super::*;
use crate::boundary::{GroupSpec, polyline_points};
use crate::math::dot;
use crate::state::{Grains, Random, State};

const RADIUS: usize = 20;
const HEIGHT: usize = 20;

fn numerics() -> Numerics {
    Numerics {
        yield_form: YieldForm::Capped,
        cap_time: 20.0,
        diffusion_gate_time: 0.3,
        solver_max_iterations: 1000,
        jitter: 0.1,
        ..sample::numerics()
    }
}

/// A column of rings, compressed by 1 %, that moves as `velocity` says; on a floor if wanted.
fn column(
    jitter: f64,
    floor: bool,
    velocity: impl Fn(&Vector<2>) -> Vector<2>,
) -> (Solver<2>, State<2>) {
    let material = Material::sand_04();
    let density = 1.01 * material.rest_density();
    let mut random = Random::new(7);
    let mut grains = Grains {
        implicit: true,
        ..Grains::default()
    };
    for b in 0..HEIGHT {
        for a in 0..RADIUS {
            let mut x = [(a as f64 + 0.5) * DP, (b as f64 + 0.5) * DP];
            let mass = density * DP * DP * std::f64::consts::TAU * x[0];
            for c in &mut x {
                *c += jitter * DP * random.symmetric();
            }
            let v = velocity(&x);
            grains.push((b * RADIUS + a) as u64, 0, x, v, mass, density);
        }
    }
    let mut walls = WallPoints::default();
    walls.groups.push(GroupSpec {
        free_slip: false,
        friction: 0.0,
        moves: false,
        wants_force: false,
        spin: [0.0; 3],
        drift: [0.0; 3],
    });
    if floor {
        for (x, normal, weight) in polyline_points(&[[0.0, 0.0], [1.0, 0.0]], false, DP) {
            walls.push(x, [0.0; 2], normal, weight, 0);
        }
    }
    let plan = Plan {
        numerics: numerics(),
        lower: [0.0, -1.0],
        walls,
        ..sample::plan(material, Geometry::Axisymmetric, [1.0, 1.0])
    };
    let mut state = State {
        impulse: vec![[0.0; 2]],
        ..sample::at_start(grains, random)
    };
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    (solver, state)
}

/// Viscous force of the velocities `v` at the viscosities of the state.
fn force(solver: &Solver<2>, v: &[Vector<2>]) -> Vec<Vector<2>> {
    let mut records = vec![Record::default(); v.len()];
    let mut force = vec![[0.0; 2]; v.len()];
    solver.stress(v, &mut records, false, &[]);
    solver.force(&records, &mut force, false, &[], |_, f| (*f, 0.0));
    force
}

fn product(a: &[Vector<2>], b: &[Vector<2>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

#[test]
fn the_viscous_operator_is_symmetric_and_dissipates() {
    for floor in [false, true] {
        let (mut solver, state) = column(0.1, floor, |x| [x[1] - 0.3 * x[0], 0.5 * x[0]]);
        assert!(solver.viscosity.iter().filter(|e| **e > 0.0).count() > 300);
        solver.sweep_pressure(&state, 1e-3);
        let mut random = Random::new(3);
        let mut field = || -> Vec<Vector<2>> {
            (0..state.grains.len())
                .map(|_| [random.symmetric(), random.symmetric()])
                .collect()
        };
        let (u, v) = (field(), field());
        let (fu, fv) = (force(&solver, &u), force(&solver, &v));
        let (uv, vu) = (product(&u, &fv), product(&v, &fu));
        let scale = product(&u, &fu).abs();
        assert!((uv - vu).abs() < 1e-12 * scale, "{uv} {vu}");
        assert!(product(&u, &fu) < 0.0 && product(&v, &fv) < 0.0);
        // One ring at the axis moves alone: its own hoop strain resists.
        let axis = (0..u.len())
            .min_by(|&a, &b| {
                let r = |i: usize| state.grains.position[i][0];
                r(a).total_cmp(&r(b))
            })
            .unwrap();
        let mut alone = vec![[0.0; 2]; u.len()];
        alone[axis][0] = 1.0;
        assert!(force(&solver, &alone)[axis][0] < 0.0);
    }
}

#[test]
fn a_translation_along_the_axis_makes_no_stress() {
    let (mut solver, state) = column(0.1, false, |x| [0.1 * x[0], 0.7]);
    solver.sweep_pressure(&state, 1e-3);
    let v = vec![[0.0, 2.5]; state.grains.len()];
    let still = force(&solver, &v);
    let moving = force(&solver, &state.grains.velocity);
    assert!(product(&moving, &moving) > 0.0);
    assert!(still.iter().flatten().all(|f| *f == 0.0));
}

/// Largest error over rings in the interior, by distance from the axis: (first two rows, farther).
fn errors(state: &State<2>, error: impl Fn(usize) -> f64) -> (f64, f64) {
    let mut worst = (0.0f64, 0.0f64);
    for (i, x) in state.grains.position.iter().enumerate() {
        let inner = x[0] < (RADIUS as f64 - 4.0) * DP
            && (4.0 * DP..(HEIGHT as f64 - 4.0) * DP).contains(&x[1]);
        if inner && x[0] < 2.0 * DP {
            worst.0 = worst.0.max(error(i));
        } else if inner {
            worst.1 = worst.1.max(error(i));
        }
    }
    worst
}

/// v = (a r, -2 a z): no divergence, gamma = a sqrt(12).
#[test]
fn a_radial_flow_has_its_strain_rate_up_to_the_axis() {
    let a = 0.3;
    let (solver, state) = column(0.0, false, |x| [a * x[0], -2.0 * a * x[1]]);
    let divergence = errors(&state, |i| (solver.kinematics[i].divergence / a).abs());
    let shear = errors(&state, |i| {
        (solver.kinematics[i].shear / (a * 12f64.sqrt()) - 1.0).abs()
    });
    println!("divergence/a {divergence:?}, shear {shear:?}");
    // The kernel's sums over a lattice at h/dp 1.6 are off by 0.4 %; beside the axis G_zz is off by 1.5 % more and
    // G_rr by 10 %, the price of an adjoint that balances pressure.
    assert!(divergence.0 < 0.01 && divergence.1 < 0.01, "{divergence:?}");
    assert!(shear.0 < 0.05 && shear.1 < 0.01, "{shear:?}");
}

/// Under uniform pressure a ring stays where it is, also at the axis: what pushes it is the error of the kernel's sums
/// over a lattice, small against the p/(rho r) of an unbalanced hoop pressure.
#[test]
fn uniform_pressure_pushes_no_ring_from_the_axis() {
    let (mut solver, state) = column(0.0, false, |_| [0.0, 0.0]);
    let p = 1000.0;
    solver.pressure.iter_mut().for_each(|q| *q = p);
    let dt = 1e-3;
    solver.sweep_pressure(&state, dt);
    let worst = errors(&state, |i| {
        let x = &state.grains.position[i];
        let push = solver.prediction[i].velocity[0].abs() / dt;
        push * state.grains.density[i] * x[0] / p
    });
    println!("push over p/(rho r) {worst:?}");
    assert!(worst.0 < 0.01 && worst.1 < 0.01, "{worst:?}");
}

/// A ring that has slipped outwards on the floor is pushed back as hard as one in the bulk, and not into the floor.
#[test]
fn a_ring_in_the_corner_of_axis_and_floor_is_held() {
    let push = |row: u64| {
        let (mut solver, mut state) = column(0.0, true, |_| [0.0, 0.0]);
        solver.gravity = [0.0; 2];
        let ring = |s: &State<2>| {
            let found = s.grains.id.iter().position(|id| *id == row * RADIUS as u64);
            found.unwrap()
        };
        let k = ring(&state);
        state.grains.position[k][0] += 0.1 * DP;
        solver.start(&mut state);
        let k = ring(&state);
        let p = 1000.0;
        solver.pressure.iter_mut().for_each(|q| *q = p);
        solver.sweep_pressure(&state, 1e-3);
        let scale = state.grains.density[k] * DP / (p * 1e-3);
        solver.prediction[k].velocity.map(|v| v * scale)
    };
    let (corner, bulk) = (push(0), push(10));
    println!("corner {corner:?} bulk {bulk:?}");
    assert!(bulk[0] < -0.05 && (corner[0] / bulk[0] - 1.0).abs() < 0.1);
    assert!(corner[1].abs() < 0.01);
}

/// Shifts of rings that stand evenly are small against the speeds that make them, also beside the axis; a ring that left its place
/// there goes back.
#[test]
fn shifting_sees_what_is_across_the_axis() {
    let shift = |out: f64| {
        let rate = 0.3;
        let (mut solver, mut state) = column(0.0, false, |x| [rate * x[0], -2.0 * rate * x[1]]);
        let mid = (HEIGHT / 2 * RADIUS) as u64;
        let place = |s: &State<2>| s.grains.id.iter().position(|id| *id == mid).unwrap();
        let k = place(&state);
        state.grains.position[k][0] += out * DP;
        solver.start(&mut state);
        solver.materials[0] = Material::fluid(1000.0, crate::material::Viscous::NONE, 0.0);
        solver.numerics.shifting = 1.0;
        solver.find_shift(&state, 1e-4);
        let speed = rate * solver.kernel.support();
        let size = |i: usize| dot(&solver.shift[i], &solver.shift[i]).sqrt() / speed;
        let shifted = solver.shift.iter().filter(|du| du[1] != 0.0).count();
        let back = solver.shift[place(&state)][0] / speed;
        (errors(&state, size), back, shifted)
    };
    let (even, _, shifted) = shift(0.0);
    println!("even {even:?}, {shifted} are shifted");
    assert!(shifted > RADIUS * HEIGHT / 4);
    assert!(even.0 < 0.02 && even.1 < 0.02, "{even:?}");
    let (_, back, _) = shift(0.05);
    println!("back {back}");
    assert!(back < -0.05, "{back}");
}
