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

/// Water leaves a bed that rests: its pores have less pressure, and between its grains there is what there was. They kept all of the weight
/// that had gone, up to what the bed yields at, twice its buoyant weight.
#[test]
fn water_that_leaves_takes_its_weight_along() {
    let text = r#"
name = "drawdown"
[domain]
lower = [-0.1, -0.2]
upper = [1.1, 0.6]
[numerics]
spacing = "12.5 mm"
sound_speed = 14
[materials.water]
law = "fluid"
preset = "water"
[materials.silt]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
pore_fluid = "water"
[bodies.bed]
material = "silt"
box = { lower = [0, 0], upper = [0.5, 0.1] }
[bodies.water]
material = "water"
box = { lower = [0, 0.1], upper = [0.5, 0.25] }
[walls.tank]
polyline = [[0, 0.5], [0, 0], [0.5, 0], [0.5, 0.14], [0.8, 0.14]]
[gates.weir]
from = [0.5, 0.14]
to = [0.5, 0.3]
max_speed = 2
[outflows.out]
lower = [0.82, -0.2]
upper = [1.1, 0.6]
[gauges.effective]
kind = "pressure"
at = [0.15, 0.05]
quantity = "effective"
[gauges.pore]
kind = "pressure"
at = [0.15, 0.05]
quantity = "pore"
[gauges.level]
kind = "depth"
foot = [0.15, 0]
[run]
step = "20 ms"
until = "3 s"
"#;
    let mut unit = Unit::new(&scene::parse("drawdown", text).unwrap());
    unit.run_to(0.1);
    unit.set("gate.weir.opening", 1.0);
    unit.run_to(3.0);
    let left = unit.get("gauge.level.depth");
    let buoyant = 990.0 * 9.81 * 0.05;
    let effective = unit.get("gauge.effective.pressure") / buoyant;
    let pore = unit.get("gauge.pore.pressure") / (1000.0 * 9.81 * (left - 0.05));
    println!("level {left:.4} m: effective {effective:.3}, pore {pore:.3}");
    assert!(left < 0.18);
    assert!(
        (effective - 1.0).abs() < 0.15,
        "{effective} of the buoyant weight"
    );
    assert!((pore - 1.0).abs() < 0.1, "{pore} of hydrostatic");
}
