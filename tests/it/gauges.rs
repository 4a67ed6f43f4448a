//! Gauges on the running solver: weight, depth and pressure of sand at rest, and what sections count.

use sandgate::component::Component;
use sandgate::scene;
use std::path::Path;

/// A component of a scene file between steps, at time 0.
pub(crate) fn stepping(file: &str) -> Component {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let scene = scene::load(&path).unwrap_or_else(|why| panic!("{why}"));
    let mut component = Component::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    component.initialize(0.0, None).unwrap();
    component
}

/// One value.
pub(crate) fn value(component: &Component, name: &str) -> f64 {
    let row = component
        .variables()
        .by_name(name)
        .unwrap_or_else(|| panic!("no variable {name}"));
    let mut values = vec![0.0; row.len()];
    component.get(&[row.reference], &mut values).unwrap();
    values[0]
}

/// Sets one input.
pub(crate) fn set(component: &mut Component, name: &str, value: f64) {
    let reference = component.variables().by_name(name).unwrap().reference;
    component.set(&[reference], &[value]).unwrap();
}

/// `count` communication steps of the scene's length.
pub(crate) fn step(component: &mut Component, count: u32) {
    for _ in 0..count {
        component
            .do_step(component.time(), component.scene().run.step)
            .unwrap();
    }
}

/// With the capped yield, which creeps to the stress of a liquid: under the exact yield sand that rests holds whatever
/// ratio of horizontal to vertical stress its friction allows, so its pressure is not rho g (H - y).
#[test]
fn sand_at_rest_shows_its_weight_depth_and_pressure() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/hydrostatic.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("spacing = \"5 mm\""));
    let text = text.replace(
        "spacing = \"5 mm\"",
        "spacing = \"5 mm\"\nyield = \"capped\"",
    );
    let scene = scene::parse("hydrostatic", &text).unwrap_or_else(|why| panic!("{why}"));
    let mut sand = Component::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    sand.initialize(0.0, None).unwrap();
    weigh(sand, true);
}

#[test]
fn sand_under_the_exact_yield_shows_its_weight_and_depth() {
    weigh(stepping("cases/hydrostatic.toml"), false);
}

fn weigh(mut sand: Component, hydrostatic: bool) {
    step(&mut sand, 10);
    let weight = value(&sand, "mass.present") * 9.81;
    // Wall pressures must carry the sand to the tolerance of rest; 1e-3 is what 0.1 s of settling leaves.
    let floor = -value(&sand, "gauge.weight.force_y");
    assert!(
        (floor - weight).abs() < 1e-3 * weight,
        "{floor} N for {weight} N"
    );
    assert!(value(&sand, "gauge.weight.force_x").abs() < 1e-3 * weight);
    let depth = value(&sand, "gauge.depth.depth");
    assert!(
        (depth - 0.1).abs() < 0.1 * 0.005,
        "{depth} m for 0.1 m, within 0.1 dp"
    );
    // rho g (H - y) of the filled density; the sand compresses by 0.5 % and the lattice is jittered.
    let density = value(&sand, "mass.initial") / (0.2 * 0.1);
    for (gauge, y) in hydrostatic
        .then_some([("pressure_low", 0.01), ("pressure_mid", 0.05)])
        .into_iter()
        .flatten()
    {
        let (found, expected) = (
            value(&sand, &format!("gauge.{gauge}.pressure")),
            density * 9.81 * (0.1 - y),
        );
        assert!(
            (found - expected).abs() < 0.02 * density * 9.81 * 0.1,
            "{gauge}: {found} Pa for {expected} Pa"
        );
    }
}

#[test]
fn closed_gate_carries_the_column_above_it() {
    let mut silo = stepping("tests/scenes/small_silo.toml");
    step(&mut silo, 10);
    // 32 of 80 mm of the floor; walls take a little, the kernel smears the ends by a spacing of eight.
    let share = value(&silo, "mass.present") * 9.81 * 0.4;
    let load = -value(&silo, "gauge.load.force_y");
    assert!(
        (load - share).abs() < 0.125 * share,
        "{load} N for {share} N"
    );
    assert_eq!(
        value(&silo, "gauge.outlet.mass"),
        0.0,
        "a closed gate passes nothing"
    );
    assert_eq!(value(&silo, "outflow.drain.mass"), 0.0);
}

