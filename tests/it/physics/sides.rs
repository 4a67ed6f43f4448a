//! What lies beside the sides of the domain: periodic ones are places like any other, others have the slack that is promised.

use super::Unit;
use sandgate::scene;

/// A bed of sand, periodic along x, with a gate that shuts into it at `x`, where it opened before.
fn bed(x: f64) -> Unit {
    let text = format!(
        r#"
name = "bed"
[domain]
lower = [0, 0]
upper = [0.4, 0.4]
periodic = ["x"]
[numerics]
spacing = "10 mm"
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.bed]
material = "sand"
box = {{ lower = [0, 0], upper = [0.4, 0.1] }}
[walls.floor]
plane = {{ point = [0, 0], normal = [0, 1] }}
[gates.slide]
from = [{x}, 0]
to = [{x}, 0.2]
start = 1
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("bed", &text).unwrap())
}

/// A gate at a periodic side saw no grains in its way and shut through the bed.
#[test]
fn a_gate_at_a_periodic_side_is_held_as_in_the_middle() {
    let openings = [0.2, 0.4].map(|x| {
        let mut unit = bed(x);
        unit.run_to(0.1);
        unit.set("gate.slide.opening", 0.0);
        unit.run_to(0.7);
        assert_eq!(unit.get("gate.slide.blocked"), 1.0, "{x}");
        unit.get("gate.slide.actual_opening")
    });
    println!("openings {openings:?}");
    // Half of the bed's depth is 0.25 of the way.
    assert!(
        openings.iter().all(|o| (0.2..0.5).contains(o)),
        "{openings:?}"
    );
}

/// A block that turns about its middle: particles that the start moves across a periodic side turn with it.
#[test]
fn a_body_that_turns_beside_a_periodic_side_turns_as_one() {
    let energy = |x: f64| {
        let text = format!(
            r#"
name = "block"
[domain]
lower = [0, 0]
upper = [0.4, 0.4]
periodic = ["x"]
gravity = 0
[numerics]
spacing = "10 mm"
expected_speed = 1
jitter = 0.4
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.block]
material = "sand"
box = {{ lower = [{}, 0.1], upper = [{}, 0.3] }}
angular_velocity = 3
centre = [{}, 0.2]
[run]
step = "10 ms"
until = "1 s"
"#,
            x - 0.1,
            x + 0.1,
            x
        );
        Unit::new(&scene::parse("block", &text).unwrap()).get("energy.kinetic")
    };
    let (aside, middle) = (energy(0.1), energy(0.2));
    assert!(
        (aside / middle - 1.0).abs() < 1e-3,
        "{aside} J for {middle} J"
    );
}

/// Water that runs against an inner wall on which its domain ends stands behind that face by less than a hundredth of a spacing.
#[test]
fn rings_may_stand_a_little_behind_an_inner_wall() {
    let text = r#"
name = "ring"
dimension = "axisymmetric"
[domain]
lower = [0.1, 0]
upper = [0.4, 5]
[numerics]
spacing = "10 mm"
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = { lower = [0.25, 0], upper = [0.4, 0.3] }
[walls.inner]
plane = { point = [0.1, 0], normal = [1, 0] }
slip = "free_slip"
[walls.outer]
plane = { point = [0.4, 0], normal = [-1, 0] }
slip = "free_slip"
[walls.floor]
plane = { point = [0.1, 0], normal = [0, 1] }
slip = "free_slip"
[run]
step = "1 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("ring", text).unwrap());
    let mut innermost = f64::INFINITY;
    for _ in 0..900 {
        unit.step();
        innermost = innermost.min(unit.component.totals().lower[0]);
    }
    println!("innermost {innermost} m");
    assert!(innermost < 0.1 && innermost > 0.0975, "{innermost}");
}

/// What leaves the domain other than by a periodic side is taken out and counted by an outflow with `outside = true`, in the plane, of rings and in
/// space; without one it ends the run, by name.
#[test]
fn what_leaves_is_counted_where_a_scene_asks_for_it() {
    for dimension in ["2", "\"axisymmetric\"", "3"] {
        let (corner, middle, size) = match dimension {
            "3" => ("[0, 0, 0]", "[0.15, 0.1, 0.1]", "[0.2, 0.1, 0.2]"),
            _ => ("[0, 0]", "[0.15, 0.1]", "[0.2, 0.2]"),
        };
        let (periodic, start, velocity) = match dimension {
            "3" => ("periodic = [\"y\"]", "[0.05, 0, 0.05]", "[1, 0.3, 1]"),
            "2" => ("", "[0.05, 0.05]", "[1, 1]"),
            _ => ("", "[0.05, 0.05]", "[0, 1]"),
        };
        let scene = |spill: &str| {
            let text = format!(
                r#"
name = "thrown"
dimension = {dimension}
[domain]
lower = {corner}
upper = {size}
{periodic}
[numerics]
spacing = "10 mm"
expected_speed = 2
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.block]
material = "sand"
box = {{ lower = {start}, upper = {middle} }}
velocity = {velocity}
{spill}
[run]
step = "10 ms"
until = "1 s"
"#
            );
            scene::parse("thrown", &text).unwrap_or_else(|e| panic!("{e}"))
        };
        let mut unit = Unit::new(&scene("[outflows.spill]\noutside = true"));
        let mass = unit.get("mass.present");
        unit.run_to(0.05);
        assert_eq!(unit.get("outflow.spill.mass"), 0.0, "{dimension}");
        unit.run_to(0.5);
        assert_eq!(unit.get("outflow.spill.mass"), mass, "{dimension}");
        assert_eq!(unit.get("solver.particles"), 0.0);
        let mut lost = Unit::new(&scene("")).component;
        let told = (0..50).find_map(|_| lost.do_step(lost.time(), 0.01).err());
        let told = told.map(|error| error.to_string()).unwrap_or_default();
        assert!(
            told.contains("left the domain") && told.contains("outside = true"),
            "{told}"
        );
    }
}
