//! Scheme `paper_b`: what its equations must give, in runs of seconds.

use super::{Unit, advance, momentum, solve};
use sandgate::scene::{self, Scene};
use sandgate::state::State;

const G: f64 = 9.81;

fn parse(text: &str) -> Scene {
    scene::parse("paper_b.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

/// A box of 0.1 m by 0.08 m with 30 mm of silt under 30 mm of water.
fn layers() -> Scene {
    parse(
        r#"
name = "layers"
[domain]
lower = [-0.03, -0.03]
upper = [0.13, 0.12]
[numerics]
scheme = "paper_b"
spacing = "5 mm"
smoothing_ratio = 2
courant = 0.25
jitter = 0
[materials.water]
law = "fluid"
preset = "water"
artificial_viscosity = 0.2
[materials.silt]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
consistency = 3.97
pore_fluid = "water"
[bodies.silt]
material = "silt"
box = { lower = [0, 0], upper = [0.1, 0.03] }
[bodies.water]
material = "water"
box = { lower = [0, 0.03], upper = [0.1, 0.06] }
[walls.tank]
polyline = [[0, 0.12], [0, 0], [0.1, 0], [0.1, 0.12]]
slip = "free_slip"
[gauges.level]
kind = "depth"
foot = [0.05, 0]
[gauges.silt]
kind = "depth"
foot = [0.05, 0]
material = "silt"
[gauges.weight]
kind = "force"
on = "wall.tank"
[run]
step = 0.01
until = 0.5
"#,
    )
}

#[test]
fn layers_rest_on_their_floor() {
    let mut unit = Unit::new(&layers());
    let (mut weight, mut count) = (0.0, 0.0);
    for n in 1..=50 {
        unit.run_to(0.01 * f64::from(n));
        if n > 20 {
            weight += unit.get("gauge.weight.force_y");
            count += 1.0;
        }
    }
    let expected = -0.1 * 0.03 * (1000.0 + 1990.0) * G;
    let got = weight / count;
    println!("mean weight {got:.3} N for {expected:.3}");
    assert!((got / expected - 1.0).abs() < 0.03, "{got} for {expected}");
    for (name, depth) in [("gauge.level.depth", 0.06), ("gauge.silt.depth", 0.03)] {
        let got = unit.get(name);
        println!("{name} {got:.5} m for {depth}");
        assert!((got - depth).abs() < 1e-3, "{name}: {got}");
    }
}

#[test]
fn columns_carry_the_buoyant_weight_of_the_bed() {
    let (solver, state) = solve(&layers(), 0.0);
    for (i, x) in state.grains.position.iter().enumerate() {
        let expected = if state.grains.phase[i] == 1 {
            990.0 * G * (0.03 - x[1])
        } else {
            0.0
        };
        let got = solver.effective_pressure()[i];
        assert!((got - expected).abs() < 1e-9 * G, "{got} for {expected}");
    }
}

/// A bed of 30 mm, on it as much of another material and water, all of it as wide as its tank.
fn two_beds(upper: &str, water: bool) -> Scene {
    let silt = "law = \"constant_friction\"\nfriction_angle = \"30 deg\"\ndensity = 1990\npore_fluid = \"water\"\n";
    let mut text = layers().source.replace(
        "[gauges.level]",
        &format!(
            "[materials.lower]\n{silt}[materials.upper]\n{upper}[bodies.upper]\nmaterial = \"upper\"\n\
             box = {{ lower = [0, 0.03], upper = [0.1, 0.06] }}\n[gauges.level]"
        ),
    );
    text = text.replace(
        "[bodies.silt]\nmaterial = \"silt\"",
        "[bodies.silt]\nmaterial = \"lower\"",
    );
    let above = "box = { lower = [0, 0.03], upper = [0.1, 0.06] }\n[walls";
    let (from, to) = if water { (0.06, 0.09) } else { (0.1, 0.11) };
    text = text.replace(
        above,
        &format!("box = {{ lower = [0, {from}], upper = [0.1, {to}] }}\n[walls"),
    );
    parse(&text.replace(
        "material = \"silt\"\n[gauges.weight]",
        "material = \"lower\"\n[gauges.weight]",
    ))
}

/// What lies on a bed bears on it with its own weight: buoyant if it is saturated, whole if it is dry.
#[test]
fn columns_carry_what_lies_on_the_bed() {
    let saturated = "law = \"constant_friction\"\nfriction_angle = \"30 deg\"\ndensity = 1700\npore_fluid = \"water\"\n";
    let dry = "law = \"constant_friction\"\nfriction_angle = \"30 deg\"\ndensity = 1600\n";
    for (upper, water, weight) in [(saturated, true, 700.0), (dry, false, 1600.0)] {
        let (solver, state) = solve(&two_beds(upper, water), 0.0);
        for (i, x) in state.grains.position.iter().enumerate() {
            let material = solver.material_of(&state, i);
            let expected = match (material.is_saturated(), x[1] < 0.03) {
                (true, true) => (990.0 * (0.03 - x[1]) + weight * 0.03) * G,
                (true, false) => weight * (0.06 - x[1]) * G,
                (false, _) => continue,
            };
            let got = solver.effective_pressure()[i];
            assert!(
                (got - expected).abs() < 1e-9 * expected,
                "{got} for {expected} at {x:?}"
            );
        }
    }
}

/// A fluid of 1 Pa s between plates without slip 40 mm apart, driven by 1 kPa/m.
#[test]
fn a_channel_has_its_profile() {
    let scene = parse(
        r#"
name = "channel"
[domain]
lower = [0, -0.01]
upper = [0.024, 0.05]
periodic = ["x"]
gravity = [1, 0]
[numerics]
scheme = "paper_b"
spacing = "2 mm"
smoothing_ratio = 2
expected_speed = 0.3
courant = 0.25
[materials.f]
law = "fluid"
density = 1000
consistency = 1
[bodies.f]
material = "f"
box = { lower = [0, 0], upper = [0.024, 0.04] }
[walls.low]
polyline = [[0, 0], [0.024, 0]]
[walls.high]
polyline = [[0.024, 0.04], [0, 0.04]]
[run]
step = 0.1
until = 1
"#,
    );
    let (_, state) = solve(&scene, 1.0);
    let (mut error, mut size) = (0.0, 0.0);
    for (x, v) in state.grains.position.iter().zip(&state.grains.velocity) {
        let y = x[1] - 0.02;
        let exact = 500.0 * (0.02f64.powi(2) - y * y);
        error += (v[0] - exact).powi(2);
        size += exact * exact;
    }
    let error = f64::sqrt(error / size);
    println!("channel: L2 {error:.4}");
    assert!(error < 0.1, "{error}");
}

/// A block of clay in free space, hit by water.
fn block(strength: &str, factor: f64) -> Scene {
    parse(&format!(
        r#"
name = "block"
[domain]
lower = [-1, -1]
upper = [1, 1]
[numerics]
scheme = "paper_b"
spacing = "5 mm"
smoothing_ratio = 2
sound_speed = 10
jitter = 0
shifting = 0
relaxation_factor = {factor}
[materials.clay]
law = "fluid"
density = 1540
consistency = 1
yield_stress = "{strength}"
[materials.water]
law = "fluid"
preset = "water"
[bodies.clay]
material = "clay"
box = {{ lower = [-0.05, -0.05], upper = [0.05, 0.05] }}
[bodies.water]
material = "water"
box = {{ lower = [0.05, -0.05], upper = [0.1, 0.05] }}
velocity = [-0.2, 0.1]
[run]
step = 0.01
until = 0.1
"#
    ))
}

#[test]
fn momentum_stays_without_attenuation_only() {
    let (_, start) = scene::build::<2>(&block("30 Pa", 1.0)).unwrap();
    let before = momentum(&start);
    let time = 0.05;
    let (_, state) = solve(&block("30 Pa", 1.0), time);
    let mass = state.grains.present_mass();
    let after = momentum(&state);
    let scale = mass * G * time;
    assert!(
        (after[0] - before[0]).abs() < 1e-12 * scale,
        "{before:?} {after:?}"
    );
    assert!(
        (after[1] - before[1] + mass * G * state.time).abs() < 1e-11 * scale,
        "{before:?} {after:?}"
    );
    // What does not yield falls at K_R g: [B]'s factor takes momentum.
    let mut alone = block("3000 Pa", 0.1);
    alone.bodies.retain(|b| b.name == "clay");
    let (plan, mut state) = scene::build::<2>(&alone).unwrap();
    // Without the weight that a block starts with.
    state.grains.density.fill(1540.0);
    let (_, state) = advance(plan, state, time);
    for v in &state.grains.velocity {
        assert!((v[1] + 0.1 * G * state.time).abs() < 1e-12, "{v:?}");
    }
}

#[test]
fn a_block_falls_by_half_g_t_squared() {
    let mut alone = block("3000 Pa", 1.0);
    alone.bodies.retain(|b| b.name == "clay");
    let (plan, mut state) = scene::build::<2>(&alone).unwrap();
    // Without the weight that a block starts with.
    state.grains.density.fill(1540.0);
    let height = |state: &State<2>| {
        let sum: f64 = state.grains.position.iter().map(|x| x[1]).sum();
        sum / state.grains.len() as f64
    };
    let before = height(&state);
    let (_, state) = advance(plan, state, 0.05);
    // Exact for any step length, as Heun's scheme is with a constant acceleration.
    let fallen = before - height(&state);
    let exact = 0.5 * G * state.time * state.time;
    assert!((fallen - exact).abs() < 1e-12, "{fallen} {exact}");
}

#[test]
fn a_thin_front_stays_above_its_floor() {
    let scene = parse(
        r#"
name = "front"
[domain]
lower = [-0.05, -0.05]
upper = [1.2, 0.25]
[numerics]
scheme = "paper_b"
spacing = "10 mm"
smoothing_ratio = 2
sound_speed = "16 m/s"
courant = 0.25
jitter = 0
[materials.clay]
law = "fluid"
preset = "clay"
[bodies.clay]
material = "clay"
box = { lower = [0, 0], upper = [0.26, 0.13] }
[walls.tank]
polyline = [[0, 0.2], [0, 0], [1.15, 0], [1.15, 0.2]]
[run]
step = 0.025
until = 1
"#,
    );
    // Single particles in front of it are what shifting took through the floor, after 0.9 s.
    let (_, state) = solve(&scene, 0.95);
    for x in &state.grains.position {
        assert!(x[1] > 0.0, "{x:?}");
    }
}

#[test]
fn saved_states_go_on_bit_for_bit_on_any_threads() {
    let scene = layers();
    let mut whole = Unit::new(&scene);
    whole.run_to(0.05);
    let saved = whole.component.save().unwrap();
    let mut second = Unit::new(&scene);
    second.component.set_threads(2);
    second.component.restore(&saved).unwrap();
    assert_eq!(
        whole.get("gauge.weight.force_y").to_bits(),
        second.get("gauge.weight.force_y").to_bits()
    );
    whole.run_to(0.1);
    second.run_to(0.1);
    assert_eq!(
        whole.component.save().unwrap(),
        second.component.save().unwrap()
    );
}

#[test]
fn what_it_has_no_equations_for_is_refused() {
    let text = r#"
name = "refused"
[domain]
lower = [-0.1, -0.1]
upper = [0.2, 0.2]
[numerics]
scheme = "paper_b"
spacing = "5 mm"
cap_time = 1
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.sand]
material = "sand"
box = { lower = [0, 0], upper = [0.1, 0.05] }
[walls.floor]
polyline = [[0, 0.1], [0, 0], [0.1, 0]]
velocity = [0.1, 0]
slip = "friction"
wall_friction = 0.4
[gates.door]
from = [0.1, 0]
to = [0.1, 0.1]
[run]
step = 0.01
until = 0.1
"#;
    let error = scene::parse("refused.toml", text).unwrap_err().to_string();
    for what in [
        "cap_time, which this scheme does not use",
        "inertial number",
        "a gate",
        "a wall with friction",
    ] {
        assert!(error.contains(what), "{what} is not in {error}");
    }
}

/// A clump of silt that hangs in the water presses on nothing: under it the bed has the effective pressure that it has beside it. It had six
/// times that where clump and bed were of one material.
#[test]
fn what_hangs_in_the_water_bears_on_no_bed() {
    let water = [
        [0.0, 0.06, 0.2, 0.16],
        [0.0, 0.16, 0.06, 0.22],
        [0.14, 0.16, 0.2, 0.22],
        [0.0, 0.22, 0.2, 0.26],
    ];
    let silt = [[0.0, 0.0, 0.2, 0.06], [0.06, 0.16, 0.14, 0.22]];
    let bodies = |material: &str, boxes: &[[f64; 4]]| {
        let body = |(n, [x, y, x2, y2]): (usize, &[f64; 4])| {
            format!(
                "[bodies.{material}{n}]\nmaterial = \"{material}\"\nbox = {{ lower = [{x}, {y}], upper = [{x2}, {y2}] }}\n"
            )
        };
        boxes.iter().enumerate().map(body).collect::<String>()
    };
    let text = format!(
        r#"
name = "clump"
[domain]
lower = [-0.1, -0.1]
upper = [0.3, 0.5]
[numerics]
spacing = "10 mm"
scheme = "paper_b"
smoothing_ratio = 2
[materials.water]
law = "fluid"
preset = "water"
[materials.silt]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
pore_fluid = "water"
{}{}
[walls.tank]
polyline = [[0, 0.4], [0, 0], [0.2, 0], [0.2, 0.4]]
slip = "free_slip"
[gauges.under]
kind = "pressure"
at = [0.1, 0.03]
quantity = "effective"
[gauges.beside]
kind = "pressure"
at = [0.03, 0.03]
quantity = "effective"
[run]
step = "10 ms"
until = "0.1 s"
"#,
        bodies("water", &water),
        bodies("silt", &silt)
    );
    let unit = Unit::new(&parse(&text));
    for gauge in ["under", "beside"] {
        let found = unit.get(&format!("gauge.{gauge}.pressure"));
        let exact = 990.0 * 9.81 * 0.03;
        assert!(
            (found / exact - 1.0).abs() < 0.05,
            "{gauge}: {found} Pa for {exact}"
        );
    }
}
