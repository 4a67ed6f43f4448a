//! The scalars of a log side by side: one row a communication point, the columns of the run's `gauges.csv`. Rows of
//! steps that were taken back are left out.

use super::ending::Ending;
use super::error::ReadError;
use super::raw::{RawEntry, RawReader};
use super::read::{Body, decode};
use super::standing::Standing;
use crate::component::{Causality, Component, Start, ValueKind, VariableTable};
use crate::scene;
use crate::wire::messages::{Applied, AppliedEvent, Gauge, StepStats};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One scalar over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the table of variables; elements of arrays by themselves.
    pub name: String,
    /// SI unit; empty for whole numbers and flags.
    pub unit: String,
    /// Line for people.
    pub description: String,
    /// Whether it is an input: its value is the one that held over the step that ended at the row's time.
    pub is_input: bool,
    /// Whether it is a flag: 0 or 1, or the validity of a gauge.
    pub is_flag: bool,
    /// One value a row, SI; NaN where the log says nothing.
    pub values: Vec<f64>,
}

/// All scalars of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Simulated time of each row [s].
    pub time: Vec<f64>,
    /// Communication steps done at each row.
    pub step: Vec<u64>,
    /// Inputs and outputs in the order of the table of variables.
    pub columns: Vec<Column>,
    /// How the log ends: whether rows are missing or may be wrong.
    pub ending: Ending,
}

/// Errors of [`Table::read`].
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The log carries no scene, which says what its columns are.
    #[error(
        "log {path} has no attachment scene.toml, which says what its columns are; only logs of sandgate have it"
    )]
    NoScene {
        /// The file.
        path: PathBuf,
    },
    /// The scene within the log is refused by this version.
    #[error("the scene within the log is refused by this version: {0}")]
    Scene(#[from] scene::SceneErrors),
}

