//! What the component does beyond the contract that all adapters share: slopes of inputs, failed steps.

use crate::gauges::{set, step, stepping, value};
use sandgate::component::{Error, Mode};

#[test]
fn slopes_ramp_inputs_inside_one_step() {
    let mut silo = stepping("tests/scenes/small_silo.toml");
    let h = silo.scene().run.step;
    let gate = silo
        .variables()
        .by_name("gate.main.opening")
        .unwrap()
        .reference;
    silo.set_input_derivatives(&[gate], &[8.0]).unwrap();
    let report = silo.do_step(0.0, h).unwrap();
    assert_eq!(
        value(&silo, "gate.main.opening"),
        8.0 * h,
        "the input holds what it reached"
    );
    let actual = value(&silo, "gate.main.actual_opening");
    // The plate follows the ramp an internal step behind.
    let behind = 8.0 * h - actual;
    assert!(
        (0.0..=1.5 * 8.0 * report.smallest_step).contains(&behind),
        "{actual} is {behind} behind"
    );
    step(&mut silo, 1);
    assert_eq!(
        value(&silo, "gate.main.actual_opening"),
        8.0 * h,
        "no slope is left"
    );

    silo.set_input_derivatives(&[gate], &[-1e3]).unwrap();
    let before = silo.state_hash();
    let message = silo.do_step(silo.time(), h).unwrap_err().to_string();
    assert!(
        message.contains("gate.main.opening at the end of the step")
            && message.contains("allowed 0 to 1"),
        "{message}"
    );
    assert_eq!(silo.state_hash(), before);
    let message = silo
        .set_input_derivatives(&[gate], &[f64::NAN])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("found NaN, allowed a finite slope"),
        "{message}"
    );
    let threads = silo
        .variables()
        .by_name("solver.threads")
        .unwrap()
        .reference;
    let message = silo
        .set_input_derivatives(&[threads], &[1.0])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("found a parameter, allowed inputs"),
        "{message}"
    );
    silo.set_input_derivatives(&[gate], &[0.0]).unwrap();
    set(&mut silo, "gate.main.opening", 0.5);
    step(&mut silo, 1);
    assert_eq!(value(&silo, "gate.main.opening"), 0.5);
}

/// FMI 2 gives no order.
#[test]
fn a_value_and_its_slope_come_in_any_order() {
    let ramped = |slope_first: bool| {
        let mut silo = stepping("tests/scenes/small_silo.toml");
        let h = silo.scene().run.step;
        let row = silo.variables().by_name("gate.main.opening");
        let gate = [row.unwrap().reference];
        for start in [0.5, 0.125] {
            if slope_first {
                silo.set_input_derivatives(&gate, &[0.25 / h]).unwrap();
                silo.set(&gate, &[start]).unwrap();
            } else {
                silo.set(&gate, &[start]).unwrap();
                silo.set_input_derivatives(&gate, &[0.25 / h]).unwrap();
            }
            step(&mut silo, 1);
            assert_eq!(value(&silo, "gate.main.opening"), start + 0.25);
        }
        // The slope was for one step.
        silo.set(&gate, &[0.75]).unwrap();
        step(&mut silo, 1);
        assert_eq!(value(&silo, "gate.main.opening"), 0.75);
        silo.state_hash()
    };
    assert_eq!(ramped(true), ramped(false));
}

