//! What each is right and makes no sense together is refused.

use sandgate::scene;

/// What is said about keys whose value would not make sense where it stands.
#[test]
fn what_makes_no_sense_together_is_refused_with_what_would() {
    let scene = |numerics: &str, material: &str, gauge: &str| {
        let text = format!(
            r#"
name = "tank"
dimension = 2
[domain]
lower = [-0.1, -0.1]
upper = [0.6, 0.6]
[numerics]
spacing = 0.0125
{numerics}
[materials.water]
law = "fluid"
density = 1000
{material}
[bodies.water]
material = "water"
box = {{ lower = [0, 0], upper = [0.5, 0.5] }}
[walls.tank]
polyline = [[0, 0.5], [0, 0], [0.5, 0], [0.5, 0.5]]
[gauges.p]
kind = "pressure"
at = [0.1, 0.1]
{gauge}
[run]
step = 0.02
until = 1
"#
        );
        scene::parse("tank.toml", &text).map_or_else(|e| e.to_string(), |_| String::new())
    };
    let viscous = "consistency = 1";
    assert_eq!(scene("", viscous, ""), "");
    let said = scene("sound_speed = 2", viscous, "");
    assert!(said.contains("at least sqrt(g H), 2.215 m/s"), "{said}");
    let said = scene("", "consistency = 1\nsound_speed = 0.5", "");
    assert!(said.contains("materials.water.sound_speed"), "{said}");
    assert!(said.contains("at least sqrt(g H), 2.215 m/s"), "{said}");
    let said = scene("grain_compressibility = 1e-3", viscous, "");
    assert!(said.contains("a sound speed of 1 m/s"), "{said}");
    assert!(said.contains("lower grain_compressibility"), "{said}");
    let said = scene("", "consistency = 1\nflow_index = 0", "");
    assert!(said.contains("found:   0\n"), "{said}");
    assert!(!said.contains('%'), "{said}");
    let said = scene("", viscous, "quantity = \"effective\"");
    assert!(said.contains("\"total\" or \"pore\""), "{said}");
    let sand = "consistency = 1\n[materials.sand]\nlaw = \"mu_i\"\npreset = \"glass_beads\"\npore_fluid = \"oil\"";
    let said = scene("", sand, "");
    assert!(said.contains("law = \"fluid\": water\n"), "{said}");
}

/// A face may lie in the domain, and its span or its rows not.
#[test]
fn inflows_whose_rows_would_appear_outside_are_refused() {
    let scene = |inflow: &str| {
        let text = format!(
            r#"
name = "feed"
dimension = 3
[domain]
lower = [0, 0, 0]
upper = [0.4, 0.2, 0.4]
[numerics]
spacing = 0.02
expected_speed = 1
[materials.water]
law = "fluid"
preset = "water"
[inflows.feed]
material = "water"
{inflow}
[walls.floor]
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[run]
step = 0.02
until = 1
"#
        );
        scene::parse("feed.toml", &text).map_or_else(|e| e.to_string(), |_| String::new())
    };
    let face = |from: &str, to: &str, span: &str, velocity: &str| {
        scene(&format!(
            "from = {from}\nto = {to}\nspan = {span}\nvelocity = {velocity}\nrate = 0"
        ))
    };
    let inside = face(
        "[0.1, 0, 0.3]",
        "[0.2, 0, 0.3]",
        "[0, 0.2, 0]",
        "[0, 0, 0.5]",
    );
    assert_eq!(inside, "");
    let aside = face(
        "[0.1, 0, 0.3]",
        "[0.2, 0, 0.3]",
        "[0, 0.4, 0]",
        "[0, 0, 0.5]",
    );
    assert!(
        aside.contains("at y from 0 to 0.2 m, the domain"),
        "{aside}"
    );
    let above = face(
        "[0.1, 0, 0.4]",
        "[0.2, 0, 0.4]",
        "[0, 0.2, 0]",
        "[0, 0, 0.5]",
    );
    assert!(above.contains("a row of particles at z = 0.41"), "{above}");
}

/// A layer of beads on a slope that starts with Bagnold's profile; `more`: of the beads.
fn slope(law: &str, degrees: f64, more: &str) -> Result<(), String> {
    let text = format!(
        r#"
name = "slope"
[domain]
lower = [0, -0.1]
upper = [0.2, 0.2]
periodic = ["x"]
slope = "{degrees} deg"
[numerics]
spacing = 0.01
[materials.water]
law = "fluid"
preset = "water"
[materials.beads]
law = "{law}"
preset = "glass_beads"
{more}
[bodies.layer]
material = "beads"
box = {{ lower = [0, 0], upper = [0.2, 0.1] }}
velocity_profile = "bagnold"
[walls.bed]
polyline = [[0, 0], [0.2, 0]]
[run]
step = 0.02
until = 1
"#
    );
    scene::parse("slope", &text).map_or_else(|e| Err(e.to_string()), |_| Ok(()))
}

#[test]
fn bagnolds_flow_is_of_dry_grains() {
    assert_eq!(slope("mu_i", 25.0, ""), Ok(()));
    let said = slope("mu_i", 25.0, "pore_fluid = \"water\"").unwrap_err();
    assert!(said.contains("grains with a pore_fluid"), "{said}");
}

/// Below its static angle too: mu(0) of this law is 0.
#[test]
fn bagnolds_flow_is_wherever_the_law_has_one() {
    for degrees in [5.0, 20.5, 25.0] {
        assert_eq!(slope("barker_gray", degrees, ""), Ok(()), "{degrees}");
    }
    let said = slope("barker_gray", 0.0, "").unwrap_err();
    assert!(
        said.contains("the angle of rest of beads, 0.00 deg"),
        "{said}"
    );
    let said = slope("mu_i", 20.5, "").unwrap_err();
    assert!(
        said.contains("the angle of rest of beads, 20.90 deg"),
        "{said}"
    );
}
