//! Forces on walls that lie flush in one plane.

use super::Unit;
use sandgate::scene;

/// A tank 0.2 m broad and 0.36 m deep whose right side is a pier, a gate of 0.12 m and a wall.
fn tank(material: &str, spacing: &str) -> Unit {
    let text = format!(
        r#"
name = "tank"
[domain]
lower = [-0.1, -0.1]
upper = [0.4, 0.5]
[numerics]
spacing = "{spacing}"
[materials.m]
{material}
[bodies.m]
material = "m"
box = {{ lower = [0, 0], upper = [0.2, 0.36] }}
[walls.tank]
polyline = [[0, 0.5], [0, 0], [0.2, 0], [0.2, 0.12]]
slip = "free_slip"
[walls.above]
polyline = [[0.2, 0.24], [0.2, 0.5]]
slip = "free_slip"
[gates.main]
from = [0.2, 0.12]
to = [0.2, 0.24]
[gauges.gate]
kind = "force"
on = "gate.main"
[gauges.above]
kind = "force"
on = "wall.above"
[run]
step = "20 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("tank", &text).unwrap())
}

/// What rests presses on a gate and on the wall above it across them and not along: each was pushed along itself, towards the seam, by 0.3 dp
/// times the pressure there if it was water, 0.6 dp if it was sand.
#[test]
fn walls_without_friction_that_lie_flush_bear_nothing_along_themselves() {
    let water = "law = \"fluid\"\npreset = \"water\"";
    let sand = "law = \"mu_i\"\npreset = \"glass_beads\"";
    for (material, spacing) in [(water, "20 mm"), (water, "10 mm"), (sand, "20 mm")] {
        let mut unit = tank(material, spacing);
        let mut sum = [0.0; 4];
        unit.run_to(0.5);
        for n in 1..=25 {
            unit.run_to(0.5 + 0.02 * f64::from(n));
            for (sum, name) in sum.iter_mut().zip([
                "gauge.gate.force_x",
                "gauge.gate.force_y",
                "gauge.above.force_x",
                "gauge.above.force_y",
            ]) {
                *sum += unit.get(name) / 25.0;
            }
        }
        let [gate, gate_along, above, above_along] = sum;
        println!(
            "{spacing}: gate {gate:.1} N across, {gate_along:.2} N along; above {above:.1} and {above_along:.2} N"
        );
        assert!(gate_along.abs() < 0.008 * gate && above_along.abs() < 0.008 * above);
        if material == water {
            let thrust = 1000.0 * 9.81 * 0.12 * 0.18;
            assert!((gate / thrust - 1.0).abs() < 0.01, "{gate} N for {thrust}");
        }
    }
}
