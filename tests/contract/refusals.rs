//! Wrong calls: each is refused with a message that says what was found and what is allowed, and leaves no trace.

use std::time::{Duration, Instant};

use super::{Driver, Outcome, Refusal, Stage};

/// A refusal that takes longer hangs an orchestrator.
const PATIENCE: Duration = Duration::from_secs(1);

/// Where in its life an instance gets the wrong call.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Place {
    New,
    Initializing,
    Stepping,
    Terminated,
}

type Call = fn(&mut dyn Driver, &Stage) -> Outcome<()>;

/// Wrong calls and what their message must contain. Times are those of an instance after two steps.
#[rustfmt::skip]
fn wrong_calls() -> Vec<(Place, Call, &'static str)> {
    use Place::*;
    vec![
        (New, |d, s| d.do_step(0.0, s.step()), "do_step is not allowed in mode Instantiated; allowed in Stepping"),
        (New, |d, _| d.exit_initialization(), "exit_initialization is not allowed in mode Instantiated; allowed in Initialization"),
        (New, |d, _| d.terminate(), "terminate is not allowed in mode Instantiated; allowed in Stepping or Failed"),
        (New, |d, _| d.enter_initialization(f64::NAN, None), "start time: found NaN s, allowed a finite time"),
        (New, |d, _| d.enter_initialization(1e12, None), "start time: found 1000000000000 s, allowed at most"),
        (New, |d, _| d.enter_initialization(-1e12, None), "count time from a later origin"),
        (New, |d, _| d.enter_initialization(2.0, Some(1.0)), "stop time: found 1 s, allowed a finite time from 2 s, the start, on"),
        (New, |d, _| d.enter_initialization(0.0, Some(f64::NAN)), "stop time: found NaN s"),
        (Initializing, |d, s| d.do_step(0.0, s.step()), "do_step is not allowed in mode Initialization; allowed in Stepping"),
        (Initializing, |d, _| d.enter_initialization(0.0, None), "enter_initialization is not allowed in mode Initialization; allowed in Instantiated"),
        (Stepping, |d, _| d.enter_initialization(0.0, None), "enter_initialization is not allowed in mode Stepping"),
        (Stepping, |d, _| d.exit_initialization(), "exit_initialization is not allowed in mode Stepping"),
        (Stepping, |d, s| d.do_step(0.0, s.step()), "do_step: t: found 0 s"),
        (Stepping, |d, s| d.do_step(5.0 * s.step(), s.step()), "the current time"),
        (Stepping, |d, s| d.do_step(f64::NAN, s.step()), "do_step: t: found NaN s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), 0.0), "do_step: h: found 0 s, allowed a finite step above 0 s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), -s.step()), "allowed a finite step above 0 s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), f64::NAN), "do_step: h: found NaN s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), f64::INFINITY), "do_step: h: found inf s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), 1e-300), "do_step: t + h: found"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), 5e-324), "allowed a finite step above 0 s, not denormal"),
        (Stepping, |d, s| d.do_step(f64::INFINITY, s.step()), "do_step: t: found inf s"),
        (Stepping, |d, s| d.set(&[s.reference("solver.resolution_scale")], &[2.0]), "set of a fixed parameter (solver.resolution_scale) is not allowed in mode Stepping; allowed in Instantiated or Initialization"),
        (Stepping, |d, s| d.set(&[s.gate(), s.reference("solver.resolution_scale")], &[0.5, 2.0]), "set of a fixed parameter (solver.resolution_scale) is not allowed in mode Stepping"),
        (New, |d, s| d.set(&[s.reference("solver.resolution_scale")], &[0.0]), "solver.resolution_scale: found 0, allowed a number from 0.1 to 10"),
        (New, |d, s| d.set(&[s.reference("solver.resolution_scale")], &[f64::NAN]), "solver.resolution_scale: found NaN"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), 20.0), "allowed a step that ends by 10 s, the stop time"),
        (Stepping, |d, s| d.set(&[s.gate()], &[f64::NAN]), "found NaN, allowed a number from 0 to 1"),
        (Stepping, |d, s| d.set(&[s.gate()], &[f64::INFINITY]), "found inf, allowed a number from 0 to 1"),
        (Stepping, |d, s| d.set(&[s.gate()], &[1e300]), "found 1e300, allowed a number from 0 to 1"),
        (Stepping, |d, s| d.do_step(-1e300, s.step()), "do_step: t: found -1e300 s"),
        (Stepping, |d, s| d.do_step(2.0 * s.step(), 5e-324), "do_step: h: found 5e-324 s"),
        (Stepping, |d, s| d.set(&[s.gate()], &[1.5]), "found 1.5, allowed a number from 0 to 1"),
        (Stepping, |d, s| d.set(&[s.gate()], &[-0.1]), "found -0.1, allowed a number from 0 to 1"),
        (Stepping, |d, s| d.set(&[s.output()], &[0.5]), "found an output, allowed inputs and parameters"),
        (Stepping, |d, s| d.set(&[s.reference("time")], &[0.5]), "time: found the independent variable, allowed inputs and parameters"),
        (Stepping, |d, _| d.set(&[987_654], &[0.5]), "value reference: found 987654, allowed 0 to"),
        (Stepping, |d, s| d.set(&[s.reference("solver.threads")], &[1.5]), "solver.threads: found 1.5, allowed a whole number from 0 to 256"),
        (Stepping, |d, s| d.set(&[s.gate()], &[0.5, 0.5]), "set: number of values: found 2, allowed 1"),
        (Stepping, |d, _| d.get(&[987_654], 1).map(drop), "value reference: found 987654, allowed 0 to"),
        (Stepping, |d, s| d.get(&[s.gate()], 3).map(drop), "get: number of values: found 3, allowed 1"),
        (Terminated, |d, s| d.do_step(2.0 * s.step(), s.step()), "do_step is not allowed in mode Terminated; allowed in Stepping"),
        (Terminated, |d, s| d.set(&[s.gate()], &[0.5]), "is not allowed in mode Terminated; allowed in Instantiated or Initialization or Stepping"),
        (Terminated, |d, _| d.terminate(), "terminate is not allowed in mode Terminated"),
        (Terminated, |d, _| d.enter_initialization(0.0, None), "enter_initialization is not allowed in mode Terminated"),
    ]
}

