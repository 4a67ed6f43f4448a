//! What requests do to a component: inputs set, steps done, start values taken again. The observer is told of each.

use crate::bus::notes::Notes;
use crate::bus::refusal::Refusal;
use crate::bus::values::Assignment;
use crate::component::{Component, Mode, StepReport, Wish};
use crate::wire::Observer;
use crate::wire::foxglove::LogLevel;

/// Sets inputs, all or none.
pub(super) fn assign(
    component: &mut Component,
    assignment: &Assignment,
    source: &str,
    observer: &mut dyn Observer,
) -> Result<(), Refusal> {
    if assignment.references.is_empty() {
        return Ok(());
    }
    component.set(&assignment.references, &assignment.values)?;
    observer.on_input(
        component,
        &assignment.references,
        &assignment.values,
        source,
    );
    tell_clamped(component, observer);
    Ok(())
}

/// Which inputs were taken but not as they were asked for.
pub(super) fn tell_clamped(component: &mut Component, observer: &mut dyn Observer) {
    for note in component.take_notes() {
        observer.on_log(component.time(), LogLevel::Warning, "bus", &note);
    }
}

/// Back to the start, with these variables set, fixed parameters among them; all or nothing.
pub(super) fn reset_with(
    component: &mut Component,
    assignment: &Assignment,
) -> Result<(), Refusal> {
    if assignment.references.is_empty() {
        return Ok(component.reset()?);
    }
    let mut fresh = component.anew()?;
    fresh.set(&assignment.references, &assignment.values)?;
    fresh.settle()?;
    *component = fresh;
    Ok(())
}

/// One communication step over `h` [s]; notes that come meanwhile are told at its start.
pub(super) fn advance(
    component: &mut Component,
    h: f64,
    source: &str,
    notes: Option<&Notes>,
    observer: &mut dyn Observer,
) -> Result<StepReport, Refusal> {
    let t = component.time();
    let done = match notes {
        None => component.do_step(t, h),
        Some(notes) => component.do_step_watched(t, h, &mut |_| {
            notes.tell(t, observer);
            Wish::GoOn
        }),
    };
    tell_clamped(component, observer);
    match done {
        Ok(report) => {
            observer.on_step(component, &report, t, h, source);
            Ok(report)
        }
        Err(error) => {
            if component.mode() == Mode::Failed {
                observer.on_log(component.time(), LogLevel::Error, "bus", &error.to_string());
            }
            Err(error.into())
        }
    }
}
