//! `validity.share_fast` and `validity.share_squeezed`: what moves faster than a fifth of the sound speed, and against what; what has
//! given way by more than a twentieth.

use super::Unit;
use sandgate::scene;

/// Sound speed of all scenes here [m/s].
const SOUND: f64 = 10.0;

/// Water that glides at `water` over a belt that runs at `belt` [m/s]; its share of fast mass at the end.
fn over_a_belt(water: f64, belt: f64) -> f64 {
    let text = include_str!("../../scenes/stream.toml")
        .replace("velocity = [0, 0]", &format!("velocity = [{belt}, 0]"))
        .replace("velocity = [2.1, 0]", &format!("velocity = [{water}, 0]"));
    let mut unit = Unit::new(&scene::parse("stream.toml", &text).unwrap());
    unit.run_to(0.02);
    unit.get("validity.share_fast")
}

#[test]
fn fast_is_faster_than_a_fifth_of_the_sound_speed_against_walls() {
    assert_eq!(over_a_belt(0.19 * SOUND, 0.0), 0.0);
    assert!(over_a_belt(0.21 * SOUND, 0.0) > 0.9);
    assert_eq!(over_a_belt(0.21 * SOUND, 0.1 * SOUND), 0.0);
    assert!(over_a_belt(0.0, -0.21 * SOUND) > 0.9);
}

/// Without walls, against the mean of all: two drops that meet are as fast in any frame.
#[test]
fn without_walls_fast_is_the_same_in_any_frame() {
    let share = |frame: f64| {
        let text = format!(
            r#"
name = "drops"
title = "Two drops that meet"
dimension = 2
[domain]
lower = [-2, -1]
upper = [2, 1]
gravity = 0
[numerics]
spacing = 0.01
sound_speed = {SOUND}
[materials.water]
law = "fluid"
density = 1000
consistency = 1e-3
[bodies.left]
material = "water"
box = {{ lower = [-0.1, -0.1], upper = [0, 0.1] }}
velocity = [{}, 0]
[bodies.right]
material = "water"
box = {{ lower = [0, -0.1], upper = [0.1, 0.1] }}
velocity = [{}, 0]
[run]
step = 0.005
until = 0.1
"#,
            frame + 0.3 * SOUND,
            frame - 0.3 * SOUND,
        );
        let mut unit = Unit::new(&scene::parse("drops.toml", &text).unwrap());
        unit.run_to(0.005);
        unit.get("validity.share_fast")
    };
    let (still, moving) = (share(0.0), share(2.0 * SOUND));
    assert!(still > 0.05 && still < 1.0, "{still}");
    assert!((still - moving).abs() < 0.01, "{still} {moving}");
}

/// A piston presses a block in a trough along by `way` of its length; its share of squeezed mass.
fn pressed(way: f64) -> f64 {
    let text = format!(
        r#"
name = "oedometer"
title = "Sand in a trough under a piston"
dimension = 2
[domain]
lower = [-0.1, -0.1]
upper = [0.3, 0.2]
gravity = 9.81
[numerics]
spacing = 0.005
sound_speed = {SOUND}
[materials.sand]
law = "mu_i"
preset = "sand_08"
[bodies.block]
material = "sand"
box = {{ lower = [0, 0], upper = [0.1, 0.1] }}
[walls.trough]
polyline = [[0, 0.1], [0, 0], [0.1, 0], [0.1, 0.1]]
slip = "free_slip"
[walls.lid]
polyline = [[0.1, 0.1], [0, 0.1]]
motion = "rigid"
velocity = [0, -0.2]
slip = "free_slip"
[run]
step = 0.005
until = 0.1
"#
    );
    let mut unit = Unit::new(&scene::parse("oedometer.toml", &text).unwrap());
    unit.run_to(way * 0.1 / 0.2);
    unit.get("validity.share_squeezed")
}

/// A box that is full: a strain of more than a twentieth is just that.
#[test]
fn what_a_piston_leaves_no_room_is_squeezed() {
    assert!(pressed(0.02) < 0.05);
    assert!(pressed(0.08) > 0.9);
}

/// All of a slow layer yields, where mu(I) is ill-posed, and nothing creeps: what yields slower than the cap of viscosity counted as creep.
#[test]
fn what_yields_slowly_does_not_creep() {
    let text = r#"
name = "slow_layer"
[domain]
lower = [0, -0.05]
upper = [0.2, 0.3]
periodic = ["x"]
slope = "20.95 deg"
[numerics]
spacing = 0.01
expected_speed = 1.5
[materials.s]
law = "mu_i"
preset = "glass_beads"
grain_diameter = "5 mm"
[bodies.a]
material = "s"
box = { lower = [0, 0], upper = [0.2, 0.1] }
velocity_profile = "bagnold"
[walls.floor]
plane = { point = [0, 0], normal = [0, 1] }
[run]
step = 0.01
until = 0.1
"#;
    let mut unit = Unit::new(&scene::parse("slow_layer", text).unwrap());
    unit.run_to(0.1);
    let (ill_posed, creep) = (
        unit.get("validity.share_ill_posed"),
        unit.get("validity.creep_rate"),
    );
    println!("ill-posed {ill_posed}, creep {creep} 1/s");
    assert!(ill_posed > 0.99 && creep < 1e-3);
}