/// Grains that fall out of the domain make a step fail.
#[test]
fn failed_step_leaves_time_and_outputs_at_the_last_good_step() {
    let mut falling = stepping("tests/scenes/no_floor.toml");
    let h = falling.scene().run.step;
    let mut good = falling.save().unwrap();
    let (time, depth, error) = loop {
        let seen = (falling.time(), value(&falling, "energy.kinetic"));
        match falling.do_step(falling.time(), h) {
            Ok(_) => good = falling.save().unwrap(),
            Err(error) => break (seen.0, seen.1, error),
        }
        assert!(falling.time() < 10.0, "nothing fell out of the domain");
    };
    assert!(matches!(error, Error::Solver(_)), "{error}");
    assert!(error.to_string().contains("particle"), "{error}");
    assert_eq!(
        (
            falling.mode(),
            falling.time(),
            value(&falling, "energy.kinetic")
        ),
        (Mode::Failed, time, depth)
    );
    let message = falling.do_step(time, h).unwrap_err().to_string();
    assert!(
        message.contains("do_step is not allowed in mode Failed; allowed in Stepping"),
        "{message}"
    );

    assert!(falling.step_failed());
    let failed = falling.save().unwrap();
    falling.restore(&good).unwrap();
    assert!(!falling.step_failed());
    assert_eq!((falling.mode(), falling.time()), (Mode::Stepping, time));
    assert!(falling.save().unwrap() == good);
    falling.do_step(time, 0.001 * h).unwrap();
    falling.restore(&failed).unwrap();
    assert_eq!(
        falling.mode(),
        Mode::Failed,
        "a failed component saves as failed"
    );
    // Terminated and restored, what it tells is of the last good step still.
    let account = falling.ledger();
    falling.terminate().unwrap();
    let ended = falling.save().unwrap();
    falling.reset().unwrap();
    falling.restore(&ended).unwrap();
    assert_eq!(
        (falling.mode(), falling.step_failed(), falling.ledger()),
        (Mode::Terminated, false, account)
    );
    falling.reset().unwrap();
    assert_eq!((falling.mode(), falling.time()), (Mode::Instantiated, 0.0));
    falling.initialize(0.0, None).unwrap();
    step(&mut falling, 1);
}

#[test]
fn a_failed_step_is_gone_back_from_to_the_state_that_was_kept() {
    let mut falling = stepping("tests/scenes/no_floor.toml");
    let h = falling.scene().run.step;
    assert!(!falling.back_to_kept(), "nothing has been kept");
    let mut good;
    loop {
        falling.keep();
        good = falling.save().unwrap();
        if falling.do_step(falling.time(), h).is_err() {
            break;
        }
        assert!(falling.time() < 10.0, "nothing fell out of the domain");
    }
    assert!(falling.back_to_kept());
    assert!(falling.save().unwrap() == good);
    assert_eq!(
        (falling.mode(), falling.step_failed()),
        (Mode::Stepping, false)
    );
    assert!(!falling.back_to_kept(), "it is kept no more");
    // It goes on with the bits of one that was restored.
    let mut restored = stepping("tests/scenes/no_floor.toml");
    restored.restore(&good).unwrap();
    for one in [&mut falling, &mut restored] {
        one.do_step(one.time(), 0.001 * h).unwrap();
    }
    assert_eq!(falling.state_hash(), restored.state_hash());
    falling.keep();
    falling.reset().unwrap();
    assert!(!falling.back_to_kept(), "a reset forgets it");
}

/// Saved bytes hold no stop time: who takes them over goes as far as it was told itself.
#[test]
fn the_stop_time_stays_with_whom_it_was_told() {
    let until = |stop: f64| {
        let mut component = stepping("tests/scenes/small_silo.toml");
        component.reset().unwrap();
        component.initialize(0.0, Some(stop)).unwrap();
        component
    };
    let h = 0.005;
    let (mut short, mut long) = (until(h), until(4.0 * h));
    short.do_step(0.0, h).unwrap();
    let bytes = short.save().unwrap();
    let error = short.do_step(h, h).unwrap_err().to_string();
    assert!(error.contains("the stop time"), "{error}");
    long.restore(&bytes).unwrap();
    assert_eq!(long.stop_time(), Some(4.0 * h));
    long.do_step(h, h).unwrap();
    short.restore(&long.save().unwrap()).unwrap();
    assert!(short.do_step(2.0 * h, h).is_err());
    // Initial values only.
    let mut none = until(0.0);
    assert!(none.do_step(0.0, h).is_err());
}

