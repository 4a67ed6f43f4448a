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
