//! Lips of outlets that are cut away below, as sharp as they are. Where a jet leaves a flat floor, it parts at the edge: what the lip
//! looks like underneath must not matter.

use super::Unit;
use sandgate::scene;

/// A tank of water, 0.36 m wide and deep, with a slot of 60 mm in its floor; lips go from its edges to (`back`, `down`) behind and
/// below them.
fn tank(back: f64, down: f64) -> Unit {
    let (left, right) = (0.15 - back, 0.21 + back);
    let text = format!(
        r#"
name = "slot"
[domain]
lower = [-0.2, -0.6]
upper = [0.56, 1.0]
[numerics]
spacing = "7.5 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0, 0], upper = [0.36, 0.36] }}
[walls.left]
polyline = [[0, 0.56], [0, 0], [0.15, 0], [{left}, -{down}]]
slip = "free_slip"
[walls.right]
polyline = [[{right}, -{down}], [0.21, 0], [0.36, 0], [0.36, 0.56]]
slip = "free_slip"
[outflows.drain]
lower = [-0.2, -0.6]
upper = [0.56, -0.35]
[gauges.in_tank]
kind = "mass"
lower = [-1, 0]
upper = [2, 2]
[run]
step = "10 ms"
until = "0.3 s"
"#
    );
    Unit::new(&scene::parse("slot", &text).unwrap())
}

/// Mass per second that leaves it while its level falls little [kg/s].
fn discharge(back: f64, down: f64) -> f64 {
    let mut unit = tank(back, down);
    unit.run_to(0.12);
    let before = unit.get("gauge.in_tank.mass");
    unit.run_to(0.28);
    (before - unit.get("gauge.in_tank.mass")) / 0.16
}

#[test]
fn a_sharp_lip_passes_what_a_square_one_does() {
    let square = discharge(0.0, 0.03);
    for (back, down) in [(0.04, 0.0693), (0.1, 0.105)] {
        let sharp = discharge(back, down);
        println!("square {square:.2} kg/s, {back} m back and {down} m down {sharp:.2} kg/s");
        assert!((sharp / square - 1.0).abs() < 0.05);
    }
}
