//! Mass, momentum, frames of reference, rest.

use super::{Unit, case};
use sandgate::scene::{self, Scene};
use sandgate::solver::{PaperA, Scheme, Solver, StepInputs, Sweeps};
use sandgate::state::State;

const CASES: [&str; 7] = [
    "chute_inflow",
    "column_collapse",
    "column_collapse_3d",
    "column_collapse_axisymmetric",
    "hydrostatic",
    "inclined_plane",
    "silo_gate",
];

/// The ledger is checked by `Unit::step` after every communication step, devices wide open.
#[test]
fn mass_is_exact_in_every_case() {
    for name in CASES {
        let mut unit = Unit::new(&case(name, &[]));
        let inputs: Vec<(String, f64)> = unit
            .component
            .variables()
            .rows()
            .iter()
            .filter(|v| v.causality == sandgate::component::Causality::Input)
            .map(|v| (v.name.clone(), v.range.map_or(1.0, |r| r.1)))
            .collect();
        for (input, most) in &inputs {
            unit.set(input, *most);
        }
        unit.run_to(if name == "column_collapse_3d" {
            0.02
        } else {
            0.1
        });
        assert!(unit.get("mass.present") > 0.0 || name == "chute_inflow");
    }
}

/// A block that turns and shears in free space, at a solver tolerance of 1e-2.
fn block(velocity: [f64; 2]) -> Scene {
    let text = format!(
        r#"
name = "block"
title = "An isolated block"
dimension = 2
[domain]
lower = [-20, -20]
upper = [20, 20]
gravity = 0
[numerics]
spacing = 0.01
sound_speed = 20
solver_tolerance = 1e-2
[materials.sand]
law = "mu_i"
preset = "sand_08"
[bodies.left]
material = "sand"
box = {{ lower = [-0.1, -0.1], upper = [0, 0.1] }}
velocity = [{}, {}]
[bodies.right]
material = "sand"
box = {{ lower = [0, -0.1], upper = [0.1, 0.1] }}
velocity = [{}, {}]
[run]
step = 0.01
until = 0.1
"#,
        velocity[0] + 0.6,
        velocity[1] + 0.3,
        velocity[0] - 0.5,
        velocity[1] - 0.2,
    );
    scene::parse("block.toml", &text).unwrap()
}

/// Runs a scene without devices in the plane for `time` [s] and gives its state.
fn run(scene: &Scene, time: f64) -> (State<2>, State<2>) {
    let (plan, mut state) = scene::build::<2>(scene).unwrap();
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    let start = state.clone();
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    while state.time < time {
        solver
            .step(&mut state, time, &inputs, &mut |_, _| {})
            .unwrap();
    }
    (start, state)
}

/// Sum m v and sum m |v|.
fn momentum(state: &State<2>) -> ([f64; 2], f64) {
    let mut sum = [0.0; 2];
    let mut scale = 0.0;
    for (m, v) in state.grains.mass.iter().zip(&state.grains.velocity) {
        for (s, c) in sum.iter_mut().zip(v) {
            *s += m * c;
            scale += m * c.abs();
        }
    }
    (sum, scale)
}

/// Kinetic energy [J].
fn kinetic_energy(state: &State<2>) -> f64 {
    let parts = state.grains.mass.iter().zip(&state.grains.velocity);
    parts
        .map(|(m, v)| 0.5 * m * (v[0] * v[0] + v[1] * v[1]))
        .sum()
}

/// 1e-12 of sum m |v| over some 100 steps: rounding, although the solve stops at 1e-2.
#[test]
fn an_isolated_body_keeps_its_momentum_at_a_loose_tolerance() {
    let (start, end) = run(&block([0.0, 0.0]), 0.1);
    assert!(
        end.steps > 50 && end.iterations > 20,
        "{} steps, {} iterations",
        end.steps,
        end.iterations
    );
    let ((before, scale), (after, _)) = (momentum(&start), momentum(&end));
    for k in 0..2 {
        let drift = (after[k] - before[k]).abs() / scale;
        assert!(drift < 1e-12, "axis {k}: {drift}");
    }
    assert!(
        kinetic_energy(&end) < kinetic_energy(&start),
        "friction creates no energy"
    );
}

/// Two materials with sound speeds of their own meet: artificial viscosity is that of the pair.
#[test]
fn materials_of_other_sound_speeds_keep_their_momentum() {
    let mut scene = block([0.0, 0.0]);
    scene.numerics.artificial_viscosity = 0.05;
    let mut stiff = scene.materials[0].clone();
    stiff.name = "stiff".to_owned();
    stiff.material.sound_speed = Some(35.0);
    scene.materials.push(stiff);
    scene.bodies[1].material = 1;
    let (start, end) = run(&scene, 0.05);
    let ((before, scale), (after, _)) = (momentum(&start), momentum(&end));
    for k in 0..2 {
        let drift = (after[k] - before[k]).abs() / scale;
        println!("axis {k}: {drift:.1e}");
        assert!(drift < 1e-12, "axis {k}: {drift}");
    }
}

