//! The table of variables: the only list. FMI XML, C names, Zenoh keys, MCAP channels and docs are made from it.
//!
//! Here: what a row is. `rows` holds the list itself (gauges' rows are in `gauges`), `document` writes docs/variables.md from it.

mod document;
mod gauges;
pub(super) mod host;
mod rows;

pub use document::variables_markdown;
pub(super) use rows::Source;

use crate::scene::Scene;

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

    /// By name.
    #[must_use]
    pub fn by_name(&self, name: &str) -> Option<&Variable> {
        self.rows.iter().find(|v| v.name == name)
    }
}
