//! Walls: Coulomb friction, motion, corners; what they push back with.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;

/// A scene of strong material, which moves as a block, of particles of 10 mm.
fn unit(domain: &str, numerics: &str, parts: &str) -> Unit {
    let text = format!(
        r#"
name = "block"
{domain}
[numerics]
spacing = "10 mm"
sleep = false
{numerics}
[materials.block]
law = "constant_friction"
friction_angle = "40 deg"
cohesion = 1000
density = 1500
{parts}
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("block", &text).unwrap())
}

/// A layer 12 by 10 particles on a floor tilted by `slope` [deg], periodic along it. `floor` holds keys of its wall.
fn layer(slope: f64, floor: &str, numerics: &str) -> Unit {
    unit(
        &format!(
            r#"
[domain]
lower = [0, -0.02]
upper = [0.12, 0.3]
periodic = ["x"]
slope = "{slope} deg""#
        ),
        numerics,
        &format!(
            r#"
[bodies.block]
material = "block"
box = {{ lower = [0, 0], upper = [0.12, 0.1] }}
[walls.floor]
plane = {{ point = [0, 0], normal = [0, 1] }}
{floor}
[gauges.floor]
kind = "force"
on = "wall.floor""#
        ),
    )
}

const FRICTION: &str = "slip = \"friction\"\nwall_friction = 0.4";

/// Mean velocity along x, and the largest size of one component of it [m/s].
fn speeds(unit: &Unit) -> (f64, f64) {
    let particles = unit.component.particles();
    let along: Vec<f64> = particles.velocity.iter().map(|v| f64::from(v[0])).collect();
    let mean = along.iter().sum::<f64>() / along.len() as f64;
    (mean, along.iter().fold(0.0, |m: f64, v| m.max(v.abs())))
}

/// Acceleration along x between two times [m/s^2].
fn acceleration(unit: &mut Unit, from: f64, to: f64) -> f64 {
    unit.run_to(from);
    let (before, _) = speeds(unit);
    unit.run_to(to);
    (speeds(unit).0 - before) / (to - from)
}

/// Above atan(mu_w) = 21.8 deg a block slides with g (sin - mu_w cos), and the floor carries mu_w times its weight: in the
/// mean, since pressure and what rubs swing by some parts of 1000 against each other as the layer settles.
#[test]
fn a_block_slides_as_coulomb_says() {
    let slope = 30f64.to_radians();
    let expected = G * (slope.sin() - 0.4 * slope.cos());
    // What the solve leaves is the wall's, too: 1e-3 of what it bears at the default tolerance.
    let mut sliding = layer(30.0, FRICTION, "solver_tolerance = 1e-5");
    let measured = acceleration(&mut sliding, 0.2, 0.7);
    let (mut along, mut down) = (0.0, 0.0);
    for k in 1..=20 {
        sliding.run_to(0.7 + 0.01 * f64::from(k));
        along += sliding.get("gauge.floor.force_x");
        down -= sliding.get("gauge.floor.force_y");
    }
    let mu = along / down;
    println!(
        "slides with {measured:.5} m/s^2 ({expected:.5}); shear force {mu:.5} of the normal one"
    );
    assert!((measured / expected - 1.0).abs() < 2e-3);
    assert!((mu / 0.4 - 1.0).abs() < 1e-3);
}

/// Below that angle it stays; what it shook at first dies out, and nothing creeps. With a large mu_w it stays on any
/// slope that it does not yield on.
#[test]
fn a_block_sticks_below_the_angle_of_wall_friction() {
    for (slope, floor) in [
        (20.0, FRICTION),
        (35.0, "slip = \"friction\"\nwall_friction = 5"),
    ] {
        let mut resting = layer(slope, floor, "");
        resting.run_to(1.0);
        let (_, first) = speeds(&resting);
        let place = |u: &Unit| -> f64 {
            let x = u.component.particles().position;
            x.iter().map(|x| f64::from(x[0])).sum::<f64>() / x.len() as f64
        };
        let start = place(&resting);
        resting.run_to(3.0);
        let (_, last) = speeds(&resting);
        let moved = place(&resting) - start;
        println!(
            "at {slope} deg {first:.1e} m/s after 1 s, {last:.1e} after 3 s; moved by {moved:.1e} m in 2 s"
        );
        assert!(last < 1e-5 && last < first && moved.abs() < 1e-6);
    }
}

