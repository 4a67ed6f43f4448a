//! The key `dimension`: 2, 3 or "axisymmetric".

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use toml::de::DeValue;

use super::problems::Problems;
use super::read::{Field, Node, describe};
use super::values::schemas;

/// What the coordinates of a scene stand for, as typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum DimensionWord {
    /// `2`
    Two,
    /// `3`
    Three,
    /// `"axisymmetric"`
    Axisymmetric,
}

impl Field for DimensionWord {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let word = match node.value() {
            DeValue::Integer(i) if i.radix() == 10 && i.as_str() == "2" => Some(Self::Two),
            DeValue::Integer(i) if i.radix() == 10 && i.as_str() == "3" => Some(Self::Three),
            DeValue::String(text) if &**text == "axisymmetric" => Some(Self::Axisymmetric),
            _ => None,
        };
        if word.is_none() {
            problems.report(
                node.place(),
                describe(node.value()),
                "2, 3 or \"axisymmetric\"",
                "write dimension = 2 (plane strain), 3, or \"axisymmetric\" (x is the radius, y the height)",
            );
        }
        word
    }

    fn example() -> String {
        "2".to_owned()
    }
}

schemas! {
    [] DimensionWord, "DimensionWord", { "enum": [2, 3, "axisymmetric"] };
}
