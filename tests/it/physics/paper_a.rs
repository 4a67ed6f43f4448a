//! Scheme `paper_a`: what its equations must give, in runs of seconds. Its cases are too long for tests.

use super::{Unit, case};
use sandgate::material::{Material, Rheology};
use sandgate::math::Vector;
use sandgate::scene::{self, Scene};
use sandgate::solver::{Plan, Scheme, Solver, StepInputs};
use sandgate::state::State;

/// Spacing of the square [m].
const DP: f64 = 0.005;

/// A square of 0.2 m, periodic in x and y, without gravity, pressed to `pressure` [Pa], on a lattice of 40 x 40.
fn periodic_square(smoothing_ratio: f64, pressure: f64, edits: &str) -> (Plan<2>, State<2>) {
    let text = format!(
        r#"
name = "square"
dimension = 2
[domain]
lower = [0, 0]
upper = [0.2, 0.2]
periodic = ["x", "y"]
gravity = 0
[numerics]
scheme = "paper_a"
spacing = {DP}
smoothing_ratio = {smoothing_ratio}
jitter = 0
reference_yield_stress = "500 Pa"
{edits}
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.all]
material = "sand"
box = {{ lower = [0, 0], upper = [0.2, 0.2] }}
[run]
step = 0.01
until = 0.1
"#
    );
    let scene = scene::parse("square.toml", &text).unwrap();
    let (plan, mut state) = scene::build::<2>(&scene).unwrap();
    let c2 = plan.numerics.sound_speed.powi(2);
    for rho in &mut state.grains.density {
        *rho += pressure / c2;
    }
    state.grains.swept_density.clone_from(&state.grains.density);
    (plan, state)
}

/// Steps to `time`; returns the number of steps.
fn advance<const D: usize>(plan: Plan<D>, state: &mut State<D>, time: f64) -> u64 {
    let mut solver = Solver::new(plan, 1);
    solver.start(state);
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    while state.time < time {
        solver.step(state, time, &inputs, &mut |_, _| {}).unwrap();
    }
    state.steps
}

/// sum m v sin(k y) [kg m/s].
fn shear_wave(state: &State<2>, k: f64) -> f64 {
    let grains = &state.grains;
    let parts = grains
        .mass
        .iter()
        .zip(&grains.velocity)
        .zip(&grains.position);
    parts.map(|((m, v), x)| m * v[0] * (k * x[1]).sin()).sum()
}

/// v = U sin(k y) decays as exp(-k^2 eta t/rho) where the viscosity is the largest of the regularised law: the shear is too
/// slow to lower it. On a square lattice the pair form transmits the share 8/k^2 sum dp^2 |F| (x/r)^2 (1 - cos k y) of it:
/// too little, and the less so the wider the kernel.
#[test]
fn a_shear_wave_decays_by_the_viscosity() {
    let pressure = 500.0;
    let k = std::f64::consts::TAU / 0.2;
    let shares = [1.3, 1.6, 2.0, 2.5].map(|smoothing| {
        let edits = "sound_speed = 20\nscaling_time = \"0.1 s\"";
        let (plan, mut state) = periodic_square(smoothing, pressure, edits);
        for (v, x) in state.grains.velocity.iter_mut().zip(&state.grains.position) {
            v[0] = 1e-5 * (k * x[1]).sin();
        }
        let rho = state.grains.density[0];
        let eta = plan.materials[0].regularised_viscosity(0.0, pressure, 0.1, 500.0);
        let before = shear_wave(&state, k);
        let steps = advance(plan, &mut state, 0.5 * rho / (eta * k * k));
        let share = (before / shear_wave(&state, k)).ln() / 0.5;
        let lattice = share_on_a_lattice(DP, smoothing * DP, k);
        println!(
            "h/dp {smoothing}: {share:.4} of eta in {steps} steps, on the lattice {lattice:.4}"
        );
        assert!((share - lattice).abs() < 5e-3, "{share} {lattice}");
        share
    });
    assert!(shares.is_sorted(), "{shares:?}");
    assert!(shares[3] > 0.95 && shares[3] < 1.0, "{shares:?}");
}