/// mu_w = 0 is free slip to the bit, a tiny one is near it: there no friction from the phase of sand
/// and wall points either.
#[test]
fn no_friction_is_free_slip() {
    let run = |floor: &str| {
        let mut unit = layer(30.0, floor, "");
        unit.run_to(0.3);
        unit.component.particles().velocity
    };
    let free = run("slip = \"free_slip\"");
    assert_eq!(run("slip = \"friction\"\nwall_friction = 0"), free);
    let tiny = run("slip = \"friction\"\nwall_friction = 1e-6");
    for (a, b) in tiny.iter().zip(&free) {
        assert!((a[0] - b[0]).abs() < 5e-4, "{a:?} and {b:?}");
    }
}

/// With the plain cap a block slides too; it shears at up to 1/cap_time meanwhile, which is 1 % here.
#[test]
fn a_capped_yield_slides_as_well() {
    let slope = 30f64.to_radians();
    let expected = G * (slope.sin() - 0.4 * slope.cos());
    let measured = acceleration(&mut layer(30.0, FRICTION, "yield = \"capped\""), 0.2, 0.7);
    println!("slides with {measured:.5} m/s^2 ({expected:.5})");
    assert!((measured / expected - 1.0).abs() < 0.02);
}

/// A belt takes a block along at mu_w g until both are as fast, and then the block rides on it.
#[test]
fn a_belt_takes_a_block_along() {
    let mut belt = layer(0.0, &format!("{FRICTION}\nvelocity = [1, 0]"), "");
    let measured = acceleration(&mut belt, 0.05, 0.2);
    println!("taken along with {measured:.5} m/s^2 ({:.5})", 0.4 * G);
    assert!((measured / (0.4 * G) - 1.0).abs() < 3e-3);
    belt.run_to(1.5);
    let (mean, largest) = speeds(&belt);
    println!("rides at {mean:.6} m/s, at most {largest:.6} m/s");
    assert!((mean - 1.0).abs() < 1e-5 && largest < 1.0 + 1e-4);
}

/// In space friction acts against the slip, whatever its direction along the face.
#[test]
fn a_block_in_space_slides_the_same() {
    let mut block = unit(
        r#"
dimension = 3
[domain]
lower = [0, 0, -0.02]
upper = [0.08, 0.08, 0.3]
periodic = ["x", "y"]
gravity = [3, 4, -10]"#,
        "",
        r#"
[bodies.block]
material = "block"
box = { lower = [0, 0, 0], upper = [0.08, 0.08, 0.06] }
[walls.floor]
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
slip = "friction"
wall_friction = 0.3"#,
    );
    let expected = 3.0 * (5.0 - 0.3 * 10.0) / 5.0;
    let measured = acceleration(&mut block, 0.1, 0.3);
    let velocity = block.component.particles().velocity;
    let mean = |k: usize| velocity.iter().map(|v| f64::from(v[k])).sum::<f64>();
    println!(
        "slides with {measured:.5} m/s^2 ({expected:.5}); v_y/v_x {:.5}",
        mean(1) / mean(0)
    );
    assert!((measured / expected - 1.0).abs() < 5e-3);
    assert!((mean(1) / mean(0) - 4.0 / 3.0).abs() < 2e-3);
}

