//! Slices in space between smooth side walls: what flows along them flows as in the plane.

use super::Unit;
use sandgate::scene;

/// Kinetic energy [J] for each metre across of a layer of mud that started 0.15 s ago down 8.6 degrees; six rows deep on a bed without slip
/// and, in space, six rows wide. `walls`: those of the slice, by the order of their tables; none: in the plane.
fn energy(walls: &[&str]) -> f64 {
    let (dimension, third) = match walls {
        [] => (2, ["", "", "", ""]),
        _ => (3, ["-0.06,", "0.09,", "0,", "0.03,"]),
    };
    let [below, above, from, to] = third;
    let tables: String = match walls {
        [] => "[walls.bed]\npolyline = [[0, 0], [0.04, 0]]\n".to_owned(),
        _ => walls.iter().map(|w| wall(w)).collect(),
    };
    let text = format!(
        r#"
name = "slice"
dimension = {dimension}
[domain]
lower = [0, {below} -0.04]
upper = [0.04, {above} 0.08]
gravity = [1.466, {from} -9.7]
periodic = ["x"]
[numerics]
spacing = 0.005
[materials.mud]
law = "fluid"
density = 1500
consistency = 2
yield_stress = 20
[bodies.layer]
material = "mud"
box = {{ lower = [0, {from} 0], upper = [0.04, {to} 0.03] }}
{tables}
[run]
step = 0.05
until = 0.15
"#
    );
    let mut unit = Unit::new(&scene::parse("slice", &text).unwrap());
    unit.run_to(0.15);
    let width = if dimension == 2 { 1.0 } else { 0.03 };
    unit.get("energy.kinetic") / width
}

/// A wall of the slice.
fn wall(name: &str) -> String {
    let (point, normal, slip) = match name {
        "bed" => ("[0, 0, 0]", "[0, 0, 1]", "no_slip"),
        "left" => ("[0, 0, 0]", "[0, 1, 0]", "free_slip"),
        _ => ("[0, 0.03, 0]", "[0, -1, 0]", "free_slip"),
    };
    format!("[walls.{name}]\nplane = {{ point = {point}, normal = {normal} }}\nslip = \"{slip}\"\n")
}

/// Without their images in the side walls (docs/theory.md, W11) layers lose a third of their viscosity at such a width.
#[test]
fn a_slice_between_smooth_walls_flows_as_the_plane() {
    let plane = energy(&[]);
    let slice = energy(&["bed", "left", "right"]);
    let other_order = energy(&["right", "left", "bed"]);
    println!("{plane} J/m in the plane, {slice} and {other_order} in a slice");
    assert!((slice / plane - 1.0).abs() < 0.08, "{slice} {plane}");
    // The points behind bed and side walls are the bed's, whichever stands first.
    assert!((other_order / slice - 1.0).abs() < 1e-3, "{other_order}");
}

/// Points of smooth side walls show 0.65 of the slope of pressure along them; images (docs/theory.md, W12) the rest.
#[test]
fn sand_between_smooth_walls_has_the_pressure_of_its_depth() {
    let degrees = 26.0_f64;
    let (along, down) = (
        9.81 * degrees.to_radians().sin(),
        9.81 * degrees.to_radians().cos(),
    );
    let text = format!(
        r#"
name = "slice"
dimension = 3
[domain]
lower = [0, -0.02, -0.02]
upper = [0.016, 0.032, 0.04]
gravity = [{along}, 0, -{down}]
periodic = ["x"]
[numerics]
spacing = 0.002
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.layer]
material = "sand"
box = {{ lower = [0, 0, 0], upper = [0.016, 0.012, 0.02] }}
[walls.bed]
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
slip = "no_slip"
[walls.left]
plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
slip = "free_slip"
[walls.right]
plane = {{ point = [0, 0.012, 0], normal = [0, -1, 0] }}
slip = "free_slip"
[gauges.middle]
kind = "pressure"
at = [0.008, 0.006, 0.01]
[run]
step = 0.02
until = 0.3
"#
    );
    let mut unit = Unit::new(&scene::parse("slice", &text).unwrap());
    let mut mean = 0.0;
    for k in 0..8 {
        unit.run_to(0.16 + 0.02 * f64::from(k));
        mean += unit.get("gauge.middle.pressure") / 8.0;
    }
    // Half of the layer's weight on the bed's area.
    let load = 0.5 * unit.get("mass.present") * down / (0.016 * 0.012);
    println!("{mean} Pa of {load} Pa");
    assert!((mean / load - 1.0).abs() < 0.03, "{mean} {load}");
}
