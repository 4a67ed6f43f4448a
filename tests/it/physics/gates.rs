//! Gates in water: what they bear, and what must not keep them from closing.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

/// A sluice between two tanks of water, open by 80 mm, closes as fast as it may; with this seed a drop stands still at its lip and held it.
#[test]
fn a_drop_holds_no_gate() {
    let text = r#"
name = "lock"
[domain]
lower = [-0.1, -0.1]
upper = [1.1, 0.9]
[numerics]
spacing = "10 mm"
seed = 2
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[bodies.left]
material = "water"
box = { lower = [0, 0], upper = [0.48, 0.4] }
[bodies.right]
material = "water"
box = { lower = [0.52, 0], upper = [1, 0.2] }
[walls.tank]
polyline = [[0, 0.8], [0, 0], [1, 0], [1, 0.8]]
slip = "free_slip"
[gates.sluice]
from = [0.48, 0]
to = [0.48, 0.5]
max_speed = 1
[run]
step = "20 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("lock", text).unwrap());
    unit.run_to(0.1);
    unit.set("gate.sluice.opening", 0.16);
    unit.run_to(0.6);
    unit.set("gate.sluice.opening", 0.0);
    unit.run_to(0.74);
    assert_eq!(unit.get("gate.sluice.actual_opening"), 0.0);
}

const FLOOR: &str = "[[0, 0], [2.4, 0]]";

/// A tank of water 1 m deep in a plane of 1 m, or 0.5 m broad in space, behind a gate, in rows of 0.1 m, with a force gauge on each wall.
/// `floor` is the plane's.
fn tank(dimension: usize, floor: &str) -> Unit {
    let point = |p: [&str; 3]| p[..dimension].join(", ");
    let mut text = format!(
        r#"
name = "tank"
dimension = {dimension}
[domain]
lower = [{}]
upper = [{}]
[numerics]
spacing = 0.1
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0, 0, {}], upper = [1, {}] }}
[gates.dam]
"#,
        point(["-0.5", "-0.5", "-0.5"]),
        point(["2.5", "2", "2"]),
        if dimension == 3 { "0" } else { "" },
        if dimension == 3 { "0.5, 1" } else { "1" },
    );
    let mut walls = vec![("left", "[0, 0, 0]", "[1, 0, 0]")];
    if dimension == 3 {
        text += "from = [1, 0.5, 0]\nto = [1, 0.5, 1.3]\nspan = [0, -0.5, 0]\nthickness = 0.4\n";
        walls.push(("floor", "[0, 0, 0]", "[0, 0, 1]"));
        walls.push(("front", "[0, 0, 0]", "[0, 1, 0]"));
        walls.push(("back", "[0, 0.5, 0]", "[0, -1, 0]"));
        for (name, point, normal) in &walls {
            text += &format!(
                "[walls.{name}]\nplane = {{ point = {point}, normal = {normal} }}\nslip = \"free_slip\"\n"
            );
        }
    } else {
        text += "from = [1, 0]\nto = [1, 1.3]\nthickness = 0.4\n";
        walls.push(("floor", "[0, 0]", "[2.4, 0]"));
        text += "[walls.left]\npolyline = [[0, 1.5], [0, 0]]\nslip = \"free_slip\"\n";
        text += &format!("[walls.floor]\npolyline = {floor}\nslip = \"free_slip\"\n");
    }
    let walls = walls.iter().map(|(name, ..)| format!("wall.{name}"));
    for on in walls.chain(["gate.dam".to_owned()]) {
        let name = &on[5..];
        text += &format!("[gauges.{name}]\nkind = \"force\"\non = \"{on}\"\n");
    }
    text += "[run]\nstep = 0.05\nuntil = 1\n";
    let mut unit = Unit::new(&scene::parse("tank", &text).unwrap());
    unit.run_to(0.5);
    unit
}

/// Each wall of a tank bears what hydrostatics says, whoever has the points of its edges, and nothing along itself: a gate lacked 6 % of its
/// thrust at ten rows, in space 16 %.
#[test]
fn a_gate_bears_the_thrust_of_the_water() {
    for (dimension, width) in [(2, 1.0), (3, 0.5)] {
        let unit = tank(dimension, FLOOR);
        let thrust = 0.5 * 1000.0 * G * width;
        let up = ["y", "z"][dimension - 2];
        let mut expected = vec![
            ("dam", "x", thrust),
            ("left", "x", -thrust),
            ("floor", up, -2.0 * thrust),
        ];
        if dimension == 3 {
            expected.extend([("front", "y", -2.0 * thrust), ("back", "y", 2.0 * thrust)]);
        }
        for (wall, axis, force) in expected {
            for k in ["x", "y", "z"].iter().take(dimension) {
                let found = unit.get(&format!("gauge.{wall}.force_{k}"));
                let exact = if *k == axis { force } else { 0.0 };
                let error = (found - exact) / force.abs();
                println!(
                    "{dimension}D: {wall} {k}: {found:.1} N for {exact:.1}: {:.2} %",
                    1e2 * error
                );
                assert!(error.abs() < 0.015, "{wall} {k}: {found} N for {exact}");
            }
        }
    }
}

/// So it does wherever the floor's points lie, that of a corner among them: a gate lacked up to 6 % of its thrust.
#[test]
fn a_gate_bears_as_much_wherever_the_points_of_its_floor_lie() {
    let thrust = 0.5 * 1000.0 * G;
    let every_137_mm: Vec<_> = (0..18).map(|k| [0.137 * f64::from(k), 0.0]).collect();
    for (floor, allowed) in [
        (FLOOR, 0.005),
        ("[[0, 0], [1, 0], [2.4, 0]]", 0.01),
        ("[[0, 0], [1.03, 0], [2.4, 0]]", 0.01),
        ("[[0, 0], [2.35, 0]]", 0.01),
        ("[[0, 0], [1, 0], [2.4, 0.05]]", 0.01),
        (&format!("{every_137_mm:?}"), 0.02),
    ] {
        let found = tank(2, floor).get("gauge.dam.force_x") / thrust;
        println!("{found:.4} of its thrust on {floor}");
        assert!((found - 1.0).abs() < allowed, "{found} on {floor}");
    }
}

