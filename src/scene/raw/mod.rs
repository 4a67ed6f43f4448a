//! What may be typed in a scene file: every table, every key, its quantity, range, default and meaning.
//!
//! Each table is declared once; reader, JSON Schema and docs/scene.md follow from the declaration. `lift` turns
//! these tables into the typed scene. Rules that concern more than one key stand there, not here.

mod bodies;
mod declare;
mod devices;
mod dimension;
mod gauges;
mod groups;
mod key;
mod materials;
mod numerics;
mod problems;
mod range;
mod read;
mod run;
mod sections;
mod shapes;
mod unknown;
mod values;

pub(super) use bodies::*;
pub(super) use devices::*;
pub(super) use dimension::DimensionWord;
pub(super) use gauges::*;
pub(super) use groups::{Coordinates, Entry, Gravity, List, Named, SeriesPoint};
pub(super) use materials::*;
pub(super) use numerics::*;
pub(super) use problems::{Place, Problems, syntax_place};
pub(super) use read::{At, read_document};
pub(super) use run::*;
pub(super) use sections::*;
pub(super) use shapes::*;
pub(super) use unknown::nearest;
pub(super) use values::{
    Angle, AngularSpeed, Density, Length, Pressure, Ratio, Scalar, Speed, Text, Viscosity,
};

use declare::{choice, table, tagged};
use key::{KeySpec, Need};
use range::Range;
use read::{Field, Node};
use unknown::refuse_unknown;
use values::{Compressibility, Flag, MassRate, Name, Time, Whole, choose, read_word};
