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

/// Tanks of bodies that share no more than an edge: boxes, a polyline that ends at a box, gates at the end of a floor and of each other.
#[test]
fn bodies_that_meet_at_an_edge_leave_no_gap() {
    let left = "[walls.l]\nbox = { lower = [-0.04, 0], upper = [0, 0.2] }\n";
    let right = "[walls.r]\nbox = { lower = [0.1, 0], upper = [0.14, 0.2] }\n";
    let floor = "[walls.f]\nbox = { lower = [0, -0.04], upper = [0.1, 0] }\n";
    let chain = "[walls.f]\npolyline = [[0, 0], [0.1, 0]]\n";
    let half = "[walls.f]\nbox = { lower = [0, -0.04], upper = [0.05, 0] }\n";
    let upright = "[gates.g]\nfrom = [0.1, 0]\nto = [0.1, 0.2]\n";
    let below = "[gates.h]\nfrom = [0.05, 0]\nto = [0.1, 0]\n";
    let tanks = [
        ("three boxes", [left, floor, right, ""]),
        ("a chain between boxes", [left, chain, right, ""]),
        ("a gate at the end of a floor", [left, floor, upright, ""]),
        (
            "a gate in the floor beside a box",
            [left, half, right, below],
        ),
        ("two gates", [left, half, upright, below]),
    ];
    for (name, parts) in tanks {
        for order in [false, true] {
            let mut parts = parts.to_vec();
            if order {
                parts.reverse();
            }
            let parts: String = parts.concat();
            for material in [WATER, SAND] {
                let mut unit = unit(material, &parts);
                unit.run_to(1.0);
                let [left, right, low] = extent(&unit);
                assert!(
                    left > 0.0 && right < 0.1 && low > 0.0,
                    "{name}: {left} {right} {low}"
                );
            }
        }
    }
}

/// The same in space, where a floor and four sides are boxes that share edges and, three by three, corners; and about an axis.
#[test]
fn boxes_in_space_and_rings_of_them_leave_no_gap() {
    let text = |dimension: &str, body: &str, walls: &str| {
        format!(
            "name = \"closed\"\ndimension = {dimension}\n{body}\n{walls}\n[numerics]\nspacing = \"10 mm\"\n\
             [materials.filling]\n{WATER}\n[run]\nstep = \"10 ms\"\nuntil = \"0.6 s\"\n"
        )
    };
    let wall = |name: &str, lower: &str, upper: &str| {
        format!("[walls.{name}]\nbox = {{ lower = [{lower}], upper = [{upper}] }}\n")
    };
    let space = [
        wall("floor", "0, 0, -0.08", "0.08, 0.06, 0"),
        wall("a", "-0.08, 0, 0", "0, 0.06, 0.15"),
        wall("b", "0.08, 0, 0", "0.16, 0.06, 0.15"),
        wall("c", "0, -0.08, 0", "0.08, 0, 0.15"),
        wall("d", "0, 0.06, 0", "0.08, 0.14, 0.15"),
    ];
    let rings = [
        wall("floor", "0, -0.08", "0.08, 0"),
        wall("side", "0.08, 0", "0.16, 0.2"),
    ];
    let scenes = [
        text(
            "3",
            "[domain]\nlower = [-0.3, -0.3, -0.3]\nupper = [0.4, 0.4, 0.4]\n[bodies.filling]\nmaterial = \"filling\"\n\
             box = { lower = [0, 0, 0], upper = [0.08, 0.06, 0.08] }",
            &space.concat(),
        ),
        text(
            "\"axisymmetric\"",
            "[domain]\nlower = [0, -0.3]\nupper = [0.4, 0.4]\n[bodies.filling]\nmaterial = \"filling\"\n\
             box = { lower = [0, 0], upper = [0.08, 0.1] }",
            &rings.concat(),
        ),
    ];
    for text in scenes {
        let mut unit = Unit::new(&scene::parse("closed", &text).unwrap());
        unit.run_to(0.6);
        let [left, right, _] = extent(&unit);
        let up = if text.contains("dimension = 3") { 2 } else { 1 };
        let all = unit.component.particles().position;
        let low = all.iter().map(|x| x[up]).fold(f32::INFINITY, f32::min);
        let side = all.iter().map(|x| x[1]).fold(f32::INFINITY, f32::min);
        assert!(
            left > 0.0 && right < 0.08 && low > 0.0 && side > 0.0,
            "{left} {right} {low} {side}"
        );
    }
}