/// The order of what one call sets is no one's meaning.
#[test]
fn inputs_are_saturated_by_the_call_that_asks_for_it() {
    let mut component = stepping("tests/scenes/small_silo.toml");
    let row = |name: &str| component.variables().by_name(name).unwrap().reference;
    let (gate, saturate) = (row("gate.main.opening"), row("saturate_inputs"));
    for references in [[saturate, gate], [gate, saturate]] {
        let values = |on: f64| references.map(|r| if r == gate { 1.5 } else { on });
        component.set(&references, &values(1.0)).unwrap();
        assert_eq!(value(&component, "gate.main.opening"), 1.0);
        assert_eq!(component.take_notes().len(), 1);
        // The call that ends it is not saturated any more, and changes nothing.
        component.set(&[gate], &[0.5]).unwrap();
        assert!(component.set(&references, &values(0.0)).is_err());
        assert!(component.saturates_inputs());
        assert_eq!(value(&component, "gate.main.opening"), 0.5);
        component.set(&[saturate], &[0.0]).unwrap();
    }
}

/// A slope out of the range is clamped where an input would be, and told.
#[test]
fn slopes_are_saturated_as_inputs_are() {
    let mut component = stepping("tests/scenes/small_silo.toml");
    set(&mut component, "gate.main.opening", 0.9);
    let gate = component.variables().by_name("gate.main.opening");
    let gate = [gate.unwrap().reference];
    let h = 0.005;
    component.set_input_derivatives(&gate, &[100.0]).unwrap();
    let error = component.do_step(0.0, h).unwrap_err().to_string();
    assert!(error.contains("allowed 0 to 1"), "{error}");
    set(&mut component, "saturate_inputs", 1.0);
    component.do_step(0.0, h).unwrap();
    let notes = component.take_notes();
    assert!(
        notes.len() == 1 && notes[0].contains("clamped to 1"),
        "{notes:?}"
    );
    assert_eq!(value(&component, "gate.main.opening"), 1.0);
    component.set_input_derivatives(&gate, &[f64::MAX]).unwrap();
    component.do_step(h, h).unwrap();
    assert_eq!(value(&component, "gate.main.opening"), 1.0);
}

#[test]
fn components_may_move_to_another_thread() {
    fn is_send<T: Send>() {}
    is_send::<sandgate::component::Component>();
}

#[test]
fn hash_of_the_state_is_that_of_what_comes_next() {
    let mut limited = stepping("tests/scenes/small_silo.toml");
    limited.reset().unwrap();
    limited.initialize(0.0, Some(1.0)).unwrap();
    let mut free = stepping("tests/scenes/small_silo.toml");
    assert_eq!(
        limited.state_hash(),
        free.state_hash(),
        "a stop time changes no bit"
    );
    set(&mut free, "gate.main.opening", 0.5);
    assert_ne!(limited.state_hash(), free.state_hash(), "an input does");
    set(&mut limited, "gate.main.opening", 0.5);
    step(&mut limited, 3);
    step(&mut free, 3);
    assert_eq!(limited.state_hash(), free.state_hash());
    assert_eq!(free.state_hash().len(), 64);
}

