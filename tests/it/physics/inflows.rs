//! Inflows: streams of fluids that push through a wall, and faces in the open beside material that stands before a part of them.

use super::Unit;
use sandgate::component::Component;
use sandgate::scene::{self, Scene};

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

fn channel(edits: &[(&str, &str)]) -> Scene {
    let mut text = CHANNEL.to_owned();
    for (old, new) in edits {
        assert!(text.contains(old), "no {old:?} to replace");
        text = text.replace(old, new);
    }
    scene::parse("channel.toml", &text).unwrap_or_else(|e| panic!("{e}"))
}

fn unit(edits: &[(&str, &str)]) -> Unit {
    Unit::new(&channel(edits))
}

/// A wall right behind the face, or three spacings behind it.
const IN_WALL: &str = "polyline = [[0, 0.3], [0, 0], [1, 0], [1, -0.1]]";
const BEHIND: &str = "polyline = [[-0.06, 0.3], [-0.06, 0], [1, 0], [1, -0.1]]";
/// The wall goes round a tank.
const TANK: &str = "polyline = [[0, 0.3], [0, 0], [1, 0], [1, 0.3]]";
/// A pool over the face, and its inflow.
const POOL: (&str, &str) = (
    "[inflows.feed]",
    "[bodies.pool]\nmaterial = \"water\"\nbox = { lower = [0, 0], upper = [1, 0.16] }\n[inflows.feed]",
);
const GENTLY: (&str, &str) = (
    "velocity = [0.8333333333, 0]\nrate = 99.99",
    "velocity = [0.3, 0]\nrate = 35",
);

/// Mass that enters in a second, once the stream stands before the face [kg/s].
fn fed(unit: &mut Unit) -> f64 {
    unit.run_to(0.5);
    let before = unit.get("inflow.feed.mass");
    unit.run_to(1.5);
    assert_eq!(unit.get("mass.error"), 0.0);
    unit.get("inflow.feed.mass") - before
}

/// A slow stream is deeper than the face lets it be at first, and all that is asked for enters, to a row of 2.4 kg.
#[test]
fn a_channel_is_fed_with_all_that_is_asked_for() {
    let rate = fed(&mut unit(&[]));
    println!("{rate} kg/s of 99.99 enter");
    assert!((rate - 99.99).abs() <= 2.4, "{rate}");
}

/// Water faster than waves, 0.06 m deep at 5/3 m/s, keeps its depth and speed on a level bed without friction.
#[test]
fn a_fast_stream_keeps_its_depth() {
    let gauge = "[gauges.stream]\nkind = \"depth\"\nfoot = [0.5, 0]\n[outflows.end]";
    let mut unit = unit(&[
        ("\"20 mm\"", "\"10 mm\""),
        ("expected_speed = 2", "expected_speed = 3"),
        ("from = [0, 0.12]", "from = [0, 0.06]"),
        ("0.8333333333", "1.6666666667"),
        ("[outflows.end]", gauge),
    ]);
    unit.run_to(1.0);
    let times = (0..25).map(|n| 1.0 + 0.02 * f64::from(n));
    let depths = times.map(|t| {
        unit.run_to(t);
        unit.get("gauge.stream.depth")
    });
    let depth = depths.sum::<f64>() / 25.0;
    println!("{depth} m deep for 0.06");
    assert!((depth / 0.06 - 1.0).abs() < 0.02, "{depth}");
}