/// Share of the viscosity of a shear wave along an axis of a square lattice that the pair form transmits.
fn share_on_a_lattice(dp: f64, h: f64, k: f64) -> f64 {
    // F = W'(r)/r of Wendland's C2 in the plane.
    let f = |r: f64| -35.0 / (4.0 * std::f64::consts::PI * h.powi(4)) * (1.0 - 0.5 * r / h).powi(3);
    let mut sum = 0.0;
    for i in -9..=9 {
        for j in -9..=9 {
            let (x, y) = (f64::from(i) * dp, f64::from(j) * dp);
            let r = x.hypot(y);
            if r > 0.0 && r < 2.0 * h {
                sum -= f(r) * (x / r).powi(2) * (1.0 - (k * y).cos());
            }
        }
    }
    8.0 * dp * dp * sum / (k * k)
}

/// The step is of second order, and near reversible: a pressure wave stepped at dt, dt/2 and dt/4.
#[test]
fn verlet_steps_converge_at_second_order() {
    let end = |courant: f64| -> Vec<Vector<2>> {
        let edits = format!("sound_speed = 20\nscaling_time = \"1e-6 s\"\ncourant = {courant}");
        let (plan, mut state) = periodic_square(1.6, 2000.0, &edits);
        let k = std::f64::consts::TAU / 0.2;
        for (v, x) in state.grains.velocity.iter_mut().zip(&state.grains.position) {
            v[0] = 0.05 * (k * x[0]).sin();
        }
        advance(plan, &mut state, 4e-3);
        let mut rows: Vec<_> = state.grains.id.iter().zip(&state.grains.velocity).collect();
        rows.sort_by_key(|(id, _)| **id);
        rows.into_iter().map(|(_, v)| *v).collect()
    };
    let runs = [0.4, 0.2, 0.1].map(end);
    let distance = |a: &[Vector<2>], b: &[Vector<2>]| -> f64 {
        let parts = a.iter().zip(b);
        let sum: f64 = parts
            .map(|(a, b)| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2))
            .sum();
        sum.sqrt()
    };
    let (coarse, fine) = (distance(&runs[0], &runs[1]), distance(&runs[1], &runs[2]));
    let order = (coarse / fine).log2();
    println!("order {order:.2}, last change {fine:.2e} m/s");
    assert!(fine > 0.0 && order > 1.7, "{order}: {coarse:e} {fine:e}");
}

/// Below the friction angle the regularised law creeps: eta(gamma, p) gamma = p tan(slope) gives a shear rate that is
/// nearly the same at every height, so speeds lie on a line from the bed. What the pair form does not transmit makes it
/// steeper. Ghosts that give back half of a grain's speed put the line's foot at the bed; ghosts at rest put it half a
/// spacing behind.
#[test]
fn a_layer_creeps_as_the_regularised_law_says_without_slip_at_the_bed() {
    let dp = 0.01;
    let (sin, cos) = 10f64.to_radians().sin_cos();
    for (beta, foot) in [(1.5, 0.0), (1.0, -0.5)] {
        let scene = creeping_layer(beta);
        let law = &scene.materials[0].material;
        let Scheme::PaperA(choices) = scene.numerics.scheme else {
            panic!("another scheme");
        };
        let (tau_0, m0) = (choices.reference_yield_stress, choices.scaling_time);
        // The default: the yield stress of the deepest sand.
        let deepest = law.yield_stress(law.rest_density() * 9.81 * 0.1);
        assert!((tau_0 / deepest - 1.0).abs() < 1e-9, "{tau_0} {deepest}");
        let mut unit = Unit::new(&scene);
        unit.run_to(3.0);
        let view = unit.component.particles();
        let mut rows = [(0.0, 0.0, 0.0); 10];
        for (x, v) in view.position.iter().zip(&view.velocity) {
            let row = ((f64::from(x[1]) / dp).floor() as usize).min(9);
            let sum = &mut rows[row];
            *sum = (
                sum.0 + f64::from(x[1]),
                sum.1 + f64::from(v[0]),
                sum.2 + 1.0,
            );
        }
        let rows = rows.map(|(y, v, n)| (y / n, v / n));
        // The line through rows away from bed and surface, and where it meets zero.
        let (low, high) = (rows[2], rows[7]);
        let slope = (high.1 - low.1) / (high.0 - low.0);
        let meets = (low.0 - low.1 / slope) / dp;
        let middle = law.rest_density() * 9.81 * cos * (0.1 - 0.5 * (low.0 + high.0));
        let ideal = creep_rate(law, middle, sin / cos, m0, tau_0);
        let share = share_on_a_lattice(dp, 2.0 * dp, 0.1 / dp);
        println!(
            "beta_max {beta}: {slope:.3} 1/s, law {ideal:.3} 1/s, share {share:.4}, foot {meets:+.3} dp"
        );
        assert!(
            (slope * share / ideal - 1.0).abs() < 0.03,
            "{slope} {share} {ideal}"
        );
        assert!((meets - foot).abs() < 0.2, "{meets}");
        // The bed carries the weight.
        let mass = unit.get("mass.present");
        for (name, ideal) in [("x", mass * 9.81 * sin), ("y", -mass * 9.81 * cos)] {
            let force = unit.get(&format!("gauge.bed.force_{name}"));
            assert!(
                (force / ideal - 1.0).abs() < 0.03,
                "{name}: {force} {ideal}"
            );
        }
    }
}