/// Makes the call; whether the adapter could express it.
fn is_refused(driver: &mut dyn Driver, stage: &Stage, call: Call, expected: &str) -> bool {
    let begin = Instant::now();
    let answer = call(driver, stage);
    let took = begin.elapsed();
    assert!(took < PATIENCE, "took {took:?}, expected: {expected}");
    match answer {
        Ok(()) => panic!("accepted, but expected a refusal with: {expected}"),
        Err(Refusal::Inexpressible) => false,
        Err(Refusal::Message(message)) => {
            assert!(
                message.contains(expected),
                "found: {message}\nexpected: {expected}"
            );
            true
        }
    }
}

/// After each refused call the state is the same byte for byte, and the instance steps on as one never disturbed.
pub(crate) fn refused_calls_leave_no_trace(stage: &Stage) {
    let (mut disturbed, mut undisturbed) = (stage.instance(), stage.instance());
    let mut refused = 0;
    let mut disturb = |driver: &mut dyn Driver, place: Place| {
        let before = driver.save().unwrap();
        for (_, call, expected) in wrong_calls().into_iter().filter(|w| w.0 == place) {
            refused += u32::from(is_refused(driver, stage, call, expected));
            assert!(
                driver.save().unwrap() == before,
                "the state changed by the call refused with: {expected}"
            );
        }
    };
    disturb(disturbed.as_mut(), Place::New);
    for driver in [&mut disturbed, &mut undisturbed] {
        driver.enter_initialization(0.0, Some(10.0)).unwrap();
    }
    disturb(disturbed.as_mut(), Place::Initializing);
    for driver in [&mut disturbed, &mut undisturbed] {
        driver.exit_initialization().unwrap();
        driver.set(&[stage.gate()], &[1.0]).unwrap();
        driver.do_step(0.0, stage.step()).unwrap();
        driver.do_step(stage.step(), stage.step()).unwrap();
    }
    disturb(disturbed.as_mut(), Place::Stepping);
    for step in 2..5 {
        let t = f64::from(step) * stage.step();
        disturbed.do_step(t, stage.step()).unwrap();
        undisturbed.do_step(t, stage.step()).unwrap();
        assert!(stage.everything(disturbed.as_mut()) == stage.everything(undisturbed.as_mut()));
    }
    assert!(disturbed.save().unwrap() == undisturbed.save().unwrap());
    disturbed.terminate().unwrap();
    disturb(disturbed.as_mut(), Place::Terminated);
    assert!(
        refused >= 15,
        "the adapter can express only {refused} wrong calls"
    );
}