/// What a section counted is what is past it: taken by the outflow, or still falling.
fn section_counts_what_is_past_it(
    file: &str,
    gate: &str,
    gauge: &str,
    outflow: &str,
    past: impl Fn(&[f32; 3]) -> bool,
) {
    let mut component = stepping(file);
    let grain = value(&component, "mass.initial") / value(&component, "solver.particles");
    set(&mut component, &format!("gate.{gate}.opening"), 1.0);
    let h = component.scene().run.step;
    let steps = (component.scene().run.until / h).round() as u32;
    let (mut integral, mut counted) = (0.0, 0.0);
    for _ in 0..steps {
        step(&mut component, 1);
        let before = counted;
        counted = value(&component, &format!("gauge.{gauge}.mass"));
        let falling = component
            .particles()
            .position
            .iter()
            .filter(|x| past(x))
            .count() as f64;
        let taken = value(&component, &format!("outflow.{outflow}.mass"));
        assert_eq!(counted, taken + grain * falling, "t = {}", component.time());
        let rate = value(&component, &format!("gauge.{gauge}.discharge"));
        assert!(
            (rate * h - (counted - before)).abs() <= 1e-12 * counted,
            "rate x step is the mass of the step"
        );
        integral += rate * h;
    }
    assert!(
        counted > 20.0 * grain,
        "hardly anything crossed: the test tests nothing"
    );
    assert!((integral - counted).abs() < 1e-12 * counted);
}

#[test]
fn section_below_a_silo_counts_every_grain_once() {
    section_counts_what_is_past_it(
        "tests/scenes/small_silo.toml",
        "main",
        "outlet",
        "drain",
        |x| x[1] < -0.001,
    );
}

#[test]
fn section_across_a_periodic_channel_in_space_counts_every_grain_once() {
    section_counts_what_is_past_it(
        "tests/scenes/devices_3d.toml",
        "sluice",
        "past_gate",
        "end",
        |x| x[0] > 0.065,
    );
}

#[test]
fn gauges_in_space_read_a_fresh_heap() {
    let heap = stepping("tests/scenes/devices_3d.toml");
    let depth = value(&heap, "gauge.depth.depth");
    assert!((depth - 0.04).abs() < 0.1 * 0.005, "{depth}");
    let front = value(&heap, "gauge.front.front");
    assert!((front - 0.04).abs() < 0.005, "{front}");
}

/// Reading of `front` at the start, of a scene with these walls and bodies at 10 mm.
fn front_at_start(dimension: &str, rest: &str) -> Component {
    let corner = |x: f64| match dimension {
        "3" => format!("[{x}, {x}, {x}]"),
        "\"axisymmetric\"" if x < 0.0 => format!("[0, {x}]"),
        _ => format!("[{x}, {x}]"),
    };
    let text = format!(
        "name = \"leaning\"\ndimension = {dimension}\n[domain]\nlower = {}\nupper = {}\n[numerics]\n\
         spacing = 0.01\n[materials.sand]\nlaw = \"mu_i\"\npreset = \"sand_08\"\n\
         [run]\nstep = 0.05\nuntil = 0.2\n{rest}",
        corner(-0.1),
        corner(0.5)
    );
    let scene = scene::parse("leaning", &text).unwrap_or_else(|why| panic!("{why}"));
    let mut component = Component::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    component.initialize(0.0, None).unwrap();
    component
}

