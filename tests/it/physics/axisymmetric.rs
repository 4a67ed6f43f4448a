//! Axisymmetric scenes: rest beside the axis, momentum along it, exact masses of rings, devices, the same bits.

use super::Unit;
use sandgate::scene::{self, Scene};
use sandgate::solver::{Solver, StepInputs};

/// A material that hardly rubs (mu = 0.02) in a round tank: pressure must be that of a liquid, at the axis too.
fn tank() -> Scene {
    let text = r#"
name = "tank"
title = "A round tank of nearly frictionless grains"
dimension = "axisymmetric"
[domain]
lower = [0, -0.1]
upper = [0.2, 0.2]
[numerics]
spacing = 0.005
jitter = 0
[materials.soup]
law = "mu_i"
preset = "sand_04"
static_friction_angle = 0.02
dynamic_friction_angle = 0.02
[bodies.fill]
material = "soup"
box = { lower = [0, 0], upper = [0.1, 0.1] }
[walls.tank]
polyline = [[0, 0], [0.1, 0], [0.1, 0.2]]
slip = "free_slip"
[gauges.axis_low]
kind = "pressure"
at = [0, 0.02]
[gauges.axis_mid]
kind = "pressure"
at = [0, 0.05]
[gauges.half_mid]
kind = "pressure"
at = [0.05, 0.05]
[gauges.depth_axis]
kind = "depth"
foot = [0, 0]
[gauges.depth_half]
kind = "depth"
foot = [0.05, 0]
[gauges.weight]
kind = "force"
on = "wall.tank"
[run]
step = 0.01
until = 1
"#;
    scene::parse("tank.toml", text).unwrap()
}

/// Mean of a variable over the steps from `from` to `to` [s].
fn mean(unit: &mut Unit, names: &[&str], from: f64, to: f64) -> Vec<f64> {
    unit.run_to(from);
    let mut sums = vec![0.0; names.len()];
    let mut count = 0.0;
    while unit.component.time() < to {
        unit.step();
        for (sum, name) in sums.iter_mut().zip(names) {
            *sum += unit.get(name);
        }
        count += 1.0;
    }
    sums.iter().map(|s| s / count).collect()
}

#[test]
fn pressure_and_level_at_the_axis_are_those_of_the_tank() {
    let scene = tank();
    let mut unit = Unit::new(&scene);
    let mass = unit.get("mass.present");
    // Exact up to the rounding of masses: rho pi R^2 H.
    let volume = std::f64::consts::PI * 0.1 * 0.1 * 0.1;
    assert!((mass / (1560.0 * volume) - 1.0).abs() < 1e-6, "{mass}");
    let names = [
        "gauge.axis_low.pressure",
        "gauge.axis_mid.pressure",
        "gauge.half_mid.pressure",
        "gauge.depth_axis.depth",
        "gauge.depth_half.depth",
        "gauge.weight.force_y",
    ];
    let found = mean(&mut unit, &names, 0.5, 1.0);
    println!("{found:?}");
    let full = 1560.0 * 9.81 * 0.1;
    for (p, y) in [(found[0], 0.02), (found[1], 0.05), (found[2], 0.05)] {
        let expected = 1560.0 * 9.81 * (found[4] - y);
        // 1 % of the full load, and what friction can carry: |p - sigma_zz| <= 2/sqrt(3) mu p.
        let carried = 2.0 / 3f64.sqrt() * 0.02 * expected;
        assert!(
            (p - expected).abs() < 0.01 * full + carried,
            "{p} for {expected} Pa at {y} m"
        );
    }
    assert!((found[3] - found[4]).abs() < 0.2 * 0.005, "{found:?}");
    assert!(
        (found[5] / (-mass * 9.81) - 1.0).abs() < 0.01,
        "the walls carry the whole ring's weight: {}",
        found[5]
    );
}

