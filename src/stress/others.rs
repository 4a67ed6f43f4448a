//! Other runs of the same case: restored in the middle, and a twin that must end alike.

use toml::Value;

use super::Case;
use super::case::Twin;
use super::checks::{Check, Failure};
use super::ride::{Done, Ride};
use super::run::{Bounds, end_of};
use super::walls::length;
use crate::component::Component;
use crate::validate::template::Template;

/// Goes on from saved bytes in a new component, with another number of threads, watched, and compares the end.
pub(super) fn same_bits(
    ride: &Ride<'_>,
    case: &Case,
    saved: Result<Vec<u8>, String>,
    done: &[Done],
) -> Option<Failure> {
    let (time, wanted) = (ride.component.time(), ride.component.state_hash());
    let fail = |what: String| Some(Failure::at(Check::SameBits, time, what));
    let mut again = match Ride::new(case, ride.scene(), f64::INFINITY) {
        Ok(again) => again,
        Err(error) => return fail(format!("a second component was refused: {error}")),
    };
    again.component.set_threads(case.drive.threads);
    let restored =
        saved.and_then(|bytes| again.component.restore(&bytes).map_err(|e| e.to_string()));
    if let Err(error) = restored {
        return fail(format!("what was saved is not restored: {error}"));
    }
    again.index = case.drive.restore_after;
    for step in done {
        match again.again(step) {
            Ok(other) if other.report.time.to_bits() == step.report.time.to_bits() => {}
            Ok(other) => {
                return fail(format!(
                    "a step to {:?} ends at {:?} after restore",
                    step.report.time, other.report.time
                ));
            }
            Err(error) => return fail(format!("a step fails after restore only: {error}")),
        }
    }
    if again.component.state_hash() == wanted {
        return None;
    }
    fail(format!(
        "restored after {} communication steps, on {} threads and watched, another state at the end",
        case.drive.restore_after, case.drive.threads
    ))
}

/// Runs the twin and compares centres of mass and mean velocities.
pub(super) fn twin(
    component: &Component,
    case: &Case,
    twin: &Twin,
    bounds: &Bounds,
) -> Option<Failure> {
    let time = component.time();
    let fail = |what: String| Some(Failure::at(Check::Twin, time, what));
    let other = match changed(case, twin) {
        Ok(other) => other,
        Err(problem) => return fail(problem),
    };
    let other = match end_of(&other, bounds) {
        Ok(other) => other,
        Err(problem) => return fail(format!("the twin does not end: {problem}")),
    };
    if (other.time() - time).abs() > 1e-9 * time {
        return fail(format!("the twin ends at {} s", other.time()));
    }
    let mean = |c: &Component| {
        let (totals, mass) = (c.totals(), c.ledger().present);
        (
            totals.moment.map(|m| m / mass),
            totals.momentum.map(|p| p / mass),
        )
    };
    let ((x, v), (y, mut u)) = (mean(component), mean(&other));
    for (u, boost) in u.iter_mut().zip(twin.boost) {
        *u -= boost;
    }
    // Frames that move against each other see the material at different places, wrapped around periodic sides.
    let apart = if twin.boost == [0.0; 2] {
        length(&x, &y)
    } else {
        (x[1] - y[1]).abs()
    };
    let faster = length(&v, &u);
    // Written so that what is no number fails.
    if apart <= twin.within && faster <= twin.speed_within {
        return None;
    }
    fail(format!(
        "centres of mass are {apart:.3e} m apart, allowed {:e}; mean velocities {faster:.3e} m/s, allowed {:e}",
        twin.within, twin.speed_within
    ))
}

/// The case with the twin's changes.
fn changed(case: &Case, twin: &Twin) -> Result<Case, String> {
    let mut template = Template::new(&case.scene_text())?;
    for (path, value) in &twin.changes {
        template = template.with(path, Value::clone(value));
    }
    let mut other = case.clone();
    other.scene = template.text()?.parse().map_err(|e| format!("{e}"))?;
    if !twin.steps.is_empty() {
        let total = |steps: &[f64], count: usize| -> f64 {
            (0..count).map(|i| steps[i % steps.len()]).sum()
        };
        let all = total(&case.drive.steps, case.drive.count);
        let cycle = total(&twin.steps, twin.steps.len());
        other.drive.count = (all / cycle).round() as usize * twin.steps.len();
        other.drive.steps.clone_from(&twin.steps);
    }
    // Both must get as far.
    other.drive.most_steps = other.drive.most_steps.saturating_mul(100);
    Ok(other)
}