/// Bytes that are no state of this scene are refused; the instance stays as it was.
pub(crate) fn bad_states_are_refused(stage: &Stage) {
    let mut driver = stage.stepping();
    driver.do_step(0.0, stage.step()).unwrap();
    let good = driver.save().unwrap();
    let mut refuse = |bytes: &[u8], expected: &str| match driver.restore(bytes) {
        Ok(()) => panic!("accepted; expected: {expected}"),
        Err(Refusal::Inexpressible) => {}
        Err(Refusal::Message(message)) => {
            assert!(
                message.contains(expected),
                "found: {message}\nexpected: {expected}"
            );
            assert!(driver.save().unwrap() == good, "changed by: {message}");
        }
    };
    let changed = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    refuse(&[], "saved state");
    refuse(b"no state at all, but long enough to hold a header of ninety bytes and a little more than that", "saved state");
    refuse(&changed(8), "format version");
    refuse(&changed(20), "checksum does not match");
    refuse(&changed(good.len() - 1), "checksum does not match");
    refuse(&changed(good.len() / 2), "checksum does not match");
    for share in 1..12 {
        refuse(&good[..share * good.len() / 12], "cut short");
    }
    let mut other = stage.scene.clone();
    other.source = other.source.replacen("name = \"", "name = \"another_", 1);
    assert!(other.source != stage.scene.source);
    let mut other = (stage.make)(&other);
    refuse(&other.save().unwrap(), "another scene");
    driver.restore(&good).unwrap();
}

/// One bad value among good ones: none is taken.
pub(crate) fn sets_apply_all_or_nothing(stage: &Stage) {
    let mut driver = stage.stepping();
    let (gate, threads) = (stage.gate(), stage.reference("solver.threads"));
    for (references, values) in [
        (vec![gate, threads], vec![0.25, -1.0]),
        (vec![gate, threads, gate], vec![0.25, 2.0, 2.0]),
        (vec![gate, 987_654], vec![0.25, 0.0]),
        (vec![gate, stage.output()], vec![0.25, 0.0]),
    ] {
        assert!(driver.set(&references, &values).is_err());
        assert_eq!(
            driver.get(&[gate, threads], 2).unwrap(),
            [1.0, 1.0],
            "after a refused set of {references:?}"
        );
    }
    driver.set(&[gate, threads], &[0.25, 2.0]).unwrap();
    assert_eq!(driver.get(&[threads, gate], 2).unwrap(), [2.0, 0.25]);
}

/// Far from 0 a step still begins and ends where it is told to, to a thousandth of its length.
pub(crate) fn far_from_zero_steps_are_as_long_as_told(stage: &Stage) {
    let (start, h) = (1e6, stage.step());
    let mut driver = stage.instance();
    driver.enter_initialization(start, Some(start + h)).unwrap();
    driver.exit_initialization().unwrap();
    for (t, h, expected) in [
        (start + 0.01 * h, h, "do_step: t: found"),
        (start - 0.01 * h, h, "do_step: t: found"),
        (start, 1.01 * h, "the stop time"),
    ] {
        match driver.do_step(t, h) {
            Err(Refusal::Message(message)) => assert!(message.contains(expected), "{message}"),
            other => panic!("{other:?}, expected {expected}"),
        }
    }
    driver.do_step(start + 1e-4 * h, h).unwrap();
}
