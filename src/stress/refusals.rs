//! What no component may take: each is refused with a reason, and changes nothing.

use crate::component::{Causality, Component, Error};

use super::checks::{Check, Failure};

/// Tries them on a component between steps.
pub(super) fn probe(component: &mut Component) -> Option<Failure> {
    let before = component.state_hash();
    let mut judge = Judge {
        time: component.time(),
        wrong: None,
    };
    steps(component, &mut judge);
    variables(component, &mut judge);
    states(component, &mut judge);
    if judge.wrong.is_none() && component.state_hash() != before {
        judge.wrong = Some(Failure::at(
            Check::Refusal,
            judge.time,
            "what was refused changed the state",
        ));
    }
    judge.wrong
}

/// Keeps the first that was taken, or refused without a reason.
struct Judge {
    /// When it is tried [s].
    time: f64,
    wrong: Option<Failure>,
}

impl Judge {
    fn hear(&mut self, what: impl std::fmt::Display, refused: Result<(), Error>) {
        let problem = match refused {
            Ok(()) => "was taken".to_owned(),
            Err(error) if error.to_string().len() < 20 => format!("was refused with: {error}"),
            Err(_) => return,
        };
        self.wrong.get_or_insert(Failure::at(
            Check::Refusal,
            self.time,
            format!("{what} {problem}"),
        ));
    }
}

/// Steps of no length, and from elsewhere in time.
fn steps(component: &mut Component, judge: &mut Judge) {
    let time = judge.time;
    for (h, what) in [
        (0.0, "a step of 0 s"),
        (-1e-3, "a step back"),
        (f64::NAN, "a step of NaN"),
        (f64::INFINITY, "a step without end"),
    ] {
        judge.hear(what, component.do_step(time, h).map(drop));
    }
    for t in [time + 1.0, f64::NAN] {
        let refused = component.do_step(t, 1e-3).map(drop);
        judge.hear(format!("a step from t = {t}"), refused);
    }
}

/// Values that no variable has, and a variable that is not there.
fn variables(component: &mut Component, judge: &mut Judge) {
    let rows: Vec<_> = component.variables().rows().to_vec();
    for row in &rows {
        let count = row.len();
        let least = row.range.map_or(f64::MIN, |(least, _)| least);
        let bad: &[f64] = match row.causality {
            Causality::Input => &[f64::NAN, 2.0 * least - 0.1, f64::INFINITY],
            // Some are taken, rightly; those that are not numbers never.
            Causality::Parameter => &[f64::NAN],
            Causality::Output | Causality::Independent => &[0.0],
        };
        for value in bad {
            let refused = component.set(&[row.reference], &vec![*value; count]);
            judge.hear(format!("{} = {value}", row.name), refused);
        }
        if row.causality == Causality::Input {
            let most = row.range.map_or(f64::MAX, |(_, most)| most);
            let refused = component.set(&[row.reference], &[2.0 * most + 1.0]);
            judge.hear(format!("{} = twice its most", row.name), refused);
        }
    }
    let refused = component.set(&[u32::MAX], &[0.0]);
    judge.hear("an unknown variable", refused);
}

/// States that are not whole.
fn states(component: &mut Component, judge: &mut Judge) {
    let Ok(bytes) = component.save() else {
        return;
    };
    let refused = component.restore(&bytes[..bytes.len() / 2]);
    judge.hear("half of a saved state", refused);
    let mut changed = bytes.clone();
    if let Some(byte) = changed.last_mut() {
        *byte ^= 1;
    }
    judge.hear("a changed saved state", component.restore(&changed));
}