/// A tank with the face under its water fills; closed by a lid it takes what fills it, to a row, and is then blocked.
#[test]
fn a_pool_over_the_face_rises_until_its_tank_is_full() {
    let gauge = "[gauges.level]\nkind = \"depth\"\nfoot = [0.7, 0]\n[outflows.end]";
    let rising = [(IN_WALL, TANK), POOL, GENTLY, ("[outflows.end]", gauge)];
    let mut open = unit(&rising);
    open.run_to(2.0);
    open.set("inflow.feed.rate", 0.0);
    open.run_to(5.0);
    let (mass, level) = (open.get("inflow.feed.mass"), open.get("gauge.level.depth"));
    println!("{mass} kg for 70, {level} m");
    assert!((mass - 70.0).abs() <= 2.4, "{mass}");
    // The level of what lies evenly, to half a spacing: it still sloshes a little.
    assert!((level - 0.16 - mass / 1000.0).abs() < 0.01, "{level}");

    let lid = "closed = true\npolyline = [[0, 0], [1, 0], [1, 0.2], [0, 0.2]]";
    let mut shut = unit(&[(IN_WALL, lid), POOL, GENTLY]);
    shut.run_to(2.0);
    let mass = shut.get("inflow.feed.mass");
    println!("{mass} kg for 40");
    assert!((mass - 40.0).abs() <= 2.4, "{mass}");
    assert_eq!(shut.get("inflow.feed.blocked"), 1.0);
}

/// A controller sets another rate in each step, faster than a stream gathers speed (4.5 ms here): what was asked for comes in, to a row, as
/// it comes at the mean rate, nothing is lost or blocked, and with the rate at 0 the rest comes and no more.
#[test]
fn a_rate_that_goes_to_and_fro_lets_in_its_mean() {
    const ROW: f64 = 2.4;
    for (step, rates) in [
        ("0.001", [35.0, 0.0]),
        ("0.005", [35.0, 0.0]),
        ("0.001", [35.0, 12.0]),
    ] {
        let shorter = ("step = 0.02", format!("step = {step}"));
        let mut unit = unit(&[(IN_WALL, TANK), POOL, GENTLY, (shorter.0, &shorter.1)]);
        let h: f64 = step.parse().unwrap();
        let mut asked = 0.0;
        for n in 0..(0.5 / h).round() as usize {
            unit.set("inflow.feed.rate", rates[n % 2]);
            unit.step();
            asked += rates[n % 2] * h;
            let behind = asked - unit.get("inflow.feed.mass");
            assert!(
                (0.0..=2.0 * ROW).contains(&(behind + 1e-9)),
                "{behind} after {n} steps"
            );
            assert_eq!(unit.get("inflow.feed.blocked"), 0.0);
        }
        unit.set("inflow.feed.rate", 0.0);
        unit.run_to(0.7);
        let mass = unit.get("inflow.feed.mass");
        println!("{step} s, {rates:?} kg/s: {mass} kg for {asked}");
        assert!(
            (0.0..ROW + 1e-9).contains(&(asked - mass)),
            "{mass} for {asked}"
        );
        assert_eq!(unit.get("mass.error"), 0.0);
    }
}

/// In rings and in space, a pool that rises over a face in the floor, and over one in a side.
#[test]
fn streams_push_in_rings_and_in_space() {
    let rings = r#"
name = "well"
dimension = "axisymmetric"
[domain]
lower = [0, -0.2]
upper = [0.4, 0.4]
[numerics]
spacing = "20 mm"
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[walls.tank]
polyline = [[0, 0], [0.3, 0], [0.3, 0.4]]
slip = "free_slip"
[bodies.pool]
material = "water"
box = { lower = [0, 0], upper = [0.3, 0.1] }
[inflows.feed]
material = "water"
from = [0, 0]
to = [0.2, 0]
velocity = [0, 0.1]
rate = 10
[run]
step = 0.02
until = 1
"#;
    let space = r#"
name = "basin"
dimension = 3
[domain]
lower = [0, 0, 0]
upper = [0.3, 0.2, 0.4]
[numerics]
spacing = "20 mm"
expected_speed = 2
[materials.water]
law = "fluid"
preset = "water"
[walls.floor]
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[walls.left]
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
slip = "free_slip"
[walls.right]
plane = { point = [0.3, 0, 0], normal = [-1, 0, 0] }
[walls.front]
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
[walls.back]
plane = { point = [0, 0.2, 0], normal = [0, -1, 0] }
[bodies.pool]
material = "water"
box = { lower = [0, 0, 0], upper = [0.3, 0.2, 0.1] }
[inflows.feed]
material = "water"
from = [0, 0.04, 0.02]
to = [0, 0.16, 0.02]
span = [0, 0, 0.06]
velocity = [0.5, 0, 0]
rate = 3.5
[run]
step = 0.02
until = 1
"#;
    for (text, asked, row) in [(rings, 10.0, 2.6), (space, 3.5, 0.144)] {
        let scene = scene::parse("pool.toml", text).unwrap_or_else(|e| panic!("{e}"));
        let mut unit = Unit::new(&scene);
        unit.run_to(1.0);
        let mass = unit.get("inflow.feed.mass");
        println!("{mass} kg for {asked}");
        assert!(mass <= asked + 1e-9 && mass >= asked - 1.5 * row, "{mass}");
        assert_eq!(unit.get("mass.error"), 0.0);
    }
}