/// Friction stops what holds together and takes it along; it does not turn it round. A block thrown on a floor ran back at 4 % of its speed,
/// one on a belt outran it by as much.
#[test]
fn friction_stops_a_block_and_no_more() {
    let ride = |block: &str, belt: &str| {
        unit(
            "[domain]\nlower = [-0.2, -0.1]\nupper = [1, 0.3]",
            "",
            &format!(
                r#"
[bodies.block]
material = "block"
box = {{ lower = [0, 0], upper = [0.2, 0.1] }}
velocity = [{block}, 0]
[walls.floor]
polyline = [[-0.2, 0], [1, 0]]
slip = "friction"
wall_friction = 0.3
velocity = [{belt}, 0]"#
            ),
        )
    };
    for (block, belt) in [("0.5", "0"), ("0", "0.5")] {
        let mut ride = ride(block, belt);
        let speed = |unit: &Unit| {
            let v = unit.component.particles().velocity;
            v.iter().map(|v| f64::from(v[0])).sum::<f64>() / v.len() as f64
        };
        let towards = if block == "0" { 1.0 } else { -1.0 };
        let mut furthest = 0.0_f64;
        for k in 1..=30 {
            ride.run_to(0.01 * f64::from(k));
            furthest = furthest.max(towards * speed(&ride));
        }
        let end = if block == "0" { 0.5 } else { 0.0 };
        println!(
            "from {block} on a belt of {belt}: at most {:.4} m/s, {:.4} at the end",
            towards * furthest,
            speed(&ride)
        );
        assert!(furthest - towards * end < 5e-3);
        assert!((speed(&ride) - end).abs() < 1e-3);
    }
}

/// A plane that turns in itself takes a block on it round at its own rate, to 2 %: near free faces the stress form resists
/// rigid rotation a little (docs/limits.md).
#[test]
fn a_turntable_takes_its_load_round() {
    let mut table = unit(
        "dimension = 3\n[domain]\nlower = [-0.1, -0.1, -0.02]\nupper = [0.1, 0.1, 0.2]",
        "",
        r#"
[bodies.block]
material = "block"
box = { lower = [-0.03, -0.03, 0], upper = [0.05, 0.03, 0.03] }
[walls.table]
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
angular_velocity = 2
centre = [0, 0, 0]
axis = [0, 0, 1]"#,
    );
    table.run_to(1.0);
    let particles = table.component.particles();
    let (mut turn, mut inertia) = (0.0, 0.0);
    for (x, v) in particles.position.iter().zip(&particles.velocity) {
        turn += f64::from(x[0] * v[1] - x[1] * v[0]);
        inertia += f64::from(x[0] * x[0] + x[1] * x[1]);
    }
    println!("turns at {:.4} rad/s", turn / inertia);
    assert!((turn / inertia - 2.0).abs() < 0.02);
}

/// A gate drawn from under a block feels mu_w times its weight; its ends stay beyond the block.
#[test]
fn a_gate_is_held_by_friction() {
    let mut block = unit(
        "[domain]\nlower = [-0.1, -0.1]\nupper = [0.3, 0.3]",
        "",
        r#"
[bodies.block]
material = "block"
box = { lower = [0, 0], upper = [0.2, 0.1] }
[walls.sides]
polyline = [[0, 0.2], [0, 0]]
slip = "free_slip"
[walls.end]
polyline = [[0.2, 0], [0.2, 0.2]]
slip = "free_slip"
[gates.floor]
from = [-0.06, 0]
to = [0.26, 0]
max_speed = 0.01
slip = "friction"
wall_friction = 0.3
[gauges.floor]
kind = "force"
on = "gate.floor""#,
    );
    block.run_to(0.5);
    let still = block.get("gauge.floor.force_x");
    block.set("gate.floor.opening", 0.05);
    block.run_to(1.0);
    let (x, y) = (
        block.get("gauge.floor.force_x"),
        block.get("gauge.floor.force_y"),
    );
    println!("{still:.3} N at rest, {x:.3} N of {:.3} N drawn", -y);
    assert!((x / y - 0.3).abs() < 3e-3, "{}", x / y);
    assert!(still.abs() < 0.01 * y.abs());
}

