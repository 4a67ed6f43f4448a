//! The scalars of a log side by side: one row a communication point, the columns of the run's `gauges.csv`. Rows of
//! steps that were taken back are left out.

mod builder;

use super::ending::Ending;
use super::error::ReadError;
use super::raw::{RawEntry, RawReader};
use super::read::decode;
use super::standing::Standing;
use crate::scene;
use builder::Builder;
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
            Some(builder) => builder.finish(),
            None => {
                let path = path.to_owned();
                return Err(match reader.how_cut() {
                    Some(ending) => ReadError::BeforeScene { path, ending }.into(),
                    None => TableError::NoScene { path },
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