/// A state saved while the wall is on its way goes on with the same bits, on another number of threads.
#[test]
fn a_stream_goes_on_from_a_saved_state_bit_for_bit() {
    let mut whole = unit(&[]);
    whole.run_to(0.5);
    let saved = whole.component.save().unwrap();
    let mut second = unit(&[]);
    second.component.set_threads(2);
    second.component.restore(&saved).unwrap();
    whole.run_to(0.8);
    second.run_to(0.8);
    let ends = [&mut whole, &mut second].map(|unit| unit.component.save().unwrap());
    assert!(ends[0] == ends[1], "the bits differ");
}

/// The foot of a slow stream stands before the foot of a face in the open. The rest of it lets in as much as a reservoir that is as high
/// as the face, (2/3)^(3/2) sqrt(g) H^(3/2) [m^2/s]: what enters loses its speed to what is there.
#[test]
fn a_face_in_the_open_feeds_a_channel_as_a_reservoir_does() {
    let rate = fed(&mut unit(&[(IN_WALL, BEHIND)])) / 1000.0;
    let reservoir = (2.0_f64 / 3.0).powf(1.5) * (G * FACE.powi(3)).sqrt();
    println!("{rate} m^2/s enter, a reservoir feeds {reservoir}");
    assert!(rate > 0.9 * reservoir, "{rate} of {reservoir}");
}

/// What is all under material lets nothing in, away from walls.
#[test]
fn a_face_in_the_open_under_material_is_blocked() {
    let behind = "polyline = [[-0.06, 0.3], [-0.06, 0], [1, 0], [1, 0.3]]";
    let pool = POOL.1.replace("lower = [0, 0]", "lower = [-0.06, 0]");
    let mut unit = unit(&[(IN_WALL, behind), (POOL.0, &pool)]);
    unit.run_to(0.5);
    assert_eq!(unit.get("inflow.feed.mass"), 0.0);
    assert_eq!(unit.get("inflow.feed.blocked"), 1.0);
}

/// A stream that goes further than a spacing in an internal step is told to lack what cannot come in, and saves nothing up: it came for long after
/// the rate was lowered.
#[test]
fn a_stream_too_fast_for_its_steps_says_so_and_saves_nothing_up() {
    let mut unit = unit(&[
        (
            IN_WALL,
            "polyline = [[0.1, 0.3], [0.1, 0], [1, 0], [1, -0.1]]",
        ),
        (
            "from = [0, 0.12]\nto = [0, 0]",
            "from = [0.2, 0.28]\nto = [0.2, 0.22]",
        ),
        (
            "velocity = [0.8333333333, 0]\nrate = 99.99",
            "velocity = [20, 0]\nrate = 1150",
        ),
        ("expected_speed = 2", "sound_speed = 15"),
        ("upper = [2, 0.4]", "upper = [9, 0.4]"),
        ("upper = [2, -0.2]", "upper = [9, -0.2]"),
        (
            "[outflows.end]",
            "[outflows.far]\nlower = [1.2, -0.2]\nupper = [9, 0.4]\n[outflows.end]",
        ),
    ]);
    unit.run_to(0.2);
    assert_eq!(unit.get("inflow.feed.blocked"), 1.0);
    assert!(unit.get("inflow.feed.actual_rate") < 1140.0);
    unit.set("inflow.feed.rate", 70.0);
    unit.run_to(0.24);
    let before = unit.get("inflow.feed.mass");
    unit.run_to(0.44);
    let rate = (unit.get("inflow.feed.mass") - before) / 0.2;
    assert!((rate / 70.0 - 1.0).abs() < 0.2, "{rate} kg/s");
}

