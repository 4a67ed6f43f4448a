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

/// Mean forces on two walls `lo` and `up` [N]: x and y of the first, then of the second, from time `from` to `to`.
fn forces_on_both(unit: &mut Unit, from: f64, to: f64) -> [f64; 4] {
    let samples = ((to - from) / 0.02).round() as usize;
    let mut sum = [0.0; 4];
    unit.run_to(from);
    for n in 1..=samples {
        unit.run_to(from + 0.02 * n as f64);
        for (sum, name) in sum.iter_mut().zip([
            "gauge.lo.force_x",
            "gauge.lo.force_y",
            "gauge.up.force_x",
            "gauge.up.force_y",
        ]) {
            *sum += unit.get(name) / samples as f64;
        }
    }
    sum
}

/// Water 0.3 m deep between upright walls, the right one parted halfway up. The upper wall read 126 N for 110 N: points on the joint stand for
/// half a spacing of either wall, and the one that starts there had all of them.
#[test]
fn an_upright_wall_that_is_parted_bears_the_thrust_of_each_part() {
    for slip in ["free_slip", "no_slip"] {
        let text = format!(
            r#"
name = "parted"
[domain]
lower = [-0.2, -0.2]
upper = [0.6, 0.9]
[numerics]
spacing = "20 mm"
[materials.m]
law = "fluid"
preset = "water"
[bodies.m]
material = "m"
box = {{ lower = [0, 0], upper = [0.4, 0.3] }}
[walls.tank]
polyline = [[0, 0.6], [0, 0], [0.4, 0]]
slip = "{slip}"
[walls.lo]
polyline = [[0.4, 0], [0.4, 0.15]]
slip = "{slip}"
[walls.up]
polyline = [[0.4, 0.15], [0.4, 0.6]]
slip = "{slip}"
[gauges.lo]
kind = "force"
on = "wall.lo"
[gauges.up]
kind = "force"
on = "wall.up"
[run]
step = "20 ms"
until = "1 s"
"#
        );
        let mut unit = Unit::new(&scene::parse("parted", &text).unwrap());
        let [lower, lower_along, upper, upper_along] = forces_on_both(&mut unit, 0.3, 0.6);
        println!(
            "{slip}: lower {lower:.1} N across, {lower_along:.2} along; upper {upper:.1} and {upper_along:.2} N"
        );
        let pressure = 1000.0 * 9.81;
        let (all, above) = (pressure * 0.3 * 0.15, pressure * 0.15 * 0.075);
        // 15 rows of water: the whole wall has its thrust to 0.5 %, and a tenth of a spacing at the joint is 2.7 % of the upper part's.
        for (found, exact) in [(lower, all - above), (upper, above)] {
            assert!((found / exact - 1.0).abs() < 0.02, "{found} N for {exact}");
        }
    }
}

/// Beads slide over two floors of the same length, which rub with a fifth of the weight: each bears half of it, and half of the friction. One
/// had 4.7 % too little of both and the other as much too much.
#[test]
fn a_floor_that_is_parted_rubs_with_the_weight_on_each_part() {
    let text = r#"
name = "parted"
[domain]
lower = [0, -0.2]
upper = [0.4, 0.4]
periodic = ["x"]
[numerics]
spacing = "20 mm"
[materials.m]
law = "mu_i"
preset = "glass_beads"
[bodies.m]
material = "m"
box = { lower = [0, 0], upper = [0.4, 0.1] }
velocity = [1, 0]
[walls.lo]
polyline = [[0, 0], [0.2, 0]]
slip = "friction"
wall_friction = 0.2
[walls.up]
polyline = [[0.2, 0], [0.4, 0]]
slip = "friction"
wall_friction = 0.2
[gauges.lo]
kind = "force"
on = "wall.lo"
[gauges.up]
kind = "force"
on = "wall.up"
[run]
step = "20 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("parted", text).unwrap());
    let [first_along, first, second_along, second] = forces_on_both(&mut unit, 0.1, 0.4);
    println!(
        "first {first:.1} N, rubs {first_along:.2} N; second {second:.1} N, rubs {second_along:.2} N"
    );
    let half = 0.5 * (first + second);
    // Of 20 columns of beads, jittered, each wall has ten: a tenth of a spacing either way.
    assert!((first / half - 1.0).abs() < 0.01, "{first} N of {half}");
    for (along, across) in [(first_along, first), (second_along, second)] {
        let friction = -along / across;
        assert!((friction - 0.2).abs() < 0.004, "{friction} for 0.2");
    }
}