/// A plug in a round pipe: floor and pipe carry its weight together, the pipe its share by friction; and a restored
/// state goes on with the same bits.
#[test]
fn a_pipe_carries_its_share() {
    let mut pipe = unit(
        "dimension = \"axisymmetric\"\n[domain]\nlower = [0, -0.1]\nupper = [0.2, 0.5]",
        "",
        r#"
[bodies.plug]
material = "block"
box = { lower = [0, 0], upper = [0.1, 0.2] }
[walls.pipe]
polyline = [[0.1, -0.05], [0.1, 0.5]]
slip = "friction"
wall_friction = 0.4
[walls.floor]
polyline = [[0, 0], [0.1, 0]]
slip = "friction"
wall_friction = 0.4
[gauges.pipe]
kind = "force"
on = "wall.pipe"
[gauges.floor]
kind = "force"
on = "wall.floor""#,
    );
    pipe.run_to(0.5);
    let saved = pipe.component.save().unwrap();
    pipe.run_to(1.0);
    let forces = |u: &Unit| (u.get("gauge.pipe.force_y"), u.get("gauge.floor.force_y"));
    let (side, floor) = forces(&pipe);
    let weight = pipe.component.ledger().present * G;
    println!("pipe {side:.3} N, floor {floor:.3} N, weight {weight:.3} N");
    assert!(side < -0.05 * weight && floor < 0.0);
    assert!(((side + floor) / weight + 1.0).abs() < 5e-3);

    let end = pipe.component.save().unwrap();
    pipe.component.restore(&saved).unwrap();
    pipe.run_to(1.0);
    assert!(
        pipe.component.save().unwrap() == end,
        "other bits after restoring"
    );
}

/// Sand that weighs ten times as much as usual on a chain of walls with the sand on its left.
fn pressed(corners: &[[f64; 2]], fill: &str, slip: &str) -> Unit {
    let text = format!(
        r#"
name = "pressed"
[domain]
lower = [-0.3, -0.1]
upper = [0.5, 0.6]
gravity = 100
[numerics]
spacing = "12.5 mm"
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.sand]
material = "sand"
polygon = {fill}
[walls.bin]
polyline = {corners:?}
{slip}
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Unit::new(&scene::parse("pressed", &text).unwrap())
}

/// How near particles come to a face of a chain that is open to above; negative: behind it [m].
fn clearance(unit: &Unit, corners: &[[f64; 2]]) -> f64 {
    let mut least = f64::INFINITY;
    for x in &unit.component.particles().position {
        for w in corners.windows(2) {
            let t = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            let d = [f64::from(x[0]) - w[0][0], f64::from(x[1]) - w[0][1]];
            least = least.min((t[0] * d[1] - t[1] * d[0]) / t[0].hypot(t[1]));
        }
    }
    least
}

/// Right and acute corners hold sand that presses hard: none of it gets behind a face, whose first row of wall points
/// is half a spacing further.
#[test]
fn corners_do_not_leak() {
    let bins = [
        (
            "right",
            vec![[0.0, 0.5], [0.0, 0.0], [0.2, 0.0], [0.2, 0.5]],
            "[[0, 0], [0.2, 0], [0.2, 0.3], [0, 0.3]]",
        ),
        (
            "30 deg",
            vec![[-0.134, 0.5], [0.0, 0.0], [0.134, 0.5]],
            "[[0, 0.02], [0.1, 0.4], [-0.1, 0.4]]",
        ),
    ];
    for slip in [
        "slip = \"no_slip\"",
        "slip = \"free_slip\"",
        "slip = \"friction\"\nwall_friction = 0.3",
    ] {
        for (name, corners, fill) in &bins {
            let mut unit = pressed(corners, fill, slip);
            let mut least = f64::INFINITY;
            for step in 1..=15 {
                unit.run_to(0.01 * f64::from(step));
                least = least.min(clearance(&unit, corners));
            }
            println!("{slip}, {name}: {least:.4} m before a face");
            assert!(least > 0.0);
        }
    }
}

