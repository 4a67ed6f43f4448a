//! Inflows beside material that stands before a part of their face.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;
/// Height of the face [m].
const FACE: f64 = 0.12;

/// Water let into an empty channel that ends in a free overfall.
const CHANNEL: &str = r#"
name = "channel"
[domain]
lower = [-0.2, -0.3]
upper = [2, 0.4]
[numerics]
spacing = "20 mm"
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[walls.bed]
polyline = [[0, 0.3], [0, 0], [1, 0], [1, -0.1]]
slip = "free_slip"
[inflows.feed]
material = "water"
from = [0, 0.12]
to = [0, 0]
velocity = [0.8333333333, 0]
rate = 99.99
[outflows.end]
lower = [-0.2, -0.3]
upper = [2, -0.2]
[run]
step = 0.02
until = 1.5
"#;

/// The foot of a slow stream stands before the foot of the face. The rest of it lets in as much as a reservoir that is as high as the face,
/// (2/3)^(3/2) sqrt(g) H^(3/2) [m^2/s]: what enters loses its speed to what is there.
#[test]
fn a_channel_is_fed_by_an_inflow_in_its_side() {
    let scene = scene::parse("channel.toml", CHANNEL).unwrap_or_else(|e| panic!("{e}"));
    let mut unit = Unit::new(&scene);
    unit.run_to(0.5);
    let before = unit.get("inflow.feed.mass");
    unit.run_to(1.5);
    let rate = (unit.get("inflow.feed.mass") - before) / 1000.0;
    let reservoir = (2.0_f64 / 3.0).powf(1.5) * (G * FACE.powi(3)).sqrt();
    println!("{rate} m^2/s enter, a reservoir feeds {reservoir}");
    assert!(rate > 0.9 * reservoir, "{rate} of {reservoir}");
    assert_eq!(unit.get("mass.error"), 0.0);
}

/// What is all under material lets nothing in.
#[test]
fn an_inflow_under_material_is_blocked() {
    let text = CHANNEL
        .replace(
            "polyline = [[0, 0.3], [0, 0], [1, 0], [1, -0.1]]",
            "polyline = [[0, 0.4], [0, 0], [1, 0], [1, 0.4]]",
        )
        .replace(
            "[inflows.feed]",
            "[bodies.pool]\nmaterial = \"water\"\nbox = { lower = [0, 0], upper = [1, 0.2] }\n[inflows.feed]",
        );
    let scene = scene::parse("pool.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let mut unit = Unit::new(&scene);
    unit.run_to(0.5);
    assert_eq!(unit.get("inflow.feed.mass"), 0.0);
    assert_eq!(unit.get("inflow.feed.blocked"), 1.0);
}
