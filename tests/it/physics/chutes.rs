//! What repeats along gravity has nothing above it: it falls, or slides between rough walls as mu(I) says; and what is driven along a
//! duct does not press on its lid.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

/// Sand between two rough walls fills a period along gravity: nothing presses it against them.
#[test]
fn a_plug_that_fills_a_period_falls_freely() {
    let text = r#"
name = "plug"
[domain]
lower = [-0.05, 0]
upper = [0.15, 0.24]
periodic = ["y"]
[numerics]
spacing = "5 mm"
sound_speed = 20
expected_speed = 1
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.plug]
material = "sand"
box = { lower = [0, 0], upper = [0.1, 0.24] }
[walls.left]
polyline = [[0, 0.24], [0, 0]]
slip = "friction"
wall_friction = 0.3
[walls.right]
polyline = [[0.1, 0], [0.1, 0.24]]
slip = "friction"
wall_friction = 0.3
[run]
step = "20 ms"
until = "0.2 s"
"#;
    let mut unit = Unit::new(&scene::parse("plug", text).unwrap());
    unit.run_to(0.2);
    let energy = unit.get("energy.kinetic");
    let speed = (2.0 * energy / unit.component.ledger().present).sqrt();
    println!("{:.4} of free fall", speed / (G * 0.2));
    assert!((speed / (G * 0.2) - 1.0).abs() < 0.03, "{speed}");
}

/// Mean speed of glass beads of 5 mm between rough walls `width` [m] apart that press with `pressure` [Pa]: shear stress grows evenly from
/// the middle, and I of its ratio to an even pressure is the law's.
fn speed_between_walls(width: f64, pressure: f64) -> f64 {
    const POINTS: u32 = 20_000;
    let (mu_s, mu_2, scale) = (
        20.9f64.to_radians().tan(),
        32.76f64.to_radians().tan(),
        0.279,
    );
    let step = width / 2.0 / f64::from(POINTS);
    let (mut speed, mut sum) = (0.0, 0.0);
    for k in 0..POINTS {
        let from_middle = width / 2.0 - (f64::from(k) + 0.5) * step;
        let friction = 1500.0 * G * from_middle / pressure;
        if friction > mu_s {
            let number = scale * (friction - mu_s) / (mu_2 - friction);
            speed += number * (pressure / 2500.0).sqrt() / 0.005 * step;
        }
        sum += speed * step;
    }
    sum / (width / 2.0)
}

/// Nothing presses beads in a closed chute but what they fill it with, and most of it is a plug: 20 rows across shear in two at either
/// wall. Without (W14) the first has the wall's friction half a spacing inside and twice as much passes as should (docs/decisions/016). A
/// percent of pressure is a sixth of the speed.
#[test]
fn beads_slide_between_rough_walls_as_fast_as_friction_lets_them() {
    const WIDTH: f64 = 0.1;
    let text = r#"
name = "chute"
[domain]
lower = [-0.08, 0]
upper = [0.08, 0.04]
periodic = ["y"]
[numerics]
spacing = "5 mm"
sound_speed = 20
friction_into_walls = true
[materials.beads]
law = "mu_i"
preset = "glass_beads"
grain_diameter = "5 mm"
[bodies.beads]
material = "beads"
box = { lower = [-0.05, 0], upper = [0.05, 0.04] }
[walls.left]
plane = { point = [-0.05, 0], normal = [1, 0] }
[walls.right]
plane = { point = [0.05, 0], normal = [-1, 0] }
[gauges.left]
kind = "force"
on = "wall.left"
[gauges.right]
kind = "force"
on = "wall.right"
[run]
step = "50 ms"
until = "3 s"
"#;
    let mut unit = Unit::new(&scene::parse("chute", text).unwrap());
    let (mut speed, mut pressure, mut shear) = (0.0, 0.0, 0.0);
    for n in 1..=10 {
        unit.run_to(2.5 + 0.05 * f64::from(n));
        let view = unit.component.particles();
        let sum: f64 = view.velocity.iter().map(|v| f64::from(v[1])).sum();
        speed -= sum / view.velocity.len() as f64 / 10.0;
        let of = |k: &str| ["left", "right"].map(|w| unit.get(&format!("gauge.{w}.force_{k}")));
        let ([left, right], [up, also_up]) = (of("x"), of("y"));
        pressure += (right - left) / 20.0 / 0.04;
        shear += (up + also_up) / 10.0;
    }
    let exact = speed_between_walls(WIDTH, pressure);
    let weight = 1500.0 * G * WIDTH * 0.04;
    println!(
        "{:.3} of the exact speed at {pressure:.0} Pa, walls bear {:.4} of the weight",
        speed / exact,
        -shear / weight
    );
    assert!((speed / exact - 1.0).abs() < 0.25, "{speed}, {exact}");
    assert!((-shear / weight - 1.0).abs() < 0.01, "{shear}");
}

