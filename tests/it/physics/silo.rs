//! Discharge of the silo: Q = C rho sqrt(g) D^1.5, whatever the fill (Beverloo; Staron et al. 2012 for mu(I)).

use super::{Unit, case};

/// Mean discharge [kg/s] from now on for `duration` [s].
fn discharge(unit: &mut Unit, duration: f64) -> f64 {
    let (t, before) = (unit.component.time(), unit.get("gauge.discharge.mass"));
    unit.run_to(t + duration);
    (unit.get("gauge.discharge.mass") - before) / (unit.component.time() - t)
}

/// Rate once the gate has reached an opening and the flow its new rate [kg/s].
fn at_opening(unit: &mut Unit, opening: f64, start_up: f64) -> f64 {
    unit.set("gate.main.opening", opening);
    let t = unit.component.time();
    unit.run_to(t + start_up);
    assert!((unit.get("gate.main.actual_opening") - opening).abs() < 1e-9);
    discharge(unit, 0.4)
}

/// One silo, three openings of its gate, and the fill from 80 % to 40 %.
#[test]
fn discharge_follows_the_opening_and_not_the_fill() {
    let scene = case("silo_gate", &[]);
    let mut unit = Unit::new(&scene);
    unit.component.set_threads(0);
    // Closed: nothing passes, and the gate carries weight.
    unit.run_to(0.1);
    assert_eq!(unit.get("gauge.discharge.mass"), 0.0);
    assert!(unit.get("gauge.gate_force.force_y") < -5.0);

    let initial = unit.get("mass.initial");
    let fill = |unit: &Unit| unit.get("mass.present") / initial;
    let mut openings = vec![(0.5, at_opening(&mut unit, 0.5, 0.15))];

    // Wide open, at 80 % and at 40 % of the fill.
    unit.set("gate.main.opening", 1.0);
    while fill(&unit) > 0.84 {
        unit.step();
    }
    let high = discharge(&mut unit, 0.1);
    let left_high = fill(&unit);
    while fill(&unit) > 0.44 {
        unit.step();
    }
    let low = discharge(&mut unit, 0.1);
    let left_low = fill(&unit);
    assert!(
        left_high > 0.73 && left_low < 0.41,
        "{left_high} {left_low}"
    );
    let drift = (low / high - 1.0).abs();
    println!("fill {left_high:.2}: {high:.3} kg/s, fill {left_low:.2}: {low:.3} kg/s");
    assert!(drift < 0.07, "drift {drift}");
    openings.push((1.0, 0.5 * (high + low)));

    openings.push((0.75, at_opening(&mut unit, 0.75, 0.1)));
    println!("openings and rates {openings:?}");

    // Least squares of ln Q = n ln D + const.
    let n = openings.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| openings.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|o| o.0.ln()), mean(&|o| o.1.ln()));
    let slope = openings
        .iter()
        .map(|o| (o.0.ln() - x) * (o.1.ln() - y))
        .sum::<f64>()
        / openings.iter().map(|o| (o.0.ln() - x).powi(2)).sum::<f64>();
    println!("exponent {slope:.3}");
    assert!((slope - 1.5).abs() < 0.1, "exponent {slope}");

    // Closing again stops the flow, and what is shut in stays. One grain may have stuck between plate and lip, and fall later.
    unit.set("gate.main.opening", 0.0);
    let t = unit.component.time();
    unit.run_to(t + 0.3);
    let leak = discharge(&mut unit, 0.1) * 0.1;
    let grain = unit.get("mass.present") / unit.get("solver.particles");
    assert!(
        leak < 1.5 * grain,
        "{leak} kg, opening {}",
        unit.get("gate.main.actual_opening")
    );
}

