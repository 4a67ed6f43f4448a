//! The same bits whatever the way: after restore, with more threads, in another order, beside another instance.

use super::{Driver, Stage};

/// A few steps with a moving gate; states after each.
fn run(stage: &Stage, driver: &mut dyn Driver, steps: u32) -> Vec<Vec<u8>> {
    (0..steps).map(|k| step(stage, driver, k)).collect()
}

/// The k-th step of the run, and the state after it.
fn step(stage: &Stage, driver: &mut dyn Driver, k: u32) -> Vec<u8> {
    let opening = [1.0, 0.3, 0.0, 0.8][k as usize % 4];
    driver.set(&[stage.gate()], &[opening]).unwrap();
    driver
        .do_step(f64::from(k) * stage.step(), stage.step())
        .unwrap();
    driver.save().unwrap()
}

/// At every step: a new instance that was only instantiated takes the state over and goes on; so does the one that
/// saved, after having gone astray.
pub(crate) fn restored_instances_go_on_with_the_same_bits(stage: &Stage) {
    const STEPS: u32 = 6;
    let mut unbroken = stage.stepping();
    let mut state = unbroken.save().unwrap();
    for k in 0..STEPS {
        let mut other = stage.instance();
        other.restore(&state).unwrap();
        assert!(
            other.save().unwrap() == state,
            "saving what was restored before step {k}"
        );
        let next = step(stage, unbroken.as_mut(), k);
        assert!(
            step(stage, other.as_mut(), k) == next,
            "restored into a new instance before step {k}"
        );
        assert!(stage.everything(other.as_mut()) == stage.everything(unbroken.as_mut()));
        unbroken.set(&[stage.gate()], &[0.55]).unwrap();
        unbroken
            .do_step(f64::from(k + 1) * stage.step(), 0.7 * stage.step())
            .unwrap();
        unbroken.restore(&state).unwrap();
        assert!(
            step(stage, unbroken.as_mut(), k) == next,
            "gone back before step {k}"
        );
        state = next;
    }
    unbroken.terminate().unwrap();
    unbroken.restore(&state).unwrap();
    step(stage, unbroken.as_mut(), STEPS);
}

/// 1, 2 and 7 threads, also changed between steps.
pub(crate) fn threads_do_not_change_a_bit(stage: &Stage) {
    let threads = stage.reference("solver.threads");
    let mut one = stage.stepping();
    let expected = run(stage, one.as_mut(), 4);
    for count in [2.0, 7.0] {
        let mut many = stage.stepping();
        many.set(&[threads], &[count]).unwrap();
        assert!(run(stage, many.as_mut(), 4) == expected, "{count} threads");
    }
    let mut changing = stage.stepping();
    for (k, state) in (0..4).zip(&expected) {
        changing.set(&[threads], &[f64::from(1 + 3 * k)]).unwrap();
        assert!(
            step(stage, changing.as_mut(), k) == *state,
            "threads changed before step {k}"
        );
    }
}

/// One by one, backwards, all at once, twice: reading changes nothing and gives the same.
pub(crate) fn reading_in_any_order_gives_the_same_bits(stage: &Stage) {
    let mut driver = stage.stepping();
    let before = run(stage, driver.as_mut(), 3).pop().unwrap();
    let rows: Vec<_> = stage.results().collect();
    let expected = stage.everything(driver.as_mut());
    let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();

    let all: Vec<u32> = rows.iter().map(|v| v.reference).collect();
    assert_eq!(bits(driver.get(&all, expected.len()).unwrap()), expected);

    let mut backwards = Vec::new();
    for row in rows.iter().rev() {
        let values = driver.get(&[row.reference], row.len()).unwrap();
        backwards.splice(0..0, bits(values));
    }
    assert_eq!(backwards, expected);

    let twice: Vec<u32> = all.iter().flat_map(|r| [*r, *r]).collect();
    let values = bits(driver.get(&twice, 2 * expected.len()).unwrap());
    let mut place = 0;
    for row in &rows {
        let (first, second) = values[2 * place..2 * (place + row.len())].split_at(row.len());
        assert_eq!(first, second, "{} read twice", row.name);
        assert_eq!(first, &expected[place..place + row.len()], "{}", row.name);
        place += row.len();
    }

    for row in &rows {
        if let Some((array, k)) = row.element_of {
            let count = stage.table.by_reference(array).unwrap().len();
            let (whole, element) = (
                driver.get(&[array], count).unwrap(),
                driver.get(&[row.reference], 1).unwrap(),
            );
            assert_eq!(whole[k].to_bits(), element[0].to_bits(), "{}", row.name);
        }
    }
    assert!(
        driver.save().unwrap() == before,
        "reading changed the state"
    );
}

