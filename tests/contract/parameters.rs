//! Parameters: fixed ones until initialisation ends, and clamped inputs.

use super::{Driver, Refusal, Stage};

/// A finer run [1] that keeps whole numbers of particles in a period of 8; coarser ones may break rules of scenes.
const FINER: f64 = 1.25;

/// Set before or inside initialisation, or brought by a state: the same bits, others than without.
pub(crate) fn parameters_count_whenever_they_are_set(stage: &Stage) {
    let scale = [stage.reference("solver.resolution_scale")];
    let start = |driver: &mut dyn Driver, before: Option<f64>, inside: Option<f64>| {
        if let Some(value) = before {
            driver.set(&scale, &[value]).unwrap();
        }
        driver.enter_initialization(0.0, None).unwrap();
        if let Some(value) = inside {
            driver.set(&scale, &[value]).unwrap();
        }
        driver.exit_initialization().unwrap();
        driver.do_step(0.0, stage.step()).unwrap();
    };
    let (mut before, mut inside, mut without) =
        (stage.instance(), stage.instance(), stage.instance());
    start(before.as_mut(), Some(FINER), None);
    start(inside.as_mut(), Some(2.0), Some(FINER));
    start(without.as_mut(), None, None);
    let finer = stage.everything(before.as_mut());
    assert!(stage.everything(inside.as_mut()) == finer);
    assert!(before.save().unwrap() == inside.save().unwrap());
    let particles = |driver: &mut dyn Driver| stage.value(driver, "solver.particles");
    assert!(particles(before.as_mut()) > particles(without.as_mut()));

    // A state brings its parameters along, and the instance goes on with them.
    let state = before.save().unwrap();
    let mut fresh = stage.instance();
    for other in [&mut fresh, &mut without] {
        other.restore(&state).unwrap();
        assert!(stage.everything(other.as_mut()) == finer);
    }
    for driver in [&mut before, &mut fresh, &mut without] {
        driver.do_step(stage.step(), stage.step()).unwrap();
    }
    let next = before.save().unwrap();
    assert!(fresh.save().unwrap() == next && without.save().unwrap() == next);

    // Reset goes back to what the scene says.
    before.reset().unwrap();
    assert_eq!(before.get(&scale, 1).unwrap(), [1.0]);
    let mut new = stage.instance();
    assert!(before.save().unwrap() == new.save().unwrap());

    // So does a state that was saved before the parameter took effect.
    new.set(&scale, &[FINER]).unwrap();
    let early = new.save().unwrap();
    before.restore(&early).unwrap();
    start(before.as_mut(), None, None);
    assert!(stage.everything(before.as_mut()) == finer);

    // And one whose outputs were read with other parameters than those it was saved with.
    let (mut back, mut plain) = (stage.instance(), stage.instance());
    back.set(&scale, &[FINER]).unwrap();
    particles(back.as_mut());
    back.set(&scale, &[1.0]).unwrap();
    let early = back.save().unwrap();
    before.restore(&early).unwrap();
    for driver in [&mut before, &mut plain] {
        driver.enter_initialization(0.0, None).unwrap();
        driver.exit_initialization().unwrap();
    }
    assert!(stage.everything(before.as_mut()) == stage.everything(plain.as_mut()));
}

/// Values that break a rule together are refused when they are needed, and may be corrected.
pub(crate) fn values_that_do_not_go_together_wait_for_each_other(stage: &Stage) {
    let material = &stage.scene.materials[0].name;
    let angle =
        |which: &str| stage.reference(&format!("material.{material}.{which}_friction_angle"));
    let (low, high) = (angle("static"), angle("dynamic"));
    let mut driver = stage.instance();
    driver.enter_initialization(0.0, None).unwrap();
    driver.set(&[low], &[1.0]).unwrap();
    let before = driver.save().unwrap();
    match driver.exit_initialization() {
        Err(Refusal::Message(message)) => {
            for part in ["dynamic", "friction_angle", "found", "allowed"] {
                assert!(message.contains(part), "{message}");
            }
        }
        other => panic!("a static angle above the dynamic one gave {other:?}"),
    }
    assert!(driver.save().unwrap() == before);
    driver.set(&[high], &[1.1]).unwrap();
    driver.exit_initialization().unwrap();
    driver.do_step(0.0, stage.step()).unwrap();
    assert_eq!(driver.get(&[low, high], 2).unwrap(), [1.0, 1.1]);
}

/// Rounding is forgiven; more only if it was asked for; what is no number never.
pub(crate) fn inputs_are_clamped_only_as_far_as_allowed(stage: &Stage) {
    let mut driver = stage.stepping();
    let (gate, saturate) = ([stage.gate()], [stage.reference("saturate_inputs")]);
    for (value, expected) in [(1.0 + 1e-10, 1.0), (-1e-10, 0.0)] {
        driver.set(&gate, &[value]).unwrap();
        assert_eq!(driver.get(&gate, 1).unwrap(), [expected]);
    }
    assert!(driver.set(&gate, &[1.0 + 1e-8]).is_err());
    driver.set(&saturate, &[1.0]).unwrap();
    for (value, expected) in [(1.5, 1.0), (-3.0, 0.0), (0.25, 0.25)] {
        driver.set(&gate, &[value]).unwrap();
        assert_eq!(driver.get(&gate, 1).unwrap(), [expected]);
    }
    assert!(driver.set(&gate, &[f64::NAN]).is_err());
    assert!(driver.set(&gate, &[f64::INFINITY]).is_err());
    driver.set(&saturate, &[0.0]).unwrap();
    assert!(driver.set(&gate, &[1.5]).is_err());
}
