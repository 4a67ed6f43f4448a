//! What no component may take: each is refused with a reason, and changes nothing.

use crate::component::{Causality, Component, Error};

use super::checks::{Check, Failure};

/// Tries them on a component between steps.
pub(super) fn probe(component: &mut Component) -> Option<Failure> {
    let before = component.state_hash();
    let time = component.time();
    let mut wrong = None;
    let mut judge = |what: String, refused: Result<(), Error>| {
        let problem = match refused {
            Ok(()) => "was taken".to_owned(),
            Err(error) if error.to_string().len() < 20 => format!("was refused with: {error}"),
            Err(_) => return,
        };
        wrong.get_or_insert(Failure::at(
            Check::Refusal,
            time,
            format!("{what} {problem}"),
        ));
    };
    for (h, what) in [
        (0.0, "a step of 0 s"),
        (-1e-3, "a step back"),
        (f64::NAN, "a step of NaN"),
        (f64::INFINITY, "a step without end"),
    ] {
        judge(what.to_owned(), component.do_step(time, h).map(drop));
    }
    for t in [time + 1.0, f64::NAN] {
        judge(
            format!("a step from t = {t}"),
            component.do_step(t, 1e-3).map(drop),
        );
    }
    let rows: Vec<_> = component.variables().rows().to_vec();
    for row in &rows {
        let count = row.len();
        let bad: &[f64] = match row.causality {
            Causality::Input => &[f64::NAN, -0.1, f64::INFINITY],
            // Some are taken, rightly; those that are not numbers never.
            Causality::Parameter => &[f64::NAN],
            Causality::Output | Causality::Independent => &[0.0],
        };
        for value in bad {
            let refused = component.set(&[row.reference], &vec![*value; count]);
            judge(format!("{} = {value}", row.name), refused);
        }
        if row.causality == Causality::Input {
            let most = row.range.map_or(f64::MAX, |(_, most)| most);
            judge(
                format!("{} = twice its most", row.name),
                component.set(&[row.reference], &[2.0 * most + 1.0]),
            );
        }
    }
    judge(
        "an unknown variable".to_owned(),
        component.set(&[u32::MAX], &[0.0]),
    );
    if let Ok(bytes) = component.save() {
        judge(
            "half of a saved state".to_owned(),
            component.restore(&bytes[..bytes.len() / 2]),
        );
        let mut changed = bytes.clone();
        if let Some(byte) = changed.last_mut() {
            *byte ^= 1;
        }
        judge(
            "a changed saved state".to_owned(),
            component.restore(&changed),
        );
    }
    if wrong.is_none() && component.state_hash() != before {
        wrong = Some(Failure::at(
            Check::Refusal,
            time,
            "what was refused changed the state",
        ));
    }
    wrong
}