/// Artificial viscosity and scheme `paper_a` act pair by pair too.
#[test]
fn every_scheme_keeps_momentum_and_loses_energy() {
    let mut scene = block([0.0, 0.0]);
    scene.numerics.artificial_viscosity = 0.05;
    let (_, damped) = run(&scene, 0.01);
    scene.numerics.artificial_viscosity = 0.0;
    scene.numerics.scheme = Scheme::PaperA(PaperA {
        reference_yield_stress: 500.0,
        scaling_time: 1.0,
        ghost_velocity_factor: 1.5,
        sweeps: Sweeps::Lanes,
    });
    let (start, explicit) = run(&scene, 0.01);
    let (before, scale) = momentum(&start);
    for (name, end) in [("artificial viscosity", &damped), ("paper_a", &explicit)] {
        let (after, _) = momentum(end);
        for k in 0..2 {
            assert!(
                (after[k] - before[k]).abs() < 1e-12 * scale,
                "{name}, axis {k}"
            );
        }
        assert!(kinetic_energy(end) < kinetic_energy(&start), "{name}");
    }
    let (_, plain) = run(&block([0.0, 0.0]), 0.01);
    assert_ne!(
        plain.grains.velocity, damped.grains.velocity,
        "the switch does something"
    );
    assert!(
        explicit.steps > 2 * plain.steps,
        "explicit viscosity bounds the step"
    );
}

/// The same collision seen from a frame that moves at 100 m/s: velocities agree to rounding of 100 m/s, grown a little
/// by the flow.
#[test]
fn a_moving_frame_sees_the_same_flow() {
    let (_, rest) = run(&block([0.0, 0.0]), 0.01);
    let (_, moving) = run(&block([100.0, 0.0]), 0.01);
    assert_eq!(rest.steps, moving.steps);
    let mut found: Vec<_> = moving
        .grains
        .id
        .iter()
        .zip(&moving.grains.velocity)
        .collect();
    found.sort_by_key(|(id, _)| **id);
    let mut expected: Vec<_> = rest.grains.id.iter().zip(&rest.grains.velocity).collect();
    expected.sort_by_key(|(id, _)| **id);
    let worst = found
        .iter()
        .zip(&expected)
        .map(|((_, a), (_, b))| (a[0] - 100.0 - b[0]).abs().max((a[1] - b[1]).abs()))
        .fold(0.0, f64::max);
    println!("largest difference {worst:.1e} m/s");
    assert!(worst < 1e-8, "{worst}");
}

/// Enough particles that sweeps really are shared out.
#[test]
fn the_silo_has_the_same_bits_on_any_number_of_threads() {
    let scene = case("silo_gate", &[]);
    let hash = |threads| {
        let mut unit = Unit::new(&scene);
        assert!(unit.get("solver.particles") > 4000.0);
        unit.component.set_threads(threads);
        unit.set("gate.main.opening", 1.0);
        unit.run_to(0.02);
        unit.component.state_hash()
    };
    let one = hash(1);
    assert_eq!(one, hash(2));
    assert_eq!(one, hash(3));
}

/// Sand in a box stays where it is: pressure of the depth, weight on the floor, depth kept.
#[test]
fn sand_at_rest_stays_at_rest() {
    let scene = case("hydrostatic", &[]);
    let mut unit = Unit::new(&scene);
    let depth: Vec<String> = unit
        .component
        .variables()
        .rows()
        .iter()
        .filter(|v| v.name.ends_with(".depth"))
        .map(|v| v.name.clone())
        .collect();
    unit.run_to(0.3);
    let before: Vec<f64> = depth.iter().map(|n| unit.get(n)).collect();
    unit.run_to(1.3);
    assert!(!depth.is_empty());
    for (name, h) in depth.iter().zip(before) {
        // A hundredth of a spacing in a second: 10 sqrt(H/g).
        let sunk = (unit.get(name) - h).abs();
        assert!(
            sunk < 0.01 * scene.numerics.spacing,
            "{name} moved by {sunk} m"
        );
    }
    let speed = unit.component.statistics().max_speed;
    assert!(speed < 1e-3 * (9.81_f64 * 0.1).sqrt(), "{speed} m/s");
}

/// A column of grains without a length or time of their own, and one four times as high: with lengths over H and times over sqrt(H/g)
/// they are the same, of which rounding knows nothing either, four being a power of two.
#[test]
fn columns_of_all_sizes_are_alike() {
    let front = |size: f64| {
        let at = |x: f64| x * size;
        let text = format!(
            r#"
name = "column"
[domain]
lower = [{}, {}]
upper = [{}, {}]
[numerics]
spacing = {}
[materials.grains]
law = "constant_friction"
friction_angle = "30 deg"
density = 1600
[bodies.column]
material = "grains"
box = {{ lower = [0, 0], upper = [{}, {}] }}
[walls.tank]
polyline = [[0, {}], [0, 0], [{}, 0]]
[gauges.front]
kind = "front"
origin = [0, 0]
direction = [1, 0]
[run]
step = {}
until = {}
"#,
            at(-0.125),
            at(-0.125),
            at(1.0),
            at(0.25),
            at(1.0 / 128.0),
            at(0.125),
            at(0.125),
            at(0.25),
            at(1.0),
            0.03125 * size.sqrt(),
            0.5 * size.sqrt(),
        );
        let mut unit = Unit::new(&sandgate::scene::parse("column", &text).unwrap());
        unit.run_to(0.5 * size.sqrt());
        unit.get("gauge.front.front") / size
    };
    let (small, large) = (front(1.0), front(4.0));
    println!("front {small} and {large}");
    assert!((large / small - 1.0).abs() < 1e-6, "{small} and {large}");
}