#[test]
fn slopes_of_outputs_are_those_of_the_last_points() {
    let mut channel = stepping("tests/scenes/devices.toml");
    set(&mut channel, "gate.sluice.opening", 1.0);
    let find = |c: &sandgate::component::Component, name: &str| {
        c.variables().by_name(name).unwrap().reference
    };
    let slope = |c: &sandgate::component::Component, name: &str| {
        let mut values = [f64::NAN];
        c.output_derivatives(&[find(c, name)], &mut values).unwrap();
        values[0]
    };
    let [depth, mass, rate] = [
        "gauge.depth.depth",
        "inflow.feed.mass",
        "inflow.feed.actual_rate",
    ];
    assert_eq!(slope(&channel, depth), 0.0, "one point has no slope");
    let (mut last, mut length) = ([0.0; 3], 0.0);
    let lengths = [0.005, 0.003, 0.004].into_iter().cycle().take(20);
    for (k, h) in lengths.enumerate() {
        let before = [depth, mass, rate].map(|name| value(&channel, name));
        channel.do_step(channel.time(), h).unwrap();
        let after = [depth, mass, rate].map(|name| value(&channel, name));
        for (place, name) in [depth, mass].into_iter().enumerate() {
            let expected = (after[place] - before[place]) / h;
            assert!(
                (slope(&channel, name) - expected).abs() <= 1e-9 * expected.abs(),
                "{name}"
            );
        }
        // A mean over a step belongs to its middle, so the first step has no slope.
        let expected = if k == 0 {
            0.0
        } else {
            (after[2] - before[2]) / (0.5 * (h + length))
        };
        assert!((slope(&channel, rate) - expected).abs() <= 1e-9 * expected.abs().max(1e-9));
        (last, length) = (after, h);
    }
    assert!(last[1] > 0.0, "the inflow runs");
    // Slopes are part of the state.
    let saved = channel.save().unwrap();
    let mut other = sandgate::component::Component::new(channel.base_scene()).unwrap();
    other.restore(&saved).unwrap();
    for name in [depth, mass, rate] {
        assert_eq!(
            slope(&other, name).to_bits(),
            slope(&channel, name).to_bits()
        );
    }
    let mut values = [0.0];
    for name in [
        "solver.steps",
        "gate.sluice.opening",
        "gauge.depth.validity",
    ] {
        let refused = channel.output_derivatives(&[find(&channel, name)], &mut values);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("variability continuous"), "{refused}");
    }
}

/// Parameters that break a rule together: nothing is changed, and they may be corrected.
#[test]
fn a_refused_initialisation_leaves_no_trace() {
    let text = std::fs::read_to_string("tests/scenes/small_silo.toml").unwrap();
    let scene = sandgate::scene::parse("small_silo", &text).unwrap();
    let mut silo = sandgate::component::Component::new(&scene).unwrap();
    let material = &scene.materials[0].name;
    let angle = |which: &str| format!("material.{material}.{which}_friction_angle");
    set(&mut silo, &angle("static"), 1.0);
    let before = silo.state_hash();
    let message = silo.initialize(1.0, Some(2.0)).unwrap_err().to_string();
    assert!(message.contains("friction_angle"), "{message}");
    assert_eq!(
        (silo.mode(), silo.time(), silo.stop_time()),
        (Mode::Instantiated, 0.0, None)
    );
    assert_eq!(silo.state_hash(), before);
    set(&mut silo, &angle("dynamic"), 1.1);
    silo.initialize(1.0, Some(2.0)).unwrap();
    assert_eq!(silo.time(), 1.0);
}

/// A gate that grains hold for a part of a communication step says so, though it moved when the step ended; a state that was saved then
/// says it too, and a refused step forgets nothing.
#[test]
fn what_blocks_a_gate_is_told_for_the_whole_step() {
    let mut silo = stepping("tests/scenes/small_silo.toml");
    set(&mut silo, "gate.main.opening", 1.0);
    while silo.time() < 0.3 - 1e-9 {
        silo.do_step(silo.time(), 0.02).unwrap();
    }
    set(&mut silo, "gate.main.opening", 0.0);
    let (mut held, mut free) = (0, 0);
    for _ in 0..40 {
        let before = value(&silo, "gate.main.actual_opening");
        silo.do_step(silo.time(), 0.005).unwrap();
        let moved = before - value(&silo, "gate.main.actual_opening");
        // 0.5 m/s of 32 mm.
        let could = f64::min(before, 0.5 * 0.005 / 0.032);
        let blocked = value(&silo, "gate.main.blocked");
        let late = moved < (1.0 - 1e-9) * could;
        // A gate that was held and arrived all the same may say so.
        let arrived = moved == before;
        assert!(
            if late {
                blocked == 1.0
            } else {
                arrived || blocked == 0.0
            },
            "{moved} {could}"
        );
        if blocked == 1.0 {
            held += 1;
            assert!(silo.do_step(-1.0, 0.02).is_err());
            assert_eq!(value(&silo, "gate.main.blocked"), 1.0);
            let mut again = stepping("tests/scenes/small_silo.toml");
            again.restore(&silo.save().unwrap()).unwrap();
            assert_eq!(value(&again, "gate.main.blocked"), 1.0);
        } else {
            free += 1;
        }
    }
    assert!(held > 0 && free > 0, "{held} steps held, {free} free");
}

