//! Moments of what material pushes walls and gates with: those of statics, and the torque that turns a drum.

use super::{Unit, case};
use sandgate::scene;

/// Water 0.2 m deep in a tank 0.3 m wide, at rest: its side and a gate bear rho g H^3/6 about their foot, its floor its weight half the
/// width away from a corner.
#[test]
fn water_turns_its_walls_as_statics_say() {
    let about =
        |on: &str, point: &str| format!("kind = \"force\"\non = \"{on}\"\nabout = {point}\n");
    let text = format!(
        r#"
name = "tank"
[domain]
lower = [-0.1, -0.1]
upper = [0.6, 0.4]
width = 0.5
[numerics]
spacing = "10 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0, 0], upper = [0.3, 0.2] }}
[walls.side]
polyline = [[0, 0.35], [0, 0]]
[walls.floor]
polyline = [[0, 0], [0.5, 0]]
[gates.g]
from = [0.3, 0]
to = [0.3, 0.3]
[gauges.side]
{}
[gauges.gate]
{}
[gauges.floor]
{}
[gauges.middle]
{}
[run]
step = "10 ms"
until = "1 s"
"#,
        about("wall.side", "[0, 0]"),
        about("gate.g", "[0.3, 0]"),
        about("wall.floor", "[0, 0]"),
        about("wall.floor", "[0.15, -0.2]"),
    );
    let mut unit = Unit::new(&scene::parse("tank", &text).unwrap());
    let names = ["side", "gate", "floor", "middle"];
    let mut means = [0.0; 4];
    unit.run_to(1.5);
    for k in 1..=50 {
        unit.run_to(1.5 + 0.01 * f64::from(k));
        for (mean, name) in means.iter_mut().zip(names) {
            *mean += unit.get(&format!("gauge.{name}.moment")) / 50.0;
        }
    }
    let (weight, turning) = (1000.0 * 9.81 * 0.5, 0.2f64.powi(3) / 6.0);
    // Material to the right of the side presses it to the left.
    let exact = [turning, -turning, -0.2 * 0.3 * 0.15, 0.0].map(|m| m * weight);
    println!("moments {means:.4?} N m, exact {exact:.4?}");
    for ((name, mean), exact) in names.iter().zip(means).zip(exact) {
        let size = f64::abs(exact).max(turning * weight);
        assert!(
            (mean - exact).abs() < 0.02 * size,
            "{name}: {mean} for {exact}"
        );
    }
}

/// What turns a half full drum holds the sand's weight aside.
#[test]
fn a_drum_is_turned_against_the_weight_that_it_lifts() {
    for slip in ["", "slip = \"friction\"\nwall_friction = 0.8"] {
        let motion = format!("motion = \"rigid\"\n{slip}");
        let scene = case(
            "rotating_drum",
            &[
                ("spacing = \"4 mm\"", "spacing = \"5 mm\""),
                ("motion = \"rigid\"", motion.as_str()),
            ],
        );
        let mut unit = Unit::new(&scene);
        let (mut borne, mut weighs) = (0.0, 0.0);
        unit.run_to(1.0);
        for k in 1..=200 {
            unit.run_to(1.0 + 0.01 * f64::from(k));
            borne += unit.get("gauge.drum.moment") / 200.0;
            let particles = unit.component.particles();
            let arms = particles.position.iter().map(|x| f64::from(x[0]));
            let arm = arms.sum::<f64>() / particles.position.len() as f64;
            weighs -= arm * unit.get("mass.present") * 9.81 / 200.0;
        }
        println!("{slip:?}: the drum bears {borne:.4} N m, the weight makes {weighs:.4}");
        assert!(weighs < -5.0, "it lifts");
        assert!((borne / weighs - 1.0).abs() < 0.01, "{borne} for {weighs}");
    }
}

/// In space each axis has one, and they are in states.
#[test]
fn moments_in_space_are_those_of_their_axes() {
    let text = r#"
name = "box"
dimension = 3
[domain]
lower = [-0.05, -0.05, -0.05]
upper = [0.25, 0.25, 0.15]
gravity = [0, -9.81, 0]
[numerics]
spacing = "10 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = { lower = [0, 0, 0], upper = [0.1, 0.1, 0.1] }
[walls.floor]
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
[walls.left]
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[walls.right]
plane = { point = [0.1, 0, 0], normal = [-1, 0, 0] }
[walls.front]
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[walls.back]
plane = { point = [0, 0, 0.1], normal = [0, 0, -1] }
[gauges.left]
kind = "force"
on = "wall.left"
about = [0, 0, 0]
[run]
step = "10 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("box", text).unwrap());
    let mut means = [0.0; 3];
    unit.run_to(0.5);
    for k in 1..=30 {
        unit.run_to(0.5 + 0.01 * f64::from(k));
        for (mean, axis) in means.iter_mut().zip(["x", "y", "z"]) {
            *mean += unit.get(&format!("gauge.left.moment_{axis}")) / 30.0;
        }
    }
    // F = (-rho g H^2/2 B, 0, 0) at (0, H/3, B/2).
    let force = 1000.0 * 9.81 * 0.5 * 0.1f64.powi(3);
    let exact = [0.0, -force * 0.05, force * 0.1 / 3.0];
    println!("moments {means:.5?} N m, exact {exact:.5?}");
    for (mean, exact) in means.iter().zip(exact) {
        assert!(
            (mean - exact).abs() < 0.03 * force * 0.05,
            "{means:?} for {exact:?}"
        );
    }
}