/// What comes in has room: a face within a wall's rows of points, or within a plate as it starts, is refused by name.
#[test]
fn an_inflow_inside_a_wall_or_a_shut_gate_is_refused() {
    const GATE: &str =
        "[gates.g]\nfrom = [0.5, 0]\nto = [0.5, 0.2]\nthickness = 0.08\nstart = 0\n[outflows.end]";
    let shut = "from = [0.56, 0.1]\nto = [0.52, 0.1]";
    let refused = |face: &str, velocity: &str, gate: bool| {
        let velocity = format!("velocity = {velocity}\nrate = 1");
        let mut edits = vec![
            ("from = [0, 0.12]\nto = [0, 0]", face),
            (
                "velocity = [0.8333333333, 0]\nrate = 99.99",
                velocity.as_str(),
            ),
        ];
        if gate {
            edits.push(("[outflows.end]", GATE));
        }
        Component::new(&channel(&edits))
            .err()
            .map(|error| error.to_string())
    };
    for depth in [0.01, 0.02, 0.03, 0.05] {
        let face = format!("from = [0.4, -{depth}]\nto = [0.2, -{depth}]");
        let error = refused(&face, "[0, -0.5]", false).unwrap();
        assert!(
            error.contains("inflow feed") && error.contains("inside wall bed"),
            "{error}"
        );
    }
    // On the wall's face it comes out of it.
    assert_eq!(
        refused("from = [0.2, 0]\nto = [0.4, 0]", "[0, 0.5]", false),
        None
    );
    let error = refused(shut, "[0, -0.5]", true).unwrap();
    assert!(error.contains("inside gate g as it starts"), "{error}");
    assert_eq!(
        refused("from = [0.46, 0.1]\nto = [0.42, 0.1]", "[0, -0.5]", true),
        None
    );
}

/// What comes in stays in.
#[test]
fn an_inflow_inside_an_outflow_is_refused() {
    let drain = "[outflows.sump]\nlower = [-0.1, 0.05]\nupper = [0.1, 0.1]\n[outflows.end]";
    let error = Component::new(&channel(&[("[outflows.end]", drain)])).err();
    let error = error.unwrap().to_string();
    assert!(error.contains("inside outflow sump"), "{error}");
}

/// A plate that closes over a face, and a wall that moves over it, keep out what is due: nothing comes in inside them.
#[test]
fn a_gate_or_a_wall_that_comes_over_a_face_blocks_it() {
    let gate = "[gates.g]\nfrom = [0.5, 0]\nto = [0.5, 0.2]\nthickness = 0.08\nmax_speed = 0.2\nstart = 1\n[outflows.end]";
    let wall = "[walls.slab]\nbox = { lower = [0.7, 0.06], upper = [0.9, 0.26] }\nmotion = \"rigid\"\nvelocity = [-0.25, 0]\n[outflows.end]";
    for over in [gate, wall] {
        let mut unit = unit(&[
            (
                "from = [0, 0.12]\nto = [0, 0]",
                "from = [0.58, 0.1]\nto = [0.5, 0.1]",
            ),
            (
                "velocity = [0.8333333333, 0]\nrate = 99.99",
                "velocity = [0, -0.5]\nrate = 10",
            ),
            (IN_WALL, TANK),
            ("[outflows.end]", over),
        ]);
        unit.run_to(0.2);
        if over == gate {
            unit.set("gate.g.opening", 0.0);
        }
        unit.run_to(0.8);
        let shut = unit.get("inflow.feed.mass");
        unit.run_to(1.0);
        println!("{shut} kg came in");
        assert!(shut > 1.0, "{shut}");
        assert_eq!(unit.get("inflow.feed.mass"), shut);
        assert_eq!(unit.get("inflow.feed.blocked"), 1.0);
    }
}
