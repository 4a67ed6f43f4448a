//! Water under a roof starts with the head of the open water that it is joined to, and stays.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

/// A channel 0.1 m high and 0.6 m long under a block, between a leg filled to 0.6 m and one filled to `right`.
fn channel(right: f64) -> Unit {
    let text = format!(
        r#"
name = "channel"
[domain]
lower = [-0.1, -0.1]
upper = [1.1, 1]
[numerics]
spacing = "10 mm"
expected_speed = "2 m/s"
[materials.water]
law = "fluid"
preset = "water"
[bodies.left]
material = "water"
box = {{ lower = [0, 0], upper = [0.2, 0.6] }}
[bodies.channel]
material = "water"
box = {{ lower = [0.2, 0], upper = [0.8, 0.1] }}
[bodies.right]
material = "water"
box = {{ lower = [0.8, 0], upper = [1, {right}] }}
[walls.tank]
polyline = [[0, 0.9], [0, 0], [1, 0], [1, 0.9]]
slip = "free_slip"
[walls.block]
box = {{ lower = [0.2, 0.1], upper = [0.8, 0.9] }}
slip = "free_slip"
[gauges.quarter]
kind = "pressure"
at = [0.35, 0.05]
[gauges.middle]
kind = "pressure"
at = [0.5, 0.05]
[gauges.far]
kind = "pressure"
at = [0.65, 0.05]
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("channel", &text).unwrap())
}

#[test]
fn water_under_a_block_starts_with_the_head_beside_it() {
    let mut unit = channel(0.6);
    let head = 1000.0 * G * 0.55;
    let at_the_start = unit.get("gauge.middle.pressure") / head;
    let mut worst = 0.0f64;
    while unit.component.time() < 0.4 {
        unit.step();
        worst = worst.max((unit.get("gauge.middle.pressure") / head - 1.0).abs());
    }
    println!("{at_the_start:.4} of its head at the start, within {worst:.4} of it for 0.4 s");
    assert!((at_the_start - 1.0).abs() < 0.02, "{at_the_start}");
    assert!(worst < 0.05, "{worst}");
}

#[test]
fn between_two_levels_the_head_falls_along_the_channel() {
    let unit = channel(0.3);
    let [a, b, c] =
        ["quarter", "middle", "far"].map(|name| unit.get(&format!("gauge.{name}.pressure")));
    let mean = 1000.0 * G * (0.45 - 0.05);
    println!("{a:.0}, {b:.0}, {c:.0} Pa for {mean:.0} in the middle");
    assert!((b / mean - 1.0).abs() < 0.03);
    assert!(((a - b) / (b - c) - 1.0).abs() < 0.1);
    assert!(a - c > 500.0);
}
