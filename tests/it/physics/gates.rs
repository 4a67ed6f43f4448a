//! Gates in water: what must not keep them from closing.

use super::Unit;
use sandgate::scene;

/// A sluice between two tanks of water, open by 80 mm, closes as fast as it may; with this seed a drop stands still at its lip and held it.
#[test]
fn a_drop_holds_no_gate() {
    let text = r#"
name = "lock"
[domain]
lower = [-0.1, -0.1]
upper = [1.1, 0.9]
[numerics]
spacing = "10 mm"
seed = 2
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[bodies.left]
material = "water"
box = { lower = [0, 0], upper = [0.48, 0.4] }
[bodies.right]
material = "water"
box = { lower = [0.52, 0], upper = [1, 0.2] }
[walls.tank]
polyline = [[0, 0.8], [0, 0], [1, 0], [1, 0.8]]
slip = "free_slip"
[gates.sluice]
from = [0.48, 0]
to = [0.48, 0.5]
max_speed = 1
[run]
step = "20 ms"
until = "1 s"
"#;
    let mut unit = Unit::new(&scene::parse("lock", text).unwrap());
    unit.run_to(0.1);
    unit.set("gate.sluice.opening", 0.16);
    unit.run_to(0.6);
    unit.set("gate.sluice.opening", 0.0);
    unit.run_to(0.74);
    assert_eq!(unit.get("gate.sluice.actual_opening"), 0.0);
}