/// A gate as thin as may be, four rows, with sand on its right alone that presses hard, and then on both sides: nothing
/// gets through or sees through.
#[test]
fn a_thin_gate_does_not_leak() {
    let bin = |left: &str| {
        let text = format!(
            r#"
name = "two_rooms"
[domain]
lower = [-0.3, -0.1]
upper = [0.5, 0.6]
gravity = 100
[numerics]
spacing = "12 mm"
sleep = false
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.right]
material = "sand"
box = {{ lower = [0.048, 0], upper = [0.2, 0.3] }}
{left}
[walls.bin]
polyline = [[-0.2, 0.5], [-0.2, 0], [0.2, 0], [0.2, 0.5]]
slip = "free_slip"
[gates.main]
from = [0, 0]
to = [0, 0.45]
thickness = 0.048
[gauges.gate]
kind = "force"
on = "gate.main"
[run]
step = "10 ms"
until = "1 s"
"#
        );
        Unit::new(&scene::parse("two_rooms", &text).unwrap())
    };
    // The gate's body lies on the right of the way up: from x = 0 to 0.048.
    let mut one = bin("");
    let mut two =
        bin("[bodies.left]\nmaterial = \"sand\"\nbox = { lower = [-0.2, 0], upper = [0, 0.12] }");
    let mut pushes = Vec::new();
    for unit in [&mut one, &mut two] {
        for step in 1..=15 {
            unit.run_to(0.01 * f64::from(step));
            for x in &unit.component.particles().position {
                assert!(
                    !(0.0..0.048).contains(&x[0]) && x[1] > 0.0,
                    "in the gate or the floor: {x:?}"
                );
            }
        }
        let right = unit.component.particles().position;
        pushes.push((
            right.iter().filter(|x| x[0] > 0.024).count(),
            unit.get("gauge.gate.force_x"),
        ));
    }
    println!("particles on the right and force on the gate: {pushes:?}");
    assert_eq!(pushes[0].0, pushes[1].0);
    // What stands on the left pushes back, and nothing else.
    assert!(pushes[0].1 < 0.0 && pushes[1].1 > pushes[0].1);
}

/// A block of sand that was launched along a rough floor stops after v^2/(2 mu_w g), whatever the lag of friction's iteration
/// (without its first step's full share: 1.23 of it).
#[test]
fn a_launched_block_slides_as_far_as_coulomb_says() {
    let (speed, friction) = (0.5, 0.4);
    let mut unit = Unit::new(
        &scene::parse(
            "launched",
            r#"
name = "launched"
[domain]
lower = [-0.1, -0.1]
upper = [0.4, 0.2]
[numerics]
spacing = "5 mm"
expected_speed = 0.5
[materials.block]
law = "constant_friction"
friction_angle = "30 deg"
cohesion = 300
density = 1600
[bodies.block]
material = "block"
box = { lower = [0, 0], upper = [0.1, 0.02] }
velocity = [0.5, 0]
[walls.floor]
polyline = [[-0.05, 0], [0.3, 0]]
slip = "friction"
wall_friction = 0.4
[run]
step = "10 ms"
until = "0.5 s"
"#,
        )
        .unwrap(),
    );
    let middle = |unit: &Unit| {
        let all = unit.component.particles().position;
        all.iter().map(|x| f64::from(x[0])).sum::<f64>() / all.len() as f64
    };
    let start = middle(&unit);
    unit.run_to(0.5);
    let ratio = (middle(&unit) - start) / (speed * speed / (2.0 * friction * G));
    println!("way over Coulomb's {ratio:.4}");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}