/// Within a fiftieth of a spacing: faces are known exactly, the search ends at a millionth of one.
#[test]
fn a_front_that_leans_on_a_wall_or_gate_ends_at_its_face() {
    let gauge = "[gauges.fr]\nkind = \"front\"\norigin = [0, 0]\ndirection = [1, 0]\n";
    let body = "[bodies.b]\nmaterial = \"sand\"\nbox = { lower = [0, 0], upper = [0.3, 0.1] }\n";
    let flat = |walls: &str| front_at_start("2", &format!("{body}{gauge}{walls}"));
    let floor = "[walls.f]\npolyline = [[0, 0.3], [0, 0], [0.45, 0]]\n";
    let rings = "[walls.f]\npolyline = [[0, 0], [0.3, 0], [0.3, 0.3]]\n";
    let deep = "[bodies.b]\nmaterial = \"sand\"\nbox = { lower = [0, 0, 0], upper = [0.3, 0.1, 0.1] }\n\
                [gauges.fr]\nkind = \"front\"\norigin = [0, 0.05, 0]\ndirection = [1, 0, 0]\n\
                [walls.f]\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\n\
                [walls.l]\nplane = { point = [0, 0, 0], normal = [1, 0, 0] }\n\
                [walls.a]\nplane = { point = [0, 0, 0], normal = [0, 1, 0] }\n\
                [walls.b]\nplane = { point = [0, 0.1, 0], normal = [0, -1, 0] }\n";
    let space = |more: &str| front_at_start("3", &format!("{deep}{more}"));
    let scenes = [
        (
            "polyline",
            flat("[walls.t]\npolyline = [[0, 0.3], [0, 0], [0.3, 0], [0.3, 0.3]]\n"),
        ),
        (
            "box",
            flat(&format!(
                "{floor}[walls.p]\nbox = {{ lower = [0.3, 0], upper = [0.36, 0.2] }}\n"
            )),
        ),
        (
            "gate",
            flat(&format!(
                "{floor}[gates.g]\nfrom = [0.3, 0]\nto = [0.3, 0.2]\n"
            )),
        ),
        (
            "rings",
            front_at_start("\"axisymmetric\"", &format!("{body}{gauge}{rings}")),
        ),
        (
            "gate in space",
            space("[gates.g]\nfrom = [0.3, 0.1, 0]\nto = [0.3, 0.1, 0.2]\nspan = [0, -0.1, 0]\n"),
        ),
        (
            "pier in space",
            space("[walls.p]\nbox = { lower = [0.3, 0.02, 0], upper = [0.36, 0.08, 0.2] }\n"),
        ),
        (
            "plane in space",
            space("[walls.p]\nplane = { point = [0.3, 0, 0], normal = [-1, 0, 0] }\n"),
        ),
    ];
    for (what, scene) in scenes {
        let front = value(&scene, "gauge.fr.front");
        assert!((front - 0.3).abs() < 2e-4, "{what}: {front} m for 0.3 m");
    }
}

#[test]
fn a_front_follows_the_face_of_a_wall_that_moves() {
    let text = "[bodies.b]\nmaterial = \"sand\"\nbox = { lower = [0, 0], upper = [0.3, 0.1] }\n\
                [gauges.fr]\nkind = \"front\"\norigin = [0, 0]\ndirection = [1, 0]\n\
                [walls.f]\npolyline = [[0, 0.3], [0, 0], [0.45, 0]]\n\
                [walls.p]\nbox = { lower = [0.3, 0], upper = [0.36, 0.2] }\n\
                velocity = [-0.1, 0]\nmotion = \"rigid\"\n";
    let mut pushed = front_at_start("2", text);
    step(&mut pushed, 2);
    let front = value(&pushed, "gauge.fr.front");
    // Pushed for 0.1 s.
    assert!((front - 0.29).abs() < 2e-4, "{front} m for 0.29 m");
}

/// What is in a domain is all that it costs: neither grids nor lines of gauges reach further.
#[test]
fn a_domain_may_be_far_larger_than_what_is_in_it() {
    let text = include_str!("../scenes/small_silo.toml");
    let run = |text: &str| {
        let mut silo = Component::new(&scene::parse("small_silo", text).unwrap()).unwrap();
        silo.initialize(0.0, None).unwrap();
        step(&mut silo, 3);
        let depths = ["gauge.level.depth", "gauge.surface.depth[2]"].map(|name| value(&silo, name));
        (silo.state_hash(), depths)
    };
    let wide = text.replacen("[\"-3 cm\", \"-12 cm\"]", "[\"-1e6 km\", \"-1e6 km\"]", 1);
    let wide = wide.replacen("[\"11 cm\", \"15 cm\"]", "[\"1e6 km\", \"1e6 km\"]", 1);
    assert_eq!(wide.matches("1e6 km").count(), 4);
    assert_eq!(run(&wide), run(text));
}
