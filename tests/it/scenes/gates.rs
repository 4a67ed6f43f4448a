//! Gates that do not fit what stands before them.

use sandgate::scene;

#[test]
fn a_body_inside_a_gate_is_told_on_which_side_material_belongs() {
    // Third coordinates of what is low and high, where there are any.
    let scene = |dimension: u8, low: &str, high: &str, gate: &str| {
        format!(
            r#"
name = "gate"
dimension = {dimension}
[domain]
lower = [-0.1, -0.1{low}]
upper = [0.6, 0.6{high}]
[numerics]
spacing = 0.0125
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.sand]
material = "sand"
box = {{ lower = [0, 0{low}], upper = [0.3, 0.1{high}] }}
[gates.front]
{gate}
[run]
step = 0.02
until = 1
"#
        )
    };
    let planar = scene(2, "", "", "from = [0.3, 0.2]\nto = [0.3, 0]");
    let said = scene::parse("gate.toml", &planar).unwrap_err().to_string();
    assert!(said.contains("on the left of a gate's way"), "{said}");
    let gate = "from = [0.3, 0, 0.1]\nto = [0.3, 0.2, 0.1]\nspan = [0, 0, -0.1]";
    let said = scene::parse("gate.toml", &scene(3, ", 0", ", 0.1", gate));
    let said = said.unwrap_err().to_string();
    assert!(said.contains("the plate of gates.front"), "{said}");
    assert!(said.contains("the side of span x (to - from)"), "{said}");
    let gate = "from = [0.3, 0, 0]\nto = [0.3, 0.2, 0]\nspan = [0, 0, 0.1]";
    let space = scene::parse("gate.toml", &scene(3, ", 0", ", 0.1", gate)).unwrap();
    scene::build::<3>(&space).unwrap();
}

/// The silo of the cases with another spacing.
fn silo(spacing: &str) -> Result<scene::Scene, scene::SceneErrors> {
    let path = crate::python::root().join("cases/silo_gate.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let coarser = text.replacen(
        "spacing = \"3.125 mm\"",
        &format!("spacing = \"{spacing}\""),
        1,
    );
    assert_ne!(text, coarser);
    scene::parse("silo_gate.toml", &coarser)
}

#[test]
fn a_wall_thinner_than_the_spacing_is_told_as_that() {
    // The lip of the outlet, chamfered below, comes nearer to the floor than half a spacing.
    let said = silo("24 mm").unwrap_err().to_string();
    assert!(
        said.contains("behind a face of walls.left is its other side"),
        "{said}"
    );
    assert!(said.contains("a spacing of at most 0.02 m"), "{said}");
    assert!(said.contains("refine numerics.spacing"), "{said}");
    assert!(!said.contains("reverse"), "{said}");
    silo("20 mm").unwrap();
}

#[test]
fn a_gate_may_be_two_spacings_wide_however_that_is_rounded() {
    let said = silo("25 mm").unwrap_err().to_string();
    assert!(!said.contains("gates.main"), "{said}");
    let said = silo("26 mm").unwrap_err().to_string();
    let wide = "a face 0.05 m wide";
    assert!(
        said.contains(wide) && said.contains("at least 0.052 m"),
        "{said}"
    );
}

/// A tank whose floor ends in a lip 0.14 m long, cut away below at this angle.
fn lip(degrees: f64, spacing: f64) -> Result<scene::Scene, scene::SceneErrors> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (x, y) = (0.25 - 0.14 * cos, -0.14 * sin);
    let text = format!(
        r#"
name = "lip"
[domain]
lower = [-0.2, -0.6]
upper = [0.8, 1.0]
[numerics]
spacing = {spacing}
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0, 0], upper = [0.6, 0.4] }}
[walls.left]
polyline = [[0, 0.9], [0, 0], [0.25, 0], [{x}, {y}]]
[walls.right]
polyline = [[0.35, 0], [0.6, 0], [0.6, 0.9]]
[run]
step = 0.02
until = 1
"#
    );
    scene::parse("lip.toml", &text)
}

/// However sharp: what is accepted is so with finer spacings, and a figure that is named passes.
#[test]
fn a_sharp_lip_is_refused_by_one_figure_or_not_at_all() {
    for degrees in [12.0, 20.0, 30.0, 40.0, 44.9, 45.0, 46.0, 52.0, 60.0] {
        let mut figure = None;
        for n in 0..60 {
            let spacing = 0.05 * 0.95_f64.powi(n);
            match lip(degrees, spacing) {
                Ok(_) => figure = Some(f64::INFINITY),
                Err(said) => {
                    let said = said.to_string();
                    let most = said.split("a spacing of at most ").nth(1);
                    let most = most.unwrap_or_else(|| panic!("{degrees} {spacing}: {said}"));
                    let most: f64 = most.split(' ').next().unwrap().parse().unwrap();
                    assert!(most < spacing, "{degrees} {spacing}: {most}");
                    assert!(
                        figure.is_none_or(|before| before == most),
                        "{degrees}: {said}"
                    );
                    lip(degrees, most).unwrap();
                    figure = Some(most);
                }
            }
        }
        assert_eq!(figure, Some(f64::INFINITY), "{degrees}");
    }
}