/// Rain from a face of 0.8 m^2 at 0.5 m/s: 4 kg/s at 10 kg/m^3 is the most, and as much more or less as the density is.
const RAIN: &str = r#"
name = "rain"
dimension = 2
[domain]
lower = [-0.1, -1]
upper = [0.9, 0.1]
[numerics]
spacing = "100 mm"
sound_speed = 30
[materials.foam]
law = "fluid"
density = 10
consistency = 1
[inflows.rain]
material = "foam"
from = ["800 mm", 0]
to = [0, 0]
velocity = [0, "-0.5 m/s"]
rate = "3 kg/s"
[outflows.end]
lower = [-0.1, -1]
upper = [0.9, -0.4]
[run]
step = "10 ms"
until = "1 s"
"#;

#[test]
fn the_most_that_an_inflow_lets_in_follows_the_density_that_is_set() {
    let scene = sandgate::scene::parse("rain.toml", RAIN).unwrap_or_else(|why| panic!("{why}"));
    let fresh = || sandgate::component::Component::new(&scene).unwrap();
    let reference = |name: &str| fresh().variables().by_name(name).unwrap().reference;
    let (density, rate) = (
        reference("material.foam.density"),
        reference("inflow.rain.rate"),
    );
    let saturate = reference("saturate_inputs");

    // The scene's own rate is too much for a lighter fluid: said, and mended by a lower one.
    let mut light = fresh();
    light.set(&[density], &[5.0]).unwrap();
    let error = light.initialize(0.0, None).unwrap_err().to_string();
    assert!(
        error.contains("inflow.rain.rate") && error.contains("3 kg/s") && error.contains("0 to 2"),
        "{error}"
    );
    light.set(&[rate], &[1.9]).unwrap();
    light.initialize(0.0, None).unwrap();
    let error = light.set(&[rate], &[2.1]).unwrap_err().to_string();
    assert!(error.contains("0 to 2 kg/s"), "{error}");
    for _ in 0..100 {
        light.do_step(light.time(), 0.01).unwrap();
    }
    // All that was asked for came, but for less than a row.
    let came = value(&light, "inflow.rain.mass");
    let row = 0.8 * 0.1 * 5.0;
    assert!((came - 1.9).abs() < row, "{came} kg of 1.9");

    // Or clamped and told, where that is asked for.
    let mut clamped = fresh();
    clamped.set(&[saturate, density], &[1.0, 5.0]).unwrap();
    clamped.initialize(0.0, None).unwrap();
    assert_eq!(value(&clamped, "inflow.rain.rate"), 2.0);
    assert!(clamped.take_notes()[0].contains("found 3, clamped to 2"));

    // A heavier one lets in more, set before, after or with its density, and what a slope leads to may be set again.
    let mut heavy = fresh();
    heavy.set(&[rate, density], &[7.0, 20.0]).unwrap();
    heavy.initialize(0.0, None).unwrap();
    heavy.set_input_derivatives(&[rate], &[50.0]).unwrap();
    heavy.do_step(0.0, 0.01).unwrap();
    let reached = value(&heavy, "inflow.rain.rate");
    assert_eq!(reached, 7.5);
    heavy.set(&[rate], &[reached]).unwrap();
    assert!(heavy.set(&[rate], &[8.1]).is_err());

    // It is not negative whatever waits.
    let mut negative = fresh();
    let error = negative
        .set(&[density, rate], &[20.0, -1.0])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("inflow.rain.rate") && error.contains("-1"),
        "{error}"
    );
    negative.set(&[density], &[20.0]).unwrap();
    assert!(negative.set(&[rate], &[-1.0]).is_err());

    // With the scene's own density nothing waits.
    let mut own = fresh();
    assert!(own.set(&[rate], &[4.1]).is_err());
    own.set(&[density, rate], &[10.0, 4.1]).unwrap();
    assert!(own.initialize(0.0, None).is_err());
}