fn creeping_layer(beta: f64) -> Scene {
    let text = format!(
        r#"
name = "creep"
dimension = 2
[domain]
lower = [0, -0.05]
upper = [0.1, 0.15]
periodic = ["x"]
slope = "10 deg"
[numerics]
scheme = "paper_a"
spacing = 0.01
smoothing_ratio = 2
jitter = 0
sound_speed = 10
scaling_time = "0.05 s"
ghost_velocity_factor = {beta}
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.layer]
material = "sand"
box = {{ lower = [0, 0], upper = [0.1, 0.1] }}
[walls.bed]
polyline = [[0, 0], [0.1, 0]]
[gauges.bed]
kind = "force"
on = "wall.bed"
[run]
step = 0.01
until = 0.1
"#
    );
    scene::parse("creep.toml", &text).unwrap()
}

/// gamma with eta(gamma, p) gamma = p tan, by bisection [1/s].
fn creep_rate(law: &Material, p: f64, tan: f64, m0: f64, tau_0: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..100 {
        let gamma = 0.5 * (low + high);
        if law.regularised_viscosity(gamma, p, m0, tau_0) * gamma < p * tan {
            low = gamma;
        } else {
            high = gamma;
        }
    }
    low
}

/// Sand in a box of ghosts rests: depth and pressure of the depth are kept, and it moves by what the law creeps.
#[test]
fn sand_in_a_box_of_ghosts_stays_at_rest() {
    let text = r#"
name = "rest"
dimension = 2
[domain]
lower = [-0.05, -0.05]
upper = [0.15, 0.15]
[numerics]
scheme = "paper_a"
spacing = 0.01
smoothing_ratio = 1.6
sound_speed = 10
scaling_time = "0.05 s"
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.fill]
material = "sand"
box = { lower = [0, 0], upper = [0.1, 0.1] }
[walls.box]
polyline = [[0, 0.15], [0, 0], [0.1, 0], [0.1, 0.15]]
[gauges.depth]
kind = "depth"
foot = [0.05, 0]
[gauges.floor]
kind = "pressure"
at = [0.05, 0.01]
[run]
step = 0.01
until = 0.1
"#;
    let scene = scene::parse("rest.toml", text).unwrap();
    let mut unit = Unit::new(&scene);
    unit.run_to(0.1);
    let before = unit.get("gauge.depth.depth");
    unit.run_to(0.4);
    let (after, pressure) = (
        unit.get("gauge.depth.depth"),
        unit.get("gauge.floor.pressure"),
    );
    let ideal = 1560.0 * 9.81 * (after - 0.01);
    let speed = unit.component.statistics().max_speed;
    println!(
        "depth {before:.5} to {after:.5} m, pressure {pressure:.1} of {ideal:.1} Pa, {speed:.1e} m/s"
    );
    assert!((after - before).abs() < 0.02 * before, "{before} {after}");
    assert!((pressure / ideal - 1.0).abs() < 0.1, "{pressure} {ideal}");
    assert!(speed < 0.02, "{speed} m/s");
}

