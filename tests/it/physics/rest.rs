//! Sleep: what it changes, what wakes it, what it saves.

use super::{Unit, case};
use sandgate::component::StaysAwake;
use sandgate::scene;

/// A small heap, with and without sleep.
fn heap(sleep: &str) -> Unit {
    let numerics = format!("spacing = \"6 mm\"\nsleep = {sleep}");
    let edits = [("spacing = \"3.02 mm\"", numerics.as_str())];
    Unit::new(&case("column_collapse", &edits))
}

/// The tolerance that docs/scene.md states for `sleep`: 1e-4 of the height, long after the flow has ended.
#[test]
fn a_heap_that_sleeps_is_the_heap_that_does_not() {
    let (mut asleep, mut awake) = (heap("true"), heap("false"));
    let end = 6.0;
    asleep.run_to(end);
    awake.run_to(end);
    let saved = 1.0 - asleep.get("solver.steps") / awake.get("solver.steps");
    println!("steps saved {:.0} %", 100.0 * saved);
    assert!(saved > 0.1, "it never slept: {saved}");
    assert!(asleep.component.particles().asleep.iter().all(|a| *a == 1));
    assert!(awake.component.particles().asleep.iter().all(|a| *a == 0));
    for name in [
        "gauge.front_left.front",
        "gauge.front_right.front",
        "gauge.depth_centre.depth",
    ] {
        let (a, b) = (asleep.get(name), awake.get(name));
        assert!((a - b).abs() < 1e-4 * 0.0875, "{name}: {a} and {b}");
    }
    let steps = asleep.get("solver.steps");
    asleep.run_to(end + 1.0);
    assert_eq!(asleep.get("solver.steps"), steps);
}

/// A gauge of force changes nothing but what is read: the same steps, and sleep at the same time.
#[test]
fn who_reads_forces_does_not_tell_when_a_silo_sleeps() {
    let edit = ("spacing = \"3.125 mm\"", "spacing = \"6.25 mm\"");
    let gauge = "[gauges.gate_force]\nkind = \"force\"\non = \"gate.outlet\"";
    let text = case("silo_gate", &[]).source.clone();
    let name = text.lines().find_map(|l| l.strip_prefix("[gates."));
    let gauge = gauge.replace("outlet", name.unwrap().trim_end_matches(']'));
    assert!(text.contains(&gauge), "{text}");
    let steps = [None, Some((gauge.as_str(), ""))].map(|without| {
        let edits: Vec<_> = std::iter::once(edit).chain(without).collect();
        let mut unit = Unit::new(&case("silo_gate", &edits));
        let gate = unit.component.variables().rows().iter();
        let gate = gate
            .map(|v| v.name.clone())
            .find(|n| n.ends_with(".opening"));
        unit.set(&gate.unwrap(), 0.0);
        unit.run_to(2.0);
        assert!(unit.component.particles().asleep.iter().all(|a| *a == 1));
        unit.get("solver.steps")
    });
    assert_eq!(steps[0], steps[1]);
}

/// A small silo, closed.
fn silo(numerics: &str) -> Unit {
    let numerics = format!("spacing = \"6.25 mm\"\n{numerics}");
    let edits = [("spacing = \"3.125 mm\"", numerics.as_str())];
    Unit::new(&case("silo_gate", &edits))
}

fn gate_force(unit: &Unit) -> f64 {
    unit.get("gauge.gate_force.force_y")
}

/// Sand is quiet long before friction has settled what a wall carries: sleep waits for that, however the grains lie.
#[test]
fn forces_have_settled_before_sleep() {
    for start in ["seed = 2", "seed = 3", "jitter = 0.0"] {
        let [asleep, awake] = ["true", "false"].map(|sleep| {
            let mut unit = silo(&format!("sleep = {sleep}\n{start}"));
            unit.run_to(1.0);
            let asleep = unit.component.particles().asleep.iter().all(|a| *a == 1);
            assert_eq!(asleep, sleep == "true", "{start}");
            gate_force(&unit)
        });
        println!("{start}: gate force {asleep} N asleep, {awake} N awake");
        assert!((asleep / awake - 1.0).abs() < 5e-3);
    }
}

