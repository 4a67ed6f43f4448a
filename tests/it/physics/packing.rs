//! What parts and meets again, or flows in with gaps, must lie as densely as what was there from the start.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

fn run(text: &str) -> Unit {
    let scene = scene::parse("packing.toml", text).unwrap_or_else(|e| panic!("{e}"));
    let mut unit = Unit::new(&scene);
    unit.run_to(scene.run.until);
    unit
}

/// A mean over a profile's points [m].
fn mean_depth(unit: &Unit, count: usize) -> f64 {
    let depths = (1..=count).map(|n| unit.get(&format!("gauge.level.depth[{n}]")));
    depths.sum::<f64>() / count as f64
}

#[test]
fn a_tank_that_a_jet_filled_stands_as_high_as_its_water() {
    let mut unit = run(r#"
name = "filled"
[domain]
lower = [-0.1, -0.1]
upper = [0.6, 0.6]
[numerics]
spacing = "12.5 mm"
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = { lower = [0, 0], upper = [0.5, 0.05] }
[walls.tank]
polyline = [[0, 0.5], [0, 0], [0.5, 0], [0.5, 0.5]]
slip = "free_slip"
[walls.feed]
box = { lower = [0.2, 0.4], upper = [0.3, 0.45] }
slip = "free_slip"
[inflows.jet]
material = "water"
from = [0.3, 0.4]
to = [0.2, 0.4]
velocity = [0, -1]
rate = 25
[gauges.level]
kind = "profile"
from = [0.025, 0]
to = [0.475, 0]
count = 10
[gauges.pressure]
kind = "pressure"
at = [0.05, 0.02]
[run]
step = 0.02
until = 2
"#);
    unit.set("inflow.jet.rate", 0.0);
    unit.run_to(4.0);
    // It still sways: means over the last second.
    let (mut level, mut pressure) = (0.0, 0.0);
    for _ in 0..50 {
        unit.step();
        level += mean_depth(&unit, 10) / 50.0;
        pressure += unit.get("gauge.pressure.pressure") / 50.0;
    }
    let exact = unit.get("mass.present") / (1000.0 * 0.5);
    let weight = 1000.0 * G * (exact - 0.02);
    println!("level {level:.4} m for {exact:.4}, pressure {pressure:.0} Pa for {weight:.0}");
    assert!((level / exact - 1.0).abs() < 0.02, "{level} for {exact} m");
    assert!(
        (pressure / weight - 1.0).abs() < 0.04,
        "{pressure} for {weight} Pa"
    );
}

/// A stream of half the density that it could have piles up to what its mass takes.
#[test]
fn sand_that_flows_in_with_gaps_closes_them() {
    let mut unit = run(r#"
name = "bin"
[domain]
lower = [-0.05, -0.05]
upper = [0.17, 0.3]
[numerics]
spacing = "3.3333 mm"
expected_speed = 2
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[walls.bin]
polyline = [[0, 0.25], [0, 0], [0.12, 0], [0.12, 0.25]]
[inflows.feed]
material = "sand"
from = [0.08, 0.1]
to = [0.04, 0.1]
velocity = [0, -0.4]
rate = 12
[gauges.level]
kind = "profile"
from = [0.0025, 0]
to = [0.1175, 0]
count = 24
length = 0.2
[gauges.weight]
kind = "force"
on = "wall.bin"
[run]
step = 0.02
until = 0.36
"#);
    unit.set("inflow.feed.rate", 0.0);
    unit.run_to(1.4);
    let (mass, level) = (unit.get("mass.present"), mean_depth(&unit, 24));
    let exact = mass / (1500.0 * 0.12);
    let weight = unit.get("gauge.weight.force_y") / (-mass * G);
    println!("{mass:.3} kg, {level:.4} m for {exact:.4}, weight {weight:.4}");
    // 12 kg/s for 0.36 s, rows that are under way included.
    assert!((mass - 4.32).abs() < 0.15, "{mass} kg");
    // Its top is uneven by half a spacing.
    assert!(
        level > 0.95 * exact && level < 1.2 * exact,
        "{level} for {exact} m"
    );
    assert!((weight - 1.0).abs() < 0.01, "{weight}");
}
