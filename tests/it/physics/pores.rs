//! Pores of saturated beds: where air reaches them.

use super::Unit;
use sandgate::scene;

/// A gap of three spacings inside a bed under water is no dry surface: its pores are hydrostatic around it (0.4 of that where it was).
#[test]
fn a_gap_inside_a_bed_under_water_does_not_drain_its_pores() {
    let bodies: String = [
        ("s", [0.0, 0.0, 0.16, 0.02]),
        ("s", [0.0, 0.02, 0.075, 0.035]),
        ("s", [0.09, 0.02, 0.16, 0.035]),
        ("s", [0.0, 0.035, 0.16, 0.05]),
        ("w", [0.0, 0.05, 0.16, 0.1]),
    ]
    .iter()
    .enumerate()
    .map(|(n, (material, [x, y, x2, y2]))| {
        format!("[bodies.b{n}]\nmaterial = \"{material}\"\nbox = {{ lower = [{x}, {y}], upper = [{x2}, {y2}] }}\n")
    })
    .collect();
    let mut unit = Unit::new(
        &scene::parse(
            "gap",
            &format!(
                r#"
name = "gap"
[domain]
lower = [-0.1, -0.1]
upper = [0.3, 0.4]
[numerics]
spacing = "5 mm"
[materials.w]
law = "fluid"
preset = "water"
[materials.s]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
pore_fluid = "w"
cohesion = 2000
{bodies}
[walls.t]
polyline = [[0, 0.3], [0, 0], [0.16, 0], [0.16, 0.3]]
slip = "free_slip"
[gauges.low]
kind = "pressure"
at = [0.08, 0.005]
quantity = "pore"
[gauges.side]
kind = "pressure"
at = [0.06, 0.03]
quantity = "pore"
[run]
step = "10 ms"
until = 0.1
"#
            ),
        )
        .unwrap(),
    );
    unit.run_to(0.1);
    for (gauge, y) in [("low", 0.005), ("side", 0.03)] {
        let share = unit.get(&format!("gauge.{gauge}.pressure")) / (1000.0 * 9.81 * (0.1 - y));
        println!("{gauge}: {share:.3}");
        assert!((share - 1.0).abs() < 0.03, "{gauge}: {share}");
    }
}

/// Water leaves a bed that rests: its pores have less pressure, and between its grains there is what there was. They kept all of the weight
/// that had gone, up to what the bed yields at, twice its buoyant weight.
#[test]
fn water_that_leaves_takes_its_weight_along() {
    let text = r#"
name = "drawdown"
[domain]
lower = [-0.1, -0.2]
upper = [1.1, 0.6]
[numerics]
spacing = "12.5 mm"
sound_speed = 14
[materials.water]
law = "fluid"
preset = "water"
[materials.silt]
law = "constant_friction"
friction_angle = "30 deg"
density = 1990
pore_fluid = "water"
[bodies.bed]
material = "silt"
box = { lower = [0, 0], upper = [0.5, 0.1] }
[bodies.water]
material = "water"
box = { lower = [0, 0.1], upper = [0.5, 0.25] }
[walls.tank]
polyline = [[0, 0.5], [0, 0], [0.5, 0], [0.5, 0.14], [0.8, 0.14]]
[gates.weir]
from = [0.5, 0.14]
to = [0.5, 0.3]
max_speed = 2
[outflows.out]
lower = [0.82, -0.2]
upper = [1.1, 0.6]
[gauges.effective]
kind = "pressure"
at = [0.15, 0.05]
quantity = "effective"
[gauges.pore]
kind = "pressure"
at = [0.15, 0.05]
quantity = "pore"
[gauges.level]
kind = "depth"
foot = [0.15, 0]
[run]
step = "20 ms"
until = "3 s"
"#;
    let mut unit = Unit::new(&scene::parse("drawdown", text).unwrap());
    unit.run_to(0.1);
    unit.set("gate.weir.opening", 1.0);
    unit.run_to(3.0);
    let left = unit.get("gauge.level.depth");
    let buoyant = 990.0 * 9.81 * 0.05;
    let effective = unit.get("gauge.effective.pressure") / buoyant;
    let pore = unit.get("gauge.pore.pressure") / (1000.0 * 9.81 * (left - 0.05));
    println!("level {left:.4} m: effective {effective:.3}, pore {pore:.3}");
    assert!(left < 0.18);
    assert!(
        (effective - 1.0).abs() < 0.15,
        "{effective} of the buoyant weight"
    );
    assert!((pore - 1.0).abs() < 0.1, "{pore} of hydrostatic");
}

