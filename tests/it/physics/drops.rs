//! Drops of one particle: what flies, falls and jumps back gains no energy.

use super::Unit;
use sandgate::scene;

/// One particle of water above a floor: g y + v^2/2 of each communication point over the first [1].
fn energy_of_a_drop(dimension: usize, slip: &str) -> Vec<f64> {
    // The last axis is the vertical one.
    let place = |side: f64, height: f64| {
        let sides = if dimension == 3 { 2 } else { 1 };
        format!("[{}{height}]", format!("{side}, ").repeat(sides))
    };
    let text = format!(
        r#"
name = "drop"
dimension = {dimension}
[domain]
lower = {}
upper = {}
[numerics]
spacing = "10 mm"
expected_speed = "3 m/s"
[materials.water]
law = "fluid"
preset = "water"
[bodies.drop]
material = "water"
box = {{ lower = {}, upper = {} }}
[walls.floor]
plane = {{ point = {}, normal = {} }}
slip = "{slip}"
[run]
step = "20 ms"
until = "4 s"
"#,
        place(-0.2, -0.2),
        place(0.7, 1.0),
        place(0.2, 0.4),
        place(0.21, 0.41),
        place(0.0, 0.0),
        place(0.0, 1.0),
    );
    let mut unit = Unit::new(&scene::parse("drop", &text).unwrap());
    let mut energies = Vec::new();
    for point in 0..=200 {
        unit.run_to(f64::from(point) * 0.02);
        let drop = unit.component.particles();
        let (x, v) = (drop.position[0], drop.velocity[0]);
        let kinetic: f64 = v.iter().map(|c| f64::from(*c).powi(2)).sum();
        energies.push(9.81 * f64::from(x[dimension - 1]) + 0.5 * kinetic);
    }
    let first = energies[0];
    energies.iter().map(|e| e / first).collect()
}

/// Six to seven jumps. Symplectic Euler takes v half a step ahead of x: g v dt/2 of energy, 0.1 % here, goes to and fro.
#[test]
fn a_lone_drop_jumps_back_no_higher_than_it_fell() {
    for (dimension, slip) in [(2, "free_slip"), (2, "no_slip"), (3, "free_slip")] {
        for (point, energy) in energy_of_a_drop(dimension, slip).iter().enumerate() {
            assert!(
                *energy < 1.005,
                "{dimension}, {slip}: {energy} of its energy at {} s",
                0.02 * point as f64
            );
        }
    }
}

/// A block 0.1 m high, 1 m over a floor, after 0.44 s: speed over g t, and root of the mean square of the height of its particles about their mean over
/// that at the start.
fn fallen(dimension: &str, material: &str, spacing: &str) -> [f64; 2] {
    let text = format!(
        r#"
name = "fall"
dimension = {dimension}
[domain]
lower = [0, -1.2]
upper = [0.5, 0.3]
[numerics]
spacing = "{spacing}"
[materials.m]
{material}
[bodies.block]
material = "m"
box = {{ lower = [0, 0], upper = [0.05, 0.1] }}
[walls.floor]
polyline = [[0, -1], [0.5, -1]]
[gauges.inside]
kind = "pressure"
at = [0.02, 0.02]
[run]
step = "20 ms"
until = "0.44 s"
"#
    );
    let mut unit = Unit::new(&scene::parse("fall", &text).unwrap());
    assert_eq!(unit.get("gauge.inside.pressure"), 0.0);
    let spread = |unit: &Unit| {
        let particles = unit.component.particles();
        let heights: Vec<f64> = particles.position.iter().map(|x| f64::from(x[1])).collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let squares: f64 = heights.iter().map(|y| (y - mean).powi(2)).sum();
        (squares / heights.len() as f64).sqrt()
    };
    let before = spread(&unit);
    unit.run_to(0.44);
    let particles = unit.component.particles();
    let speed: f64 = particles.velocity.iter().map(|v| -f64::from(v[1])).sum();
    [
        speed / particles.velocity.len() as f64 / (9.81 * 0.44),
        spread(&unit) / before,
    ]
}

/// What falls freely bears nothing: it neither bursts nor shrinks.
#[test]
fn a_block_that_falls_keeps_its_size() {
    let sand = "law = \"mu_i\"\npreset = \"sand_04\"";
    let water = "law = \"fluid\"\npreset = \"water\"";
    for (dimension, material) in [
        ("2", sand),
        ("2", water),
        ("\"axisymmetric\"", sand),
        ("\"axisymmetric\"", water),
    ] {
        for spacing in ["10 mm", "5 mm"] {
            let [speed, size] = fallen(dimension, material, spacing);
            println!("{dimension}, {spacing}: {speed:.6} of g t, {size:.5} of its height");
            assert!((speed - 1.0).abs() < 1e-5, "{speed}");
            assert!((size - 1.0).abs() < 2e-3, "{size}");
        }
    }
}

/// Water in the lower half of a drum of so many segments, over what is 40 mm of it [1].
fn half_full(segments: usize) -> f64 {
    let circle = |n: usize, radius: f64, from: f64, turn: f64| {
        let at = |k: usize| {
            let angle = from + turn * k as f64 / n as f64;
            format!("[{:.6}, {:.6}]", radius * angle.cos(), radius * angle.sin())
        };
        (0..=n).map(at).collect::<Vec<_>>()
    };
    let pi = std::f64::consts::PI;
    let mut wall = circle(segments, 0.1, 0.0, 2.0 * pi);
    wall.pop();
    let half = circle(60, 0.099, pi, pi);
    let text = format!(
        r#"
name = "drum"
[domain]
lower = [-0.2, -0.2]
upper = [0.2, 0.2]
[numerics]
spacing = "5 mm"
[materials.m]
law = "fluid"
preset = "water"
[bodies.half]
material = "m"
polygon = [{}]
[walls.drum]
polyline = [{}]
closed = true
slip = "free_slip"
[gauges.inside]
kind = "pressure"
at = [0, -0.04]
[run]
step = "10 ms"
until = "10 ms"
"#,
        half.join(", "),
        wall.join(", ")
    );
    let unit = Unit::new(&scene::parse("drum", &text).unwrap());
    unit.get("gauge.inside.pressure") / (1000.0 * 9.81 * 0.04)
}

/// However short the segments of its wall are, and however little each of its points weighs.
#[test]
fn what_lies_in_a_drum_stands_on_it() {
    for segments in [40, 400] {
        let share = half_full(segments);
        println!("{segments} segments: {share:.4}");
        assert!((share - 1.0).abs() < 0.03, "{share}");
    }
}
