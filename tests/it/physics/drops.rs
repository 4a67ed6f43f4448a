//! Drops of one particle: what flies, falls and jumps back gains no energy.

use super::Unit;
use sandgate::scene;

/// One particle of water above a floor: g y + v^2/2 of each communication point over the first [1].
fn energy_of_a_drop(dimension: usize, slip: &str) -> Vec<f64> {
    // The last axis is the vertical one.
    let place = |side: f64, height: f64| {
        let sides = if dimension == 3 { 2 } else { 1 };
        format!("[{}{height}]", format!("{side}, ").repeat(sides))
    };
    let text = format!(
        r#"
name = "drop"
dimension = {dimension}
[domain]
lower = {}
upper = {}
[numerics]
spacing = "10 mm"
expected_speed = "3 m/s"
[materials.water]
law = "fluid"
preset = "water"
[bodies.drop]
material = "water"
box = {{ lower = {}, upper = {} }}
[walls.floor]
plane = {{ point = {}, normal = {} }}
slip = "{slip}"
[run]
step = "20 ms"
until = "4 s"
"#,
        place(-0.2, -0.2),
        place(0.7, 1.0),
        place(0.2, 0.4),
        place(0.21, 0.41),
        place(0.0, 0.0),
        place(0.0, 1.0),
    );
    let mut unit = Unit::new(&scene::parse("drop", &text).unwrap());
    let mut energies = Vec::new();
    for point in 0..=200 {
        unit.run_to(f64::from(point) * 0.02);
        let drop = unit.component.particles();
        let (x, v) = (drop.position[0], drop.velocity[0]);
        let kinetic: f64 = v.iter().map(|c| f64::from(*c).powi(2)).sum();
        energies.push(9.81 * f64::from(x[dimension - 1]) + 0.5 * kinetic);
    }
    let first = energies[0];
    energies.iter().map(|e| e / first).collect()
}

/// Six to seven jumps. Symplectic Euler takes v half a step ahead of x: g v dt/2 of energy, 0.1 % here, goes to and fro.
#[test]
fn a_lone_drop_jumps_back_no_higher_than_it_fell() {
    for (dimension, slip) in [(2, "free_slip"), (2, "no_slip"), (3, "free_slip")] {
        for (point, energy) in energy_of_a_drop(dimension, slip).iter().enumerate() {
            assert!(
                *energy < 1.005,
                "{dimension}, {slip}: {energy} of its energy at {} s",
                0.02 * point as f64
            );
        }
    }
}
