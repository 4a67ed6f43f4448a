//! What may be typed in a scene file: every table, every key, its quantity, range, default and meaning.
//!
//! Each table is declared once; reader, JSON Schema and docs/scene.md follow from the declaration. `lift` turns
//! these tables into the typed scene. Rules that concern more than one key stand there, not here.

mod declare;
mod dimension;
mod groups;
mod materials;
mod range;
mod read;
mod sections;
mod values;

pub(super) use dimension::DimensionWord;
pub(super) use groups::{Coordinates, Entry, Gravity, List, Named, SeriesPoint};
pub(super) use materials::*;
pub(super) use read::{At, Place, Problems, nearest, read_document, syntax_place};
pub(super) use sections::*;
pub(super) use values::{Angle, Density, Length, Pressure, Ratio, Speed, Text, Viscosity};

use declare::{choice, table, tagged};
use range::Range;
use read::{Field, KeySpec, Need, Node, refuse_unknown};
use values::{AngularSpeed, Compressibility, Flag, MassRate, Name, Time, Whole, choose, read_word};
