//! Pores of saturated beds: where air reaches them.

use super::Unit;
use sandgate::scene;

/// A gap of three spacings inside a bed under water is no dry surface: its pores are hydrostatic around it (0.4 of that where it was).
#[test]
fn a_gap_inside_a_bed_under_water_does_not_drain_its_pores() {
    let bodies: String = [
        ("s", [0.0, 0.0, 0.16, 0.02]),
        ("s", [0.0, 0.02, 0.075, 0.035]),
        ("s", [0.09, 0.02, 0.16, 0.035]),
        ("s", [0.0, 0.035, 0.16, 0.05]),
        ("w", [0.0, 0.05, 0.16, 0.1]),
    ]
    .iter()
    .enumerate()
    .map(|(n, (material, [x, y, x2, y2]))| {
        format!("[bodies.b{n}]\nmaterial = \"{material}\"\nbox = {{ lower = [{x}, {y}], upper = [{x2}, {y2}] }}\n")
    })
    .collect();
    let mut unit = Unit::new(
        &scene::parse(
            "gap",
            &format!(
                r#"
name = "gap"
[domain]
lower = [-0.1, -0.1]
upper = [0.3, 0.4]
[numerics]
spacing = "5 mm"
[materials.w]
law = "fluid"
preset = "water"
[materials.s]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
pore_fluid = "w"
cohesion = 2000
{bodies}
[walls.t]
polyline = [[0, 0.3], [0, 0], [0.16, 0], [0.16, 0.3]]
slip = "free_slip"
[gauges.low]
kind = "pressure"
at = [0.08, 0.005]
quantity = "pore"
[gauges.side]
kind = "pressure"
at = [0.06, 0.03]
quantity = "pore"
[run]
step = "10 ms"
until = 0.1
"#
            ),
        )
        .unwrap(),
    );
    unit.run_to(0.1);
    for (gauge, y) in [("low", 0.005), ("side", 0.03)] {
        let share = unit.get(&format!("gauge.{gauge}.pressure")) / (1000.0 * 9.81 * (0.1 - y));
        println!("{gauge}: {share:.3}");
        assert!((share - 1.0).abs() < 0.03, "{gauge}: {share}");
    }
}
