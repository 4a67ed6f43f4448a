//! What drives a component between two calls that move its time: gathered as it happens, told by the next
//! [`Applied`].

use super::convert::timestamp;
use super::messages::{Applied, AppliedEvent, AppliedInput, AppliedMoment};
use crate::component::{Causality, Component, ValueReference, Variable, Wish};
use std::collections::HashSet;

/// Inputs that are all told, also those that were set again before a step could use them. Of more only the last of each
/// variable is kept, so that a component that waits takes set-points for days in the same memory.
const TOLD: usize = 1024;

/// Something done inside a step, after one of its internal steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Simulated time at which the internal step ended [s].
    pub time: f64,
    /// Inputs set for the rest of the step: references and flat values of each call.
    pub inputs: Vec<(Vec<ValueReference>, Vec<f64>)>,
    /// What was wished then.
    pub wish: Wish,
}

/// Inputs that were set and are not told yet.
#[derive(Clone, Debug, Default)]
pub struct Pending {
    inputs: Vec<AppliedInput>,
    moments: Vec<AppliedMoment>,
}

impl Pending {
    /// Variables were set by `source`: flat values as in [`Component::set`]. Told is what inputs hold, in their range whatever was asked:
    /// who sets it again needs no `saturate_inputs`, which one call may have set together with the input.
    pub fn set(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.inputs
            .extend(applied_inputs(component, references, values, source, held));
        self.forget_superseded();
    }

    /// Inputs were given slopes by `source`, one each.
    pub fn slopes(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        slopes: &[f64],
        source: &str,
    ) {
        let inputs = applied_inputs(component, references, slopes, source, |_, _, slope| slope);
        self.inputs.extend(inputs.map(|input| AppliedInput {
            slope: true,
            ..input
        }));
        self.forget_superseded();
    }

    /// If there are too many, keeps the last value and the last slope of each variable, in the order in which they were
    /// set: who sets these comes to the same inputs.
    fn forget_superseded(&mut self) {
        if self.inputs.len() <= TOLD {
            return;
        }
        let mut later = HashSet::new();
        self.inputs.reverse();
        self.inputs
            .retain(|input| later.insert((input.reference, input.slope)));
        self.inputs.reverse();
        // What so many took is not needed again soon.
        self.inputs.shrink_to(TOLD);
    }

    /// Something was done inside the step that is running.
    pub fn moment(&mut self, component: &Component, moment: &Moment, source: &str) {
        let inputs = moment.inputs.iter();
        let end = match moment.wish {
            Wish::GoOn => None,
            Wish::EndAt(time) => Some(time),
        };
        self.moments.push(AppliedMoment {
            t_bits: moment.time.to_bits(),
            inputs: inputs
                .flat_map(|(references, values)| {
                    applied_inputs(component, references, values, source, held)
                })
                .collect(),
            ends: end.is_some(),
            end_bits: end.map_or(0, f64::to_bits),
        });
    }

    /// Whether nothing waits to be told.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inputs.is_empty()
    }

    /// The step that was running did not come to its end.
    pub fn forget_moments(&mut self) {
        self.moments.clear();
    }

    /// Nothing of it counts any more.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The message of a call that took it all: `t` and `h` as [`Applied`] has them.
    pub fn applied(
        &mut self,
        event: AppliedEvent,
        step: u64,
        (t, h): (f64, f64),
        source: &str,
    ) -> Applied {
        Applied {
            timestamp: Some(timestamp(t)),
            event: event as i32,
            step,
            t_bits: t.to_bits(),
            h_bits: h.to_bits(),
            t,
            h,
            inputs: std::mem::take(&mut self.inputs),
            source: source.to_owned(),
            moments: std::mem::take(&mut self.moments),
            state: Vec::new(),
        }
    }
}

/// As an input holds it: what was accepted out of its range was clamped.
fn held(component: &Component, variable: &Variable, value: f64) -> f64 {
    match component.range_of(variable) {
        Some((least, most)) if variable.causality == Causality::Input => value.clamp(least, most),
        _ => value,
    }
}

/// One message each variable.
fn applied_inputs(
    component: &Component,
    references: &[ValueReference],
    values: &[f64],
    source: &str,
    told: impl Fn(&Component, &Variable, f64) -> f64,
) -> impl Iterator<Item = AppliedInput> {
    let mut rest = values;
    // References were accepted by the component, so that all are known.
    references.iter().filter_map(move |&reference| {
        let variable = component.variables().by_reference(reference)?;
        let (own, others) = rest.split_at(variable.len().min(rest.len()));
        rest = others;
        let own: Vec<f64> = own
            .iter()
            .map(|&value| told(component, variable, value))
            .collect();
        Some(AppliedInput {
            reference,
            name: variable.name.clone(),
            bits: own.iter().map(|v| v.to_bits()).collect(),
            values: own,
            source: source.to_owned(),
            slope: false,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::ValueKind;

    #[test]
    fn a_component_that_waits_keeps_the_last_of_each_input() {
        let text = include_str!("../../tests/scenes/devices.toml");
        let scene = crate::scene::parse("devices.toml", text).unwrap();
        let component = Component::new(&scene).unwrap();
        let rows = component.variables().rows().iter();
        let inputs: Vec<_> = rows
            .filter(|v| {
                v.causality == Causality::Input && v.kind == ValueKind::Real && v.len() == 1
            })
            .map(|v| v.reference)
            .collect();
        let [first, second, ..] = inputs[..] else {
            panic!("two inputs are needed: {inputs:?}")
        };
        let mut pending = Pending::default();
        pending.set(&component, &[second], &[0.25], "early");
        pending.slopes(&component, &[first], &[0.5], "early");
        let mut most = 0;
        for k in 0..10_000 {
            pending.set(&component, &[first], &[f64::from(k) * 1e-4], "late");
            most = most.max(pending.inputs.len());
        }
        assert_eq!(most, TOLD);
        let told = pending.applied(AppliedEvent::Step, 1, (0.0, 0.1), "test");
        let of = |reference, slope| {
            let found = told
                .inputs
                .iter()
                .rposition(|i| i.reference == reference && i.slope == slope);
            found.map(|k| (k, told.inputs[k].values[0]))
        };
        let (value, slope) = (of(first, false).unwrap(), of(first, true).unwrap());
        assert_eq!((value.1, slope.1), (0.9999, 0.5));
        assert_eq!(of(second, false).unwrap().1, 0.25);
        // In the order in which they were set.
        assert!(slope.0 < value.0);
        assert!(pending.is_empty());
    }
}