/// Two bodies of rings that collide along the axis: momentum along it is kept to rounding at a solver tolerance of 1e-2.
#[test]
fn a_free_body_of_rings_keeps_its_momentum_along_the_axis() {
    let text = r#"
name = "rings"
title = "Two discs of sand collide"
dimension = "axisymmetric"
[domain]
lower = [0, -20]
upper = [20, 20]
gravity = 0
[numerics]
spacing = 0.01
sound_speed = 20
solver_tolerance = 1e-2
[materials.sand]
law = "mu_i"
preset = "sand_08"
[bodies.lower]
material = "sand"
box = { lower = [0, -0.1], upper = [0.12, 0] }
velocity = [0, 0.9]
[bodies.upper]
material = "sand"
box = { lower = [0, 0], upper = [0.08, 0.1] }
velocity = [0, -0.5]
[run]
step = 0.01
until = 0.1
"#;
    let scene = scene::parse("rings.toml", text).unwrap();
    let (plan, mut state) = scene::build::<2>(&scene).unwrap();
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    let sums = |state: &sandgate::state::State<2>| {
        let parts = state.grains.mass.iter().zip(&state.grains.velocity);
        let along = parts.clone().map(|(m, v)| m * v[1]).sum::<f64>();
        let size = parts.clone().map(|(m, v)| m * v[1].abs()).sum::<f64>();
        let energy = parts.map(|(m, v)| 0.5 * m * (v[0] * v[0] + v[1] * v[1]));
        (along, size, energy.sum::<f64>())
    };
    let (before, size, energy) = sums(&state);
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    while state.time < 0.05 {
        solver
            .step(&mut state, 0.05, &inputs, &mut |_, _| {})
            .unwrap();
    }
    let (after, _, left) = sums(&state);
    assert!(state.steps > 50 && state.iterations > 20);
    assert!(
        state.grains.velocity.iter().any(|v| v[0] > 0.05),
        "sand is pushed outwards"
    );
    assert!((after - before).abs() < 1e-12 * size, "{before} {after}");
    assert!(left < energy, "friction creates no energy");
    assert!(state.grains.position.iter().all(|x| x[0] >= 0.0));
}

/// A round silo with an iris at the axis, an inflow above and a drain below the outlet's section.
const SILO: &str = r#"
name = "round_silo"
title = "A round silo"
dimension = "axisymmetric"
[domain]
lower = [0, "-12 cm"]
upper = ["11 cm", "20 cm"]
[numerics]
spacing = "4 mm"
[materials.beads]
law = "mu_i"
preset = "glass_beads"
[bodies.fill]
material = "beads"
box = { lower = [0, 0], upper = ["8 cm", "8 cm"] }
[walls.shell]
polyline = [["3.2 cm", 0], ["8 cm", 0], ["8 cm", "19 cm"]]
[gates.iris]
from = [0, 0]
to = ["3.2 cm", 0]
max_speed = "1 m/s"
[inflows.top]
material = "beads"
from = ["3 cm", "15 cm"]
to = ["0 cm", "15 cm"]
velocity = [0, "-0.5 m/s"]
rate = "0.5 kg/s"
[outflows.drain]
lower = [0, "-11 cm"]
upper = ["11 cm", "-1 mm"]
[gauges.outlet]
kind = "discharge"
from = [0, "-1 mm"]
to = ["4 cm", "-1 mm"]
[gauges.load]
kind = "force"
on = "gate.iris"
[run]
step = "5 ms"
until = "0.2 s"
"#;

/// Mass is exact after every step although rings weigh from 1 to 20 (`Unit::step`), and what crosses the outlet is
/// what is gone from above it.
#[test]
fn a_round_silo_counts_whole_rings() {
    let scene = scene::parse("round_silo.toml", SILO).unwrap();
    let mut unit = Unit::new(&scene);
    unit.run_to(0.02);
    let load = unit.get("gauge.load.force_y");
    assert!(load < 0.0, "sand rests on the iris: {load} N");
    unit.set("gate.iris.opening", 1.0);
    unit.run_to(0.4);
    let (crossed, inflow, outflow) = (
        unit.get("gauge.outlet.mass"),
        unit.get("mass.inflow"),
        unit.get("mass.outflow"),
    );
    println!("crossed {crossed} inflow {inflow} outflow {outflow} kg");
    assert!(outflow > 0.1 && inflow > 0.1);
    // The drain begins at the section: what has crossed it is drained in the same internal step.
    assert_eq!(crossed, outflow);
}

