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
        assert!((sharp / square - 1.0).abs() < 0.025);
    }
}

/// A hopper with sides of 45 deg that end at an outlet, eight spacings across in the plane or twelve round about its axis; `filling`: its material.
fn hopper(round: bool, slip: &str, filling: &str) -> Unit {
    let (dimension, width, polygon, left, from) = if round {
        let polygon = "[[0, 0], [0.03, 0], [0.1, 0.07], [0.1, 0.2], [0, 0.2]]";
        ("\"axisymmetric\"", "", polygon, String::new(), "0")
    } else {
        let polygon = "[[-0.02, 0], [0.02, 0], [0.1, 0.08], [0.1, 0.2], [-0.1, 0.2], [-0.1, 0.08]]";
        let left =
            format!("[walls.left]\n{slip}\npolyline = [[-0.1, 0.24], [-0.1, 0.08], [-0.02, 0]]");
        ("2", "width = \"0.1 m\"", polygon, left, "-0.02")
    };
    let (outermost, edge, bend) = if round {
        ("0", "0.03", "0.07")
    } else {
        ("-0.15", "0.02", "0.08")
    };
    let text = format!(
        r#"
name = "hopper"
dimension = {dimension}
[domain]
lower = [{outermost}, -0.12]
upper = [0.15, 0.25]
{width}
[numerics]
spacing = "5 mm"
expected_speed = "1.5 m/s"
[materials.filling]
{filling}
[bodies.fill]
material = "filling"
polygon = {polygon}
{left}
[walls.right]
{slip}
polyline = [[{edge}, 0], [0.1, {bend}], [0.1, 0.24]]
[gates.main]
from = [{from}, 0]
to = [{edge}, 0]
[outflows.drain]
lower = [{outermost}, -0.12]
upper = [0.15, -0.08]
[gauges.flow]
kind = "discharge"
from = [{outermost}, -0.04]
to = [0.15, -0.04]
[run]
step = "10 ms"
until = "0.5 s"
"#
    );
    Unit::new(&scene::parse("hopper", &text).unwrap())
}

/// Mass that it has passed half a second after its gate began to open [kg].
fn passed(round: bool, slip: &str, filling: &str) -> f64 {
    let mut unit = hopper(round, slip, filling);
    unit.set("gate.main.opening", 1.0);
    unit.run_to(0.5);
    unit.get("gauge.flow.mass")
}

const BEADS: &str = "law = \"mu_i\"\npreset = \"glass_beads\"";

/// Friction of 0.6 deg takes about 1 % of what a hopper without passes; rings scatter by 2 % between coefficients. At 0.3, less than sand's own, it takes no
/// more than half a spacing of sand that sticks on either side would: 7/8 of the width to the power of 1.5, 0.82, less scatter.
#[test]
fn a_little_friction_takes_little_off_a_hopper() {
    for round in [false, true] {
        let free = passed(round, "slip = \"free_slip\"", BEADS);
        let with = |mu: f64| {
            passed(
                round,
                &format!("slip = \"friction\"\nwall_friction = {mu}"),
                BEADS,
            )
        };
        let (little, much) = (with(0.01), with(0.3));
        println!("round {round}: {free:.3} kg, {little:.3} at 0.01, {much:.3} at 0.3");
        assert!((little / free - 1.0).abs() < 0.05);
        assert!(much < free && much > 0.7 * free);
    }
}

/// Water does not rub on walls, whatever their friction.
#[test]
fn a_hopper_of_water_passes_the_same_with_friction() {
    let water = "law = \"fluid\"\npreset = \"water\"";
    let free = passed(false, "slip = \"free_slip\"", water);
    let rough = passed(false, "slip = \"friction\"\nwall_friction = 0.3", water);
    println!("{free:.3} kg, {rough:.3} with friction");
    assert!((rough / free - 1.0).abs() < 0.01);
}
