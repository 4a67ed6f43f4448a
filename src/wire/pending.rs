//! What drives a component between two calls that move its time: gathered as it happens, told by the next
//! [`Applied`].

use super::convert::timestamp;
use super::messages::{Applied, AppliedEvent, AppliedInput, AppliedMoment};
use crate::component::{Component, ValueReference, Wish};

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
    /// Variables were set by `source`: flat values as in [`Component::set`].
    pub fn set(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.inputs
            .extend(applied_inputs(component, references, values, source));
    }

    /// Inputs were given slopes by `source`, one each.
    pub fn slopes(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        slopes: &[f64],
        source: &str,
    ) {
        let inputs = applied_inputs(component, references, slopes, source);
        self.inputs.extend(inputs.map(|input| AppliedInput {
            slope: true,
            ..input
        }));
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
                    applied_inputs(component, references, values, source)
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

/// One message each variable.
fn applied_inputs(
    component: &Component,
    references: &[ValueReference],
    values: &[f64],
    source: &str,
) -> impl Iterator<Item = AppliedInput> {
    let mut rest = values;
    // References were accepted by the component, so that all are known.
    references.iter().filter_map(move |&reference| {
        let variable = component.variables().by_reference(reference)?;
        let (own, others) = rest.split_at(variable.len().min(rest.len()));
        rest = others;
        Some(AppliedInput {
            reference,
            name: variable.name.clone(),
            bits: own.iter().map(|v| v.to_bits()).collect(),
            values: own.to_vec(),
            source: source.to_owned(),
            slope: false,
        })
    })
}