#[test]
fn rings_have_the_same_bits_on_any_number_of_threads_and_after_a_restore() {
    let text = SILO.replace("spacing = \"4 mm\"", "spacing = \"1.4 mm\"");
    let scene = scene::parse("round_silo.toml", &text).unwrap();
    let run = |threads: usize| {
        let mut unit = Unit::new(&scene);
        unit.component.set_threads(threads);
        unit.set("gate.iris.opening", 1.0);
        unit.run_to(0.02);
        unit
    };
    let mut one = run(1);
    assert!(one.get("solver.particles") > 3000.0);
    assert_eq!(one.component.state_hash(), run(2).component.state_hash());
    let saved = one.component.save().unwrap();
    let mut other = Unit::new(&scene);
    other.component.restore(&saved).unwrap();
    one.step();
    other.step();
    assert_eq!(one.component.state_hash(), other.component.state_hash());
}

/// A round tank of water begins at rest: what its floor bears does not swing.
#[test]
fn a_round_tank_of_water_starts_at_rest() {
    let text = r#"
name = "tank"
dimension = "axisymmetric"
[domain]
lower = [0, "-50 mm"]
upper = ["150 mm", "150 mm"]
[numerics]
spacing = "5 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = { lower = [0, 0], upper = ["100 mm", "60 mm"] }
[walls.floor]
polyline = [[0, 0], ["100 mm", 0]]
[walls.side]
polyline = [["100 mm", 0], ["100 mm", "100 mm"]]
slip = "free_slip"
[gauges.floor]
kind = "force"
on = "wall.floor"
[gauges.side]
kind = "force"
on = "wall.side"
[run]
step = "5 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("tank", text).unwrap());
    let weight = 9.81 * unit.get("mass.initial");
    let mut most = 0.0f64;
    for k in 1..=60 {
        unit.run_to(0.005 * f64::from(k));
        let down = unit.get("gauge.floor.force_y") + unit.get("gauge.side.force_y");
        most = most.max((down / weight + 1.0).abs());
    }
    println!("floor and side bear the weight to {most:.4}");
    assert!(most < 0.02, "{most}");
}

/// Rings of silt under water, and the same four times as large: one tank in two units. The effective pressure evened a ring against its
/// neighbours by its volume, in m^3.
#[test]
fn rings_of_silt_of_all_sizes_are_alike() {
    let effective = |size: f64| {
        let at = |x: f64| x * size;
        let text = format!(
            r#"
name = "well"
dimension = "axisymmetric"
[domain]
lower = [{r}, -{r}]
upper = [{R}, {R}]
[numerics]
spacing = {dp}
strain_relaxation_time = {relax}
[materials.water]
law = "fluid"
density = 1000
consistency = 0
[materials.silt]
law = "constant_friction"
friction_angle = "30 deg"
density = 1900
pore_fluid = "water"
[bodies.silt]
material = "silt"
box = {{ lower = [{r}, 0], upper = [{R}, {r}] }}
[bodies.water]
material = "water"
box = {{ lower = [{r}, {r}], upper = [{R}, {top}] }}
[walls.tank]
polyline = [[{r}, {R}], [{r}, 0], [{R}, 0], [{R}, {R}]]
slip = "free_slip"
[gauges.grains]
kind = "pressure"
quantity = "effective"
at = [{middle}, {low}]
[run]
step = {step}
until = {until}
"#,
            r = at(0.125),
            R = at(0.375),
            dp = at(1.0 / 64.0),
            top = at(0.1875),
            middle = at(0.25),
            low = at(0.03125),
            relax = 0.03125 * size.sqrt(),
            step = 0.03125 * size.sqrt(),
            until = 0.25 * size.sqrt(),
        );
        let mut unit = Unit::new(&sandgate::scene::parse("well", &text).unwrap());
        unit.run_to(0.25 * size.sqrt());
        unit.get("gauge.grains.pressure") / size
    };
    let (small, large) = (effective(1.0), effective(4.0));
    println!("effective pressure {small} and {large} Pa");
    assert!((large / small - 1.0).abs() < 1e-9, "{small} {large}");
}