/// Two instances stepped in turns give what each gives alone.
pub(crate) fn instances_do_not_know_each_other(stage: &Stage) {
    let alone = run(stage, stage.stepping().as_mut(), 4);
    let (mut first, mut second) = (stage.stepping(), stage.stepping());
    for k in 0..4 {
        assert!(step(stage, first.as_mut(), k) == alone[k as usize]);
        second.set(&[stage.gate()], &[0.1]).unwrap();
        second
            .do_step(f64::from(k) * 0.5 * stage.step(), 0.5 * stage.step())
            .unwrap();
    }
    drop(second);
    step(stage, first.as_mut(), 4);
}

/// After a reset an instance does what a new one does.
pub(crate) fn reset_is_as_new(stage: &Stage) {
    let new = stage.instance().save().unwrap();
    let expected = run(stage, stage.stepping().as_mut(), 3);
    let mut driver = stage.stepping();
    run(stage, driver.as_mut(), 2);
    let threads = [stage.reference("solver.threads")];
    let start = driver.get(&threads, 1).unwrap();
    driver.set(&threads, &[start[0] + 1.0]).unwrap();
    driver.reset().unwrap();
    assert_eq!(
        driver.get(&threads, 1).unwrap(),
        start,
        "solver.threads has a start value, too"
    );
    assert!(
        driver.save().unwrap() == new,
        "a reset instance is not as a new one"
    );
    driver.enter_initialization(0.0, Some(10.0)).unwrap();
    driver.exit_initialization().unwrap();
    assert!(run(stage, driver.as_mut(), 3) == expected);
}

/// Steps of any length end at t + h bit for bit, also when the orchestrator's sum is off by rounding, and outputs
/// that count events agree with each other.
pub(crate) fn steps_end_where_they_are_told_to(stage: &Stage) {
    let mut driver = stage.stepping();
    let mut t = 0.0;
    for k in 0..12 {
        let h = stage.step() * [1.0, 0.31, 0.017, 1.9][k % 4];
        driver.do_step(t, h).unwrap();
        assert_eq!(
            stage.value(driver.as_mut(), "time").to_bits(),
            (t + h).to_bits(),
            "step {k}"
        );
        t = (t + h) * (1.0 + f64::EPSILON);
    }
}

/// initial + inflow - outflow = present, to the last bit, and devices add up to the ledger.
pub(crate) fn mass_is_exact_at_every_step(stage: &Stage) {
    let mut driver = stage.stepping();
    let sum = |driver: &mut dyn Driver, kind: &str, names: Vec<&String>| -> f64 {
        names
            .iter()
            .map(|name| stage.value(driver, &format!("{kind}.{name}.mass")))
            .sum()
    };
    let steps = (stage.scene.run.until / stage.step()).round() as u32;
    let mut left = 0.0;
    for k in 0..steps {
        driver
            .do_step(f64::from(k) * stage.step(), stage.step())
            .unwrap();
        let d = driver.as_mut();
        let [initial, inflow, outflow, present, error] =
            ["initial", "inflow", "outflow", "present", "error"]
                .map(|n| stage.value(d, &format!("mass.{n}")));
        assert_eq!(error, 0.0, "step {k}");
        assert_eq!(initial + inflow - outflow, present, "step {k}");
        assert!(initial > 0.0 && present > 0.0);
        assert_eq!(
            sum(
                d,
                "inflow",
                stage.scene.inflows.iter().map(|i| &i.name).collect()
            ),
            inflow
        );
        assert_eq!(
            sum(
                d,
                "outflow",
                stage.scene.outflows.iter().map(|o| &o.name).collect()
            ),
            outflow
        );
        left = outflow;
    }
    assert!(
        left > 0.0,
        "nothing left within {steps} steps: the test tests nothing"
    );
}
