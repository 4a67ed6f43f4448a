//! Rows for the host of a component: what it is asked to do beside stepping it. The component does nothing with them;
//! `component::host` keeps their values.

use super::{Causality, Start, ValueKind, Variability, Variable};
use crate::scene::Scene;

/// Name of the row with the log's file.
pub(in crate::component) const LOG_PATH: &str = "log.path";
/// Whether the log is required.
pub(in crate::component) const LOG_REQUIRED: &str = "log.required";
/// Name of the row with Zenoh's configuration.
pub(in crate::component) const ZENOH_CONFIG: &str = "zenoh.config";

/// The rows, before they have their numbers.
pub(super) fn rows(scene: &Scene) -> [Variable; 3] {
    let text = Start::Empty;
    let required = Start::Exact(vec![f64::from(scene.log.required)]);
    [
        row(
            LOG_PATH,
            text.clone(),
            "file of the MCAP log of all traffic, empty for none; never overwritten",
        ),
        row(
            LOG_REQUIRED,
            required,
            "whether a log that cannot be written is an error of the step; otherwise it is told once",
        ),
        row(
            ZENOH_CONFIG,
            text,
            "Zenoh's configuration, a path or JSON5 such as {}, to publish on Zenoh; empty for no Zenoh",
        ),
    ]
}

/// A flag if it has a number to start from, else a text. Fixed once the component is initialised.
fn row(name: &str, start: Start, description: &str) -> Variable {
    let is_flag = start != Start::Empty;
    Variable {
        reference: 0,
        name: name.to_owned(),
        description: description.to_owned(),
        causality: Causality::Parameter,
        variability: Variability::Fixed,
        kind: if is_flag {
            ValueKind::Boolean
        } else {
            ValueKind::Text
        },
        unit: "",
        display_unit: None,
        shape: Vec::new(),
        start,
        range: is_flag.then_some((0.0, 1.0)),
        element_of: None,
    }
}
