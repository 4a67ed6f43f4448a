//! Closed bodies of walls and gates hold what is in them, whatever moves, opens or is named first. No reference but that nothing
//! gets through.

use super::Unit;
use sandgate::scene;

/// A scene of particles of 5 mm, 0.1 m wide and 0.08 m high, and what goes round it.
fn unit(material: &str, parts: &str) -> Unit {
    let text = format!(
        r#"
name = "closed"
[domain]
lower = [-0.3, -0.3]
upper = [0.4, 0.4]
[numerics]
spacing = "5 mm"
[materials.filling]
{material}
[bodies.filling]
material = "filling"
box = {{ lower = [0, 0], upper = [0.1, 0.08] }}
{parts}
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("closed", &text).unwrap())
}

const WATER: &str = "law = \"fluid\"\npreset = \"water\"";
const SAND: &str = "law = \"mu_i\"\npreset = \"sand_08\"";

/// Extent of all particles: least and largest x, least y [m].
fn extent(unit: &Unit) -> [f64; 3] {
    let all = unit.component.particles().position;
    let of = |k: usize| all.iter().map(move |x| f64::from(x[k]));
    let (least, most) = (f64::min, f64::max);
    [
        of(0).fold(f64::INFINITY, least),
        of(0).fold(f64::NEG_INFINITY, most),
        of(1).fold(f64::INFINITY, least),
    ]
}

/// Two fixed sides and a floor that falls, in either order of names.
#[test]
fn nothing_gets_out_where_a_wall_leaves_and_names_do_not_matter() {
    let floor =
        "plane = { point = [0, 0], normal = [0, 1] }\nmotion = \"rigid\"\nvelocity = [0, -0.1]";
    let box_of = |floor_name: &str| {
        format!(
            "[walls.{floor_name}]\n{floor}\n\
             [walls.m]\nplane = {{ point = [0, 0], normal = [1, 0] }}\n\
             [walls.n]\nplane = {{ point = [0.1, 0], normal = [-1, 0] }}\n"
        )
    };
    for material in [SAND, WATER] {
        let [first, last] = ["a", "z"].map(|name| {
            let mut unit = unit(material, &box_of(name));
            unit.run_to(0.3);
            let [left, right, low] = extent(&unit);
            assert!(
                left > 0.0 && right < 0.1 && low > -0.03,
                "{left} {right} {low}"
            );
            unit.component.particles().position
        });
        assert_eq!(first, last);
    }
}

/// A bin of three walls that move together.
#[test]
fn walls_that_move_together_hold_water_as_fixed_ones_do() {
    let wall = |name: &str, points: &str| {
        format!("[walls.{name}]\npolyline = {points}\nmotion = \"rigid\"\nvelocity = [0.1, 0]\n")
    };
    let parts = [
        wall("l", "[[0, 0.2], [0, 0]]"),
        wall("f", "[[0, 0], [0.1, 0]]"),
        wall("r", "[[0.1, 0], [0.1, 0.2]]"),
    ];
    let mut unit = unit(WATER, &parts.concat());
    unit.run_to(0.5);
    let [left, right, low] = extent(&unit);
    assert!(
        left > 0.05 && right < 0.15 && low > 0.0,
        "{left} {right} {low}"
    );
}

/// A floor gate from wall foot to wall foot and an upright one at the end of a floor: shut they hold water, half open it flows, and
/// shut again they hold it.
#[test]
fn a_shut_gate_leaves_no_gap_where_it_meets_a_wall() {
    let below = "[walls.l]\npolyline = [[0, 0.3], [0, 0]]\n[walls.r]\npolyline = [[0.1, 0], [0.1, 0.3]]\n\
                 [gates.g]\nfrom = [0, 0]\nto = [0.1, 0]\nmax_speed = 0.5\n";
    let beside = "[walls.l]\npolyline = [[0, 0.3], [0, 0], [0.1, 0]]\n\
                  [gates.g]\nfrom = [0.1, 0]\nto = [0.1, 0.15]\nmax_speed = 0.5\n";
    let outflow = "[outflows.o]\nlower = [-0.3, -0.3]\nupper = [0.4, -0.05]\n\
                   [outflows.p]\nlower = [0.25, -0.05]\nupper = [0.4, 0.4]\n";
    for parts in [below, beside] {
        let mut unit = unit(WATER, &format!("{parts}{outflow}"));
        unit.run_to(0.3);
        let [left, right, low] = extent(&unit);
        assert!(
            left > 0.0 && right < 0.1 && low > 0.0,
            "{left} {right} {low}"
        );
        unit.set("gate.g.opening", 0.2);
        unit.run_to(0.4);
        unit.set("gate.g.opening", 0.0);
        unit.run_to(0.6);
        let left = unit.get("mass.present");
        assert!(left < 0.95 * unit.component.ledger().initial && left > 1.0);
        unit.run_to(1.0);
        assert_eq!(unit.get("mass.present"), left);
    }
}