/// What sleeps is carried: the forces of all walls and gates are its weight.
#[test]
fn a_sleeping_silo_weighs_its_weight() {
    let gauges = "[gauges.left]\nkind = \"force\"\non = \"wall.left\"\n\n\
                  [gauges.right]\nkind = \"force\"\non = \"wall.right\"\n\n[gauges.gate_force]";
    let edits = [
        ("spacing = \"3.125 mm\"", "spacing = \"6.25 mm\""),
        ("[gauges.gate_force]", gauges),
    ];
    let mut unit = Unit::new(&case("silo_gate", &edits));
    unit.run_to(1.0);
    assert!(unit.component.particles().asleep.iter().all(|a| *a == 1));
    let sum = |axis: &str| -> f64 {
        let forces = ["left", "right", "gate_force"];
        let of = |name: &str| unit.get(&format!("gauge.{name}.force_{axis}"));
        forces.into_iter().map(of).sum()
    };
    let weight = 9.81 * unit.component.ledger().present;
    println!("weight {weight} N, carried {} N", sum("y"));
    assert!((sum("y") / -weight - 1.0).abs() < 1e-12);
    assert!(sum("x").abs() < 1e-12 * weight);
}

/// The last particle creeps into an outflow and stops, within the skin of the neighbour lists: it is gone, and nothing that sleeps
/// leans on it.
#[test]
fn what_an_outflow_took_weighs_nothing_on_a_heap_that_sleeps() {
    let scene = |from: f64| {
        let gauge = format!(
            "[outflows.end]\nlower = [{from}, 0]\nupper = [0.39, 0.1]\n\n[gauges.weight]\nkind = \"force\"\non = \"wall.floor\"\n\n\
             [gauges.depth_centre]"
        );
        let edits = [
            ("spacing = \"3.02 mm\"", "spacing = \"6 mm\""),
            ("[gauges.depth_centre]", gauge.as_str()),
        ];
        let mut unit = Unit::new(&case("column_collapse", &edits));
        unit.run_to(6.0);
        assert!(unit.component.particles().asleep.iter().all(|a| *a == 1));
        unit
    };
    let whole = scene(0.38);
    assert_eq!(whole.component.ledger().outflow, 0.0);
    let particles = whole.component.particles();
    let toe = particles.position.iter().map(|x| x[0]);
    let toe = toe.fold(f64::NEG_INFINITY, |most, x| most.max(f64::from(x)));

    let cut = scene(toe - 2e-4);
    let account = cut.component.ledger();
    println!("{account:?}");
    assert!(account.outflow > 0.0);
    let weight = 9.81 * account.present;
    let carried = -cut.get("gauge.weight.force_y");
    assert!(
        (carried / weight - 1.0).abs() < 1e-12,
        "{carried} and {weight} N"
    );
}