/// A fluid that is driven along a duct, from side to side of the domain, leans on its floor alone.
#[test]
fn the_lid_of_a_duct_bears_nothing_at_the_start() {
    let text = r#"
name = "duct"
[domain]
lower = [0, -0.02]
upper = [0.1, 0.06]
periodic = ["x"]
gravity = [9.81, -0.3]
[numerics]
spacing = "2.5 mm"
sound_speed = "6 m/s"
[materials.fluid]
law = "fluid"
density = 1000
consistency = 1
[bodies.fluid]
material = "fluid"
box = { lower = [0, 0], upper = [0.1, 0.04] }
[walls.floor]
polyline = [[0, 0], [0.1, 0]]
[walls.lid]
polyline = [[0.1, 0.04], [0, 0.04]]
[gauges.floor]
kind = "force"
on = "wall.floor"
[gauges.lid]
kind = "force"
on = "wall.lid"
[run]
step = "5 ms"
until = "0.05 s"
"#;
    let mut unit = Unit::new(&scene::parse("duct", text).unwrap());
    let (mut floor, mut lid) = (0.0, 0.0);
    for _ in 0..4 {
        unit.step();
        // A quarter each of a force on 0.1 m.
        floor -= unit.get("gauge.floor.force_y") / 0.4;
        lid += unit.get("gauge.lid.force_y") / 0.4;
    }
    let weight = 1000.0 * 0.3 * 0.04;
    println!("floor {floor:.2} Pa, lid {lid:.2} Pa, weight {weight:.2} Pa");
    // The start's jitter sounds: 0.3 to 0.5 Pa of the 12, 486 with the weight of a period.
    assert!(lid.abs() < 0.08 * weight, "{lid}");
    assert!((floor - weight).abs() < 0.08 * weight, "{floor}");
}

/// A layer on a slope of 60 deg presses on its bed with its weight across it.
#[test]
fn a_layer_on_a_steep_slope_starts_with_the_load_across_it() {
    let text = r#"
name = "steep"
[domain]
lower = [-0.5, -0.1]
upper = [1.5, 0.5]
slope = "60 deg"
[numerics]
spacing = "5 mm"
expected_speed = 2
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.layer]
material = "sand"
box = { lower = [0, 0], upper = [0.5, 0.05] }
[walls.bed]
polyline = [[-0.5, 0], [1.5, 0]]
slip = "friction"
wall_friction = 0.3
[gauges.probe]
kind = "pressure"
at = [0.25, 0.01]
[run]
step = "5 ms"
until = "0.1 s"
"#;
    let unit = Unit::new(&scene::parse("steep", text).unwrap());
    let pressure = unit.get("gauge.probe.pressure");
    let across = 1500.0 * G * 0.5 * 0.04;
    println!("{pressure:.1} Pa for {across:.1}");
    assert!((pressure / across - 1.0).abs() < 0.1, "{pressure}");
}