/// In space an upright gate whose sides and foot share no more than edges with the boxes of a channel: shut, a third open and shut again.
#[test]
fn a_gate_in_space_leaves_no_gap_at_its_sides() {
    let wall = |name: &str, lower: &str, upper: &str| {
        format!("[walls.{name}]\nbox = {{ lower = [{lower}], upper = [{upper}] }}\n")
    };
    let channel = [
        wall("floor", "0, 0, -0.08", "0.08, 0.06, 0"),
        wall("a", "-0.08, 0, 0", "0, 0.06, 0.15"),
        wall("c", "0, -0.08, 0", "0.08, 0, 0.15"),
        wall("d", "0, 0.06, 0", "0.08, 0.14, 0.15"),
    ];
    let text = format!(
        "name = \"closed\"\ndimension = 3\n[domain]\nlower = [-0.3, -0.3, -0.6]\nupper = [0.6, 0.4, 0.4]\n\
         [numerics]\nspacing = \"10 mm\"\n[materials.filling]\n{WATER}\n[bodies.filling]\nmaterial = \"filling\"\n\
         box = {{ lower = [0, 0, 0], upper = [0.08, 0.06, 0.1] }}\n{}\
         [gates.g]\nfrom = [0.08, 0.06, 0]\nto = [0.08, 0.06, 0.15]\nspan = [0, -0.06, 0]\nmax_speed = 0.5\n\
         [outflows.o]\nlower = [0.09, -0.3, -0.6]\nupper = [0.6, 0.4, 0.4]\n\
         [outflows.p]\nlower = [-0.3, -0.3, -0.6]\nupper = [0.09, 0.4, -0.02]\n\
         [outflows.q]\nlower = [-0.3, -0.3, -0.02]\nupper = [0.09, -0.01, 0.4]\n\
         [outflows.r]\nlower = [-0.3, 0.07, -0.02]\nupper = [0.09, 0.4, 0.4]\n\
         [run]\nstep = \"10 ms\"\nuntil = \"0.8 s\"\n",
        channel.concat()
    );
    let mut unit = Unit::new(&scene::parse("closed", &text).unwrap());
    unit.run_to(0.3);
    assert_eq!(unit.get("mass.outflow"), 0.0);
    unit.set("gate.g.opening", 0.3);
    unit.run_to(0.36);
    unit.set("gate.g.opening", 0.0);
    unit.run_to(0.5);
    let left = unit.get("mass.present");
    println!("left {left} kg of {} kg", unit.component.ledger().initial);
    assert!(left < 0.95 * unit.component.ledger().initial && left > 0.1);
    unit.run_to(0.8);
    assert_eq!(unit.get("mass.present"), left);
}

/// A block that stands on a floor bears along its side what water pushes on it (rho g h^2/2), and the floor nothing of it: the face
/// it stands on is nobody's. Coarse, 16 rows: 1.5 %.
#[test]
fn the_foot_of_a_block_bears_what_is_pushed_on_it() {
    let parts = "[walls.l]\nbox = { lower = [-0.04, 0], upper = [0, 0.2] }\nslip = \"free_slip\"\n\
                 [walls.f]\nplane = { point = [0, 0], normal = [0, 1] }\nslip = \"free_slip\"\n\
                 [walls.r]\nplane = { point = [0.1, 0], normal = [-1, 0] }\nslip = \"free_slip\"\n\
                 [gauges.l]\nkind = \"force\"\non = \"wall.l\"\n[gauges.f]\nkind = \"force\"\non = \"wall.f\"\n";
    let mut unit = unit(WATER, parts);
    let (mut block, mut floor) = (0.0, 0.0);
    unit.run_to(0.8);
    for k in 1..=20 {
        unit.run_to(0.8 + 0.01 * f64::from(k));
        block += unit.get("gauge.l.force_x") / 20.0;
        floor += unit.get("gauge.f.force_x") / 20.0;
    }
    let thrust = 0.5 * 1000.0 * 9.81 * 0.08 * 0.08;
    println!("block {block} N, floor {floor} N, right: {} and 0", -thrust);
    assert!((block / -thrust - 1.0).abs() < 0.015, "{block} N");
    assert!(floor.abs() < 0.01 * thrust, "{floor} N");
}

/// A wall whose face is the domain's side: mud that sinks away from it is drawn a little into it, and cohesive sand, and neither is lost.
#[test]
fn what_a_wall_on_the_domains_side_holds_is_not_lost() {
    for keys in [
        "law = \"fluid\"\npreset = \"clay\"",
        "law = \"mu_i\"\npreset = \"sand_04\"\ncohesion = 200",
    ] {
        let text = format!(
            r#"
name = "flush"
[domain]
lower = [0, 0]
upper = [0.6, 0.6]
[numerics]
spacing = "5 mm"
[materials.mud]
{keys}
[bodies.block]
material = "mud"
box = {{ lower = [0, 0], upper = [0.1, 0.15] }}
[walls.floor]
polyline = [[0, 0.5], [0, 0], [0.6, 0]]
[run]
step = "20 ms"
until = 0.3
"#
        );
        let scene = sandgate::scene::parse("flush", &text).unwrap();
        let mut unit = super::Unit::new(&scene);
        unit.run_to(0.3);
        let particles = unit.component.particles();
        let least = particles.position.iter().map(|x| x[0]);
        let least = least.fold(f32::MAX, f32::min);
        println!("{least} m");
        // Clay came to 0.02 spacings behind the face in other starts; what leaves the domain by more than a quarter stops the run.
        assert!(least > -0.05 * 0.005, "{least}");
    }
}
