//! The table of variables: the only list. FMI XML, C names, Zenoh keys, MCAP channels and docs are made from it.
//!
//! Here: what a row is. `rows` holds the list itself (rows of `devices` and `gauges` are in these), `document` writes docs/variables.md from it.

mod devices;
mod document;
mod gauges;
pub(super) mod host;
mod rows;

pub use document::variables_markdown;
pub(super) use rows::Source;

use crate::scene::{InputTarget, Scene};

/// Handle of a variable, the same in FMI 2, FMI 3, C and Zenoh.
pub type ValueReference = u32;

/// Who sets a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Simulated time.
    Independent,
    /// Set before initialisation ends (fixed) or between steps (tunable).
    Parameter,
    /// Set by the orchestrator between steps.
    Input,
    /// Read by the orchestrator.
    Output,
}

/// When a variable may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// After initialisation never.
    Fixed,
    /// At communication points.
    Tunable,
    /// At steps, by jumps (flags, counts).
    Discrete,
    /// At any time.
    Continuous,
}

/// What values mean; all but texts travel as f64 through [`super::Component::get`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// A real number with a unit.
    Real,
    /// A whole number (counts, enumerations such as validity).
    Integer,
    /// 0 or 1.
    Boolean,
    /// Text: not among the numbers, see [`super::Component::set_texts`].
    Text,
}

/// Where the value at the start comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// This value, settable before initialisation.
    Exact(Vec<f64>),
    /// The empty text, settable before initialisation.
    Empty,
    /// Computed during initialisation.
    Calculated,
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Handle.
    pub reference: ValueReference,
    /// Structured name: `gate.main.opening`, `gauge.weir.depth`.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Who sets it.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Kind of value.
    pub kind: ValueKind,
    /// SI unit as FMI spells it: "m", "kg/s", "Pa", "N", "1"; empty for whole numbers and flags.
    pub unit: &'static str,
    /// Unit people like to see, with factor: e.g. ("mm", 1000.0).
    pub display_unit: Option<(&'static str, f64)>,
    /// Extents of an array; empty for a scalar.
    pub shape: Vec<usize>,
    /// Start value.
    pub start: Start,
    /// Smallest and largest allowed value, if bounded.
    pub range: Option<(f64, f64)>,
    /// If this row is the i-th element of an array row: that row's reference and i. FMI 2 lists elements and no arrays.
    pub element_of: Option<(ValueReference, usize)>,
}

impl Variable {
    /// Number of flat values.
    #[must_use]
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether it has no values (never).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The rows, in order of reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VariableTable {
    rows: Vec<Variable>,
    /// Where the value of each row comes from, in the same order; rows for the host have none.
    sources: Vec<Source>,
    /// First flat value of each row; elements point into their array's values.
    offsets: Vec<usize>,
}

impl VariableTable {
    /// The table of a scene's component.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut table = rows::list(scene);
        // Behind all others: they have no source and no place among the flat values.
        for mut row in host::rows(scene) {
            row.reference = table.rows.len() as ValueReference;
            table.rows.push(row);
        }
        table
    }

    /// Whether a variable is for the host of a component ([`super::HostSettings`]) and not for the component itself.
    #[must_use]
    pub fn is_for_host(&self, row: &Variable) -> bool {
        row.reference as usize >= self.sources.len()
    }

    /// Where a row's value comes from.
    pub(super) fn source(&self, reference: ValueReference) -> Option<&Source> {
        self.sources.get(reference as usize)
    }

    /// First flat value of a row of this table.
    pub(super) fn offset(&self, row: &Variable) -> usize {
        self.offsets[row.reference as usize]
    }

    /// Rows with their sources; those for the host are left out.
    pub(super) fn with_sources(&self) -> impl Iterator<Item = (&Variable, &Source)> {
        self.rows.iter().zip(&self.sources)
    }

    /// All rows.
    #[must_use]
    pub fn rows(&self) -> &[Variable] {
        &self.rows
    }

    /// By handle.
    #[must_use]
    pub fn by_reference(&self, reference: ValueReference) -> Option<&Variable> {
        self.rows.get(reference as usize)
    }

    /// The input that a schedule of the scene sets.
    #[must_use]
    pub fn input(&self, input: InputTarget) -> ValueReference {
        self.of_source(match input {
            InputTarget::GateOpening(gate) => Source::GateOpening(gate),
            InputTarget::InflowRate(inflow) => Source::InflowRate(inflow),
            InputTarget::WallDrive(drive) => Source::WallDrive(drive),
        })
    }

    /// The opening that a gate of the scene has, by its index.
    #[must_use]
    pub fn actual_opening(&self, gate: usize) -> ValueReference {
        self.of_source(Source::GateActualOpening(gate))
    }

    /// Whether material keeps a gate of the scene from following its input, by its index.
    #[must_use]
    pub fn gate_blocked(&self, gate: usize) -> ValueReference {
        self.of_source(Source::GateBlocked(gate))
    }

    /// The mass that an inflow of the scene let in, by its index.
    #[must_use]
    pub fn inflow_mass(&self, inflow: usize) -> ValueReference {
        self.of_source(Source::InflowMass(inflow))
    }

    /// The share of the mass that is too fast for the sound speed.
    #[must_use]
    pub fn share_fast(&self) -> ValueReference {
        self.of_source(Source::ShareFast)
    }

    /// The share of the mass that is squeezed too much.
    #[must_use]
    pub fn share_squeezed(&self) -> ValueReference {
        self.of_source(Source::ShareSqueezed)
    }

    /// The row with this source: `rows` has one for each device of the scene, so that one without is a device of another.
    fn of_source(&self, source: Source) -> ValueReference {
        let place = self.sources.iter().position(|other| *other == source);
        assert!(place.is_some(), "no variable of this scene is {source:?}");
        place.unwrap_or_default() as ValueReference
    }

    /// By name.
    #[must_use]
    pub fn by_name(&self, name: &str) -> Option<&Variable> {
        self.rows.iter().find(|v| v.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_of_devices_are_found_by_what_they_are() {
        let text = include_str!("../../tests/scenes/devices.toml");
        let table = VariableTable::of(&crate::scene::parse("devices.toml", text).unwrap());
        for (reference, name) in [
            (
                table.input(InputTarget::GateOpening(0)),
                "gate.sluice.opening",
            ),
            (table.input(InputTarget::InflowRate(0)), "inflow.feed.rate"),
            (table.actual_opening(0), "gate.sluice.actual_opening"),
            (table.gate_blocked(0), "gate.sluice.blocked"),
            (table.inflow_mass(0), "inflow.feed.mass"),
            (table.share_fast(), "validity.share_fast"),
            (table.share_squeezed(), "validity.share_squeezed"),
        ] {
            assert_eq!(table.rows()[reference as usize].name, name);
        }
    }

    #[test]
    #[should_panic(expected = "GateActualOpening(7)")]
    fn a_device_of_another_scene_has_no_variables() {
        let text = include_str!("../../tests/scenes/devices.toml");
        let _ = VariableTable::of(&crate::scene::parse("devices.toml", text).unwrap())
            .actual_opening(7);
    }
}
