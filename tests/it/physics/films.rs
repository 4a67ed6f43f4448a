//! Films of clay on a slope: where they begin to flow, and how fast the first row over the floor is.

use super::Unit;
use sandgate::scene;
use sandgate::solver::{Solver, StepInputs};

/// The clay of Monge-Gapper et al. (2024), Table 1: density, yield stress, K, n; on 3 degrees.
const RHO: f64 = 1540.0;
const YIELD: f64 = 30.0;
const K: f64 = 4.472;
const N: f64 = 0.472;

/// Weight along the slope [Pa/m].
fn pull() -> f64 {
    RHO * 9.81 * 3.0_f64.to_radians().sin()
}

/// Depth whose weight is the yield stress at the floor [m].
fn plug() -> f64 {
    YIELD / pull()
}

/// Exact steady velocity at a height over the floor [m/s].
fn exact(depth: f64, height: f64) -> f64 {
    let speed = |sheared: f64| {
        N / (N + 1.0) * (pull() / K).powf(1.0 / N) * sheared.max(0.0).powf(1.0 + 1.0 / N)
    };
    speed(depth - plug()) - speed(depth - plug() - height)
}

/// Heights over the floor and velocities of a film's particles, ten to a row, from its lowest row up; all those of `snapshots`
/// of them, 0.1 s apart and the last at `time`.
fn film(depth: f64, rows: u32, time: f64, snapshots: u32) -> Vec<[f64; 2]> {
    let dp = depth / f64::from(rows);
    let length = 10.0 * dp;
    let text = format!(
        r#"
name = "film"
[domain]
lower = [0, {}]
upper = [{length}, {}]
periodic = ["x"]
slope = "3 deg"
[numerics]
spacing = {dp}
sleep = false
[materials.clay]
law = "fluid"
density = {RHO}
consistency = {K}
flow_index = {N}
yield_stress = {YIELD}
[bodies.film]
material = "clay"
box = {{ lower = [0, 0], upper = [{length}, {depth}] }}
[walls.bed]
polyline = [[0, 0], [{length}, 0]]
[run]
step = 0.5
until = {time}
"#,
        -6.0 * dp,
        1.5 * depth
    );
    let scene = scene::parse("film.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let (plan, mut state) = scene::build::<2>(&scene).unwrap();
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    let mut seen = Vec::new();
    for k in (0..snapshots).rev() {
        let at = time - 0.1 * f64::from(k);
        while state.time < at {
            let step = solver.step(&mut state, at, &inputs, &mut |_, _| {});
            step.unwrap_or_else(|e| panic!("{e}"));
        }
        let grains = &state.grains;
        seen.extend(
            grains
                .position
                .iter()
                .zip(&grains.velocity)
                .map(|(x, v)| [x[1], v[0]]),
        );
    }
    seen.sort_by(|a: &[f64; 2], b| a[0].total_cmp(&b[0]));
    seen
}

fn mean(of: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = of.len() as f64;
    of.sum::<f64>() / n
}

/// Without (W8) eight rows stand under 1.1 times the load that they bear, at 7e-6 m/s.
#[test]
fn a_film_of_few_rows_flows_where_the_floor_yields_it_and_not_before() {
    let stands = film(0.95 * plug(), 8, 4.0, 1);
    let fastest = stands
        .iter()
        .fold(0.0, |most: f64, [_, v]| most.max(v.abs()));
    println!("0.95 of its plug: {fastest:.2e} m/s");
    // What is left of settling after 4 s.
    assert!(fastest < 3e-5, "{fastest}");
    let depth = 1.1 * plug();
    let flows = film(depth, 8, 8.0, 10);
    let speed = mean(flows.iter().map(|[_, v]| *v));
    let aim = mean(flows.iter().map(|[y, _]| exact(depth, *y)));
    println!("1.1 of its plug: {speed:.2e} m/s for {aim:.2e}");
    assert!((speed / aim - 1.0).abs() < 0.04, "{speed} {aim}");
}

/// Without (W7) across the floor the first row sinks to 0.468 spacings and moves at 0.68 of its speed.
#[test]
fn the_first_row_over_a_floor_stands_and_moves_as_it_should() {
    let (depth, rows) = (0.06, 20);
    let film = film(depth, rows, 10.0, 20);
    let first = &film[..film.len() / rows as usize];
    let height = mean(first.iter().map(|[y, _]| y * f64::from(rows) / depth));
    let speed = mean(first.iter().map(|[_, v]| *v));
    let aim = mean(first.iter().map(|[y, _]| exact(depth, *y)));
    println!("first row at {height:.4} spacings, {speed:.4} m/s for {aim:.4}");
    assert!((height - 0.5).abs() < 0.01, "{height}");
    assert!((speed / aim - 1.0).abs() < 0.1, "{speed} {aim}");
    let speed = mean(film.iter().map(|[_, v]| *v));
    let aim = mean(film.iter().map(|[y, _]| exact(depth, *y)));
    println!("film {speed:.4} m/s for {aim:.4}");
    assert!((speed / aim - 1.0).abs() < 0.02, "{speed} {aim}");
}

/// Oil that a sound speed's artificial viscosity would thicken, from rest down a slope for ten seconds: what passed, over what should
/// (the series of a film that starts). With all of it 0.86 did.
#[test]
fn oil_is_not_thickened_where_it_is_sheared_alone() {
    let text = r#"
name = "oil"
dimension = 2
[domain]
lower = [0, -0.1]
upper = [0.1, 0.2]
periodic = ["x"]
gravity = [0.05, -9.81]
[numerics]
spacing = "10 mm"
[materials.oil]
law = "fluid"
density = 1000
consistency = 0.2
[bodies.film]
material = "oil"
box = { lower = [0, 0], upper = [0.1, 0.1] }
[walls.bed]
polyline = [[0, 0], [0.1, 0]]
[gauges.section]
kind = "discharge"
from = [0.05, 0]
to = [0.05, 0.2]
[run]
step = "50 ms"
until = 10
"#;
    let mut unit = Unit::new(&scene::parse("oil", text).unwrap());
    unit.run_to(10.0);
    let (nu, h, g, end) = (2e-4_f64, 0.1_f64, 0.05_f64, 10.0_f64);
    let missing: f64 = (0..50)
        .map(|n| {
            let k = (f64::from(n) + 0.5) * std::f64::consts::PI / h;
            let decay = nu * k * k;
            6.0 / (k * h).powi(4) * (1.0 - (-decay * end).exp()) / decay
        })
        .sum();
    let exact = 1000.0 * g * h.powi(3) / (3.0 * nu) * (end - missing);
    let share = unit.get("gauge.section.mass") / exact;
    println!("{share:.3} of {exact:.1} kg");
    assert!((0.9..1.01).contains(&share), "{share}");
}