/// A plate moves a tenth of h in a step at most, and steps follow it down to one of sound, however many there are to a solve.
#[test]
fn a_quick_gate_opens_at_a_seventh_of_sound() {
    for acoustic_steps in [1, 2] {
        let numerics = format!("[numerics]\nacoustic_steps = {acoustic_steps}");
        let quick = "max_speed = \"10 m/s\"";
        let edits = [
            ("[numerics]", numerics.as_str()),
            ("max_speed = \"0.5 m/s\"", quick),
        ];
        let scene = case("silo_gate", &edits);
        let held = scene.numerics.plate_speed();
        assert!((held * 7.0 / scene.numerics.sound_speed - 1.0).abs() < 1e-12);
        let mut unit = Unit::new(&scene);
        unit.set("gate.main.opening", 1.0);
        let step = scene.numerics.acoustic_step();
        unit.component.do_step(0.0, 8.0 * step).unwrap();
        // 0.05 m to open.
        let opening = unit.get("gate.main.actual_opening") * 0.05 / (8.0 * step * held);
        assert!((opening - 1.0).abs() < 1e-9, "{opening}");
    }
}

/// A box of dry grains whose floor has a slot with a gate, eight spacings of 7.5 mm deep in space: between walls that slip depth must not
/// matter. A gate that waits for every single grain would not close.
#[test]
fn a_gate_in_space_closes_through_a_stream_as_in_the_plane() {
    let of = |space: bool| {
        let place = |x: f64, y: f64, height: f64| match space {
            true => format!("[{x}, {y}, {height}]"),
            false => format!("[{x}, {height}]"),
        };
        let boxed = |lower: (f64, f64, f64), upper: (f64, f64, f64)| {
            let [lower, upper] = [lower, upper].map(|(x, y, h)| place(x, y, h));
            format!("{{ lower = {lower}, upper = {upper} }}")
        };
        let plane = |at: (f64, f64, f64), n: (f64, f64, f64)| {
            let [at, n] = [at, n].map(|(x, y, h)| place(x, y, h));
            format!("plane = {{ point = {at}, normal = {n} }}\nslip = \"free_slip\"")
        };
        let sides = match space {
            true => format!(
                "[walls.front]\n{}\n[walls.back]\n{}\n",
                plane((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
                plane((0.0, 0.06, 0.0), (0.0, -1.0, 0.0)),
            ),
            false => String::new(),
        };
        let text = format!(
            r#"
name = "slot"
dimension = {}
[domain]
lower = {}
upper = {}
[numerics]
spacing = "7.5 mm"
expected_speed = 1.5
[materials.grains]
law = "mu_i"
preset = "glass_beads"
[bodies.fill]
material = "grains"
box = {}
{sides}
[walls.left]
{}
[walls.right]
{}
[walls.floor_left]
box = {}
[walls.floor_right]
box = {}
[gates.slot]
from = {}
to = {}
{}
max_speed = 0.5
[outflows.below]
lower = {}
upper = {}
[run]
step = "10 ms"
until = 0.6
"#,
            if space { 3 } else { 2 },
            place(-0.12, -0.05, -0.25),
            place(0.12, 0.11, 0.2),
            boxed((-0.06, 0.0, 0.0), (0.06, 0.06, 0.12)),
            plane((-0.06, 0.0, 0.0), (1.0, 0.0, 0.0)),
            plane((0.06, 0.0, 0.0), (-1.0, 0.0, 0.0)),
            boxed((-0.06, 0.0, -0.03), (-0.03, 0.06, 0.0)),
            boxed((0.03, 0.0, -0.03), (0.06, 0.06, 0.0)),
            place(-0.03, 0.06, 0.0),
            place(0.03, 0.06, 0.0),
            if space { "span = [0, -0.06, 0]" } else { "" },
            place(-0.12, -0.05, -0.25),
            place(0.12, 0.11, -0.15),
        );
        let mut unit = Unit::new(&crate::physics::scene::parse("slot", &text).unwrap());
        for (until, opening) in [(0.05, 0.0), (0.2, 1.0), (0.6, 0.0)] {
            unit.set("gate.slot.opening", opening);
            unit.run_to(until);
        }
        let out = unit.get("mass.outflow") / unit.get("mass.initial");
        (unit.get("gate.slot.actual_opening"), out)
    };
    let [(_, plane), (opening, space)] = [of(false), of(true)];
    println!("{plane:.3} out in the plane, {space:.3} in space, where the gate is at {opening:.3}");
    // It stops on the grain that it presses on its sill, at most.
    assert!(opening < 0.15, "{opening}");
    // Before single grains no longer held it: 0.70 and 0.86.
    assert!((space - plane).abs() < 0.15, "{space} for {plane}");
}
