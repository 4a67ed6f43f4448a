//! Tension that fluids with a yield stress bear, and others do not.

use super::Unit;
use sandgate::scene;
use sandgate::solver::{Solver, SolverError, StepInputs};

const DENSITY: f64 = 1500.0;
const YIELD: f64 = 300.0;
const G: f64 = 9.81;

/// Longest strip that bears its own weight [m]: in the plane what stretches bears twice its yield stress.
const LONGEST: f64 = 2.0 * YIELD / (DENSITY * G);

/// Mean speed along gravity of a strip of so many times that length, 12 mm wide, that hangs from a wall for half a second; or the
/// error where it fell out of the domain.
fn hangs(length: f64, yield_stress: f64) -> Result<f64, SolverError> {
    let text = format!(
        r#"
name = "strip"
[domain]
lower = [-0.02, -0.1]
upper = [0.3, 0.1]
gravity = [{G}, 0]
[numerics]
spacing = 0.0015
sound_speed = 10
sleep = false
[materials.mud]
law = "fluid"
density = {DENSITY}
consistency = 10
yield_stress = {yield_stress}
[bodies.strip]
material = "mud"
box = {{ lower = [0, -0.006], upper = [{}, 0.006] }}
[walls.top]
polyline = [[0, 0.08], [0, -0.08]]
[run]
step = 0.5
until = 0.5
"#,
        length * LONGEST
    );
    let scene = scene::parse("strip.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let (plan, mut state) = scene::build::<2>(&scene).unwrap();
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    let inputs = StepInputs {
        openings: &[],
        rates: &[],
        drives: &[],
    };
    while state.time < 0.5 {
        solver.step(&mut state, 0.5, &inputs, &mut |_, _| {})?;
    }
    let speeds = state.grains.velocity.iter().map(|v| v[0]);
    Ok(speeds.sum::<f64>() / state.grains.len() as f64)
}

#[test]
fn a_strip_of_clay_hangs_by_its_yield_stress_and_a_longer_one_falls() {
    let still = hangs(0.9, YIELD).unwrap();
    println!("0.9 of the longest: {still:.1e} m/s");
    assert!(still.abs() < 1e-4, "{still}");
    assert!(hangs(1.5, YIELD).is_err(), "it must fall");
}

/// The same weight on a tenth of the yield stress is far too long, and water bears no tension at all.
#[test]
fn what_yields_sooner_and_what_flows_fall() {
    for yield_stress in [30.0, 0.0] {
        assert!(hangs(0.9, yield_stress).is_err(), "{yield_stress}");
    }
}

/// Clay that hangs has p < 0, which bulk friction of other materials has no part in.
#[test]
fn clay_hangs_beside_sand_with_bulk_friction() {
    let text = r#"
name = "beside"
[domain]
lower = [-0.02, -0.1]
upper = [0.3, 0.1]
gravity = [9.81, 0]
[numerics]
spacing = 0.003
sound_speed = 10
[materials.mud]
law = "fluid"
density = 1500
consistency = 10
yield_stress = 300
[materials.sand]
law = "mu_i"
preset = "sand_04"
bulk_friction = 0.5
[bodies.strip]
material = "mud"
box = { lower = [0, -0.012], upper = [0.03, 0.012] }
[bodies.sand]
material = "sand"
box = { lower = [0.15, -0.012], upper = [0.16, 0.012] }
[walls.top]
polyline = [[0, 0.08], [0, -0.08]]
[run]
step = 0.02
until = 0.02
"#;
    let (solver, _) = super::solve(&scene::parse("beside", text).unwrap(), 0.02);
    let least = solver.pressure().iter().copied().fold(0.0, f64::min);
    assert!(least < 0.0, "nothing is pulled");
}

/// Undrained clay is grains without friction and no fluid: its halves part, and it rubs on a wall by mu_w.
#[test]
fn clay_without_friction_parts_and_rubs_as_grains_do() {
    let scene = |bodies: &str, slip: &str, until: f64| {
        let text = format!(
            r#"
name = "undrained"
[domain]
lower = [-0.2, -0.1]
upper = [0.6, 0.4]
[numerics]
spacing = "5 mm"
expected_speed = 2
[materials.clay]
law = "constant_friction"
friction_angle = "0 deg"
density = 1800
cohesion = "2 kPa"
{bodies}
[walls.floor]
polyline = [[-0.1, 0], [0.5, 0]]
{slip}
[gauges.above]
kind = "mass"
lower = [-0.2, 0.1]
upper = [0.6, 0.4]
[run]
step = "10 ms"
until = "0.3 s"
"#
        );
        let mut unit = Unit::new(&scene::parse("undrained", &text).unwrap());
        unit.run_to(until);
        unit
    };
    let halves = "[bodies.low]\nmaterial = \"clay\"\nbox = { lower = [0, 0], upper = [0.1, 0.05] }\n\
        [bodies.high]\nmaterial = \"clay\"\nbox = { lower = [0, 0.05], upper = [0.1, 0.1] }\nvelocity = [0, 1]";
    let above = scene(halves, "", 0.1).get("gauge.above.mass");
    assert!(above > 7.0, "{above} kg of 9 are up");
    let block = "[bodies.a]\nmaterial = \"clay\"\nbox = { lower = [0, 0], upper = [0.1, 0.05] }\nvelocity = [0.5, 0]";
    let unit = scene(block, "slip = \"friction\"\nwall_friction = 0.5", 0.15);
    // v/(mu_w g) is 0.10 s.
    let left = unit.get("energy.kinetic") / (0.5 * 9.0 * 0.25);
    assert!(left < 1e-3, "{left} of its energy is left");
}
