//! Boxes as walls: what they bear does not hang on how far they go on where nothing is.

use super::Unit;
use sandgate::scene;

/// Sand that slides down 25 deg on a bed in a period of 0.1 m, 20 spacings deep: force on the bed along it [N] and kinetic energy after 0.4 s [J].
fn slide(bed: &str) -> (f64, f64) {
    let text = format!(
        r#"
name = "bed"
dimension = 2
[domain]
lower = [0, -0.05]
upper = [0.1, 0.25]
periodic = ["x"]
slope = "25 deg"
[numerics]
spacing = 0.005
[materials.m]
law = "constant_friction"
friction_angle = "20 deg"
match = "simple_shear"
density = 1600
[bodies.b]
material = "m"
box = {{ lower = [0, 0], upper = [0.1, 0.1] }}
[walls.bed]
{bed}
slip = "free_slip"
[gauges.f]
kind = "force"
on = "wall.bed"
[run]
step = 0.02
until = 0.4
"#
    );
    let mut unit = Unit::new(&scene::parse("bed", &text).unwrap());
    unit.run_to(0.4);
    (unit.get("gauge.f.force_x"), unit.get("energy.kinetic"))
}

/// m (g sin 25 deg t)^2/2 = 22.00 J for 16 kg, and nothing along the bed: the two ends of a box held it back by 0.03 of its weight. The
/// chain has 0.01 N and 0.02 % by rounding of the solve.
#[test]
fn a_smooth_box_that_spans_a_period_brakes_nothing() {
    let stands = "box = { lower = [0, -0.03], upper = [0.1, 0] }";
    let moves = format!("{stands}\nmotion = \"rigid\"\nvelocity = [-0.3, 0]");
    for bed in [stands, &moves] {
        let (force, energy) = slide(bed);
        let exact = 8.0 * (9.81 * 25f64.to_radians().sin() * 0.4).powi(2);
        println!("{force} N, {energy} J for 0 and {exact}");
        assert!(force.abs() < 0.03, "{bed}: {force} N");
        assert!((energy / exact - 1.0).abs() < 1e-3, "{bed}: {energy} J");
    }
}

/// Force on a smooth wall that gives way at 10 mm/s, sand 10 spacings deep and 5 wide behind it, after 0.1 s [N].
fn retaining(wall: &str, side: [&str; 2]) -> [f64; 3] {
    let [left, right] = side;
    let text = format!(
        r#"
name = "retaining"
dimension = 3
[domain]
lower = [-0.2, -0.05, -0.1]
upper = [0.25, 0.1, 0.35]
[numerics]
spacing = 0.01
[materials.m]
law = "constant_friction"
friction_angle = "30 deg"
density = 1600
[bodies.b]
material = "m"
box = {{ lower = [0, 0, 0], upper = [0.15, 0.05, 0.1] }}
[walls.floor]
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[walls.back]
plane = {{ point = [0.15, 0, 0], normal = [-1, 0, 0] }}
slip = "free_slip"
[walls.left]
{left}
slip = "free_slip"
[walls.right]
{right}
slip = "free_slip"
[walls.wall]
{wall}
slip = "free_slip"
motion = "rigid"
velocity = [-0.01, 0, 0]
[gauges.f]
kind = "force"
on = "wall.wall"
[run]
step = 0.02
until = 0.1
"#
    );
    let mut unit = Unit::new(&scene::parse("retaining", &text).unwrap());
    unit.run_to(0.1);
    ["x", "y", "z"].map(|k| unit.get(&format!("gauge.f.force_{k}")))
}

const PLANES: [&str; 2] = [
    "plane = { point = [0, 0, 0], normal = [0, 1, 0] }",
    "plane = { point = [0, 0.05, 0], normal = [0, -1, 0] }",
];

/// The same to rounding of where the points lie, be it a box or a plane. One row behind each side pushed a box down by 0.25 of its thrust.
#[test]
fn what_a_wall_has_behind_planes_that_it_slides_along_counts_for_nothing() {
    let ends = retaining(
        "box = { lower = [-0.06, 0, 0], upper = [0, 0.05, 0.3] }",
        PLANES,
    );
    let walls = [
        "box = { lower = [-0.06, -0.01, 0], upper = [0, 0.06, 0.3] }",
        "box = { lower = [-0.06, -0.05, -0.02], upper = [0, 0.1, 0.3] }",
        "plane = { point = [0, 0, 0], normal = [1, 0, 0] }",
    ];
    for wall in walls {
        let force = retaining(wall, PLANES);
        println!("{force:?} N, {ends:?} of the one that ends there");
        for (a, b) in force.iter().zip(&ends) {
            assert!(
                (a - b).abs() < 1e-3 * ends[0].abs(),
                "{wall}: {force:?}, {ends:?} N"
            );
        }
    }
}

/// Sides that are boxes keep what reaches into them, and it goes on as the face beside: nothing is borne along the wall (0.02 of the
/// thrust is; 0.25 was).
#[test]
fn a_box_that_reaches_into_others_looks_there_as_beside_them() {
    let boxes = [
        "box = { lower = [-0.15, -0.05, 0], upper = [0.2, 0, 0.345] }",
        "box = { lower = [-0.15, 0.05, 0], upper = [0.2, 0.1, 0.345] }",
    ];
    let force = retaining(
        "box = { lower = [-0.06, -0.01, 0], upper = [0, 0.06, 0.3] }",
        boxes,
    );
    println!("{force:?} N");
    assert!(force[2].abs() < 0.05 * force[0].abs(), "{force:?} N");
}

/// A floor that is a box goes on under the walls that stand on it, by any length: each wall's thrust is its own.
/// The floor's points in the corner looked towards its own end: 0.055 of the thrust was the floor's, at four spacings and more. At four 0.01 still is.
#[test]
fn a_floor_that_goes_on_under_its_walls_takes_nothing_of_their_thrust() {
    for more in [0.0, 0.01, 0.02, 0.04, 0.1] {
        let text = format!(
            r#"
name = "floor"
[domain]
lower = [-0.2, -0.2]
upper = [0.4, 0.2]
[numerics]
spacing = 0.01
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0, 0], upper = [0.2, 0.1] }}
[walls.floor]
box = {{ lower = [{}, -0.1], upper = [{}, 0] }}
slip = "free_slip"
[walls.left]
plane = {{ point = [0, 0], normal = [1, 0] }}
slip = "free_slip"
[walls.right]
plane = {{ point = [0.2, 0], normal = [-1, 0] }}
slip = "free_slip"
[gauges.f]
kind = "force"
on = "wall.left"
[run]
step = 0.02
until = 0.4
"#,
            -more,
            0.2 + more
        );
        let scene = scene::parse("floor.toml", &text).unwrap_or_else(|e| panic!("{e}"));
        let mut unit = Unit::new(&scene);
        unit.run_to(0.4);
        let thrust = -unit.get("gauge.f.force_x") / (0.5 * 1000.0 * 9.81 * 0.1_f64.powi(2));
        println!("{more} m under the walls: {thrust} of the thrust");
        assert!((thrust - 1.0).abs() < 0.015, "{more}: {thrust}");
    }
}