/// These bodies of sand (with full pores if `wet`) and water in a tank 0.35 m long, at 5 mm, with these gauges.
fn sand_and_water(bodies: &str, wet: bool, gauges: &str) -> Unit {
    sand_and(1000.0, bodies, wet, gauges)
}

/// As [`sand_and_water`], of water of this density [kg/m^3].
fn sand_and(density: f64, bodies: &str, wet: bool, gauges: &str) -> Unit {
    let pores = if wet { "pore_fluid = \"water\"" } else { "" };
    let text = format!(
        r#"
name = "bed"
[domain]
lower = [-0.05, -0.05]
upper = [0.4, 0.3]
[numerics]
spacing = "5 mm"
[materials.water]
law = "fluid"
preset = "water"
density = {density}
[materials.sand]
law = "mu_i"
preset = "sand_08"
{pores}
{bodies}
[walls.tank]
polyline = [[0, 0.25], [0, 0], [0.35, 0], [0.35, 0.25]]
{gauges}
[run]
step = "20 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("bed", &text).unwrap())
}

fn body(name: &str, material: &str, [x, y, x2, y2]: [f64; 4]) -> String {
    format!(
        "[bodies.{name}]\nmaterial = \"{material}\"\nbox = {{ lower = [{x}, {y}], upper = [{x2}, {y2}] }}\n"
    )
}

/// A column falls under water more slowly than in air and not as far. It ran over a row of water, which bore it: 0.29 m for 0.24 in air, and
/// further the finer.
#[test]
fn a_column_under_water_does_not_run_out_on_water() {
    let column = body("column", "sand", [0.0, 0.0, 0.1, 0.1]);
    let water = [
        body("above", "water", [0.0, 0.1, 0.1, 0.16]),
        body("beside", "water", [0.1, 0.0, 0.35, 0.16]),
    ]
    .concat();
    let front = "[gauges.front]\nkind = \"front\"\norigin = [0, 0]\ndirection = [1, 0]\nmaterial = \"sand\"\nleast_depth = \"10 mm\"";
    let run_out = |wet: bool| {
        let bodies = if wet {
            format!("{column}{water}")
        } else {
            column.clone()
        };
        let mut unit = sand_and_water(&bodies, wet, front);
        let fronts = [0.2, 0.9].map(|time| {
            unit.run_to(time);
            unit.get("gauge.front.front")
        });
        assert_eq!(unit.get("mass.error"), 0.0);
        fronts
    };
    let (wet, dry) = (run_out(true), run_out(false));
    println!("under water {wet:.3?} m, in air {dry:.3?} m");
    assert!(wet[0] < 0.8 * dry[0] && wet[1] < dry[1], "{wet:?} {dry:?}");
    assert!(wet[1] > 0.15, "{wet:?}");
}

/// Water under a bed rises through it, and the bed settles in its place, whatever its density: that of 1301 kg/m^3 stayed, as the pores' water
/// was another by rounding.
#[test]
fn water_under_a_bed_rises() {
    for density in [1000.0, 1301.0] {
        rises(density);
    }
}

fn rises(density: f64) {
    let bodies = [
        body("left", "sand", [0.0, 0.0, 0.06, 0.05]),
        body("pocket", "water", [0.06, 0.0, 0.08, 0.005]),
        body("over", "sand", [0.06, 0.005, 0.08, 0.05]),
        body("right", "sand", [0.08, 0.0, 0.35, 0.05]),
        body("above", "water", [0.0, 0.05, 0.35, 0.1]),
    ];
    let mut unit = sand_and(density, &bodies.concat(), true, "");
    let below = |unit: &Unit| {
        let view = unit.component.particles();
        let all = view.position.iter().zip(&view.phase);
        all.filter(|(x, phase)| **phase == 0 && x[1] < 0.04).count()
    };
    assert_eq!(below(&unit), 4);
    unit.run_to(0.4);
    assert_eq!(below(&unit), 0, "{density} kg/m^3");
    assert_eq!(unit.get("mass.error"), 0.0);
}

/// A bed that fills a closed tank has the pores' pressure of one under air, and one in a tank beside it its own: the equation leaves a constant
/// open, which was 0 in the mean.
#[test]
fn pores_of_a_closed_bed_have_no_pressure_at_its_top() {
    let text = r#"
name = "closed"
[domain]
lower = [-0.1, -0.1]
upper = [0.64, 0.4]
[numerics]
spacing = "8 mm"
[materials.water]
law = "fluid"
preset = "water"
[materials.silt]
law = "mu_i"
preset = "sand_04"
pore_fluid = "water"
[bodies.closed]
material = "silt"
box = { lower = [0, 0], upper = [0.2, 0.2] }
[bodies.open]
material = "silt"
box = { lower = [0.3, 0], upper = [0.5, 0.2] }
[walls.closed]
polyline = [[0, 0.2], [0, 0], [0.2, 0], [0.2, 0.2]]
closed = true
[walls.open]
polyline = [[0.3, 0.3], [0.3, 0], [0.5, 0], [0.5, 0.3]]
[gauges.closed]
kind = "pressure"
quantity = "pore"
at = [0.1, 0.02]
[gauges.open]
kind = "pressure"
quantity = "pore"
at = [0.4, 0.02]
[bodies.grain]
material = "silt"
box = { lower = [0.55, 0.2], upper = [0.558, 0.208] }
[gauges.grain]
kind = "pressure"
quantity = "pore"
at = [0.554, 0.204]
[run]
step = "20 ms"
until = "0.2 s"
"#;
    let mut unit = Unit::new(&scene::parse("closed", text).unwrap());
    // Around one grain alone is air.
    assert_eq!(unit.get("gauge.grain.validity"), 0.0);
    assert_eq!(unit.get("gauge.grain.pressure"), 0.0);
    unit.run_to(0.2);
    for gauge in ["closed", "open"] {
        let share = unit.get(&format!("gauge.{gauge}.pressure")) / (1000.0 * 9.81 * 0.18);
        println!("{gauge}: {share} of hydrostatic");
        assert!((share - 1.0).abs() < 0.01, "{gauge}: {share}");
    }
}

/// Saturated beads that flow down a slope of 11.5 degrees, from rest: friction is mu(I) times what presses grain on grain, tau/p' the same at any
/// depth, and Bagnold's mean speed 2/5 I/d sqrt(p'(0)/rho_s) H. With all of the half percent that pressure stands above the load between grains they were 3 to 7 % slow.
#[test]
fn a_saturated_layer_flows_as_its_buoyant_weight_lets_it() {
    const DEPTH: f64 = 0.05;
    const DIAMETER: f64 = 0.005;
    const GRAIN: f64 = 2500.0;
    const BULK: f64 = 0.6 * GRAIN + 0.4 * 1000.0;
    let (sin, cos) = 11.5_f64.to_radians().sin_cos();
    let tan = |degrees: f64| degrees.to_radians().tan();
    let (least, most) = (tan(20.9), tan(32.76));
    let mu = BULK / (BULK - 1000.0) * sin / cos;
    let inertial = 0.279 * (mu - least) / (most - mu);
    let exact =
        0.4 * inertial / DIAMETER * ((BULK - 1000.0) * 9.81 * cos * DEPTH / GRAIN).sqrt() * DEPTH;
    let mut mean = 0.0;
    for seed in [1, 2] {
        let text = format!(
            r#"
name = "slope"
[domain]
lower = [0, -0.05]
upper = [0.02, 0.1]
periodic = ["x"]
slope = "11.5 deg"
[numerics]
spacing = "2.5 mm"
seed = {seed}
[materials.water]
law = "fluid"
preset = "water"
[materials.beads]
law = "mu_i"
preset = "glass_beads"
grain_diameter = {DIAMETER}
grain_density = {GRAIN}
phi_min = 0.59
phi_max = 0.6
pore_fluid = "water"
[bodies.layer]
material = "beads"
box = {{ lower = [0, 0], upper = [0.02, {DEPTH}] }}
[walls.bed]
polyline = [[0, 0], [0.02, 0]]
[run]
step = "50 ms"
until = 6
"#
        );
        let mut unit = Unit::new(&scene::parse("slope", &text).unwrap());
        unit.run_to(5.0);
        for _ in 0..20 {
            unit.step();
            let particles = unit.component.particles();
            let sum: f64 = particles.velocity.iter().map(|v| f64::from(v[0])).sum();
            mean += sum / particles.velocity.len() as f64 / 40.0;
        }
    }
    println!("{mean} m/s for {exact}");
    assert!((mean / exact - 1.0).abs() < 0.02, "{mean}");
}