/// A gate flush in a floor bears the water above it, whatever lips stand below its edges: they lie behind the floor, and what fills
/// the edge under a lip bears for it. It read 6 % too much beside upright lips, 14 % beside those of 45 degrees.
#[test]
fn a_gate_in_a_floor_bears_what_is_above_it() {
    let lip = |depth: f64, aside: f64| {
        format!(
            r#"
name = "bin"
[domain]
lower = [-0.35, -0.3]
upper = [0.35, 0.6]
[numerics]
spacing = "5 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [-0.15, 0], upper = [0.15, 0.2] }}
[walls.left]
polyline = [[-0.15, 0.5], [-0.15, 0], [-0.03, 0], [{}, -{depth}]]
slip = "free_slip"
[walls.right]
polyline = [[{}, -{depth}], [0.03, 0], [0.15, 0], [0.15, 0.5]]
slip = "free_slip"
[gates.main]
from = [-0.03, 0]
to = [0.03, 0]
[gauges.force]
kind = "force"
on = "gate.main"
[run]
step = "50 ms"
until = "0.5 s"
"#,
            -0.03 - aside,
            0.03 + aside,
        )
    };
    let weight = 1000.0 * G * 0.2 * 0.06;
    for (depth, aside) in [(0.06, 0.0), (0.04, 0.02), (0.04, 0.04), (0.0125, 0.01)] {
        let mut bin = Unit::new(&scene::parse("bin", &lip(depth, aside)).unwrap());
        bin.run_to(0.5);
        let found = -bin.get("gauge.force.force_y") / weight;
        println!("lip {depth} m down, {aside} m aside: {found:.4} of the water's weight");
        assert!((found - 1.0).abs() < 0.04);
    }
}

/// A gate that closes on sand at 1 m/s takes its time for the last of its opening, and what stands there falls out of it: it shot grains out at
/// 7 m/s, which left the domain.
#[test]
fn a_fast_gate_shoots_no_grains() {
    let text = r#"
name = "hopper"
[domain]
lower = [-0.2, -0.3]
upper = [0.5, 0.7]
[numerics]
spacing = "7 mm"
sound_speed = 20
[materials.sand]
law = "mu_i"
preset = "sand_04"
[walls.left]
polyline = [[0, 0.5], [0, 0], [0.1, 0]]
slip = "free_slip"
[walls.right]
polyline = [[0.2, 0], [0.3, 0], [0.3, 0.5]]
slip = "free_slip"
[gates.main]
from = [0.1, 0]
to = [0.2, 0]
thickness = 0.08
max_speed = 1
[inflows.feed]
material = "sand"
from = [0.25, 0.45]
to = [0.05, 0.45]
velocity = [0, -1]
[outflows.out]
lower = [-0.2, -0.3]
upper = [0.5, -0.2]
[gauges.above]
kind = "mass"
lower = [-0.2, 0.25]
upper = [0.5, 0.7]
[run]
step = "10 ms"
until = "2.4 s"
"#;
    let mut unit = Unit::new(&scene::parse("hopper", text).unwrap());
    unit.set("inflow.feed.rate", 30.0);
    unit.run_to(1.0);
    unit.set("inflow.feed.rate", 0.0);
    unit.run_to(1.6);
    unit.set("gate.main.opening", 1.0);
    unit.run_to(1.85);
    unit.set("gate.main.opening", 0.0);
    for n in 1..=55 {
        unit.run_to(1.85 + 0.01 * f64::from(n));
        let thrown = unit.get("gauge.above.mass");
        assert!(thrown == 0.0, "{thrown} kg above the fill");
    }
    assert!(unit.get("gate.main.actual_opening") < 0.25);
}

/// A gate flush with the lip of a steep hopper has the stream along its edge all the time: single grains of it held it, for more than
/// the time of its way.
#[test]
fn a_stream_along_the_lip_holds_no_gate() {
    let text = r#"
name = "hopper"
[domain]
lower = [-0.2, -0.3]
upper = [0.2, 0.4]
[numerics]
spacing = "6 mm"
seed = 2
expected_speed = 1.5
[materials.beads]
law = "mu_i"
preset = "glass_beads"
[bodies.fill]
material = "beads"
polygon = [[-0.03, 0], [0.03, 0], [0.1, 0.121], [0.1, 0.25], [-0.1, 0.25], [-0.1, 0.121]]
[walls.left]
polyline = [[-0.1, 0.4], [-0.1, 0.121], [-0.03, 0], [-0.08, 0]]
[walls.right]
polyline = [[0.08, 0], [0.03, 0], [0.1, 0.121], [0.1, 0.4]]
[gates.mouth]
from = [-0.03, 0]
to = [0.03, 0]
max_speed = 0.5
[outflows.below]
lower = [-0.2, -0.3]
upper = [0.2, -0.15]
[run]
step = "10 ms"
until = "0.6 s"
"#;
    let mut unit = Unit::new(&scene::parse("hopper", text).unwrap());
    unit.set("gate.mouth.opening", 1.0);
    unit.run_to(0.5);
    unit.set("gate.mouth.opening", 0.5);
    // 30 mm are 60 ms of its way.
    unit.run_to(0.58);
    assert_eq!(unit.get("gate.mouth.actual_opening"), 0.5);
}