impl Table {
    /// Reads `path`: rows whose time is from `span.0` to `span.1` [s].
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read(path: &Path, span: (f64, f64)) -> Result<Self, TableError> {
        let standing = Standing::of(path)?;
        let mut builder: Option<Builder> = None;
        let mut reader = RawReader::open(path)?;
        for entry in reader.by_ref() {
            match (entry?, &mut builder) {
                (RawEntry::Attachment { name, data, .. }, none @ None) if name == "scene.toml" => {
                    let scene = scene::parse("scene.toml", &String::from_utf8_lossy(&data))?;
                    *none = Some(Builder::new(scene, span, &standing));
                }
                (RawEntry::Attachment { name, data, .. }, Some(builder))
                    if name == "start.state" =>
                {
                    builder.begin_at(&data);
                }
                (RawEntry::Message(message), Some(builder)) => {
                    match message.channel.schema.name.as_str() {
                        // The large ones are not looked into.
                        "sandgate.Gauge" | "sandgate.Applied" | "sandgate.StepStats" => {
                            builder.add(decode(path, &message)?);
                        }
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        let mut table = match builder {
            Some(builder) => builder.table,
            None => {
                return Err(TableError::NoScene {
                    path: path.to_owned(),
                });
            }
        };
        table.ending = reader.ending().cloned().unwrap_or_default();
        Ok(table)
    }

    /// A column by name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

struct Builder<'a> {
    standing: &'a Standing,
    scene: scene::Scene,
    table: Table,
    /// Columns of a variable: one, or one each element.
    places: HashMap<String, Vec<usize>>,
    /// Of each column.
    ranges: Vec<Option<(f64, f64)>>,
    /// The row being filled.
    row: Vec<f64>,
    /// Lines of figures and SAVEs so far.
    lines: usize,
    saves: usize,
    /// The row as it was when states were saved to which the log comes back, and how often it still does, by checksum.
    saved: HashMap<Vec<u8>, (Vec<f64>, usize)>,
    span: (f64, f64),
}

impl<'a> Builder<'a> {
    fn new(scene: scene::Scene, span: (f64, f64), standing: &'a Standing) -> Self {
        let variables = VariableTable::of(&scene);
        let mut places: HashMap<String, Vec<usize>> = HashMap::new();
        let (mut columns, mut row, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        let scalars = variables
            .rows()
            .iter()
            .filter(|v| matches!(v.causality, Causality::Input | Causality::Output))
            .filter(|v| v.shape.is_empty());
        for variable in scalars {
            let own = match variable.element_of {
                None => Some(variable),
                Some((array, _)) => variables.by_reference(array),
            };
            if let Some(own) = own {
                let list = places.entry(own.name.clone()).or_default();
                list.push(columns.len());
            }
            row.push(match &variable.start {
                Start::Exact(values) => values.first().copied(),
                Start::Empty | Start::Calculated => None,
            });
            ranges.push(variable.range);
            columns.push(Column {
                name: variable.name.clone(),
                unit: variable.unit.to_owned(),
                description: variable.description.clone(),
                is_input: variable.causality == Causality::Input,
                is_flag: variable.kind == ValueKind::Boolean
                    || variable.name.ends_with(".validity"),
                values: Vec::new(),
            });
        }
        Self {
            standing,
            scene,
            table: Table {
                columns,
                ..Table::default()
            },
            places,
            ranges,
            lines: 0,
            saves: 0,
            saved: HashMap::new(),
            row: row.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect(),
            span,
        }
    }

    /// Inputs are those of a saved state. One that does not fit leaves them as nobody knows them.
    fn begin_at(&mut self, state: &[u8]) {
        let component = Component::new(&self.scene).and_then(|mut component| {
            component.restore(state)?;
            Ok(component)
        });
        for (column, value) in self.table.columns.iter().zip(&mut self.row) {
            if !column.is_input {
                continue;
            }
            *value = f64::NAN;
            if let Ok(component) = &component
                && let Some(variable) = component.variables().by_name(&column.name)
            {
                let mut own = [f64::NAN];
                // Refused only for arrays, which a column is not.
                if component.get(&[variable.reference], &mut own).is_ok() {
                    *value = own[0];
                }
            }
        }
    }

    fn add(&mut self, body: Body) {
        match body {
            Body::Applied(applied) => self.inputs(&applied),
            Body::Gauge(gauge) => self.gauge(&gauge),
            // Comes after all outputs of its point.
            Body::Stats(stats) => self.row(&stats),
            _ => {}
        }
    }

    fn row(&mut self, stats: &StepStats) {
        let stands = self.standing.row(self.lines);
        self.lines += 1;
        if !(stands && (self.span.0..=self.span.1).contains(&stats.time)) {
            return;
        }
        self.table.time.push(stats.time);
        self.table.step.push(stats.step);
        for (column, value) in self.table.columns.iter_mut().zip(&self.row) {
            column.values.push(*value);
        }
    }

    fn inputs(&mut self, applied: &Applied) {
        let moments = applied.moments.iter().flat_map(|moment| &moment.inputs);
        for input in applied.inputs.iter().chain(moments).filter(|i| !i.slope) {
            self.put(&input.name, &input.values);
        }
        match applied.event() {
            AppliedEvent::Save => self.save(&applied.state),
            AppliedEvent::Restore => self.restore(&applied.state),
            _ => {}
        }
    }

    fn save(&mut self, state: &[u8]) {
        let returns = self.standing.returns(self.saves);
        self.saves += 1;
        if returns > 0 {
            self.saved
                .insert(state.to_vec(), (self.row.clone(), returns));
        }
    }

    /// Outputs of the state come again; its inputs do not.
    fn restore(&mut self, state: &[u8]) {
        let Some((row, returns)) = self.saved.get_mut(state) else {
            return;
        };
        self.row.clone_from(row);
        *returns -= 1;
        if *returns == 0 {
            self.saved.remove(state);
        }
    }

    fn gauge(&mut self, gauge: &Gauge) {
        self.put(&gauge.name, &gauge.values);
        if let Some((device, _)) = gauge.name.rsplit_once('.') {
            self.put(&format!("{device}.validity"), &[f64::from(gauge.validity)]);
        }
    }

    fn put(&mut self, name: &str, values: &[f64]) {
        let places = self.places.get(name).map_or(&[][..], Vec::as_slice);
        for (&place, &value) in places.iter().zip(values) {
            // The log has what was asked for. What was taken and lies out of the range was clamped.
            self.row[place] = match self.ranges[place] {
                Some((least, most)) if self.table.columns[place].is_input => {
                    value.clamp(least, most)
                }
                _ => value,
            };
        }
    }
}