/// A closed silo sleeps; its gate wakes it, and it then discharges as one that was never asleep. Forces stay while it
/// sleeps, and a saved sleeper sleeps on.
#[test]
fn a_gate_wakes_a_silo() {
    let (mut asleep, mut awake) = (silo("sleep = true"), silo("sleep = false"));
    for unit in [&mut asleep, &mut awake] {
        unit.run_to(1.0);
    }
    assert!(asleep.component.particles().asleep.iter().all(|a| *a == 1));
    println!(
        "gate force {} N asleep, {} N awake",
        gate_force(&asleep),
        gate_force(&awake)
    );
    // The force of resting sand on a gate still drifts by some 1e-3 as it settles.
    assert!((gate_force(&asleep) / gate_force(&awake) - 1.0).abs() < 5e-3);

    let saved = asleep.component.save().unwrap();
    for unit in [&mut asleep, &mut awake] {
        unit.set("gate.main.opening", 1.0);
        unit.run_to(1.4);
    }
    let mass = |u: &Unit| u.get("gauge.discharge.mass");
    let (a, b) = (mass(&asleep), mass(&awake));
    println!("discharged {a:.4} kg after sleep, {b:.4} kg without");
    assert!(b > 1.0 && (a / b - 1.0).abs() < 0.02, "{a} and {b}");

    // An opening that grows within one step is seen in that step.
    asleep.component.restore(&saved).unwrap();
    let reference = asleep.reference("gate.main.opening");
    asleep
        .component
        .set_input_derivatives(&[reference], &[1.0])
        .unwrap();
    asleep.step();
    assert!(asleep.get("gate.main.actual_opening") > 0.005);

    // The same again from the saved state, bit for bit.
    asleep.component.restore(&saved).unwrap();
    asleep.set("gate.main.opening", 1.0);
    asleep.run_to(1.4);
    assert_eq!(mass(&asleep).to_bits(), a.to_bits());
}

/// A block of a stiff fluid creeps on for hours, more slowly than sand that counts as quiet: it does not sleep.
#[test]
fn what_creeps_does_not_sleep() {
    let text = r#"
name = "tar"
[domain]
lower = [-0.1, -0.1]
upper = [0.4, 0.3]
[numerics]
spacing = "10 mm"
[materials.tar]
law = "fluid"
density = 1000
consistency = 1e6
[bodies.tar]
material = "tar"
box = { lower = [0, 0], upper = [0.1, 0.1] }
[walls.tank]
polyline = [[0, 0.2], [0, 0], [0.3, 0], [0.3, 0.2]]
[run]
step = 0.5
until = 5
"#;
    let mut unit = Unit::new(&scene::parse("tar.toml", text).unwrap());
    unit.run_to(5.0);
    let speed = (2.0 * unit.get("energy.kinetic") / 10.0).sqrt();
    println!("{speed:.1e} m/s");
    // Quiet is 3e-5 of sqrt(g H), about 1 m/s.
    assert!(speed > 1e-6 && speed < 3e-5, "{speed}");
    assert_eq!(unit.component.particles().asleep[0], 0);
}

/// A sound speed that was raised for other reasons makes no flow slow, and a law without static friction creeps for ever.
#[test]
fn what_sleeps_does_not_depend_on_the_sound_speed() {
    let text = |numerics: &str, material: &str| {
        format!(
            r#"
name = "mud"
[domain]
lower = [-0.1, -0.1]
upper = [0.4, 0.3]
[numerics]
spacing = "10 mm"
{numerics}
[materials.mud]
{material}
[bodies.mud]
material = "mud"
box = {{ lower = [0, 0], upper = [0.1, 0.05] }}
[walls.tank]
polyline = [[0, 0.2], [0, 0], [0.3, 0], [0.3, 0.2]]
[run]
step = 0.5
until = 1
"#
        )
    };
    let awake = |numerics: &str, material: &str| {
        let unit = Unit::new(&scene::parse("mud", &text(numerics, material)).unwrap());
        unit.component.stays_awake()
    };
    let mud = |viscosity: &str| {
        format!("law = \"fluid\"\ndensity = 1000\nyield_stress = 40\nconsistency = {viscosity}")
    };
    let fast = "expected_speed = 15";
    assert_eq!(awake(fast, &mud("0.003")), None);
    assert_eq!(awake("", &mud("0.003")), None);
    for numerics in ["", fast] {
        assert_eq!(
            awake(numerics, &mud("0.005")),
            Some(StaysAwake::Creeping(0))
        );
    }
    let beads = |law: &str| format!("law = \"{law}\"\npreset = \"glass_beads\"");
    assert_eq!(awake("", &beads("mu_i")), None);
    assert_eq!(
        awake("", &beads("barker_gray")),
        Some(StaysAwake::Creeping(0))
    );
}