/// A layer that starts in steady flow keeps the pressure of that flow, and the bed carries it.
#[test]
fn a_layer_starts_in_bagnolds_flow() {
    let scene = case("paper_a/inclined_plane", &[]);
    let mut unit = Unit::new(&scene);
    let view = unit.component.particles();
    let fastest = view.velocity.iter().map(|v| v[0]).fold(0.0, f32::max);
    // 12.8 m/s at the surface, a bit less in the uppermost row, 2.5 mm below it.
    assert!((12.6..12.85).contains(&fastest), "{fastest}");
    unit.run_to(0.1);
    let mass = unit.get("mass.present");
    let weight = mass * 9.81 * 25f64.to_radians().cos();
    let force = -unit.get("gauge.bed_force.force_y");
    println!("bed {force:.2} N, weight {weight:.2} N");
    assert!((force / weight - 1.0).abs() < 0.1, "{force} {weight}");
}

/// The same bits on any number of threads, and from a saved state.
#[test]
fn paper_a_has_the_same_bits_on_any_number_of_threads_and_from_a_saved_state() {
    let edits = [
        ("spacing = \"1.20 mm\"", "spacing = \"1.10 mm\""),
        ("step = \"10 ms\"", "step = \"0.05 ms\""),
    ];
    let scene = case("paper_a/column_1", &edits);
    let steps = |unit: &mut Unit| {
        unit.step();
        unit.step();
        unit.component.state_hash()
    };
    let mut one = Unit::new(&scene);
    assert!(one.get("solver.particles") > 2500.0);
    one.component.set_threads(1);
    one.step();
    let saved = one.component.save().unwrap();
    let end = steps(&mut one);
    assert!(one.component.statistics().steps > 20);
    let mut two = Unit::new(&scene);
    two.component.set_threads(2);
    two.component.restore(&saved).unwrap();
    assert_eq!(steps(&mut two), end);
}

/// A block of sand that slumps between ghosts, by both forms of the sums: places and velocities differ by rounding, whatever the
/// dimension, with artificial viscosity and without.
#[test]
fn lanes_and_plain_sums_are_the_same() {
    let block = |dimension: usize, sweeps: &str, alpha: f64| {
        let point = |x: f64, z: f64| match dimension {
            2 => format!("[{x}, {z}]"),
            _ => format!("[{x}, {x}, {z}]"),
        };
        let floor = match dimension {
            2 => "polyline = [[0, 0.3], [0, 0], [0.4, 0]]",
            _ => "plane = { point = [0, 0, 0], normal = [0, 0, 1] }",
        };
        format!(
            r#"
name = "slump"
dimension = {dimension}
[domain]
lower = {}
upper = {}
[numerics]
scheme = "paper_a"
sweeps = "{sweeps}"
spacing = 0.02
smoothing_ratio = 1.6
sound_speed = 10
scaling_time = "0.01 s"
artificial_viscosity = {alpha}
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.block]
material = "sand"
box = {{ lower = {}, upper = {} }}
[walls.floor]
{floor}
[run]
step = 0.01
until = 0.1
"#,
            point(-0.1, -0.1),
            point(0.4, 0.3),
            point(0.0, 0.0),
            point(0.12, 0.2),
        )
    };
    for alpha in [0.0, 0.1] {
        let forms = ["lanes", "plain"];
        same::<2>(&forms.map(|sweeps| block(2, sweeps, alpha)));
        same::<3>(&forms.map(|sweeps| block(3, sweeps, alpha)));
    }
}

/// Runs both scenes for 50 ms; they must have the same steps, and places and velocities that differ by rounding, though they do.
fn same<const D: usize>(texts: &[String; 2]) {
    let [(steps, a), (others, b)] = texts.each_ref().map(|text| {
        let scene = scene::parse("slump.toml", text).unwrap();
        let (plan, mut state) = scene::build::<D>(&scene).unwrap();
        (advance(plan, &mut state, 0.05), state.grains)
    });
    let largest = |v: &[Vector<D>], w: &[Vector<D>]| {
        let pairs = v.iter().flatten().zip(w.iter().flatten());
        pairs.fold(0.0, |most: f64, (v, w)| most.max((v - w).abs()))
    };
    assert_eq!(steps, others);
    let fastest = largest(&b.velocity, &vec![[0.0; D]; b.len()]);
    assert!(fastest > 0.1, "it slumps: {fastest} m/s");
    let x = largest(&a.position, &b.position);
    let v = largest(&a.velocity, &b.velocity);
    assert!(x > 0.0 && x < 1e-11 && v < 1e-10, "{D}D: {x} m, {v} m/s");
}
