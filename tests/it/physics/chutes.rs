//! What repeats along gravity has nothing above it: it falls, and what is driven along a duct does not press on its lid.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

/// Sand between two rough walls fills a period along gravity: nothing presses it against them.
#[test]
fn a_plug_that_fills_a_period_falls_freely() {
    let text = r#"
name = "plug"
[domain]
lower = [-0.05, 0]
upper = [0.15, 0.24]
periodic = ["y"]
[numerics]
spacing = "5 mm"
sound_speed = 20
expected_speed = 1
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.plug]
material = "sand"
box = { lower = [0, 0], upper = [0.1, 0.24] }
[walls.left]
polyline = [[0, 0.24], [0, 0]]
slip = "friction"
wall_friction = 0.3
[walls.right]
polyline = [[0.1, 0], [0.1, 0.24]]
slip = "friction"
wall_friction = 0.3
[run]
step = "20 ms"
until = "0.2 s"
"#;
    let mut unit = Unit::new(&scene::parse("plug", text).unwrap());
    unit.run_to(0.2);
    let energy = unit.get("energy.kinetic");
    let speed = (2.0 * energy / unit.component.ledger().present).sqrt();
    println!("{:.4} of free fall", speed / (G * 0.2));
    assert!((speed / (G * 0.2) - 1.0).abs() < 0.03, "{speed}");
}

/// A fluid that is driven along a duct, from side to side of the domain, leans on its floor alone.
#[test]
fn the_lid_of_a_duct_bears_nothing_at_the_start() {
    let text = r#"
name = "duct"
[domain]
lower = [0, -0.02]
upper = [0.1, 0.06]
periodic = ["x"]
gravity = [9.81, -0.3]
[numerics]
spacing = "2.5 mm"
sound_speed = "6 m/s"
[materials.fluid]
law = "fluid"
density = 1000
consistency = 1
[bodies.fluid]
material = "fluid"
box = { lower = [0, 0], upper = [0.1, 0.04] }
[walls.floor]
polyline = [[0, 0], [0.1, 0]]
[walls.lid]
polyline = [[0.1, 0.04], [0, 0.04]]
[gauges.floor]
kind = "force"
on = "wall.floor"
[gauges.lid]
kind = "force"
on = "wall.lid"
[run]
step = "5 ms"
until = "0.05 s"
"#;
    let mut unit = Unit::new(&scene::parse("duct", text).unwrap());
    let (mut floor, mut lid) = (0.0, 0.0);
    for _ in 0..4 {
        unit.step();
        // A quarter each of a force on 0.1 m.
        floor -= unit.get("gauge.floor.force_y") / 0.4;
        lid += unit.get("gauge.lid.force_y") / 0.4;
    }
    let weight = 1000.0 * 0.3 * 0.04;
    println!("floor {floor:.2} Pa, lid {lid:.2} Pa, weight {weight:.2} Pa");
    // The start's jitter sounds: 0.3 to 0.5 Pa of the 12, 486 with the weight of a period.
    assert!(lid.abs() < 0.08 * weight, "{lid}");
    assert!((floor - weight).abs() < 0.08 * weight, "{floor}");
}

/// A layer on a slope of 60 deg presses on its bed with its weight across it.
#[test]
fn a_layer_on_a_steep_slope_starts_with_the_load_across_it() {
    let text = r#"
name = "steep"
[domain]
lower = [-0.5, -0.1]
upper = [1.5, 0.5]
slope = "60 deg"
[numerics]
spacing = "5 mm"
expected_speed = 2
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.layer]
material = "sand"
box = { lower = [0, 0], upper = [0.5, 0.05] }
[walls.bed]
polyline = [[-0.5, 0], [1.5, 0]]
slip = "friction"
wall_friction = 0.3
[gauges.probe]
kind = "pressure"
at = [0.25, 0.01]
[run]
step = "5 ms"
until = "0.1 s"
"#;
    let unit = Unit::new(&scene::parse("steep", text).unwrap());
    let pressure = unit.get("gauge.probe.pressure");
    let across = 1500.0 * G * 0.5 * 0.04;
    println!("{pressure:.1} Pa for {across:.1}");
    assert!((pressure / across - 1.0).abs() < 0.1, "{pressure}");
}
