//! Waves of water keep their energy, as far as a spacing lets them.

use super::Unit;
use sandgate::scene;

const PI: f64 = std::f64::consts::PI;
const LENGTH: f64 = 0.4;
const DEPTH: f64 = 0.1;
const HEIGHT: f64 = 0.005;

/// A tank whose water is let go from half a cosine, one spacing high: kinetic energies each time it is level, over that of a linear wave.
fn slosh() -> Vec<f64> {
    let crest = (0..=40).rev().map(|k| {
        let x = LENGTH * f64::from(k) / 40.0;
        let y = DEPTH + HEIGHT * (PI * x / LENGTH).cos();
        format!(", [{x:.6}, {y:.6}]")
    });
    let crest: String = crest.collect();
    let text = format!(
        r#"
name = "slosh"
[domain]
lower = [-0.05, -0.05]
upper = [0.45, 0.2]
[numerics]
spacing = "5 mm"
[materials.water]
law = "fluid"
preset = "water"
artificial_viscosity = 0
[bodies.water]
material = "water"
polygon = [[0, 0], [{LENGTH}, 0]{crest}]
[walls.tank]
polyline = [[0, 0.18], [0, 0], [{LENGTH}, 0], [{LENGTH}, 0.18]]
slip = "free_slip"
[run]
step = "10 ms"
until = 3
"#
    );
    let mut unit = Unit::new(&scene::parse("slosh", &text).unwrap());
    let k = PI / LENGTH;
    let period = 2.0 * PI / (9.81 * k * (k * DEPTH).tanh()).sqrt();
    let whole = 0.25 * 1000.0 * 9.81 * HEIGHT * HEIGHT * LENGTH;
    let mut peaks = vec![0.0_f64; 6];
    while unit.component.time() < 3.0 * period {
        unit.step();
        let half = (2.0 * unit.component.time() / period) as usize;
        if let Some(peak) = peaks.get_mut(half) {
            *peak = peak.max(unit.get("energy.kinetic") / whole);
        }
    }
    peaks
}

/// Sliding along smooth walls costs nothing: rough as their points made them they took a quarter of what a wave lost, 0.30 of its energy here.
#[test]
fn a_tank_sloshes_on() {
    let peaks = slosh();
    println!("kinetic energy of half periods: {peaks:.3?}");
    assert!(peaks[5] > 0.75 * peaks[0], "{peaks:?}");
}

/// Sound in layers whose densities differ by ten dies away: fed by the diffusion of density it grew to a fifth of the weight.
#[test]
fn layers_of_unlike_density_fall_silent() {
    const LAYER: f64 = 0.06;
    let text = format!(
        r#"
name = "silent"
[domain]
lower = [-0.05, -0.05]
upper = [0.17, 0.3]
[numerics]
spacing = "6 mm"
[materials.lower]
law = "fluid"
density = 1000
consistency = 1e-3
[materials.upper]
law = "fluid"
density = 100
consistency = 1e-3
[bodies.lower]
material = "lower"
box = {{ lower = [0, 0], upper = [0.12, {LAYER}] }}
[bodies.upper]
material = "upper"
box = {{ lower = [0, {LAYER}], upper = [0.12, {}] }}
[walls.tank]
polyline = [[0, 0.25], [0, 0], [0.12, 0], [0.12, 0.25]]
slip = "free_slip"
[gauges.tank]
kind = "force"
on = "wall.tank"
[run]
step = "2 ms"
until = 3
"#,
        2.0 * LAYER
    );
    let mut unit = Unit::new(&scene::parse("silent", &text).unwrap());
    let weight = 9.81 * unit.get("mass.present");
    unit.run_to(2.0);
    let mut squares = 0.0;
    for _ in 0..500 {
        unit.step();
        squares += (unit.get("gauge.tank.force_y") / weight + 1.0).powi(2) / 500.0;
    }
    println!("force swings by {:.2e} of the weight", squares.sqrt());
    assert!(squares.sqrt() < 1e-3, "{}", squares.sqrt());
}
