//! The request `step`: inputs set, one communication step done, outputs read; all of it or nothing.

use super::drive::{advance, assign};
use super::verbs::object;
use super::{Fields, Protocol, source};
use crate::bus::refusal::{Code, Refusal};
use crate::bus::request::Request;
use crate::bus::status::nanoseconds;
use crate::bus::values::{self, Assignment};
use crate::component::{Component, Mode, step_end};
use crate::wire::Observer;
use serde_json::json;
use std::time::Instant;

impl Protocol {
    /// One step, if nothing speaks against it.
    pub(super) fn step(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
        if self.free_running.is_some() {
            return Err(Refusal::new(
                Code::State,
                "step: the component runs freely; send pause first",
            ));
        }
        let h = step_length(component, request)?;
        let assignment = Assignment::resolve(component.variables(), &request.inputs)?;
        let rows = match &request.outputs {
            Some(names) => values::rows(component.variables(), Some(names))?,
            None => Vec::new(),
        };
        let names: Vec<_> = rows.iter().map(|row| row.reference).collect();
        let before = assignment.present(component)?;
        assign(component, &assignment, source(request), observer)?;
        let started = Instant::now();
        let report = match advance(component, h, source(request), self.notes.as_ref(), observer) {
            Ok(report) => report,
            Err(refusal) => {
                if component.mode() != Mode::Failed {
                    // Refused without a step: the inputs go back, too. They were allowed a moment ago.
                    assign(component, &before, "undone", observer)?;
                }
                return Err(refusal);
            }
        };
        let wall_us = u64::try_from(started.elapsed().as_micros()).unwrap_or(u64::MAX);
        let rows: Vec<_> = names
            .iter()
            .filter_map(|&reference| component.variables().by_reference(reference))
            .collect();
        let outputs = values::read(component, &rows)?;
        Ok(object(json!({
            "outputs": outputs, "substeps": report.substeps, "iterations": report.iterations,
            "wall_us": wall_us,
        })))
    }
}

/// How long the step is that is asked for [s].
///
/// # Errors
/// [`Code::Conflict`] if it shall begin at another time than now.
fn step_length(component: &Component, request: &Request) -> Result<f64, Refusal> {
    let now = nanoseconds(component.time());
    if let Some(t_ns) = request.t_ns
        && t_ns != now
    {
        return Err(Refusal::new(
            Code::Conflict,
            format!("t_ns: found {t_ns}, the component is at {now}; read status and decide"),
        ));
    }
    // The end is a whole number of nanoseconds, made a time once, so that any number of steps does not drift. Over
    // 1e9 is the nearest f64; times 1e-9 is one bit off for many. The sum saturates far beyond any run.
    let end = match request.dt_ns {
        Some(dt) => now.saturating_add_unsigned(dt) as f64 / 1e9,
        None => step_end(component.time(), component.scene().run.step),
    };
    Ok(end - component.time())
}
